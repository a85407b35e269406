// What the forms of cores share: stretches of a core, sums over them, and its light.
//
// In all files here y is a vector from the surface's point, and n the surface's normal, of length 1. A stretch lies all
// above the horizon, n.y > 0.
#pragma once
#include "types.h"

// How a surface faces a place.
#ifndef FACING
#define FACING(normal, y) dot(normal, y)
#endif

#define PI_F 3.14159265f

// From where to where parts of a core go, in its parameter.
typedef struct {
    float from[2], to[2];
    int count;
} Stretches;

// Adds one, unless it is empty.
void add_stretch(Stretches *const stretches, const float from, const float to) {
    if (!(to > from) || stretches->count == 2)
        return;
    stretches->from[stretches->count] = from;
    stretches->to[stretches->count] = to;
    ++stretches->count;
}

// Returns the light at s, 0 to 1 over the core.
float3 light_at(__global const CastLight *const core, const float s) {
    return core->light.xyz + s * (core->slope.xyz + s * core->bend.xyz);
}

int is_even(__global const CastLight *const core) {
    return all(core->slope.xyz == 0.0f) && all(core->bend.xyz == 0.0f);
}

// Nodes and weights of Gauss' rules on [-1,1], the positive ones.
#define GAUSS_HALF 6
__constant float GAUSS_NODES[GAUSS_HALF] = {0.125233409f, 0.367831499f, 0.587317954f,
                                            0.769902674f, 0.904117256f, 0.981560634f};
__constant float GAUSS_WEIGHTS[GAUSS_HALF] = {0.249147046f, 0.233492537f, 0.203167427f,
                                              0.160078329f, 0.106939326f, 0.0471753364f};
__constant float FAR_NODES[2] = {0.339981044f, 0.861136312f};
__constant float FAR_WEIGHTS[2] = {0.652145155f, 0.347854845f};
