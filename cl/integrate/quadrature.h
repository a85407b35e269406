// What both methods know besides the ray and the source.
#pragma once
#include "../decay.h"
#include "../types.h"

typedef struct {
    __global const Node *nodes; // of the Simpson rule
    uint node_count;
    Decay decay;
    float torus_threshold, curve_threshold; // exact: how large unresolved coefficients may be, of the integral
    __global uint *counts;
} Quadrature;
