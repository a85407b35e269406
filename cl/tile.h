// Square tiles of pixels whose light is interpolated from 16 of their pixels, the nodes: four in a row and four rows of
// them, near the zeros of the Chebyshev polynomial. A group of work-items works on a tile, 16 rays at a time in rounds
// of all their lanes: on a GPU 16 of one lane each, elsewhere a single one (PoCL 3.1 compiles barriers for hours).
#pragma once
#include "ray.h"
#include "store.h"
#include "types.h"

#define NODES_A_SIDE 4
#define TILE_RAYS 16u
#define TILE_ROUNDS (TILE_RAYS / (LANES * TILE_WORKERS))
#define BLOCK_WIDTH 8u
#define BLOCK_HEIGHT 2u

// What the work-items of a group show each other.
#if TILE_WORKERS > 1
#define meet() barrier(CLK_LOCAL_MEM_FENCE)
#else
#define meet()
#endif

// Its place in the image, pixels.
typedef struct {
    uint column, row;
} Tile;

// The first of the rays that this work-item takes in a round.
uint first_ray(const uint round) {
    return (round * TILE_WORKERS + (uint)get_local_id(0)) * LANES;
}

// Shows the group what this work-item has for its rays; all see it after they meet.
void show(const floatv value, const uint ray, __local float *const values) {
#if LANES == 1
    values[ray] = value;
#else
    JOIN(vstore, LANES)(value, 0, values + ray);
#endif
}

floatv shown(const uint ray, __local const float *const values) {
#if LANES == 1
    return values[ray];
#else
    return JOIN(vload, LANES)(0, values + ray);
#endif
}

// Pixel of a node in its row or column.
uintv node_place(const TilePass *const pass, const uintv node) {
    const uintv from_begin = (node & 1u) * pass->inner, from_end = ((node + 1u) & 1u) * pass->inner;
    return select(from_begin, pass->size - 1u - from_end, node > 1u);
}

// Pixel of a point between the nodes, where the interpolation is put to the test: there the first polynomial that it
// cannot render is largest.
uintv test_place(const TilePass *const pass, const uintv node) {
    const uint outer = (15u * pass->size + 64u) / 128u, inner = 25u * pass->size / 64u;
    const uintv from_begin = select((uintv)(outer), (uintv)(inner), (node & 1u) != 0u);
    return select(from_begin, pass->size - 1u - from_begin, node > 1u);
}

// Weights of the four nodes for a place between the first and the last, -1 to 1; the inner ones are at -q and q.
typedef struct {
    floatv weight[NODES_A_SIDE];
} Basis;

float inner_place(const TilePass *const pass) {
    return 1.0f - 2.0f * (float)pass->inner / (float)(pass->size - 1u);
}

INLINE Basis basis_at(const TilePass *const pass, const uintv place) {
    const float q = inner_place(pass);
    const floatv x = fma(to_floatv(place), splat(2.0f / (float)(pass->size - 1u)), splat(-1.0f));
    const float scale = 0.5f / (1.0f - q * q);
    const floatv outer = scale * fma(x, x, splat(-q * q)), inner = scale * fma(-x, x, splat(1.0f));
    const floatv turn = inner * x * (1.0f / q);
    const Basis basis = {{fma(-outer, x, outer), inner - turn, inner + turn, fma(outer, x, outer)}};
    return basis;
}

// Values at the nodes, by rows, taken down to one row of four.
INLINE void interpolate_down(__local const float *const values, const Basis *const down, floatv row[NODES_A_SIDE]) {
#pragma unroll
    for (uint j = 0; j < NODES_A_SIDE; ++j) {
        row[j] = down->weight[0] * values[j];
#pragma unroll
        for (uint i = 1; i < NODES_A_SIDE; ++i)
            row[j] = fma(down->weight[i], splat(values[NODES_A_SIDE * i + j]), row[j]);
    }
}

INLINE floatv interpolate_across(const floatv row[NODES_A_SIDE], const Basis *const across) {
    floatv value = across->weight[0] * row[0];
#pragma unroll
    for (uint j = 1; j < NODES_A_SIDE; ++j)
        value = fma(across->weight[j], row[j], value);
    return value;
}

INLINE floatv interpolate(__local const float *const values, const Basis *const down, const Basis *const across) {
    floatv row[NODES_A_SIDE];
    interpolate_down(values, down, row);
    return interpolate_across(row, across);
}

// The largest of the highest two Chebyshev coefficients of four rows of values at once: of an even and an odd function.
typedef struct {
    float even, odd;
} Coefficients;

float largest(const float4 v) {
    const float2 two = fmax(fabs(v.lo), fabs(v.hi));
    return fmax(two.x, two.y);
}

Coefficients highest_coefficients(const float q, const float4 v0, const float4 v1, const float4 v2, const float4 v3) {
    const float scale = 0.25f / (1.0f - q * q);
    const float4 even = (v0 + v3) - (v1 + v2), odd = (v3 - v0) - (v2 - v1) * (1.0f / q);
    const Coefficients c = {scale * largest(even), 0.5f * scale * largest(odd)};
    return c;
}

// Whether 16 shared numbers are all numbers, and none above 0.
bool none_is_positive(__local const float *const values) {
    bool none_is = true;
    for (uint k = 0; k < TILE_RAYS; ++k)
        none_is &= values[k] <= 0.0f;
    return none_is;
}

// Whether values at the nodes look like those of a function that can be interpolated: the highest coefficients are
// small beside the least value. Never where a value is not a number.
bool seems_smooth(const TilePass *const pass, __local const float *const values) {
    const float4 v0 = vload4(0, values), v1 = vload4(1, values), v2 = vload4(2, values), v3 = vload4(3, values);
    const float4 sizes = fmin(fmin(fabs(v0), fabs(v1)), fmin(fabs(v2), fabs(v3)));
    const float2 two = fmin(sizes.lo, sizes.hi);
    const float least = fmin(two.x, two.y);
    const float q = inner_place(pass);
    const Coefficients down = highest_coefficients(q, v0, v1, v2, v3);
    const Coefficients across =
        highest_coefficients(q, (float4)(v0.x, v1.x, v2.x, v3.x), (float4)(v0.y, v1.y, v2.y, v3.y),
                             (float4)(v0.z, v1.z, v2.z, v3.z), (float4)(v0.w, v1.w, v2.w, v3.w));
    const float4 sums = (v0 + v1) + (v2 + v3);
    const bool are_numbers = !isnan((sums.x + sums.y) + (sums.z + sums.w));
    return are_numbers && fmax(down.even, across.even) <= pass->most_even * least &&
           fmax(down.odd, across.odd) <= pass->most_odd * least;
}

// Writes (or adds to) the pixels of a block from the ray of this number on; the image has so many columns and rows of
// it.
INLINE void store_block(__global float4 *const corner, const uint ray, const uint pitch, const uint columns,
                        const uint rows, const float3v color, const uint accumulate) {
#ifndef NO_SHUFFLES
    if (columns >= BLOCK_WIDTH && rows >= BLOCK_HEIGHT && !accumulate) {
        __global float4 *const first = corner + ray / BLOCK_WIDTH * pitch + ray % BLOCK_WIDTH;
        store_all_pixels(first, first + (LANES == TILE_RAYS ? pitch : LANES / 2), color);
        return;
    }
#endif
    const Clip clip = {ray, BLOCK_WIDTH, pitch, columns, rows};
    store_clipped(corner, clip, color, accumulate);
}
