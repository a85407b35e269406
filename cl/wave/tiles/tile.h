// Square tiles of pixels whose light is interpolated from 16 of their pixels, the nodes: four rows of four, near the
// zeros of the Chebyshev polynomial. A group of work-items works on a tile, 16 rays at a time in rounds of all their
// lanes: on a GPU 16 of one lane each, elsewhere a single one (PoCL 3.1 compiles barriers for hours).
#pragma once
#include "../../film.h"
#include "../../view.h"
#include "../types.h"

#define NODES_A_SIDE 4
#define TILE_RAYS 16u
#define BLOCK_WIDTH 8u

// Rays that a group takes in a round: 16, or 32, a tile's nodes and its tests side by side. The tests are wasted where
// the nodes fail, on work-items that would have waited.
#if LANES * TILE_WORKERS > 16
#define ROUND_RAYS 32u
#else
#define ROUND_RAYS (LANES * TILE_WORKERS)
#endif
#define ALL_RAYS (2u * TILE_RAYS)               // the nodes, then the tests
#define ROUNDS (ALL_RAYS / ROUND_RAYS)          // of all rays
#define TILE_ROUNDS ((ROUNDS + 1u) / 2u)        // of the nodes, or of the tests
#define FIRST_TEST_ROUND (ROUNDS - TILE_ROUNDS) // in which the tests begin
#define BLOCK_HEIGHT (ROUND_RAYS > TILE_RAYS ? 4u : 2u)
#define BLOCK_ROUNDS (BLOCK_WIDTH * BLOCK_HEIGHT / ROUND_RAYS)

// What the work-items of a group show each other.
#if TILE_WORKERS > 1
#define meet() barrier(CLK_LOCAL_MEM_FENCE)
#else
#define meet()
#endif

// Before what all have just read is written again; spoiled builds leave it out.
#ifndef meet_again
#define meet_again() meet()
#endif

// A tile's place in the image, pixels.
typedef struct {
    uint column, row;
} Tile;

// Returns the first of the rays that this work-item takes in a round.
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

// Returns the pixel of a node in its row or column.
uintv node_place(const TilePass *const pass, const uintv node) {
    const uintv from_begin = (node & 1u) * pass->inner, from_end = ((node + 1u) & 1u) * pass->inner;
    return select(from_begin, pass->size - 1u - from_end, node > 1u);
}

// Returns the column (turn 1) or row (turn 7) of a point where the interpolation is put to the test: no two share
// either, so that no stripe passes between them.
uintv test_place(const TilePass *const pass, const uintv ray, const uint turn) {
    const uintv sixteenth = (ray * turn + (turn >> 1u)) % TILE_RAYS;
    return pass->size * (2u * sixteenth + 1u) / (2u * TILE_RAYS);
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

// Interpolates values at the nodes, by rows, down to one row of four.
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

// The rays of a tile: through its nodes, then through the points where interpolation is tested, with the weights of the
// nodes there.
typedef struct {
    Ray rays[ROUNDS];
    Basis across[TILE_ROUNDS], down[TILE_ROUNDS];
} TileRays;

// Returns whether a ray of this work-item is a node's, in a round that has nodes.
bool is_node(const uint ray) {
    return ROUND_RAYS <= TILE_RAYS || ray < TILE_RAYS;
}

INLINE TileRays rays_of_tile(const Screen *const screen, const TilePass *const pass, const Tile *const tile) {
    TileRays rays;
    for (uint round = 0; round < ROUNDS; ++round) {
        const uint first = first_ray(round);
        const uintv ray = (first & (TILE_RAYS - 1u)) + LANE_NUMBERS;
        const bool is_test = first >= TILE_RAYS;
        const uintv column = is_test ? test_place(pass, ray, 1u) : node_place(pass, ray & 3u);
        const uintv row = is_test ? test_place(pass, ray, 7u) : node_place(pass, ray >> 2u);
        rays.rays[round] = ray_through(screen, tile->column + column, tile->row + row);
        if (round >= FIRST_TEST_ROUND) {
            rays.across[round - FIRST_TEST_ROUND] = basis_at(pass, column);
            rays.down[round - FIRST_TEST_ROUND] = basis_at(pass, row);
        }
    }
    return rays;
}

// Writes the pixels of a block from this ray on, and what is gathered for them; the image has `columns` columns and
// `rows` rows of it.
INLINE void store_block(const FilmPart *const part, const uint corner, const uint ray, const uint columns,
                        const uint rows, float3v color, FILM_PARAMETER) {
    const Clip clip = {ray, BLOCK_WIDTH, part->width, columns, rows};
    if (part->adds)
        color = add3(color, gathered_clipped(part, corner, &clip, pixels));
#ifdef STORES_WHOLE
    if (columns >= BLOCK_WIDTH && rows >= BLOCK_HEIGHT && stores_whole(part)) {
        const uint first = corner + ray / BLOCK_WIDTH * part->width + ray % BLOCK_WIDTH;
        const uint second = first + (LANES == TILE_RAYS ? part->width : LANES / 2);
        store_all_pixels(channels_of(part, first, FILM_ARGUMENT), channels_of(part, second, FILM_ARGUMENT), color);
        return;
    }
#endif
    store_clipped(part, corner, &clip, color, FILM_ARGUMENT);
}
