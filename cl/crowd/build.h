// What sources are together: of each its peak and level, of each cell the sums of those, and light at nodes in the cell
// that stands for its sources, as seen from any tile that does not touch the cell.
#pragma once
#include "nodes.h"
#include "point.h"

// Finds peak and level of sources at the slopes u and v, from the light 3 and 48 pixels beside each.
INLINE void find_strength(const CrowdView *const view, const floatv own_u, const floatv own_v, const floatv z,
                          floatv *const peak, floatv *const level) {
    // Across the way to the middle, on which rays begin no farther from the eye.
    const floatv off2 = fma(own_u, own_u, fma(own_v, own_v, splat(1e-12f)));
    const floatv per_off = 0.5f * twice_inverse_sqrt_(off2);
    const floatv way_u = (own_v + 1e-6f) * per_off, way_v = (1e-6f - own_u) * per_off;
    const End end = whole_ray(view);
    floatv light[2], core[2];
    for (uint k = 0u; k < 2u; ++k) {
        const float away = k == 0u ? 3.0f / 48.0f : 1.0f;
        const floatv a = away * min(48.0f * view->step_u, 0.04f) * way_u;
        const floatv b = away * min(48.0f * view->step_v, 0.04f) * way_v;
        const Rays rays = rays_through(view, own_u + a, own_v + b);
        const floatv c = fma(a, own_v, -b * own_u), beside2 = fma(a, a, fma(b, b, c * c));
        const floatv per2 = rays.per_stretch * rays.per_stretch;
        const floatv along = z * fma(rays.u, own_u, fma(rays.v, own_v, splat(1.0f))) * rays.per_stretch;
        const Approach approach = approach_of(view, rays.begin - along, z * z * beside2 * per2);
        light[k] = light_to(view, &approach, &end);
        core[k] = core_of(view, beside2 * per2 / (1.0f + off2));
    }
    *peak = (light[0] - light[1]) / (core[0] - core[1]);
    *level = fma(-*peak, core[1], light[1]);
}

// Finds peak and level of LANES sources.
__kernel void find_peaks(const CrowdView view, __global const uint *const restrict cells,
                         __global float *const restrict sources) {
    const uint first = get_global_id(0) * LANES;
    if (first >= view.sources)
        return;
    const uintv number = min(first + LANE_NUMBERS, (uintv)(view.sources - 1u));
    const intv at = as_intv(number * 8u);
    float u[LANES], v[LANES], peak[LANES], level[LANES];
    for (uint lane = 0u; lane < LANES; ++lane) {
        const uint index = min(first + lane, view.sources - 1u), cell = cells[index];
        const float x = sources[8u * index], y = sources[8u * index + 1u];
        u[lane] = slope_u(&view, middle_x_of(cell) + x);
        v[lane] = slope_v(&view, middle_y_of(cell) + y);
    }
    const floatv own_u = LOAD_LANES(u), own_v = LOAD_LANES(v);
    const floatv z = gather(sources + 2, at);
    floatv strength, rest;
    find_strength(&view, own_u, own_v, z, &strength, &rest);
    scatter(strength, peak), scatter(rest, level);
    for (uint lane = 0u; lane < LANES && first + lane < view.sources; ++lane) {
        sources[8u * (first + lane) + 6u] = peak[lane];
        sources[8u * (first + lane) + 7u] = level[lane];
    }
}

// Sums the peaks of a cell's sources, and in .w has the greatest; and their levels, in .w the least z. In the place
// of its level each source then has the least square of a sine that its core is seen under.
__kernel void sum_cells(const CrowdView view, __global const uint *const restrict starts,
                        __global CrowdSource *const restrict sources, __global float4 *const restrict peaks,
                        __global float4 *const restrict levels) {
    const uint cell = get_global_id(0);
    if (cell >= cells_below(&view, 1u))
        return;
    float4 peak = (float4)(0.0f), level = (float4)(0.0f, 0.0f, 0.0f, INFINITY);
    for (uint index = starts[cell]; index < starts[cell + 1u]; ++index) {
        __global CrowdSource *const source = sources + index;
        const float4 light = (float4)(source->red, source->green, source->blue, 0.0f);
        peak.xyz += source->peak * light.xyz;
        peak.w = max(peak.w, source->peak * max(light.x, max(light.y, light.z)));
        level.xyz += source->level * light.xyz;
        level.w = min(level.w, source->z);
        source->level = max(view.floor2 / (source->z * source->z), 1e-24f);
    }
    peaks[cell] = peak, levels[cell] = level;
}

// Sums those of the four cells of each.
__kernel void sum_quarters(const CrowdView view, const uint level, __global float4 *const restrict peaks,
                           __global float4 *const restrict levels) {
    const uint cell = get_global_id(0), across = cells_across(&view, level);
    if (cell >= across * across)
        return;
    const uint from = cells_below(&view, level - 1u) + 4u * cell, to = cells_below(&view, level) + cell;
    float4 peak = (float4)(0.0f), sum = (float4)(0.0f, 0.0f, 0.0f, INFINITY);
    for (uint quarter = from; quarter < from + 4u; ++quarter) {
        peak.xyz += peaks[quarter].xyz;
        peak.w = max(peak.w, peaks[quarter].w);
        sum.xyz += levels[quarter].xyz;
        sum.w = min(sum.w, levels[quarter].w);
    }
    peaks[to] = peak, levels[to] = sum;
}

// What a cell lays on its nodes.
typedef struct {
    __global const uint *starts, *cells;
    __global const CrowdSource *sources;
    __global const float *numbers;
    uint cell, level;
} Laying;

// Where the light of a row of nodes is: four of them a vector.
#define ROW_VECTORS(n) (((n) + 3u) / 4u)
#define MOST_VECTORS ((MOST_NODES + 3u) / 4u)

// With -D NO_SHUFFLES element by element: oclgrind 21.10 ends on others.
INLINE float16 side_by_side(const float4 a, const float4 b, const float4 c, const float4 d) {
#ifdef NO_SHUFFLES
    return (float16)(a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w, c.x, c.y, c.z, c.w, d.x, d.y, d.z, d.w);
#else
    return (float16)(a, b, c, d);
#endif
}

// Writes what a source lays on a row of a cell's nodes, and the weights of the rows.
INLINE void weigh(const Laying *const laying, const uint index, const uint n, const float4 light, float16 *const in_row,
                  float *const down) {
    const float half_side = (float)(4u << laying->level);
    const uint cell = laying->cells[index];
    __global const CrowdSource *const source = laying->sources + index;
    const float column = 2.0f * half_side * (float)every_other(laying->cell) + half_side;
    const float row = 2.0f * half_side * (float)every_other(laying->cell >> 1) + half_side;
#ifdef MIDDLES_ONLY
    const float right = 0.0f, below = 0.0f; // spoiled
#else
    const float right = (middle_x_of(cell) - column + source->x) / half_side;
    const float below = (middle_y_of(cell) - row + source->y) / half_side;
#endif
    float across[4u * MOST_VECTORS];
    for (uint i = 0u; i < 4u * ROW_VECTORS(n); ++i)
        across[i] = 0.0f;
    weights_at(laying->numbers, CELL_NODES, n, right, across);
    weights_at(laying->numbers, CELL_NODES, n, below, down);
    for (uint k = 0u; k < ROW_VECTORS(n); ++k)
        in_row[k] = side_by_side(across[4u * k] * light, across[4u * k + 1u] * light, across[4u * k + 2u] * light,
                                 across[4u * k + 3u] * light);
}

// Lays the peaks of a cell's sources on its nodes; n is a constant where it can be.
INLINE void lay_flat(const CrowdView *const view, const Laying *const laying, const uint n, float16 *const laid) {
    for (uint k = 0u; k < n * ROW_VECTORS(n); ++k)
        laid[k] = (float16)(0.0f);
    const uint shift = 2u * laying->level, end = laying->starts[(laying->cell + 1u) << shift];
    for (uint index = laying->starts[laying->cell << shift]; index < end; ++index) {
        __global const CrowdSource *const source = laying->sources + index;
        float16 in_row[MOST_VECTORS];
        float down[MOST_NODES];
        const float4 light = source->peak * (float4)(source->red, source->green, source->blue, 0.0f);
        weigh(laying, index, n, light, in_row, down);
        for (uint j = 0u; j < n; ++j)
            for (uint k = 0u; k < ROW_VECTORS(n); ++k)
                laid[j * ROW_VECTORS(n) + k] += down[j] * in_row[k];
    }
}

// Writes where the depths of a cell are, whose sources have such ln z.
void write_planes(const CrowdView *const view, __global const float *const numbers, const float low, const float high,
                  __global float *const planes) {
    // At least so wide that weights stay finite.
    const float middle = 0.5f * (low + high), half_way = 1.0001f * max(0.5f * (high - low), 1e-3f);
    planes[0] = middle, planes[1] = half_way;
    __global float *const deep = planes + 2u, *const whole = deep + view->depths;
    for (uint q = 0u; q < view->depths; ++q)
        deep[q] = exp(fma(half_way, numbers[DEPTH_NODES + q], middle));
    for (uint q = 0u; q < view->whole_depths; ++q)
        whole[q] = exp(fma(half_way, numbers[WHOLE_NODES + q], middle));
}

// Lays their light on its nodes in all depths.
INLINE void lay_deep(const CrowdView *const view, const Laying *const laying, const uint n,
                     __global const float *const planes, float16 *const laid) {
    const uint depths = view->depths, shift = 2u * laying->level;
    for (uint k = 0u; k < n * ROW_VECTORS(n) * depths; ++k)
        laid[k] = (float16)(0.0f);
    const float per_half_way = 1.0f / planes[1];
    const uint end = laying->starts[(laying->cell + 1u) << shift];
    for (uint index = laying->starts[laying->cell << shift]; index < end; ++index) {
        __global const CrowdSource *const source = laying->sources + index;
        float16 in_row[MOST_VECTORS];
        float down[MOST_NODES], deep[MOST_DEPTHS];
        weigh(laying, index, n, (float4)(source->red, source->green, source->blue, 0.0f), in_row, down);
        weights_at(laying->numbers, DEPTH_NODES, depths, (log(source->z) - planes[0]) * per_half_way, deep);
        for (uint q = 0u; q < depths; ++q)
            for (uint j = 0u; j < n; ++j)
                for (uint k = 0u; k < ROW_VECTORS(n); ++k)
                    laid[(q * n + j) * ROW_VECTORS(n) + k] += deep[q] * down[j] * in_row[k];
    }
}

// Lays the light of a cell's sources on its nodes. Without depths it is their peaks, where there are more sources than
// nodes and `is_wanted` says that tiles look at the cell that it is a quarter of.
__kernel void lay_sources(const CrowdView view, const uint level, const uint has_depths,
                          __global const uint *const restrict starts, __global const uint *const restrict cells,
                          __global const CrowdSource *const restrict sources,
                          __global const float *const restrict numbers, __global const uint *const restrict is_wanted,
                          __global float4 *const restrict nodes, __global float *const restrict planes) {
    const uint cell = get_global_id(0), across = cells_across(&view, level);
    if (cell >= across * across)
        return;
    const uint begin = starts[cell << (2u * level)], end = starts[(cell + 1u) << (2u * level)];
    if (begin == end || (!has_depths && is_wanted[cells_below(&view, level + 1u) + (cell >> 2)] == 0u))
        return;
    const uint n = view.nodes, depths = has_depths ? view.depths : 1u;
    const uint deep = cells_below(&view, level) - cells_below(&view, view.base) + cell;
    if (!has_depths && end - begin <= n * n) // tiles take so few by themselves
        return;
    float16 laid[MOST_NODES * MOST_VECTORS * MOST_DEPTHS];
    const Laying laying = {starts, cells, sources, numbers, cell, level};
    if (!has_depths)
        n == 3u   ? lay_flat(&view, &laying, 3u, laid)
        : n == 4u ? lay_flat(&view, &laying, 4u, laid)
                  : lay_flat(&view, &laying, n, laid);
    else {
        __global float *const own = planes + planes_of_cell(&view) * deep;
        float low = INFINITY, high = 0.0f;
        for (uint index = begin; index < end; ++index)
            low = min(low, sources[index].z), high = max(high, sources[index].z);
        write_planes(&view, numbers, log(low), log(high), own);
        n == 3u   ? lay_deep(&view, &laying, 3u, own, laid)
        : n == 4u ? lay_deep(&view, &laying, 4u, own, laid)
                  : lay_deep(&view, &laying, n, own, laid);
    }
    const uint from = n * n * (has_depths ? depths * deep : limits_of_cell(&view, level, cell, begin));
    const float4 *const row = (const float4 *)laid;
    for (uint node = 0u; node < n * n * depths; ++node)
        nodes[from + node] = row[4u * ROW_VECTORS(n) * (node / n) + node % n];
}

// Lays the light at the nodes of four cells on those of the cell that they are quarters of.
__kernel void lay_quarters(const CrowdView view, const uint level, __global const uint *const restrict starts,
                           __global const float *const restrict numbers, __global float4 *const restrict nodes,
                           __global float *const restrict planes) {
    const uint cell = get_global_id(0), across = cells_across(&view, level);
    if (cell >= across * across || starts[cell << (2u * level)] == starts[(cell + 1u) << (2u * level)])
        return;
    const uint n = view.nodes, plane = n * n, depths = view.depths, base = cells_below(&view, view.base);
    const uint to = cells_below(&view, level) - base + cell, from = cells_below(&view, level - 1u) - base + 4u * cell;
    const uint row = planes_of_cell(&view);
    bool is_empty[4];
    float low = INFINITY, high = -INFINITY;
    for (uint quarter = 0u; quarter < 4u; ++quarter) {
        const uint first = 4u * cell + quarter, shift = 2u * level - 2u;
        __global const float *const its = planes + row * (from + quarter);
        is_empty[quarter] = starts[first << shift] == starts[(first + 1u) << shift];
        if (!is_empty[quarter])
            low = min(low, its[0] - its[1]), high = max(high, its[0] + its[1]);
    }
    __global float *const own = planes + row * to;
    write_planes(&view, numbers, low, high, own);
    float weight[2][MOST_NODES][MOST_NODES]; // [side][node of the quarter][node of the cell]
    for (uint side = 0u; side < 2u; ++side)
        for (uint i = 0u; i < n; ++i)
            weights_at(numbers, CELL_NODES, n, 0.5f * numbers[CELL_NODES + i] + (float)side - 0.5f, weight[side][i]);
    float4 laid[MOST_NODES * MOST_NODES * MOST_DEPTHS], flat[MOST_NODES * MOST_NODES], half_way[MOST_NODES];
    for (uint node = 0u; node < plane * depths; ++node)
        laid[node] = (float4)(0.0f);
    for (uint quarter = 0u; quarter < 4u; ++quarter) {
        if (is_empty[quarter])
            continue;
        __global const float *const its = planes + row * (from + quarter);
        __global const float4 *light = nodes + plane * depths * (from + quarter);
        for (uint depth = 0u; depth < depths; ++depth, light += plane) {
            for (uint node = 0u; node < plane; ++node)
                flat[node] = (float4)(0.0f);
            for (uint j = 0u; j < n; ++j) {
                for (uint k = 0u; k < n; ++k)
                    half_way[k] = (float4)(0.0f);
                for (uint i = 0u; i < n; ++i)
                    for (uint k = 0u; k < n; ++k)
                        half_way[k] += weight[quarter & 1u][i][k] * light[j * n + i];
                for (uint l = 0u; l < n; ++l)
                    for (uint k = 0u; k < n; ++k)
                        flat[l * n + k] += weight[quarter >> 1][j][l] * half_way[k];
            }
            float deep[MOST_DEPTHS];
            weights_at(numbers, DEPTH_NODES, depths,
                       (fma(its[1], numbers[DEPTH_NODES + depth], its[0]) - own[0]) / own[1], deep);
            for (uint q = 0u; q < depths; ++q)
                for (uint node = 0u; node < plane; ++node)
                    laid[q * plane + node] += deep[q] * flat[node];
        }
    }
    for (uint node = 0u; node < plane * depths; ++node)
        nodes[plane * depths * to + node] = laid[node];
}
