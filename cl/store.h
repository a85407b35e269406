// Writes one RGBA pixel for every lane, alpha 1.
#pragma once
#include "lanes.h"

// How many lanes have a pixel, when so many pixels are left.
#ifndef LAST_LANES
#define LAST_LANES(left) min(left, (uint)LANES)
#endif

#if LANES > 1
// Four pixels from the channels of four lanes: red with green and blue with alpha, then pairs with pairs. Said element
// by element the same costs a torus of 64 divisions a tenth of its frame.
void store_four_pixels(__global float *const values, const float4 red, const float4 green, const float4 blue) {
    float8 red_green = (float8)(0.0f), blue_alpha = (float8)(1.0f);
    red_green.even = red, red_green.odd = green, blue_alpha.even = blue;
    ulong8 pixels = (ulong8)(0);
    pixels.even = as_ulong4(red_green), pixels.odd = as_ulong4(blue_alpha);
    vstore16(as_float16(pixels), 0, values);
}
#endif

// Writes all lanes, half of them in each of two places.
INLINE void store_all_pixels(__global float4 *const first_half, __global float4 *const second_half,
                             const float3v color) {
    __global float *const first = (__global float *)first_half, *const second = (__global float *)second_half;
#if LANES == 1
    first_half[0] = (float4)(color.x, color.y, color.z, 1.0f);
#elif LANES == 4
    store_four_pixels(first, color.x, color.y, color.z);
#elif LANES == 8
    store_four_pixels(first, color.x.lo, color.y.lo, color.z.lo);
    store_four_pixels(second, color.x.hi, color.y.hi, color.z.hi);
#else
    store_four_pixels(first, color.x.lo.lo, color.y.lo.lo, color.z.lo.lo);
    store_four_pixels(first + 16, color.x.lo.hi, color.y.lo.hi, color.z.lo.hi);
    store_four_pixels(second, color.x.hi.lo, color.y.hi.lo, color.z.hi.lo);
    store_four_pixels(second + 16, color.x.hi.hi, color.y.hi.hi, color.z.hi.hi);
#endif
}

// The lanes one by one: pixels of a block of so many columns, `pitch` pixels from one row to the next, of which the
// image has some.
typedef struct {
    uint first_lane; // of this work-item in the block
    uint block_width, pitch;
    uint columns, rows; // that the image has
} Clip;

INLINE void store_clipped(__global float4 *const corner, const Clip clip, const float3v color, const uint accumulate) {
    float red[LANES], green[LANES], blue[LANES];
    scatter(color.x, red);
    scatter(color.y, green);
    scatter(color.z, blue);
    for (uint lane = 0; lane < LANES; ++lane) {
        const uint column = (clip.first_lane + lane) % clip.block_width;
        const uint row = (clip.first_lane + lane) / clip.block_width;
        if (column >= clip.columns || row >= clip.rows)
            continue;
        __global float4 *const pixel = corner + row * clip.pitch + column;
        const float4 before = accumulate ? *pixel : (float4)(0.0f);
        const float4 light = (float4)(red[lane], green[lane], blue[lane], 0.0f) + before;
        *pixel = (float4)(light.xyz, 1.0f);
    }
}

// Writes (or adds to) pixels[0 .. count), count at most LANES.
INLINE void store_pixels(__global float4 *const pixels, const uint count, const float3v color, const uint accumulate) {
#ifndef NO_SHUFFLES
    if (count == LANES && !accumulate) {
        store_all_pixels(pixels, pixels + LANES / 2, color);
        return;
    }
#endif
    const Clip clip = {0, LANES, 0, count, 1};
    store_clipped(pixels, clip, color, accumulate);
}
