// The light of many points of light, seen in tiles. A tile of level k is a square of 8 * 2^k pixels; it has the light
// at 4x4 nodes of all sources that lie in none of the 3x3 cells around it. Where those have so little light that it may
// be misplaced within them, a tile ends with their softened light; else it is quartered. Tiles of 8 pixels that are
// open at the end take the sources around them one by one.
#pragma once
#include "cells.h"

// Light is softened by this share of a tile's side.
#define SOFTENING 0.35f

#ifndef BLOCK // a test spoils it
#define BLOCK(view) (view)->block
#endif

// How many times misplaced light may be larger than its mean.
#ifndef CAUTION
#define CAUTION 1.0f
#endif

// Cut rays see less light, and behind depths light changes at every edge: more may be misplaced.
#ifndef CAUTION_OF_CUT
#define CAUTION_OF_CUT 0.5f
#endif

// Writes the light at the nodes of a tile, of one end, that its parent has at its own.
void inherit(__global const float *const numbers, const float *const parent, const uint code, float *const light) {
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

// Numbers of the light of a tile.
#define VALUES (3u * NODES * MOST_ENDS)

#ifdef WITH_ENDS
// Writes the light of a parent up to a share of its rays.
void parent_up_to(const CrowdView *const view, __global const float *const table, __global const float *const values,
                  const float share, float *const light) {
    for (uint k = 0u; k < 3u * NODES; ++k)
        light[k] = 0.0f;
    float slab_at[LANES];
    scatter(slab_of(view, splat(share)), slab_at);
    const uint counts = as_uint(table[ROW_OF_ENDS - 1u]), own = (uint)slab_at[0];
    uint at = 0u;
    for (uint slab = 0u; slab < own; ++slab)
        at += nodes_in(counts, slab);
    const uint count = own == SLABS ? 1u : nodes_in(counts, own);
    float nodes[MOST_IN_SLAB];
    for (uint i = 0u; i < count; ++i)
        nodes[i] = table[at + i];
    for (uint i = 0u; i < count; ++i) {
        float weight = 1.0f;
        for (uint other = 0u; other < count; ++other)
            if (other != i)
                weight *= (share - nodes[other]) / (nodes[i] - nodes[other]);
        for (uint k = 0u; k < 3u * NODES; ++k)
            light[k] = fma(weight, values[3u * NODES * (at + i) + k], light[k]);
    }
}
#endif

// Returns the least light of each channel at the nodes up to an end.
float4 least_light(const NodesOfTile *const tile, const uint end) {
    float lanes[3][NODES];
    float4 least = (float4)(INFINITY);
    for (uint batch = 0u; batch < BATCHES; ++batch) {
        const float3v *const light = &tile->light[end * BATCHES + batch];
        scatter(light->x, lanes[0] + batch * LANES);
        scatter(light->y, lanes[1] + batch * LANES);
        scatter(light->z, lanes[2] + batch * LANES);
    }
    for (uint node = 0u; node < NODES; ++node)
        least = fmin(least, (float4)(lanes[0][node], lanes[1][node], lanes[2][node], INFINITY));
    return least;
}

// Returns whether the light of the cells around a tile may be misplaced within them.
INLINE bool is_enough(const CrowdView *const view, const Cells *const cells, const uint level, const uint column,
                      const uint row, const float angle, const float *const ends, const Ends some, const float caution,
                      const NodesOfTile *const tile) {
#ifdef ENOUGH_ALWAYS
    return true; // spoiled
#endif
    const uint across = cells_across(view, level), first = cells_below(view, level);
    float4 peak = (float4)(0.0f);
    float nearest = INFINITY;
    const uint block = max(BLOCK(view), 1u);
    for (uint y = max(row, block) - block; y < min(row + block + 1u, across); ++y)
        for (uint x = max(column, block) - block; x < min(column + block + 1u, across); ++x) {
            const float4 it = cells->peaks[first + code_of(x, y)];
            peak.xyz += it.xyz;
            peak.w = max(peak.w, it.w);
            nearest = min(nearest, cells->levels[first + code_of(x, y)].w);
        }
#ifdef WITH_ENDS
    // Rays that end before all of the block see no cores.
    float4 least = (float4)(INFINITY);
    for (uint end = some.first; end < some.end; ++end) {
        const float z = fma(view->ray_length, ends[end], view->near_plane);
        if (z * fma(4.0f, angle, 1.0f) >= nearest)
            least = fmin(least, view->tolerance * least_light(tile, end));
    }
#else
    const float4 least = view->tolerance * least_light(tile, 0u);
#endif
    const float spread = caution * (view->is_square ? 1.0f / angle : 1.0f);
    const float of_one = view->is_square ? 20.0f / angle : -2.0f * log(0.05f * angle);
    const float most = max(least.x, max(least.y, least.z));
    const float share = view->is_square ? 10.0f : 1.0f;
    return all(isless(spread * peak.xyz, least.xyz) | (peak.xyz == 0.0f)) && peak.w * of_one <= share * most;
}

__kernel void light_tiles(const CrowdView view, const uint level, const uint first_slot, const uint next_slot,
                          __global const uint *const restrict roots, __global const uint *const restrict starts,
                          __global const uint *const restrict places,
                          __global const CrowdSource *const restrict sources,
                          __global const float4 *const restrict peaks, __global const float4 *const restrict levels,
                          __global const float4 *const restrict nodes, __global const float4 *const restrict limits,
                          __global const float *const restrict rest, __global const float *const restrict numbers,
                          __global const float *const restrict planes, __global CrowdTile *const restrict tiles,
                          __global float *const restrict values, __global uint *const restrict owners,
                          __global uint *const restrict is_wanted, __global uint *const restrict counts,
                          __global const float *const restrict ranges, __global float *const restrict ends_of_tiles) {
    const Cells cells = {starts, places, sources, peaks, levels, nodes, limits, numbers, planes};
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
        const float mid_u = slope_u(&view, middle_x), mid_v = slope_v(&view, middle_y);
        const float side = 2.0f * half_side * sqrt(view.step_u * view.step_v);
        const float angle = side / fma(mid_u, mid_u, fma(mid_v, mid_v, 1.0f));
        float place_u[NODES], place_v[NODES];
        for (uint node = 0u; node < NODES; ++node) {
            place_u[node] = slope_u(&view, fma(half_side, numbers[TILE_NODES + (node & 3u)], middle_x));
            place_v[node] = slope_v(&view, fma(half_side, numbers[TILE_NODES + (node >> 2)], middle_y));
        }
        for (uint batch = 0u; batch < BATCHES; ++batch)
            tile.rays[batch] =
                rays_through(&view, LOAD_LANES(place_u + batch * LANES), LOAD_LANES(place_v + batch * LANES));
#ifdef WITH_ENDS
        float ends[ROW_OF_ENDS];
        tile.end_count = ends_of_tile(&view, ranges, level, column, row, angle, ends);
        for (uint k = 0u; k < ROW_OF_ENDS; ++k)
            ends_of_tiles[ROW_OF_ENDS * slot + k] = ends[k];
        for (uint end = 0u; end < tile.end_count; ++end)
            tile.ends[end] = end_at(&view, splat(ends[end]));
        tile.cut_count = tile.end_count - as_uint(ends[ROW_OF_ENDS - 1u]) / WHOLE_BIT;
        const uint was_open = level == view.top ? WHOLE_OPEN | CUT_OPEN : tiles[tiles[slot].parent].is_open;
        const uint is_whole = was_open & WHOLE_OPEN, is_cut = was_open & CUT_OPEN;
        tile.cut.first = 0u, tile.cut.end = is_cut ? tile.cut_count : 0u;
        tile.whole.first = tile.cut_count, tile.whole.end = is_whole ? tile.end_count : tile.cut_count;
#else
        const float ends[1] = {1.0f};
        tile.end_count = 1u, tile.cut_count = 0u;
        tile.ends[0] = whole_ray(&view);
#endif
        for (uint end = 0u; end < ENDS_OF(&tile); ++end) {
            float parent[3u * NODES], inherited[3u * NODES];
            for (uint k = 0u; k < 3u * NODES; ++k)
                inherited[k] = 0.0f;
            if (level < view.top) {
                const uint above = tiles[slot].parent;
                __global const float *const theirs = values + VALUES * above;
#ifdef WITH_ENDS
                parent_up_to(&view, ends_of_tiles + ROW_OF_ENDS * above, theirs, ends[end], parent);
#else
                for (uint k = 0u; k < 3u * NODES; ++k)
                    parent[k] = theirs[k];
#endif
                inherit(numbers, parent, code, inherited);
            }
            for (uint batch = 0u; batch < BATCHES; ++batch) {
                float3v *const light = &tile.light[end * BATCHES + batch];
                light->x = LOAD_LANES(inherited + batch * LANES);
                light->y = LOAD_LANES(inherited + NODES + batch * LANES);
                light->z = LOAD_LANES(inherited + 2u * NODES + batch * LANES);
            }
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

            // Rays that need no more take what is around the tile, softened; those that do, wait for its quarters.
#ifdef WITH_ENDS
        const Ends cut = tile.cut, whole = tile.whole;
        const bool is_cut_open = cut.end > 0u && !is_enough(&view, &cells, level, column, row, angle, ends, cut,
                                                            CAUTION_OF_CUT * CAUTION, &tile);
        const bool is_whole_open = whole.end > whole.first &&
                                   !is_enough(&view, &cells, level, column, row, angle, ends, whole, CAUTION, &tile);
        const uint is_open = (is_whole_open ? WHOLE_OPEN : 0u) | (is_cut_open ? CUT_OPEN : 0u);
        tile.cut.end = is_cut_open ? 0u : cut.end;
        tile.whole.end = is_whole_open ? whole.first : whole.end;
        const bool has_closed = tile.cut.end > 0u || tile.whole.end > tile.whole.first;
#else
        const uint is_open =
            is_enough(&view, &cells, level, column, row, angle, ends, OPEN_WHOLE(&tile), CAUTION, &tile) ? 0u
                                                                                                         : WHOLE_OPEN;
        const bool has_closed = is_open == 0u;
#endif
        const bool is_done = is_open == 0u;
        if (has_closed) {
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
        atomic_add(counts + (level >= view.shallow ? COUNTED_CELLS : COUNTED_LIMITS), looked_at);
        for (uint end = 0u; end < ENDS_OF(&tile); ++end) {
            __global float *const value = values + VALUES * slot + 3u * NODES * end;
            for (uint batch = 0u; batch < BATCHES; ++batch) {
                const float3v *const light = &tile.light[end * BATCHES + batch];
                STORE_LANES(light->x, value + batch * LANES);
                STORE_LANES(light->y, value + NODES + batch * LANES);
                STORE_LANES(light->z, value + 2u * NODES + batch * LANES);
            }
        }
        tiles[slot].code = code, tiles[slot].level = level, tiles[slot].is_open = is_open;

        // The tiles of 8 pixels in it, as far as the image goes, belong to it; or its quarters follow.
        const uint left = view.left >> 3, above = view.above >> 3;
        const uint right = left + view.tile_columns, below = above + ((view.height + 7u) >> 3);
        if (is_done || level == 0u) {
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
        if (level <= view.shallow)
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
