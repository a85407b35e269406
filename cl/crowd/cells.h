// What the cells around a tile give its nodes: by their own nodes, by limits that hold beside small cells, or of each
// source by itself where those are fewer.
#pragma once
#include "../film.h"
#include "build.h"
#include "ends.h"

#define NODES 16u
#define BATCHES (NODES / LANES)

// Some of the ends of a tile.
typedef struct {
    uint first, end;
} Ends;

// Rays through the nodes of a tile, where they end, and their light up to each end. The ends of cut rays come before
// that of whole ones; `cut` and `whole` are those that still take light.
typedef struct {
    Rays rays[BATCHES];
    uint end_count, cut_count;
    Ends cut, whole;
    End ends[MOST_ENDS];
    float3v light[MOST_ENDS * BATCHES];
} NodesOfTile;

#ifdef WITH_ENDS
#define ENDS_OF(tile) (tile)->end_count
#define CUT_OF(tile) (tile)->cut_count
#define OPEN_CUT(tile) (tile)->cut
#define OPEN_WHOLE(tile) (tile)->whole
#else
#define ENDS_OF(tile) 1u
#define CUT_OF(tile) 0u
#define OPEN_CUT(tile) ((Ends){0u, 0u})
#define OPEN_WHOLE(tile) ((Ends){0u, 1u})
#endif

// What all cells have.
typedef struct {
    __global const uint *starts, *places;
    __global const CrowdSource *sources;
    __global const float4 *peaks, *levels, *nodes, *limits;
    __global const float *numbers, *planes;
} Cells;

bool is_empty_cell(const Cells *const cells, const uint level, const uint code) {
    return cells->starts[code << (2u * level)] == cells->starts[(code + 1u) << (2u * level)];
}

INLINE void add_light(float3v *const light, const floatv core, const float4 source) {
    light->x = fma(core, splat(source.x), light->x);
    light->y = fma(core, splat(source.y), light->y);
    light->z = fma(core, splat(source.z), light->z);
}

// Adds the light of a point along a batch of rays, up to each of some ends.
INLINE void add_point(const CrowdView *const view, const Rays *const rays, const Passing passing, const float4 source,
                      const uint batch, const Ends ends, NodesOfTile *const tile) {
    const Approach approach = approach_of(view, rays->begin - passing.along, passing.least);
    for (uint end = ends.first; end < ends.end; ++end) {
        const floatv light = light_to(view, &approach, &tile->ends[end]);
        add_light(&tile->light[end * BATCHES + batch], light, source);
    }
}

// Adds the light of the sources of a cell, of each by itself.
INLINE void add_sources(const CrowdView *const view, const Cells *const cells, const uint first, const uint end,
                        const float angle, const Ends ends, NodesOfTile *const tile) {
    const float soft4 = angle * angle * angle * angle;
    for (uint index = first; index < end; ++index) {
        __global const CrowdSource *const source = cells->sources + index;
        const uint cell = cells->places[index];
        const float u = slope_u(view, middle_x_of(cell) + source->x);
        const float v = slope_v(view, middle_y_of(cell) + source->y);
        const float z = source->z, far2 = z * z * fma(u, u, fma(v, v, 1.0f));
        const float4 light = (float4)(source->red, source->green, source->blue, 0.0f);
        for (uint batch = 0u; batch < BATCHES; ++batch) {
            const Rays *const rays = &tile->rays[batch];
            const floatv beside2 = cross2(rays->u - u, rays->v - v, u, v);
            add_point(view, rays, passing(rays, u, v, z, beside2, soft4 * far2 * far2), light, batch, ends, tile);
        }
    }
}

// Where the nodes of a cell are: which of those with depths it is, the middle of the cell, and its half side in pixels.
typedef struct {
    uint deep;
    float half_side, u, v;
} Place;

// Adds the limit of a point at the slopes u and v, of so great a peak, which is that of whole rays.
INLINE void add_limit(const CrowdView *const view, const float u, const float v, const float4 peak, const float soft4,
                      NodesOfTile *const tile) {
    float3v *const light = tile->light + CUT_OF(tile) * BATCHES;
    const float per_length2 = 1.0f / fma(u, u, fma(v, v, 1.0f));
    for (uint batch = 0u; batch < BATCHES; ++batch) {
        const Rays *const rays = &tile->rays[batch];
        const floatv beside2 = cross2(rays->u - u, rays->v - v, u, v);
        floatv sine2 = beside2 * rays->per_stretch * rays->per_stretch * per_length2;
        if (soft4 > 0.0f)
            sine2 = root(fma(sine2, sine2, splat(soft4)));
        add_light(&light[batch], core_of(view, sine2), peak);
    }
}

// Adds the limits of a cell, by its nodes or by its sources, whichever are fewer.
INLINE void add_limits(const CrowdView *const view, const Cells *const cells, const uint level, const uint code,
                       const Place place, const uint first, const uint end, const float angle,
                       NodesOfTile *const tile) {
    const uint n = view->nodes;
    const float soft4 = angle * angle * angle * angle;
    if (end - first <= n * n)
        for (uint index = first; index < end; ++index) {
            __global const CrowdSource *const source = cells->sources + index;
            const uint cell = cells->places[index];
            const float u = slope_u(view, middle_x_of(cell) + source->x);
            const float v = slope_v(view, middle_y_of(cell) + source->y);
            const float4 peak = source->peak * (float4)(source->red, source->green, source->blue, 0.0f);
            add_limit(view, u, v, peak, soft4, tile);
        }
    else {
        __global const float4 *const limits = cells->limits + n * n * limits_of_cell(view, level, code, first);
        for (uint node = 0u; node < n * n; ++node) {
            const float right = cells->numbers[CELL_NODES + node % n], below = cells->numbers[CELL_NODES + node / n];
            const float u = fma(place.half_side * view->step_u, right, place.u);
            const float v = fma(place.half_side * view->step_v, below, place.v);
            add_limit(view, u, v, limits[node], soft4, tile);
        }
    }
    for (uint batch = 0u; batch < BATCHES; ++batch)
        add_light(&tile->light[CUT_OF(tile) * BATCHES + batch], splat(1.0f),
                  cells->levels[cells_below(view, level) + code]);
}

// Adds the light of the nodes of a cell.
INLINE void add_nodes(const CrowdView *const view, const Cells *const cells, const Place place, const float angle,
                      const bool is_whole, const Ends ends, NodesOfTile *const tile) {
    const uint n = view->nodes, depths = is_whole ? view->whole_depths : view->depths;
    __global const float4 *const nodes = cells->nodes + n * n * view->depths * place.deep;
    __global const float *const planes =
        cells->planes + planes_of_cell(view) * place.deep + (is_whole ? 2u + view->depths : 2u);
    const float soft4 = angle * angle * angle * angle;
    for (uint j = 0u; j < n; ++j) {
        const float v = fma(place.half_side * view->step_v, cells->numbers[CELL_NODES + j], place.v);
        for (uint i = 0u; i < n; ++i) {
            const float u = fma(place.half_side * view->step_u, cells->numbers[CELL_NODES + i], place.u);
            const float length2 = fma(u, u, fma(v, v, 1.0f));
            __global const float4 *const column = nodes + j * n + i;
#ifdef WITH_ENDS
            // Whole rays need fewer depths: light at others is laid on those.
            float4 laid[MOST_DEPTHS];
            for (uint q = 0u; q < depths; ++q) {
                laid[q] = is_whole ? (float4)(0.0f) : column[q * n * n];
                for (uint from = 0u; is_whole && from < view->depths; ++from)
                    laid[q] += cells->numbers[DEPTH_WEIGHTS + q * MOST_DEPTHS + from] * column[from * n * n];
            }
#endif
            for (uint batch = 0u; batch < BATCHES; ++batch) {
                const Rays *const rays = &tile->rays[batch];
                const floatv beside2 = cross2(rays->u - u, rays->v - v, u, v);
                for (uint q = 0u; q < depths; ++q) {
#ifdef WITH_ENDS
                    const float4 light = laid[q];
#else
                    const float4 light = column[q * n * n];
#endif
#ifdef ONE_DEPTH
                    const float z = planes[0]; // spoiled
#else
                    const float z = planes[q];
#endif
#ifdef LIMITS_ALWAYS // spoiled
                    floatv peak, level;
                    find_strength(view, splat(u), splat(v), splat(z), &peak, &level);
                    floatv sine2 = beside2 * rays->per_stretch * rays->per_stretch / length2;
                    sine2 = root(fma(sine2, sine2, splat(soft4)));
                    for (uint end = ends.first; end < ends.end; ++end)
                        add_light(&tile->light[end * BATCHES + batch], fma(peak, core_of(view, sine2), level), light);
                    continue;
#endif
                    const float far2 = z * z * length2;
                    add_point(view, rays, passing(rays, u, v, z, beside2, soft4 * far2 * far2), light, batch, ends,
                              tile);
                }
            }
        }
    }
}

// Adds the light of a cell at the nodes of a tile, softened by an angle: to whole rays by its limits, where the cell is
// so small that it needs no depths; else by its nodes. Where its sources are fewer, they are taken by themselves.
INLINE void add_cell(const CrowdView *const view, const Cells *const cells, const uint level, const uint code,
                     const float angle, NodesOfTile *const tile) {
    const uint n = view->nodes, at = cells_below(view, level) + code;
    Place place;
    place.half_side = (float)(4u << level);
    place.u = slope_u(view, (2.0f * (float)every_other(code) + 1.0f) * place.half_side);
    place.v = slope_v(view, (2.0f * (float)every_other(code >> 1) + 1.0f) * place.half_side);
    place.deep = at - cells_below(view, view->base);
    const uint first = cells->starts[code << (2u * level)], end = cells->starts[(code + 1u) << (2u * level)];
    const Ends cut = OPEN_CUT(tile), whole = OPEN_WHOLE(tile);
    if (cut.end > 0u) {
        if (level < view->base || end - first <= n * n * view->depths)
            add_sources(view, cells, first, end, angle, cut, tile);
        else
            add_nodes(view, cells, place, angle, false, cut, tile);
    }
    if (whole.first == whole.end)
        return;
    if (level < view->shallow)
        add_limits(view, cells, level, code, place, first, end, angle, tile);
    else if (end - first <= n * n * view->whole_depths)
        add_sources(view, cells, first, end, angle, whole, tile);
    else
        add_nodes(view, cells, place, angle, true, whole, tile);
}

// Adds the light of sources beside the grid, or near the eye, at the nodes of a tile.
INLINE void add_rest(const CrowdView *const view, __global const float *const restrict rest, NodesOfTile *const tile) {
    const Ends all = {0u, ENDS_OF(tile)};
    for (uint index = 0u; index < view->rest; ++index) {
        const float x = rest[6u * index], y = rest[6u * index + 1u], z = rest[6u * index + 2u];
        const float4 light = (float4)(rest[6u * index + 3u], rest[6u * index + 4u], rest[6u * index + 5u], 0.0f);
        for (uint batch = 0u; batch < BATCHES; ++batch) {
            const Rays *const rays = &tile->rays[batch];
            const floatv a = fma(splat(-z), rays->v, splat(y)), b = fma(splat(z), rays->u, splat(-x)),
                         c = fma(splat(x), rays->v, -y * rays->u);
            const floatv least = fma(a, a, fma(b, b, c * c)) * rays->per_stretch * rays->per_stretch;
            const floatv along = fma(splat(x), rays->u, fma(splat(y), rays->v, splat(z))) * rays->per_stretch;
            const Passing it = {least, along};
            add_point(view, rays, it, light, batch, all, tile);
        }
    }
}
