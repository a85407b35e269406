// Where the rays of a tile end. Shares of their length fall into slabs of depth, the same for all tiles: some in and
// around the crowd, one before them and one behind; a tile has Chebyshev nodes in each slab in which rays of it end,
// over just the shares there, and one more for whole rays. Light is interpolated between the nodes of a slab only.
#pragma once
#include "nodes.h"
#include "point.h"

#ifdef WITH_ENDS
// Ends in a tile, at most; a row of the table of ends, whose last number counts nodes.
#define SLABS 8u
#define MOST_IN_SLAB 3u
#define MOST_ENDS 25u
#define ROW_OF_ENDS 26u
#define WHOLE_BIT (1u << 16)

// Of each tile of 8 pixels: the least and the greatest share in each slab, and whether there are whole rays.
#define ROW_OF_RANGES 18u

// Returns the slab of a share; SLABS for a whole ray.
INLINE floatv slab_of(const CrowdView *const view, const floatv share) {
    const floatv slab = floor((share - view->slab_begin) * view->per_slab) + 1.0f;
    return select(min(max(slab, splat(0.0f)), splat((float)SLABS - 1.0f)), splat((float)SLABS), share >= 1.0f);
}

// Returns how many nodes a tile has in a slab.
uint nodes_in(const uint counts, const uint slab) {
    return counts >> (2u * slab) & 3u;
}

// Returns the weight of one of the nodes of a slab at a share.
INLINE floatv weight_of_end(const float *const nodes, const uint count, const uint own, const floatv share) {
    floatv weight = splat(1.0f);
    for (uint i = 0u; i < count; ++i)
        if (i != own)
            weight *= (share - nodes[i]) / (nodes[own] - nodes[i]);
    return weight;
}

// Writes at which shares a tile has nodes, and returns how many; their counts stand behind them.
uint ends_of_tile(const CrowdView *const view, __global const float *const ranges, const uint level, const uint column,
                  const uint row, const float angle, float *const ends) {
    const uint left = view->left >> 3, above = view->above >> 3, columns = view->tile_columns;
    const uint right = left + columns, below = above + ((view->height + 7u) >> 3);
    float low[SLABS], high[SLABS];
    for (uint slab = 0u; slab < SLABS; ++slab)
        low[slab] = 2.0f, high[slab] = -1.0f;
    bool has_whole = false;
    for (uint y = max(row << level, above); y < min((row + 1u) << level, below); ++y)
        for (uint x = max(column << level, left); x < min((column + 1u) << level, right); ++x) {
            __global const float *const range = ranges + ROW_OF_RANGES * ((y - above) * columns + x - left);
            for (uint slab = 0u; slab < SLABS; ++slab) {
                low[slab] = min(low[slab], range[2u * slab]);
                high[slab] = max(high[slab], range[2u * slab + 1u]);
            }
            has_whole |= range[2u * SLABS] > 0.0f;
        }
    uint counts = has_whole ? WHOLE_BIT : 0u;
    for (uint slab = 0u; slab < SLABS; ++slab) {
        if (low[slab] > high[slab])
            continue;
        // How far apart the ends are, in sides of the tile.
        const float side = angle * fma(view->ray_length, max(low[slab], 0.0f), view->near_plane);
        const float span = view->ray_length * (high[slab] - low[slab]) / side;
#ifdef ONE_END
        counts |= 1u << (2u * slab); // spoiled
#else
        counts |= (span < 0.004f ? 1u : span < 0.3f ? 2u : 3u) << (2u * slab);
#endif
    }
    uint at = 0u;
    for (uint slab = 0u; slab < SLABS; ++slab) {
        const uint n = nodes_in(counts, slab);
        const float turn = n == 1u ? 0.0f : n == 2u ? 0.70710678f : 0.86602540f;
        for (uint i = 0u; i < n; ++i) {
            const float node = n == 1u ? 0.0f : turn * (1.0f - 2.0f * (float)i / (float)(n - 1u));
            // At least so wide that weights stay finite.
            const float half_way = max(0.5f * (high[slab] - low[slab]), 1e-5f);
            ends[at++] = fma(half_way, node, 0.5f * (low[slab] + high[slab]));
        }
    }
    if (has_whole)
        ends[at++] = 1.0f;
    ends[ROW_OF_ENDS - 1u] = as_float(counts);
    return at;
}

// Writes at which share of its length the ray of each pixel ends, and of each tile of 8 pixels the ranges of those.
__kernel void find_ends(const CrowdView view, __global const float *const restrict depths,
                        __global float *const restrict shares, __global float *const restrict ranges) {
    const uint number = get_global_id(0), rows = (view.height + 7u) >> 3;
    if (number >= view.tile_columns * rows)
        return;
    const uint left = 8u * (number % view.tile_columns), top = 8u * (number / view.tile_columns);
    floatv low[SLABS], high[SLABS];
    for (uint slab = 0u; slab < SLABS; ++slab)
        low[slab] = splat(2.0f), high[slab] = splat(-1.0f);
    bool has_whole = false;
    for (uint vector = 0u; vector < 64u / LANES; ++vector) {
        const uintv place = vector * LANES + LANE_NUMBERS;
        // Beyond the image, its last pixels again.
        const uintv x = min(left + (place & 7u), (uintv)(view.width - 1u));
        const uintv y = min(top + (place >> 3), (uintv)(view.height - 1u));
        const floatv u = fma(to_floatv(x + view.left) + 0.5f, splat(view.step_u), splat(view.first_u));
        const floatv v = fma(to_floatv(y + view.above) + 0.5f, splat(view.step_v), splat(view.first_v));
        const Rays rays = rays_through(&view, u, v);
        const floatv depth = gather(depths, as_intv(y * view.width + x));
        const floatv length = view.is_along_axis ? depth * rays.stretch : depth;
        const floatv share = min(max((length - rays.begin) / view.ray_length, splat(0.0f)), splat(1.0f));
        float share_of[LANES];
        scatter(share, share_of);
        for (uint lane = 0u; lane < LANES; ++lane) {
            const uint at = vector * LANES + lane, column = left + (at & 7u), row = top + (at >> 3);
            if (column < view.width && row < view.height)
                shares[row * view.width + column] = share_of[lane];
        }
        const intv is_cut = share < 1.0f;
        has_whole |= any_lane(!is_cut);
        if (!any_lane(is_cut))
            continue;
        const floatv own = slab_of(&view, share);
        for (uint slab = 0u; slab < SLABS; ++slab) {
            const intv is_in = own == (float)slab;
            low[slab] = min(low[slab], select(splat(2.0f), share, is_in));
            high[slab] = max(high[slab], select(splat(-1.0f), share, is_in));
        }
    }
    __global float *const range = ranges + ROW_OF_RANGES * number;
    for (uint slab = 0u; slab < SLABS; ++slab) {
        float lows[LANES], highs[LANES];
        scatter(low[slab], lows), scatter(high[slab], highs);
        for (uint lane = 1u; lane < LANES; ++lane)
            lows[0] = min(lows[0], lows[lane]), highs[0] = max(highs[0], highs[lane]);
        range[2u * slab] = lows[0], range[2u * slab + 1u] = highs[0];
    }
    range[2u * SLABS] = has_whole ? 1.0f : 0.0f;
}
#else
#define MOST_ENDS 1u
#endif
