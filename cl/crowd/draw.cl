// Gives the light of tiles to the pixels: interpolated from the nodes of the tile that a pixel lies in; where that was
// left open, with the light of the sources in the cells around it, of each by itself.
#include "tiles.cl"

#define PIXELS 64u
#define VECTORS (PIXELS / LANES)

// Rays of pixels end where each does, or all are whole.
#ifdef WITH_ENDS
#define END_VECTORS VECTORS
#define HAS_VECTOR(vectors, vector) ((vectors) >> (vector)&1ul)
#else
#define END_VECTORS 1u
#define HAS_VECTOR(vectors, vector) 1ul
#endif

// Which vectors of an open tile take the sources next to it by the form of near ones, and which by the closed form; of
// those, the lanes that do.
typedef struct {
    ulong near, closed;
    intv lanes[END_VECTORS];
} Taking;

// Returns the integral of 1 / sqrt(x^2 + y^2 + t^2) over a rectangle from the origin.
INLINE floatv square_from_origin(const floatv x, const floatv y, const float t) {
    const floatv x2 = fma(x, x, splat(t * t)), y2 = fma(y, y, splat(t * t));
    const floatv along = x * inverse_hyperbolic_sine(0.5f * y * twice_inverse_sqrt_(x2));
    const floatv across = y * inverse_hyperbolic_sine(0.5f * x * twice_inverse_sqrt_(y2));
    return along + across - t * angle_of(x * y, t * root(fma(x, x, y2)) + splat(SMALL));
}

// Returns the mean over pixels of what a source's peak is multiplied with, whose middles are so far right and below it;
// q: the square of the sine there, least: that of the core.
INLINE floatv mean_core(const CrowdView *const view, const floatv right, const floatv below, const float width,
                        const float height, const floatv q, const float least) {
    if (!view->is_square) // the mean of ln over a square around the core is that at 0.347 of its side
        return core_of(view, max(q, max(0.12f * width * height, least)));
    // Beside a core the mean is more by a 24th of the second derivatives.
    const floatv core = core_of(view, max(q, least));
    floatv mean = core * fma(core * core, splat(width * height / 24.0f), splat(1.0f));
    const intv is_near = (fabs(right) < 1.6f) & (fabs(below) < 1.6f);
    if (any_lane(is_near)) {
        const float t = view->thickness;
        const floatv west = width * (right - 0.5f), east = width * (right + 0.5f);
        const floatv north = height * (below - 0.5f), south = height * (below + 0.5f);
        const floatv all = square_from_origin(east, south, t) - square_from_origin(west, south, t) -
                           square_from_origin(east, north, t) + square_from_origin(west, north, t);
        mean = select(mean, all * (1.0f / (width * height)), is_near);
    }
    return mean;
}

// Returns how far right of the middle of a tile of 8 pixels, and below it, the pixels of a vector are.
INLINE floatv right_of(const uint vector) {
    return to_floatv((vector * LANES + LANE_NUMBERS) & 7u) - 3.5f;
}

INLINE floatv down_of(const uint vector) {
    return to_floatv((vector * LANES + LANE_NUMBERS) >> 3) - 3.5f;
}

// Adds a source next to a tile of 8 pixels, x and y from the middle of the tile, to its pixels.
INLINE void add_near(const CrowdView *const view, __global const CrowdSource *const source, const float x,
                     const float y, const float column, const float row, const ulong vectors, float3v *const light,
                     float3v *const sum) {
    const float u = slope_u(view, column + x), v = slope_v(view, row + y);
    const float stretch2 = fma(u, u, fma(v, v, 1.0f)), per2 = 1.0f / stretch2;
    const float east = view->step_u * view->step_u * fma(v, v, 1.0f) * per2;
    const float south = view->step_v * view->step_v * fma(u, u, 1.0f) * per2;
    const float both = -2.0f * view->step_u * view->step_v * u * v * per2;
    const float4 peak = source->peak * (float4)(source->red, source->green, source->blue, 0.0f);
    const float least = source->level;
    if (view->thickness > 0.0f) {
        const float width = sqrt(east), height = sqrt(south);
        for (uint vector = 0u; vector < VECTORS; ++vector) {
            if (HAS_VECTOR(vectors, vector) == 0ul)
                continue;
            const floatv right = right_of(vector) - x, down = down_of(vector) - y;
            const floatv q = fma(right, fma(splat(east), right, both * down), south * down * down);
            add_light(&light[vector], mean_core(view, right, down, width, height, q, least), peak);
        }
    } else if (view->is_square) {
#pragma unroll
        for (uint vector = 0u; vector < VECTORS; ++vector) {
            if (HAS_VECTOR(vectors, vector) == 0ul)
                continue;
            const floatv right = right_of(vector) - x, down = down_of(vector) - y;
            const floatv q = fma(right, fma(splat(east), right, both * down), south * down * down);
            add_light(&light[vector], twice_inverse_sqrt_(max(q, least)), 0.5f * peak);
        }
    } else {
#pragma unroll
        for (uint vector = 0u; vector < VECTORS; ++vector) {
            if (HAS_VECTOR(vectors, vector) == 0ul)
                continue;
            const floatv right = right_of(vector) - x, down = down_of(vector) - y;
            const floatv q = fma(right, fma(splat(east), right, both * down), south * down * down);
            add_light(&light[vector], binary_logarithm(max(q, least)), -LN_2 * peak);
        }
    }
    add_light(sum, splat(1.0f), peak);
}

// The same by the whole closed form, where pixels are so wide that a source's strength changes from one to the next. In
// a pixel that is a mean, a core is rounded off in the closed form, and what is missing comes from the other.
INLINE void add_whole(const CrowdView *const view, __global const CrowdSource *const source, const float x,
                      const float y, const float column, const float row, const Taking *const taking,
                      const End *const ends, float3v *const light) {
    const float u = slope_u(view, column + x), v = slope_v(view, row + y), z = source->z;
    const float stretch2 = fma(u, u, fma(v, v, 1.0f)), per2 = 1.0f / stretch2;
    const float width = view->step_u * sqrt(fma(v, v, 1.0f) * per2),
                height = view->step_v * sqrt(fma(u, u, 1.0f) * per2);
    const float round2 = view->thickness > 0.0f ? 0.25f * width * height : 0.0f;
    const float4 own = (float4)(source->red, source->green, source->blue, 0.0f);
    for (uint vector = 0u; vector < VECTORS; ++vector) {
        if (HAS_VECTOR(taking->closed, vector) == 0ul)
            continue;
        const floatv right = right_of(vector), down = down_of(vector);
        const Rays rays = rays_through(view, fma(splat(view->step_u), right, splat(slope_u(view, column))),
                                       fma(splat(view->step_v), down, splat(slope_v(view, row))));
        const floatv beside2 = cross2(view->step_u * (right - x), view->step_v * (down - y), u, v);
        const floatv q = beside2 * per2, rounded = max(q, round2);
        const Passing it = passing(&rays, u, v, z, rounded * stretch2, 0.0f);
        const End *const end = &ends[vector % END_VECTORS];
        const Approach approach = approach_of(view, rays.begin - it.along, it.least);
        floatv here = light_to(view, &approach, end);
#ifdef WITH_ENDS
        here = select(splat(0.0f), here, taking->lanes[vector]);
#endif
        add_light(&light[vector], here, own);
        intv is_core = q < 9.0f * width * height;
        if (view->thickness > 0.0f && any_lane(is_core)) {
#ifdef WITH_ENDS
            is_core &= (rays.begin + end->length > it.along) & taking->lanes[vector];
#endif
            const floatv mean = mean_core(view, right - x, down - y, width, height, q, source->level);
            const floatv more = (mean - core_of(view, rounded)) * (view->is_square ? rays.stretch : splat(1.0f));
            add_light(&light[vector], select(splat(0.0f), more, is_core), source->peak * own);
        }
    }
}

// Adds the sources around an open tile, in their order.
INLINE void add_around(const CrowdView *const view, __global const uint *const starts,
                       __global const CrowdSource *const sources, __global const float4 *const levels, const uint code,
                       const Taking *const taking, const End *const ends, float3v *const light,
                       __global uint *const counts) {
    const uint column = every_other(code), row = every_other(code >> 1), across = cells_across(view, 0u);
    const float middle_x = (float)(8u * column + 4u), middle_y = (float)(8u * row + 4u);
    float3v near[VECTORS], sum = uniform3((float4)(0.0f)), level = sum;
    for (uint vector = 0u; vector < VECTORS; ++vector)
        near[vector] = uniform3((float4)(0.0f));
    const uint block = BLOCK(view);
    uint looked_at = 0u;
    for (uint y = max(row, block) - block; y < min(row + block + 1u, across); ++y)
        for (uint x = max(column, block) - block; x < min(column + block + 1u, across); ++x) {
            const uint cell = code_of(x, y);
            const float from_x = 8.0f * ((float)x - (float)column), from_y = 8.0f * ((float)y - (float)row);
            for (uint index = starts[cell]; index < starts[cell + 1u]; ++index) {
                __global const CrowdSource *const source = sources + index;
                const float right = source->x + from_x, below = source->y + from_y;
                if (taking->near != 0ul)
                    add_near(view, source, right, below, middle_x, middle_y, taking->near, near, &sum);
                if (taking->closed != 0ul)
                    add_whole(view, source, right, below, middle_x, middle_y, taking, ends, light);
            }
            looked_at += starts[cell + 1u] - starts[cell];
            add_light(&level, splat(1.0f), levels[cell]);
        }
    atomic_add(counts + COUNTED_PAIRS, looked_at);
    if (taking->near == 0ul)
        return;
    for (uint vector = 0u; vector < VECTORS; ++vector) {
        if (HAS_VECTOR(taking->near, vector) == 0ul)
            continue;
        const uintv place = vector * LANES + LANE_NUMBERS;
        const floatv u = fma(splat(view->step_u), to_floatv(place & 7u) - 3.5f, splat(slope_u(view, middle_x)));
        const floatv v = fma(splat(view->step_v), to_floatv(place >> 3) - 3.5f, splat(slope_v(view, middle_y)));
        // The pixel's part of the sine.
        const floatv stretch2 = fma(u, u, fma(v, v, splat(1.0f)));
        const floatv factor = view->is_square ? root(stretch2) : splat(1.0f);
        const floatv more = view->is_square ? splat(0.0f) : LN_2 * binary_logarithm(stretch2);
        float3v *const it = &light[vector];
        it->x += fma(near[vector].x, factor, fma(sum.x, more, level.x));
        it->y += fma(near[vector].y, factor, fma(sum.y, more, level.y));
        it->z += fma(near[vector].z, factor, fma(sum.z, more, level.z));
    }
}

// Returns the light of a tile's values at pixels.
INLINE float3v light_within(__global const float *const values, const floatv across[4], const floatv down[4]) {
    floatv sums[3];
    for (uint channel = 0u; channel < 3u; ++channel) {
        __global const float *const at = values + 16u * channel;
        sums[channel] = splat(0.0f);
        for (uint row = 0u; row < 4u; ++row) {
            floatv in_row = across[0] * at[4u * row];
            for (uint i = 1u; i < 4u; ++i)
                in_row = fma(across[i], splat(at[4u * row + i]), in_row);
            sums[channel] = fma(down[row], in_row, sums[channel]);
        }
    }
    float3v light;
    light.x = sums[0], light.y = sums[1], light.z = sums[2];
    return light;
}

#ifdef WITH_ENDS

// Returns the light of a tile at pixels whose rays end at shares.
INLINE float3v light_up_to(const CrowdView *const view, __global const float *const table,
                           __global const float *const values, const floatv across[4], const floatv down[4],
                           const floatv share) {
    float3v light = uniform3((float4)(0.0f));
    const uint counts = as_uint(table[ROW_OF_ENDS - 1u]);
    const floatv own = slab_of(view, share);
    uint at = 0u;
    for (uint slab = 0u; slab <= SLABS; ++slab) {
        const uint count = slab == SLABS ? counts / WHOLE_BIT : nodes_in(counts, slab);
        const intv is_in = own == (float)slab;
        if (count > 0u && any_lane(is_in)) {
            float nodes[MOST_IN_SLAB];
            for (uint i = 0u; i < count; ++i)
                nodes[i] = table[at + i];
            for (uint i = 0u; i < count; ++i) {
                const floatv weight = select(splat(0.0f), weight_of_end(nodes, count, i, share), is_in);
                const float3v there = light_within(values + 48u * (at + i), across, down);
                light.x = fma(weight, there.x, light.x);
                light.y = fma(weight, there.y, light.y);
                light.z = fma(weight, there.z, light.z);
            }
        }
        at += count;
    }
    return light;
}
#endif

__kernel void draw_crowd(const FilmPart part, const CrowdView view, __global const uint *const restrict starts,
                         __global const CrowdSource *const restrict sources,
                         __global const float4 *const restrict levels, __global const float *const restrict numbers,
                         __global const CrowdTile *const restrict tiles, __global const float *const restrict values,
                         __global const uint *const restrict owners, __global uint *const restrict counts,
                         const uint first_tile, const uint end_tile, __global const float *const restrict shares,
                         __global const float *const restrict ends_of_tiles, FILM_PARAMETER) {
    const uint number = first_tile + get_global_id(0);
    if (number >= end_tile)
        return;
    const uint left = 8u * (number % view.tile_columns), top = 8u * (number / view.tile_columns);
    const uint slot = owners[number], level = tiles[slot].level, code = tiles[slot].code;
    const float per_half_side = 1.0f / (float)(4u << level);
    const float from_x = (float)(left + view.left) - (float)(every_other(code) << (3u + level));
    const float from_y = (float)(top + view.above) - (float)(every_other(code >> 1) << (3u + level));
    __global const float *const value = values + VALUES * slot;
    float3v light[VECTORS];
    End ends[END_VECTORS];
#ifdef WITH_ENDS
    __global const float *const row_of_ends = ends_of_tiles + ROW_OF_ENDS * slot;
    intv is_dark[VECTORS];
    Taking taking = {0ul, 0ul, {(intv)(0)}};
    const intv none = (intv)(0);
#endif
    const uint is_open = tiles[slot].is_open;
    for (uint vector = 0u; vector < VECTORS; ++vector) {
        const uintv place = vector * LANES + LANE_NUMBERS;
        floatv across[4], down[4];
        tile_weights(numbers, fma(to_floatv(place & 7u) + (from_x + 0.5f), splat(per_half_side), splat(-1.0f)), across);
        tile_weights(numbers, fma(to_floatv(place >> 3) + (from_y + 0.5f), splat(per_half_side), splat(-1.0f)), down);
#ifdef WITH_ENDS
        float share_of[LANES];
        for (uint lane = 0u; lane < LANES; ++lane) {
            const uint at = vector * LANES + lane, x = left + (at & 7u), y = top + (at >> 3);
            share_of[lane] = shares[min(y, view.height - 1u) * view.width + min(x, view.width - 1u)];
        }
        const floatv share = LOAD_LANES(share_of);
        ends[vector] = end_at(&view, share);
        light[vector] = light_up_to(&view, row_of_ends, value, across, down, share);
        is_dark[vector] = share <= 0.0f;
        const intv is_cut = share < 1.0f;
        taking.lanes[vector] = (is_open & CUT_OPEN ? is_cut : none) | (is_open & WHOLE_OPEN ? share >= 1.0f : none);
        const bool is_near = view.has_near_form && is_open & WHOLE_OPEN && !any_lane(is_cut);
        taking.near |= (is_near ? 1ul : 0ul) << vector;
        taking.closed |= (!is_near && any_lane(taking.lanes[vector]) ? 1ul : 0ul) << vector;
#else
        light[vector] = light_within(value, across, down);
#endif
    }
#ifndef WITH_ENDS
    ends[0] = whole_ray(&view);
    const ulong near = view.has_near_form ? ~0ul : 0ul;
    const Taking taking = {near, ~near, {(intv)(0)}};
#endif
    if (is_open != 0u)
        add_around(&view, starts, sources, levels, code, &taking, ends, light, counts);
#ifdef WITH_ENDS
    for (uint vector = 0u; vector < VECTORS; ++vector) {
        light[vector].x = select(light[vector].x, splat(0.0f), is_dark[vector]);
        light[vector].y = select(light[vector].y, splat(0.0f), is_dark[vector]);
        light[vector].z = select(light[vector].z, splat(0.0f), is_dark[vector]);
    }
#endif
    for (uint vector = 0u; vector < VECTORS; ++vector) {
        float red[LANES], green[LANES], blue[LANES];
        scatter(light[vector].x, red), scatter(light[vector].y, green), scatter(light[vector].z, blue);
        for (uint lane = 0u; lane < LANES; ++lane) {
            const uint place = vector * LANES + lane, x = left + (place & 7u), y = top + (place >> 3);
            const uint pixel = y * view.width + x;
            if (x >= view.width || y >= view.height || pixel < part.first || pixel >= part.first + part.count)
                continue;
            const uint index = pixel - part.first;
            const float4 there = part.adds ? pixels[part.slot + index] : (float4)(0.0f);
            store_pixel(&part, index, there + (float4)(red[lane], green[lane], blue[lane], 0.0f), FILM_ARGUMENT);
        }
    }
}
