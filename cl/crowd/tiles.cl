// The light of many points of light, seen in tiles. A tile of level k is a square of 8 * 2^k pixels; it has the light
// at 4x4 nodes of all sources that lie in none of the 3x3 cells around it. Where those have so little light that it may
// be misplaced within them, a tile ends with their softened light; else it is quartered. Tiles of 8 pixels that are
// open at the end take the sources around them one by one.
#pragma once
#include "../film.h"
#include "build.h"

#define NODES 16u
#define BATCHES (NODES / LANES)

// Light is softened by this share of a tile's side.
#define SOFTENING 0.35f

#ifndef BLOCK // a test spoils it
#define BLOCK(view) (view)->block
#endif

// How many times misplaced light may be larger than its mean.
#ifndef CAUTION
#define CAUTION 1.0f
#endif

typedef struct {
    Rays rays[BATCHES];
    float3v light[BATCHES];
} NodesOfTile;

// What all cells have.
typedef struct {
    __global const uint *starts;
    __global const float4 *peaks, *levels, *nodes, *limits;
    __global const float *numbers;
} Cells;

bool is_empty_cell(const Cells *const cells, const uint level, const uint code) {
    return cells->starts[code << (2u * level)] == cells->starts[(code + 1u) << (2u * level)];
}

INLINE void add_light(float3v *const light, const floatv core, const float4 source) {
    light->x = fma(core, splat(source.x), light->x);
    light->y = fma(core, splat(source.y), light->y);
    light->z = fma(core, splat(source.z), light->z);
}

// Adds the light of a cell at the nodes of a tile, softened by an angle.
INLINE void add_cell(const CrowdView *const view, const Cells *const cells, const uint level, const uint code,
                     const float angle, NodesOfTile *const tile) {
    const uint n = view->nodes;
    const float half_side = (float)(4u << level);
    const float column = (2.0f * (float)every_other(code) + 1.0f) * half_side;
    const float row = (2.0f * (float)every_other(code >> 1) + 1.0f) * half_side;
    const float middle_u = slope_u(view, column), middle_v = slope_v(view, row);
    const float soft4 = angle * angle * angle * angle;
    const bool has_depths = level >= view->base;
    const uint at = cells_below(view, level) + code;
    const uint depths = has_depths ? view->depths : 1u;
    const uint from = has_depths ? (at - cells_below(view, view->base)) * n * n * depths : at * n * n;
    for (uint j = 0u; j < n; ++j) {
        const float v = fma(half_side * view->step_v, cells->numbers[CELL_NODES + j], middle_v);
        for (uint i = 0u; i < n; ++i) {
            const float u = fma(half_side * view->step_u, cells->numbers[CELL_NODES + i], middle_u);
            const float length2 = fma(u, u, fma(v, v, 1.0f)), per_length2 = 1.0f / length2;
            for (uint batch = 0u; batch < BATCHES; ++batch) {
                const Rays *const rays = &tile->rays[batch];
                const floatv beside2 = cross2(rays->u - u, rays->v - v, u, v);
                if (!has_depths) {
                    floatv sine2 = beside2 * rays->per_stretch * rays->per_stretch * per_length2;
                    if (angle > 0.0f)
                        sine2 = root(fma(sine2, sine2, splat(soft4)));
                    add_light(&tile->light[batch], core_of(view, sine2), cells->limits[from + j * n + i]);
                    continue;
                }
                for (uint q = 0u; q < depths; ++q) {
#ifdef ONE_DEPTH
                    const float z = cells->numbers[DEPTHS_THEMSELVES]; // spoiled
#else
                    const float z = cells->numbers[DEPTHS_THEMSELVES + q];
#endif
                    const float far2 = z * z * length2;
                    const floatv light = light_of_place(view, rays, u, v, z, beside2, soft4 * far2 * far2);
                    add_light(&tile->light[batch], light, cells->nodes[from + (q * n + j) * n + i]);
                }
            }
        }
    }
    if (!has_depths)
        for (uint batch = 0u; batch < BATCHES; ++batch)
            add_light(&tile->light[batch], splat(1.0f), cells->levels[at]);
}

// Adds the light of sources beside the grid, or near the eye, at the nodes of a tile.
INLINE void add_rest(const CrowdView *const view, __global const float *const restrict rest, NodesOfTile *const tile) {
    for (uint index = 0u; index < view->rest; ++index) {
        const float x = rest[6u * index], y = rest[6u * index + 1u], z = rest[6u * index + 2u];
        const float4 light = (float4)(rest[6u * index + 3u], rest[6u * index + 4u], rest[6u * index + 5u], 0.0f);
        for (uint batch = 0u; batch < BATCHES; ++batch) {
            const Rays *const rays = &tile->rays[batch];
            const floatv a = fma(splat(-z), rays->v, splat(y)), b = fma(splat(z), rays->u, splat(-x)),
                         c = fma(splat(x), rays->v, -y * rays->u);
            const floatv least = fma(a, a, fma(b, b, c * c)) * rays->per_stretch * rays->per_stretch;
            const floatv along = fma(splat(x), rays->u, fma(splat(y), rays->v, splat(z))) * rays->per_stretch;
            add_light(&tile->light[batch], light_beside(view, rays->begin - along, least), light);
        }
    }
}

// Writes the light at the nodes of a tile that its parent has at its own.
void inherit(__global const float *const numbers, __global const float *const parent, const uint code,
             float *const light) {
    __global const float *const across = numbers + QUARTER_WEIGHTS + 16u * (code & 1u);
    __global const float *const down = numbers + QUARTER_WEIGHTS + 16u * (code >> 1 & 1u);
    for (uint channel = 0u; channel < 3u; ++channel) {
        float half_way[NODES];
        for (uint row = 0u; row < 4u; ++row)
            for (uint i = 0u; i < 4u; ++i) {
                float sum = 0.0f;
                for (uint k = 0u; k < 4u; ++k)
                    sum = fma(across[4u * i + k], parent[NODES * channel + 4u * row + k], sum);
                half_way[4u * row + i] = sum;
            }
        for (uint j = 0u; j < 4u; ++j)
            for (uint i = 0u; i < 4u; ++i) {
                float sum = 0.0f;
                for (uint k = 0u; k < 4u; ++k)
                    sum = fma(down[4u * j + k], half_way[4u * k + i], sum);
                light[NODES * channel + 4u * j + i] = sum;
            }
    }
}

// Returns the least light of each channel at the nodes.
float4 least_light(const NodesOfTile *const tile) {
    float lanes[3][NODES];
    float4 least = (float4)(INFINITY);
    for (uint batch = 0u; batch < BATCHES; ++batch) {
        scatter(tile->light[batch].x, lanes[0] + batch * LANES);
        scatter(tile->light[batch].y, lanes[1] + batch * LANES);
        scatter(tile->light[batch].z, lanes[2] + batch * LANES);
    }
    for (uint node = 0u; node < NODES; ++node)
        least = fmin(least, (float4)(lanes[0][node], lanes[1][node], lanes[2][node], INFINITY));
    return least;
}

// Returns whether the light of the cells around a tile may be misplaced within them.
INLINE bool is_enough(const CrowdView *const view, const Cells *const cells, const uint level, const uint column,
                      const uint row, const float angle, const NodesOfTile *const tile) {
#ifdef ENOUGH_ALWAYS
    return true; // spoiled
#endif
    const uint across = cells_across(view, level), first = cells_below(view, level);
    float4 peak = (float4)(0.0f);
    const uint block = max(BLOCK(view), 1u);
    for (uint y = max(row, block) - block; y < min(row + block + 1u, across); ++y)
        for (uint x = max(column, block) - block; x < min(column + block + 1u, across); ++x) {
            const float4 it = cells->peaks[first + code_of(x, y)];
            peak.xyz += it.xyz;
            peak.w = max(peak.w, it.w);
        }
    const float4 least = view->tolerance * least_light(tile);
    const float spread = CAUTION * (view->is_square ? 1.0f / angle : 1.0f);
    const float of_one = view->is_square ? 20.0f / angle : -2.0f * log(0.05f * angle);
    const float most = max(least.x, max(least.y, least.z));
    const float share = view->is_square ? 10.0f : 1.0f;
    return all(isless(spread * peak.xyz, least.xyz) | (peak.xyz == 0.0f)) && peak.w * of_one <= share * most;
}

__kernel void light_tiles(const CrowdView view, const uint level, const uint first_slot, const uint next_slot,
                          __global const uint *const restrict roots, __global const uint *const restrict starts,
                          __global const float4 *const restrict peaks, __global const float4 *const restrict levels,
                          __global const float4 *const restrict nodes, __global const float4 *const restrict limits,
                          __global const float *const restrict rest, __global const float *const restrict numbers,
                          __global CrowdTile *const restrict tiles, __global float *const restrict values,
                          __global uint *const restrict owners, __global uint *const restrict is_wanted,
                          __global uint *const restrict counts) {
    const Cells cells = {starts, peaks, levels, nodes, limits, numbers};
    const uint count = level == view.top ? view.roots : counts[level];
    const uint across = cells_across(&view, level);
    const float half_side = (float)(4u << level);
    for (uint number = get_global_id(0); number < count; number += get_global_size(0)) {
        const uint slot = first_slot + number;
        const uint code = level == view.top ? roots[number] : tiles[slot].code;
        const uint column = every_other(code), row = every_other(code >> 1);
        NodesOfTile tile;
        const float middle_x = (2.0f * (float)column + 1.0f) * half_side,
                    middle_y = (2.0f * (float)row + 1.0f) * half_side;
        float place_u[NODES], place_v[NODES], inherited[3u * NODES];
        for (uint node = 0u; node < NODES; ++node) {
            place_u[node] = slope_u(&view, fma(half_side, numbers[TILE_NODES + (node & 3u)], middle_x));
            place_v[node] = slope_v(&view, fma(half_side, numbers[TILE_NODES + (node >> 2)], middle_y));
            inherited[node] = inherited[NODES + node] = inherited[2u * NODES + node] = 0.0f;
        }
        if (level < view.top)
            inherit(numbers, values + 3u * NODES * tiles[slot].parent, code, inherited);
        for (uint batch = 0u; batch < BATCHES; ++batch) {
            tile.rays[batch] =
                rays_through(&view, LOAD_LANES(place_u + batch * LANES), LOAD_LANES(place_v + batch * LANES));
            tile.light[batch].x = LOAD_LANES(inherited + batch * LANES);
            tile.light[batch].y = LOAD_LANES(inherited + NODES + batch * LANES);
            tile.light[batch].z = LOAD_LANES(inherited + 2u * NODES + batch * LANES);
        }

        // What lies around the parent, and not around the tile itself.
        const bool is_top = level == view.top;
        const uint block = BLOCK(&view), around = 2u * view.block;
        const uint west = is_top ? 0u : (column & ~1u) - min(column & ~1u, around);
        const uint north = is_top ? 0u : (row & ~1u) - min(row & ~1u, around);
        const uint east = is_top ? across : min((column & ~1u) + around + 2u, across);
        const uint south = is_top ? across : min((row & ~1u) + around + 2u, across);
        uint looked_at = 0u;
        for (uint y = north; y < south; ++y)
            for (uint x = west; x < east; ++x) {
                const bool is_near = x + block >= column && x <= column + block && y + block >= row && y <= row + block;
                const uint cell = code_of(x, y);
                if (is_near || is_empty_cell(&cells, level, cell))
                    continue;
                add_cell(&view, &cells, level, cell, 0.0f, &tile);
                ++looked_at;
            }
        if (is_top)
            add_rest(&view, rest, &tile);

        const float mid_u = slope_u(&view, middle_x), mid_v = slope_v(&view, middle_y);
        const float side = 2.0f * half_side * sqrt(view.step_u * view.step_v);
        const float angle = side / fma(mid_u, mid_u, fma(mid_v, mid_v, 1.0f));
        const bool ends = is_enough(&view, &cells, level, column, row, angle, &tile);
        if (ends) {
#ifndef NO_BLOCK_LIGHT
            for (uint y = max(row, block) - block; y < min(row + block + 1u, across); ++y)
                for (uint x = max(column, block) - block; x < min(column + block + 1u, across); ++x) {
                    const uint cell = code_of(x, y);
                    if (is_empty_cell(&cells, level, cell))
                        continue;
                    add_cell(&view, &cells, level, cell, SOFTENING * angle, &tile);
                    ++looked_at;
                }
#endif
        }
        atomic_add(counts + (level >= view.base ? COUNTED_CELLS : COUNTED_LIMITS), looked_at);
        __global float *const value = values + 3u * NODES * slot;
        for (uint batch = 0u; batch < BATCHES; ++batch) {
            STORE_LANES(tile.light[batch].x, value + batch * LANES);
            STORE_LANES(tile.light[batch].y, value + NODES + batch * LANES);
            STORE_LANES(tile.light[batch].z, value + 2u * NODES + batch * LANES);
        }
        tiles[slot].code = code, tiles[slot].level = level, tiles[slot].is_open = ends ? 0u : 1u;

        // The tiles of 8 pixels in it, as far as the image goes, belong to it; or its quarters follow.
        const uint left = view.left >> 3, above = view.above >> 3;
        const uint right = left + view.tile_columns, below = above + ((view.height + 7u) >> 3);
        if (ends || level == 0u) {
            for (uint y = max(row << level, above); y < min((row + 1u) << level, below); ++y)
                for (uint x = max(column << level, left); x < min((column + 1u) << level, right); ++x)
                    owners[(y - above) * view.tile_columns + x - left] = slot;
            continue;
        }
        for (uint quarter = 0u; quarter < 4u; ++quarter) {
            const uint x = 2u * column + (quarter & 1u), y = 2u * row + (quarter >> 1), below_level = level - 1u;
            const bool is_seen = ((x + 1u) << below_level) > left && (x << below_level) < right &&
                                 ((y + 1u) << below_level) > above && (y << below_level) < below;
            if (!is_seen)
                continue;
            const uint next = next_slot + atomic_inc(counts + below_level);
            tiles[next].code = 4u * code + quarter, tiles[next].parent = slot;
        }
        if (level <= view.base)
            for (uint y = max(row, view.block) - view.block; y < min(row + view.block + 1u, across); ++y)
                for (uint x = max(column, view.block) - view.block; x < min(column + view.block + 1u, across); ++x)
                    atomic_or(is_wanted + cells_below(&view, level) + code_of(x, y), 1u);
    }
}

// Forgets the counts, and which cells are looked at.
__kernel void clear_crowd(const CrowdView view, __global uint *const restrict counts,
                          __global uint *const restrict is_wanted) {
    const uint number = get_global_id(0);
    if (number < COUNTED_END)
        counts[number] = 0u;
    if (number < cells_below(&view, view.top + 1u))
        is_wanted[number] = 0u;
}
