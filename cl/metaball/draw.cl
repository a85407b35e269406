// Draws surfaces of metaballs: of each ray the length up to the first of them, and of each pixel the mean of the
// radiance that its rays meet.
#include "march.h"

// Returns the first slab in which rays may meet a particle: none that ends behind the eye.
uint first_followed(__global const Surface *const surface, const uint2 slabs) {
    const float before_eye = -surface->first_z / surface->thickness;
    const uint from_eye = before_eye > 0.0f ? (uint)before_eye : 0u;
    return max(slabs.x > surface->reach ? slabs.x - surface->reach : 0u, from_eye);
}

// Passes slab after slab until all rays are at the surface, or behind all particles.
INLINE void follow(const Search *const search, Near *const near, March *const march, const uint2 slabs) {
    __global const Surface *const surface = search->surface;
    const uint reach = surface->reach;
    const uint last = min(slabs.y + reach, surface->slab_count);
    Window window = {0u, 0u, 0u, false, cursor_at(0u, 0u)};
    for (uint slab = first_followed(surface, slabs); slab < last; ++slab) {
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
        for (intv looks_on = march->is_open; any_lane(looks_on);) {
            const intv found = march_on(search, &window, near, march, end);
            if (!any_lane(found))
                break;
            looks_on = settle(search, &window, near, march, found);
        }
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

// Rays across and down in a unit, at most, and blocks.
#if LANES == 1
#define UNIT_RAYS 8u
#else
#define UNIT_RAYS 16u
#endif
#define UNIT_BLOCKS ((UNIT_RAYS + BLOCK_COLUMNS - 1u) / BLOCK_COLUMNS * ((UNIT_RAYS + BLOCK_ROWS - 1u) / BLOCK_ROWS))

// A unit, a square of whole pixels, and what its rays have met: block by block.
typedef struct {
    uint first_column, first_row, end_column, end_row; // rays, the last not included
    uint blocks_across;
    float length[UNIT_BLOCKS * LANES]; // along the rays, or the axis of view, as depths are
    float red[UNIT_BLOCKS * LANES], green[UNIT_BLOCKS * LANES], blue[UNIT_BLOCKS * LANES];
} Unit;

// Returns the given lengths that end rays, of the nearest in the picture.
floatv given_lengths(const Sight *const sight, const uintv column, const uintv row,
                     __global const float *const depths) {
    if (!sight->has_depth)
        return splat(INFINITY);
    const uint columns = sight->width / sight->depth_step;
    const uintv place = row / sight->depth_step * columns + column / sight->depth_step;
    return gather(depths, as_intv(place));
}

// Columns and rows of the rays of a block, those beside the picture at its edge.
#define COLUMNS_OF(sight, column) (min((column) + LANE_NUMBERS % BLOCK_COLUMNS, (uintv)((sight)->width - 1u)))
#define ROWS_OF(sight, row) (min((row) + LANE_NUMBERS / BLOCK_COLUMNS, (uintv)((sight)->height - 1u)))

// Begins a unit: nothing is met but what the host has given.
INLINE void begin_unit(const Sight *const sight, const uint number, __global const float *const depths,
                       Unit *const unit) {
    const uint unit_columns = (sight->width + sight->unit - 1u) / sight->unit;
    unit->first_column = number % unit_columns * sight->unit;
    unit->first_row = number / unit_columns * sight->unit;
    unit->end_column = min(unit->first_column + sight->unit, sight->width);
    unit->end_row = min(unit->first_row + sight->unit, sight->height);
    unit->blocks_across = (unit->end_column - unit->first_column + BLOCK_COLUMNS - 1u) / BLOCK_COLUMNS;
    uint at = 0u;
    for (uint row = unit->first_row; row < unit->end_row; row += BLOCK_ROWS)
        for (uint column = unit->first_column; column < unit->end_column; column += BLOCK_COLUMNS) {
            scatter(given_lengths(sight, COLUMNS_OF(sight, column), ROWS_OF(sight, row), depths), unit->length + at);
            scatter(splat(0.0f), unit->red + at);
            scatter(splat(0.0f), unit->green + at);
            scatter(splat(0.0f), unit->blue + at);
            at += LANES;
        }
}

// Follows the rays of a block to a surface; the nearest is seen.
INLINE void draw_block(Search *const search, const uint2 slabs, const uint column, const uint row, const uint at,
                       Near *const near, Unit *const unit) {
    const Sight *const sight = search->sight;
    const Rays rays = rays_at(sight, COLUMNS_OF(sight, column), ROWS_OF(sight, row));
    search->rays = &rays;
    const floatv length = LOAD_LANES(unit->length + at);
    March march;
    march.s = march.want = splat(0.0f);
    march.limit = sight->is_along_axis ? length * rays.per_z : length;
    march.is_open = (column + LANE_NUMBERS % BLOCK_COLUMNS < unit->end_column) &
                    (row + LANE_NUMBERS / BLOCK_COLUMNS < unit->end_row);
    march.is_hit = march.is_strict = (intv)(0);
    march.on = splat(0.0f);
    march.taken = (uintv)(0u);
    march.normal = uniform3((float4)(0.0f));
    follow(search, near, &march, slabs);
    if (!any_lane(march.is_hit))
        return;
    const float3v light = shade(sight, search->surface, march.normal);
    const floatv found = sight->is_along_axis ? march.s / rays.per_z : march.s;
    scatter(select(length, found, march.is_hit), unit->length + at);
    scatter(select(LOAD_LANES(unit->red + at), light.x, march.is_hit), unit->red + at);
    scatter(select(LOAD_LANES(unit->green + at), light.y, march.is_hit), unit->green + at);
    scatter(select(LOAD_LANES(unit->blue + at), light.z, march.is_hit), unit->blue + at);
}

// Stores the lengths of a unit's rays, and the mean light of those of each pixel.
INLINE void store_unit(const Sight *const sight, const Unit *const unit, __global float *const lengths,
                       __global float4 *const light) {
    const uint across = sight->across, picture_width = sight->width / across;
    const float share = 1.0f / (float)(across * across);
    for (uint first_row = unit->first_row; first_row < unit->end_row; first_row += across)
        for (uint first_column = unit->first_column; first_column < unit->end_column; first_column += across) {
            float4 sum = (float4)(0.0f);
            for (uint row = first_row; row < first_row + across; ++row)
                for (uint column = first_column; column < first_column + across; ++column) {
                    const uint x = column - unit->first_column, y = row - unit->first_row;
                    const uint block = y / BLOCK_ROWS * unit->blocks_across + x / BLOCK_COLUMNS;
                    const uint at = block * LANES + y % BLOCK_ROWS * BLOCK_COLUMNS + x % BLOCK_COLUMNS;
                    sum += (float4)(unit->red[at], unit->green[at], unit->blue[at], 0.0f);
                    lengths[row * sight->width + column] = unit->length[at];
                }
            sum *= share;
            light[first_row / across * picture_width + first_column / across] = (float4)(sum.xyz, 1.0f);
        }
}

__kernel void draw_surfaces(const Sight sight, __global const Surface *const restrict surfaces,
                            const uint surface_count, __global const Slab *const restrict slabs,
                            __global const uint *const restrict cells,
                            __global const Particle *const restrict particles,
                            __global const float *const restrict planes, const uint plane,
                            __global const uint2 *const restrict squares, __global const float *const restrict depths,
                            const uint first_unit, const uint end_unit, __global uint *const restrict counts,
                            __global float *const restrict lengths, __global float4 *const restrict light) {
    const uint number = first_unit + get_global_id(0);
    if (number >= end_unit)
        return;
    Unit unit;
    begin_unit(&sight, number, depths, &unit);
    Near near;
    forget(&near);
#ifdef COUNT_NODES
    near.passes = near.pairs = 0u;
#endif
    Listed listed;
    const uint square = unit.first_row / sight.square * sight.span_columns + unit.first_column / sight.square;
    for (uint at = 0u; at < surface_count; ++at) {
        __global const Surface *const surface = surfaces + at;
        const uint2 range = squares[surface->first_square + square];
        if (range.y <= range.x)
            continue;
        Search whole;
        whole.sight = &sight, whole.surface = surface, whole.slabs = slabs + surface->first_slab;
        whole.cells = cells, whole.particles = particles, whole.planes = planes, whole.plane = plane;
        whole.unit = &whole, whole.listed = &listed;
        set_rectangle(&whole, unit.first_column, unit.first_row, sight.unit, sight.unit);
        begin_list(&listed, first_of_window(surface, first_followed(surface, range)));
        uint place = 0u;
        for (uint row = unit.first_row; row < unit.end_row; row += BLOCK_ROWS)
            for (uint column = unit.first_column; column < unit.end_column; column += BLOCK_COLUMNS) {
                Search search = whole;
                set_rectangle(&search, column, row, BLOCK_COLUMNS, BLOCK_ROWS);
                draw_block(&search, range, column, row, place, &near, &unit);
                place += LANES;
            }
    }
#ifdef COUNT_NODES
    atomic_add(counts, near.passes);
    atomic_add(counts + 1, near.pairs);
#endif
    store_unit(&sight, &unit, lengths, light);
}
