// Chebyshev nodes of tiles and cells: cos(pi (2 i + 1) / 2 n) on [-1, 1], and the weights with which values there are
// interpolated, or light is laid on them (Lagrange).
#pragma once
#include "types.h"

// Writes the weights of a place for n nodes.
INLINE void weights_at(__global const float *const numbers, const uint nodes, const uint n, const float x,
                       float *const weights) {
#ifdef TWO_NODES // spoiled: as if a cell had two along each side
    if (nodes == CELL_NODES) {
        for (uint i = 0u; i < n; ++i)
            weights[i] = fma(2.0f * x, numbers[nodes + i], 1.0f) / (float)n;
        return;
    }
#endif
    float product = 1.0f;
    for (uint i = 0u; i < n; ++i) {
        weights[i] = product * numbers[FACTORS + nodes + i];
        product *= x - numbers[nodes + i];
    }
    product = 1.0f;
    for (uint i = n; i > 0u; --i) {
        weights[i - 1u] *= product;
        product *= x - numbers[nodes + i - 1u];
    }
}

// The same in lanes, for the four nodes of a tile.
INLINE void tile_weights(__global const float *const numbers, const floatv x, floatv weights[4]) {
    floatv product = splat(1.0f);
    for (uint i = 0u; i < 4u; ++i) {
        weights[i] = product * numbers[FACTORS + TILE_NODES + i];
        product *= x - numbers[TILE_NODES + i];
    }
    product = splat(1.0f);
    for (uint i = 4u; i > 0u; --i) {
        weights[i - 1u] *= product;
        product *= x - numbers[TILE_NODES + i - 1u];
    }
}

// Returns the slope of a place of the grid.
float slope_u(const CrowdView *const view, const float column) {
    return fma(view->step_u, column, view->first_u);
}

float slope_v(const CrowdView *const view, const float row) {
    return fma(view->step_v, row, view->first_v);
}
