// The light that space gives off in the cells of a grid: each work-item sums emission times field (Watanabe, Abe, Konno
// 2015, eq. 18) in a row of cells along x, as seen by rays along it.
#include "../view.h"
#include "radiance.h"

#ifndef POWER_OF_REST // a test spoils it
#define POWER_OF_REST 3
#endif

// Adds a source's light to that of cells, and where that is asked for to what all but the strongest source give. Of
// light m and less light l what counts as the strongest is (m^4 + l^4) / (m^3 + l^3): next to a core m itself but for
// the cube of l/m, and smooth where another source becomes the strongest. The rest is m times (q + q^3) / (1 + q^3).
void add_to_cells(const Cells *const cells, __global float *const restrict to, const floatv light) {
    const floatv before = LOAD_LANES(to);
    STORE_LANES(before + light, to);
    if (cells->channels == 3u)
        return;
    __global float *const restrict rest_to = to + 3 * cells->plane;
    const floatv rest = LOAD_LANES(rest_to), strongest = before - rest;
    const floatv more = max(strongest, light), less = max(min(strongest, light), splat(0.0f));
    const floatv q = less / max(more, splat(1e-30f));
    floatv cube = q;
    for (int i = 1; i < POWER_OF_REST; ++i)
        cube *= q;
    STORE_LANES(fma(more, (q + cube) / (1.0f + cube), rest), rest_to);
}

#include "cells.h" // sphere_add_to_row and so on

// Returns rays along a row of cells, through one of its places across.
Ray ray_along(const Cells *const cells, const uint row, const float y, const float z, const float softening2) {
    const float length = cells->step * (float)cells->columns;
    const float3v origin = {splat(cells->first.x),
                            splat(cells->first.y + cells->step * ((float)(row % cells->rows) + y)),
                            splat(cells->first.z + cells->step * ((float)(row / cells->rows) + z))};
    const fine3v from = {to_finev(origin.x), to_finev(origin.y), to_finev(origin.z)};
    const fine3v toward = {to_finev(splat(length)), to_finev(splat(0.0f)), to_finev(splat(0.0f))};
    Ray ray = make_ray(from, toward, splat(1.0f), splat(length), softening2);
    ray.floor2 = splat(cells->floor2);
    return ray;
}

#define ADD_TO_ROW(kind, Type, number)                                                                                 \
    for (uint i = launch.begin[number]; i < launch.end[number]; ++i)                                                   \
        kind##_add_to_row(&cells, &ray, &sources, i, values + row * cells.stride);

__kernel void bake(const Cells cells, const uint first_row, const uint end_row, const Integrand integrand,
                   const Launch launch, KINDS(SOURCE_PARAMETER) __global const float4 *const restrict rows,
                   __global float *const restrict values) {
    const uint row = first_row + get_global_id(0);
    if (row >= end_row)
        return;
    const Sources sources = {KINDS(SOURCE_VALUE) rows};
    for (uint channel = 0; channel < cells.channels; ++channel)
        for (uint x = 0; x < cells.stride; x += LANES)
            STORE_LANES(splat(0.0f), values + row * cells.stride + channel * cells.plane + x);
    const float per_part = 1.0f / (float)cells.parts;
    for (uint part = 0; part < cells.parts * cells.parts; ++part) {
        const float y = per_part * ((float)(part % cells.parts) + 0.5f),
                    z = per_part * ((float)(part / cells.parts) + 0.5f);
        const Ray ray = ray_along(&cells, row, y, z, integrand.softening2);
        KINDS(ADD_TO_ROW)
    }
}
