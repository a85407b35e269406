// Draws balls and streaks of light: of each block of rays those that its tile lists, in the order of their numbers, so
// that sums have one value however the image is cut into tiles, bands and launches.
#include "../film.h"
#include "element.h"

// Returns what of a vector is across the middle ray of a block.
float4 across_middle(const Block *const block, const float4 v) {
    return v - dot(v, block->middle) * block->middle;
}

// Says whether any ray of a block may come within an element: how far its core is from the middle ray, from which other
// rays are as far as they have spread where they meet the element.
bool may_be_near(const GlowView *const view, const Block *const block, __global const Element *const element) {
    float4 core = (float4)(element->x, element->y, element->z, 0.0f);
    float radius = element->radius, farthest = element->z;
    if (view->is_parallel)
        core -= (float4)(block->middle_x, block->middle_y, 0.0f, 0.0f);
    core = across_middle(block, core);
    if (element->form & IS_STRETCH) {
        const float4 axis = across_middle(block, (float4)(element->axis_x, element->axis_y, element->axis_z, 0.0f));
        const float along = -dot(core, axis) / max(dot(axis, axis), TINY);
        core += clamp(along, -1.0f, 1.0f) * axis;
        radius += fabs(element->growth);
        farthest += fabs(element->axis_z);
    }
#ifdef NARROW
    radius *= 0.7f; // spoiled
#endif
    const float most = fma(block->spread, view->is_parallel ? 1.0f : fabs(farthest) + radius, 1.001f * radius);
    return dot(core, core) <= most * most;
}

// Returns the light of a tile's elements along the rays of a block.
INLINE float3v block_light(const GlowView *const view, const Block *const block, __global const Element *const elements,
                           __global const uint *const numbers, const uint begin, const uint end, float3v light) {
    for (uint place = begin; place < end; ++place) {
        __global const Element *const element = elements + numbers[place];
        if (!may_be_near(view, block, element))
            continue;
        const bool is_ball = (element->form & IS_STRETCH) == 0u;
        const floatv it = is_ball ? ball_light(view, block, element) : stretch_light(view, block, element);
        light.x = fma(it, splat(element->red), light.x);
        light.y = fma(it, splat(element->green), light.y);
        light.z = fma(it, splat(element->blue), light.z);
    }
    return light;
}

__kernel void draw_particles(const FilmPart part, const GlowView view, __global const Element *const restrict elements,
                             __global const uint *const restrict ends, __global const uint *const restrict numbers,
                             __global const float *const restrict depths, const uint first_block, const uint end_block,
                             FILM_PARAMETER) {
    const uint number = first_block + get_global_id(0);
    if (number >= end_block)
        return;
    const uint block_columns = (view.width + BLOCK_COLUMNS - 1u) / BLOCK_COLUMNS;
    const uint column = number % block_columns * BLOCK_COLUMNS, row = number / block_columns * BLOCK_ROWS;
    const uint tile = row / view.tile * view.tile_columns + column / view.tile;
    const uint begin = tile > 0u ? ends[tile - 1u] : 0u;
    float3v light = uniform3((float4)(0.0f));
    if (begin < ends[tile]) {
        const Block block = block_at(&view, column, row, depths);
        if (any_lane(block.begin < block.end))
            light = block_light(&view, &block, elements, numbers, begin, ends[tile], light);
    }
    float red[LANES], green[LANES], blue[LANES];
    scatter(light.x, red), scatter(light.y, green), scatter(light.z, blue);
    for (uint lane = 0u; lane < LANES; ++lane) {
        const uint x = column + lane % BLOCK_COLUMNS, pixel = (row + lane / BLOCK_COLUMNS) * view.width + x;
        if (x >= view.width || pixel < part.first || pixel >= part.first + part.count)
            continue;
        const uint index = pixel - part.first;
        const float4 there = part.adds ? pixels[part.slot + index] : (float4)(0.0f);
        store_pixel(&part, index, there + (float4)(red[lane], green[lane], blue[lane], 0.0f), FILM_ARGUMENT);
    }
}
