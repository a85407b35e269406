// Draws balls and streaks of light: of each unit of rays those that its tile lists, in the order of their numbers, so
// that sums have one value however the image is cut into tiles, bands and launches.
#include "../film.h"
#include "element.h"
#include "near.h"
#include "pixels.h"

// What rays have gathered, a block's side by side.
typedef struct {
    float3v light[UNIT * UNIT];
} Gathered;

// A block of a unit: its first pixel.
typedef struct {
    uint column, row;
} Corner;

// Returns the so manieth block of a unit.
Corner corner_of(const uint column, const uint row, const uint number) {
    const Corner corner = {column + number % UNIT * BLOCK_COLUMNS, row + number / UNIT * BLOCK_ROWS};
    return corner;
}

// Says whether a part may have pixels of a block.
bool has_block(const FilmPart *const part, const GlowView *const view, const Corner *const block) {
    return block->column < view->width && block->row < view->height &&
           block->row * view->width < part->first + part->count &&
           (block->row + BLOCK_ROWS) * view->width > part->first;
}

// Adds an element's light along the rays of a block.
INLINE void add_element(const GlowView *const view, const Cone *const cone, const Block *const block,
                        __global const Element *const element, float3v *const light) {
    const Rays *const rays = &block->rays;
    floatv it;
    if ((element->form & IS_CLEAR) && element->z + element->radius <= block->least_z) {
        const Passing way = passing(block, element->x, element->y, element->z);
        it = clear_ball_light(view, rays, &way, element);
    } else if (element->form & IS_STRETCH) {
        const float4 middle = (float4)(element->x, element->y, element->z, 0.0f);
        const float4 axis = (float4)(element->axis_x, element->axis_y, element->axis_z, 0.0f);
        if (!any_lane(is_stretch_near(view, cone, uniform3(middle), uniform3(axis), splat(element->growth),
                                      splat(element->radius))))
            return;
        const Passing way = passing(block, element->x, element->y, element->z);
        it = stretch_light(view, rays, &way, element);
    } else {
        const Passing way = passing(block, element->x, element->y, element->z);
        it = ball_light(view, rays, &way, element);
    }
    light->x = fma(it, splat(element->red), light->x);
    light->y = fma(it, splat(element->green), light->y);
    light->z = fma(it, splat(element->blue), light->z);
}

// Adds the light of candidates to the blocks of a unit.
INLINE void add_light(const FilmPart *const part, const GlowView *const view, const uint column, const uint row,
                      __global const Element *const elements, const Candidates *const candidates,
                      __global const float *const depths, Gathered *const gathered) {
    for (uint number = 0u; number < UNIT * UNIT; ++number) {
        const Corner corner = corner_of(column, row, number);
        if (!has_block(part, view, &corner))
            continue;
        const Cone cone = cone_of(view, corner.column, corner.row, BLOCK_COLUMNS, BLOCK_ROWS);
#if UNIT == 1
        const uint count = candidates->count;
#else
        ushort list[ROOM + LANES];
        const uint count = near_block(view, &cone, candidates, list);
#endif
        if (count == 0u)
            continue;
        const Block block = block_at(view, corner.column, corner.row, depths);
        if (!any_lane(block.rays.begin < block.rays.end))
            continue;
        float3v light = gathered->light[number];
        for (uint place = 0u; place < count; ++place) {
#if UNIT == 1
            const uint at = candidates->number[place];
#else
            const uint at = candidates->number[list[place]];
#endif
            add_element(view, &cone, &block, elements + at, &light);
        }
        gathered->light[number] = light;
    }
}

INLINE void store_light(const FilmPart *const part, const GlowView *const view, const uint column, const uint row,
                        const Gathered *const gathered, FILM_PARAMETER) {
    for (uint number = 0u; number < UNIT * UNIT; ++number) {
        const Corner corner = corner_of(column, row, number);
        if (!has_block(part, view, &corner))
            continue;
        float3v light = gathered->light[number];
        const uint first = corner.row * view->width + corner.column, end = part->first + part->count;
        const uint columns = min(BLOCK_COLUMNS, view->width - corner.column);
        const uint rows = min(BLOCK_ROWS, view->height - corner.row);
        if (first >= part->first && first + (rows - 1u) * view->width + columns <= end) {
            const Clip clip = {0u, BLOCK_COLUMNS, view->width, columns, rows};
            if (part->adds)
                light = add3(gathered_clipped(part, first - part->first, &clip, pixels), light);
            store_rows(part, first - part->first, &clip, light, FILM_ARGUMENT);
            continue;
        }
        // A part may begin and end within a block.
        float red[LANES], green[LANES], blue[LANES];
        scatter(light.x, red), scatter(light.y, green), scatter(light.z, blue);
        for (uint lane = 0u; lane < LANES; ++lane) {
            const uint x = corner.column + lane % BLOCK_COLUMNS;
            const uint pixel = (corner.row + lane / BLOCK_COLUMNS) * view->width + x;
            if (x >= view->width || pixel < part->first || pixel >= end)
                continue;
            const uint index = pixel - part->first;
            const float4 there = part->adds ? pixels[part->slot + index] : (float4)(0.0f);
            store_pixel(part, index, there + (float4)(red[lane], green[lane], blue[lane], 0.0f), FILM_ARGUMENT);
        }
    }
}

__kernel void draw_particles(const FilmPart part, const GlowView view, __global const Element *const restrict elements,
                             __global const uint *const restrict ends, __global const uint *const restrict numbers,
                             __global const float *const restrict depths, const uint first_unit, const uint end_unit,
                             FILM_PARAMETER) {
    const uint unit = first_unit + get_global_id(0);
    if (unit >= end_unit)
        return;
    const uint unit_columns = (view.width + UNIT_COLUMNS - 1u) / UNIT_COLUMNS;
    const uint column = unit % unit_columns * UNIT_COLUMNS, row = unit / unit_columns * UNIT_ROWS;
    const uint tile = row / view.tile * view.tile_columns + column / view.tile;
    const uint end = ends[tile];
    uint at = tile > 0u ? ends[tile - 1u] : 0u;
    Gathered gathered;
    for (uint number = 0u; number < UNIT * UNIT; ++number)
        gathered.light[number] = uniform3((float4)(0.0f));
    if (at < end) {
        const Cone cone = cone_of(&view, column, row, UNIT_COLUMNS, UNIT_ROWS);
        Candidates candidates;
        while (at < end) {
            candidates.count = 0u;
            for (; at < end && candidates.count + LANES <= ROOM; at += LANES)
                add_candidates(&view, &cone, elements, numbers, at, end, &candidates);
            fill_last_lanes(&candidates);
            add_light(&part, &view, column, row, elements, &candidates, depths, &gathered);
        }
    }
    store_light(&part, &view, column, row, &gathered, FILM_ARGUMENT);
}
