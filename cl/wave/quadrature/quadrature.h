// What both methods know in addition to the ray and the source.
#pragma once
#include "../../random.h"
#include "../types.h"
#include "decay.h"
#include "reduction.h"

typedef struct {
    __global const Node *nodes; // of a sum: Simpson's rule, or with -D JITTERED strata
    uint node_count;
#ifdef JITTERED
    floatv beyond; // how far beyond the beginning of every stratum its sample is, of the parameter s
#endif
    Decay decay;
    float smooth_threshold, kinked_threshold; // exact: how large unresolved coefficients may be, of the integral
    __global uint *counts;
} Quadrature;

// `number` is that of each lane's ray: of its pixel, or in its list.
Quadrature quadrature_of(const Integrand *const integrand, __global const Node *const nodes,
                         __global uint *const counts, const floatv ray_length, const uintv number) {
    const Quadrature quadrature = {nodes,
                                   integrand->node_count,
#ifdef JITTERED
                                   random_of(number, integrand->seed) * (1.0f / (float)integrand->node_count),
#endif
                                   decay_of(integrand, ray_length),
                                   integrand->smooth_threshold,
                                   integrand->kinked_threshold,
                                   counts};
    return quadrature;
}
