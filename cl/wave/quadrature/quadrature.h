// What both methods know in addition to the ray and the source.
#pragma once
#include "../types.h"
#include "decay.h"

typedef struct {
    __global const Node *nodes; // of the Simpson rule
    uint node_count;
    Decay decay;
    float smooth_threshold, kinked_threshold; // exact: how large unresolved coefficients may be, of the integral
    __global uint *counts;
} Quadrature;

Quadrature quadrature_of(const Integrand *const integrand, __global const Node *const nodes,
                         __global uint *const counts, const floatv ray_length) {
    const Quadrature quadrature = {nodes,
                                   integrand->node_count,
                                   decay_of(integrand, ray_length),
                                   integrand->smooth_threshold,
                                   integrand->kinked_threshold,
                                   counts};
    return quadrature;
}
