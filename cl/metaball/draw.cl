// Draws surfaces of metaballs: of each ray the length up to the first of them, and of each pixel the mean of the
// radiance that its rays meet.
#include "march.h"

// Passes slab after slab until all rays are at the surface, or behind all particles.
INLINE void follow(const Search *const search, Near *const near, March *const march, const uint2 slabs) {
    __global const Surface *const surface = search->surface;
    const uint reach = surface->reach;
    const uint last = min(slabs.y + reach, surface->slab_count);
    // Slabs that end behind the eye.
    const float before_eye = -surface->first_z / surface->thickness;
    const uint from_eye = before_eye > 0.0f ? (uint)before_eye : 0u;
    Window window = {0u, 0u, 0u, false, cursor_at(0u, 0u)};
    for (uint slab = max(slabs.x > reach ? slabs.x - reach : 0u, from_eye); slab < last; ++slab) {
        const floatv per_z = search->rays->per_z;
        const floatv begin = max(slab_begin(surface, slab) * per_z, 0.0f);
        const floatv end = slab_begin(surface, slab + 1u) * per_z;
        march->s = select(march->s, max(march->s, begin), march->is_open);
        march->want = max(march->want, begin);
        march->is_open &= march->s < march->limit;
        if (!any_lane(march->is_open))
            return;
        move_window(search, &window, near, slab);
        if (window.is_kept && near->count == 0u)
            continue;
        const intv found = march_on(search, &window, near, march, end);
        if (any_lane(found))
            settle(search, &window, near, march, found);
    }
}

// Returns the radiance of surfaces that have a normal.
INLINE float3v shade(const Sight *const sight, __global const Surface *const surface, const float3v normal) {
    const float3v color = uniform3(surface->color);
    if (surface->has_normals) {
        const float4 right = sight->right, down = sight->down, forward = sight->forward;
        const float3v world = {fma(normal.x, right.x, fma(normal.y, down.x, normal.z * forward.x)),
                               fma(normal.x, right.y, fma(normal.y, down.y, normal.z * forward.y)),
                               fma(normal.x, right.z, fma(normal.y, down.z, normal.z * forward.z))};
        const float3v shade = {0.5f * world.x + 0.5f, 0.5f * world.y + 0.5f, 0.5f * world.z + 0.5f};
        const float3v shaded = {shade.x * color.x, shade.y * color.y, shade.z * color.z};
        return shaded;
    }
    const float3v lamp = uniform3((float4)(LAMP, 0.0f));
    const floatv facing = max(dot3(normal, lamp), 0.0f);
    return scale3(color, fma(facing, splat(1.0f - AMBIENT), splat(AMBIENT)));
}

// Follows the rays of a block to every surface; the nearest is seen.
INLINE float3v draw_block(Search *const search, const uint surface_count, __global const Surface *const surfaces,
                          __global const Slab *const slabs, __global const uint2 *const squares, const uint square,
                          Near *const near, March *const march) {
    float3v light = uniform3((float4)(0.0f));
    const intv is_inside = march->is_open;
    intv is_hit = (intv)(0);
    for (uint number = 0u; number < surface_count; ++number) {
        __global const Surface *const surface = surfaces + number;
        const uint2 range = squares[surface->first_square + square];
        if (range.y <= range.x)
            continue;
        search->surface = surface;
        search->slabs = slabs + surface->first_slab;
        march->s = march->want = splat(0.0f);
        march->taken = (uintv)(0u);
        march->is_open = is_inside;
        march->is_hit = (intv)(0);
        follow(search, near, march, range);
        light = select3(light, shade(search->sight, surface, march->normal), march->is_hit);
        march->limit = select(march->limit, march->s, march->is_hit);
        is_hit |= march->is_hit;
    }
    march->is_hit = is_hit;
    march->is_open = is_inside;
    return light;
}

Search search_of(const Sight *const sight, const Rays *const rays, const uint column, const uint row) {
    Search search;
    search.sight = sight;
    search.rays = rays;
    search.block = block_of(sight, column, row, BLOCK_COLUMNS, BLOCK_ROWS);
    const Block *const block = &search.block;
    const float middle_column = 0.5f * (block->left + block->right), middle_row = 0.5f * (block->top + block->bottom);
    search.middle_x = fma(middle_column, sight->step_x, fma(middle_row, sight->skew_x, sight->first_x));
    search.middle_y = fma(middle_row, sight->step_y, sight->first_y);
    const float rows = block->bottom - block->top, down = rows * sight->step_y;
    const float across = fma(block->right - block->left, sight->step_x, rows * fabs(sight->skew_x));
    search.spread = 0.501f * sqrt(fma(across, across, down * down));
    search.longest = sqrt(1.0f + block->steepest2);
    return search;
}

// Pixels across and down in a unit, and rays in a pixel, at most.
#define MOST_PIXELS 4u

// What a unit, a square of whole pixels, has gathered.
typedef struct {
    float4 light[MOST_PIXELS * MOST_PIXELS];
} Gathered;

// Adds the light of a block's rays to their pixels, and stores their lengths.
INLINE void gather_block(const Sight *const sight, const uint column, const uint row, const uint first_column,
                         const uint first_row, const March *const march, const floatv length, const float3v light,
                         Gathered *const gathered, __global float *const lengths) {
    float red[LANES], green[LANES], blue[LANES], end[LANES];
    scatter(light.x, red), scatter(light.y, green), scatter(light.z, blue), scatter(length, end);
    const uint pixels = sight->unit / sight->across;
    for (uint lane = 0u; lane < LANES; ++lane) {
        const uint x = column + lane % BLOCK_COLUMNS, y = row + lane / BLOCK_COLUMNS;
        if (x >= min(first_column + sight->unit, sight->width) || y >= min(first_row + sight->unit, sight->height))
            continue;
        const uint pixel = (y - first_row) / sight->across * pixels + (x - first_column) / sight->across;
        gathered->light[pixel] += (float4)(red[lane], green[lane], blue[lane], 0.0f);
        lengths[y * sight->width + x] = end[lane];
    }
}

// Returns the given lengths that end rays, of the nearest in the picture.
floatv given_lengths(const Sight *const sight, const uintv column, const uintv row,
                     __global const float *const depths) {
    if (!sight->has_depth)
        return splat(INFINITY);
    const uint columns = sight->width / sight->depth_step;
    const uintv place = row / sight->depth_step * columns + column / sight->depth_step;
    return gather(depths, as_intv(place));
}

__kernel void draw_surfaces(const Sight sight, __global const Surface *const restrict surfaces,
                            const uint surface_count, __global const Slab *const restrict slabs,
                            __global const uint *const restrict cells,
                            __global const Particle *const restrict particles,
                            __global const float *const restrict planes, const uint plane,
                            __global const uint2 *const restrict squares, __global const float *const restrict depths,
                            const uint first_unit, const uint end_unit, __global uint *const restrict counts,
                            __global float *const restrict lengths, __global float4 *const restrict light) {
    const uint unit = first_unit + get_global_id(0);
    if (unit >= end_unit)
        return;
    const uint unit_columns = (sight.width + sight.unit - 1u) / sight.unit;
    const uint first_column = unit % unit_columns * sight.unit, first_row = unit / unit_columns * sight.unit;
    Gathered gathered;
    for (uint pixel = 0u; pixel < MOST_PIXELS * MOST_PIXELS; ++pixel)
        gathered.light[pixel] = (float4)(0.0f);
    Near near;
    forget(&near);
#ifdef COUNT_NODES
    near.passes = near.pairs = 0u;
#endif
    const uint last_column = min(first_column + sight.unit, sight.width);
    const uint last_row = min(first_row + sight.unit, sight.height);
    for (uint row = first_row; row < last_row; row += BLOCK_ROWS)
        for (uint column = first_column; column < last_column; column += BLOCK_COLUMNS) {
            const uintv columns = column + LANE_NUMBERS % BLOCK_COLUMNS, rows = row + LANE_NUMBERS / BLOCK_COLUMNS;
            const uintv inside_x = min(columns, (uintv)(sight.width - 1u));
            const uintv inside_y = min(rows, (uintv)(sight.height - 1u));
            const Rays rays = rays_at(&sight, inside_x, inside_y);
            Search search = search_of(&sight, &rays, column, row);
            search.cells = cells, search.particles = particles, search.planes = planes, search.plane = plane;
            const floatv given = given_lengths(&sight, inside_x, inside_y, depths);
            March march;
            march.limit = sight.is_along_axis ? given * rays.per_z : given;
            march.is_open = (columns < last_column) & (rows < last_row);
            march.normal = uniform3((float4)(0.0f));
            const uint square = row / sight.square * sight.span_columns + column / sight.square;
            const float3v block_light =
                draw_block(&search, surface_count, surfaces, slabs, squares, square, &near, &march);
            const floatv found = sight.is_along_axis ? march.limit / rays.per_z : march.limit;
            const floatv length = select(given, found, march.is_hit);
            gather_block(&sight, column, row, first_column, first_row, &march, length, block_light, &gathered, lengths);
        }
#ifdef COUNT_NODES
    atomic_add(counts, near.passes);
    atomic_add(counts + 1, near.pairs);
#endif
    const uint pixels = sight.unit / sight.across, picture_width = sight.width / sight.across;
    const float share = 1.0f / (float)(sight.across * sight.across);
    for (uint y = 0u; y < pixels && first_row + y * sight.across < sight.height; ++y)
        for (uint x = 0u; x < pixels && first_column + x * sight.across < sight.width; ++x) {
            const float4 sum = share * gathered.light[y * pixels + x];
            const uint pixel = (first_row / sight.across + y) * picture_width + first_column / sight.across + x;
            light[pixel] = (float4)(sum.xyz, 1.0f);
        }
}
