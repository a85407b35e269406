// What the forms of cores share: stretches of a core, sums over them, and its light.
//
// In all files here y is a vector from the surface's point, and n the surface's normal, of length 1. A stretch lies all
// above the horizon, n.y > 0.
#pragma once
#include "../lanes.h"
#include "types.h"

// How a surface faces a place.
#ifdef WITHOUT_COSINE
#define FACING(normal, y) length(y)
#define FACING3(normal, y) sqrt(dot3(y, y))
#else
#define FACING(normal, y) dot(normal, y)
#define FACING3(normal, y) dot3(uniform3((float4)(normal, 0.0f)), y)
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

// Returns the sum over lanes of a weight times the light at s.
float3 lit_sum(__global const CastLight *const core, const floatv weight, const floatv s) {
    const floatv weighted = weight * s;
    return sum_lanes(weight) * core->light.xyz + sum_lanes(weighted) * core->slope.xyz +
           sum_lanes(weighted * s) * core->bend.xyz;
}

// Nodes and weights of Gauss' rules on [-1,1], of 12 and of 4 nodes, to be taken LANES at a time: behind the last node
// weights are 0.
#define GAUSS_COUNT 12u
__constant float GAUSS_NODES[16] = {-0.981560634f, -0.904117256f, -0.769902674f, -0.587317954f,
                                    -0.367831499f, -0.125233409f, 0.125233409f,  0.367831499f,
                                    0.587317954f,  0.769902674f,  0.904117256f,  0.981560634f};
__constant float GAUSS_WEIGHTS[16] = {0.0471753364f, 0.106939326f, 0.160078329f, 0.203167427f,
                                      0.233492537f,  0.249147046f, 0.249147046f, 0.233492537f,
                                      0.203167427f,  0.160078329f, 0.106939326f, 0.0471753364f};
#define FAR_COUNT 4u
__constant float FAR_NODES[16] = {-0.861136312f, -0.339981044f, 0.339981044f, 0.861136312f};
__constant float FAR_WEIGHTS[16] = {0.347854845f, 0.652145155f, 0.652145155f, 0.347854845f};
