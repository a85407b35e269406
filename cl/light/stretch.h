// What the forms of cores share: stretches of a core, sums over them, and its light. A lane is a point of a surface.
//
// In all files here y is a vector from the surface's point, and n the surface's normal, of length 1. A stretch lies all
// above the horizon, n.y > 0.
#pragma once
#include "../elementary.h"
#include "../roots.h"
#include "types.h"

// How a surface faces a place.
#ifdef WITHOUT_COSINE
#define FACING(normal, y) sqrt(dot3(y, y))
#else
#define FACING(normal, y) dot3(normal, y)
#endif

#define PI_F 3.14159265f
#define LOG2_E 1.44269504f

// From where to where up to two parts of a core go, in its parameter; a part that goes nowhere is none.
typedef struct {
    floatv from[2], to[2];
} Stretches;

// Adds one, unless it is empty.
void add_stretch(Stretches *const stretches, const floatv from, const floatv to) {
    const intv is_some = to > from, is_first = !(stretches->to[0] > stretches->from[0]);
    stretches->from[0] = select(stretches->from[0], from, is_some & is_first);
    stretches->to[0] = select(stretches->to[0], to, is_some & is_first);
    stretches->from[1] = select(stretches->from[1], from, is_some & !is_first);
    stretches->to[1] = select(stretches->to[1], to, is_some & !is_first);
}

Stretches no_stretch(void) {
    const floatv zero = splat(0.0f);
    const Stretches none = {{zero, zero}, {zero, zero}};
    return none;
}

int is_even(__global const CastLight *const core) {
    return all(core->slope.xyz == 0.0f) && all(core->bend.xyz == 0.0f);
}

// Sums of weights over a core, times 1, s and s^2, s from 0 to 1 over its parameter: what its light is made of.
typedef struct {
    floatv even, slope, bend;
} LitSum;

void add_lit(LitSum *const sum, __global const CastLight *const core, const floatv weight, const floatv s) {
    sum->even += weight;
    if (is_even(core))
        return;
    sum->slope = fma(weight, s, sum->slope);
    sum->bend = fma(weight * s, s, sum->bend);
}

LitSum no_light(void) {
    const LitSum none = {splat(0.0f), splat(0.0f), splat(0.0f)};
    return none;
}

// Returns the light, linear RGB, of such sums.
float3v light_of(__global const CastLight *const core, const LitSum sum) {
    const float3v even = scale3(uniform3(core->light), sum.even);
    return fma3(uniform3(core->bend), sum.bend, fma3(uniform3(core->slope), sum.slope, even));
}

// Nodes above 0 and weights of Gauss' rules on [-1,1], of 4, 6, 8 and 12 nodes.
__constant float GAUSS_NODES[15] = {0.339981044f, 0.861136312f, 0.238619186f, 0.661209386f, 0.932469514f,
                                    0.183434642f, 0.525532410f, 0.796666477f, 0.960289856f, 0.125233409f,
                                    0.367831499f, 0.587317954f, 0.769902674f, 0.904117256f, 0.981560634f};
__constant float GAUSS_WEIGHTS[15] = {0.652145155f, 0.347854845f, 0.467913935f, 0.360761573f, 0.171324492f,
                                      0.362683783f, 0.313706646f, 0.222381034f, 0.101228536f, 0.249147046f,
                                      0.233492537f, 0.203167427f, 0.160078329f, 0.106939326f, 0.0471753364f};
typedef struct {
    uint first, end;
} Rule;
__constant Rule RULE_4 = {0u, 2u}, RULE_6 = {2u, 5u}, RULE_8 = {5u, 9u}, RULE_12 = {9u, 15u};
