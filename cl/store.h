// Writes one RGBA pixel for every lane, alpha 1.
#pragma once
#include "lanes.h"

// How many lanes have a pixel, when so many pixels are left.
#ifndef LAST_LANES
#define LAST_LANES(left) min(left, (uint)LANES)
#endif

// The pixel of a lane, by the lane's hexadecimal digit.
#define PIXEL(color, lane) (float4)(color.x.s##lane, color.y.s##lane, color.z.s##lane, 1.0f)
#define FOUR_PIXELS(color, a, b, c, d) (float16)(PIXEL(color, a), PIXEL(color, b), PIXEL(color, c), PIXEL(color, d))

// All lanes at once: whole vectors, which the compiler shuffles together.
void store_all_pixels(__global float4 *const pixels, const float3v radiance) {
    __global float *const values = (__global float *)pixels;
#if LANES == 1
    pixels[0] = (float4)(radiance.x, radiance.y, radiance.z, 1.0f);
#else
    vstore16(FOUR_PIXELS(radiance, 0, 1, 2, 3), 0, values);
#if LANES > 4
    vstore16(FOUR_PIXELS(radiance, 4, 5, 6, 7), 1, values);
#endif
#if LANES > 8
    vstore16(FOUR_PIXELS(radiance, 8, 9, a, b), 2, values);
    vstore16(FOUR_PIXELS(radiance, c, d, e, f), 3, values);
#endif
#endif
}

// Writes (or adds to) pixels[0 .. count), count at most LANES.
void store_pixels(__global float4 *const pixels, const uint count, const float3v radiance, const uint accumulate) {
    if (count == LANES && !accumulate) {
        store_all_pixels(pixels, radiance);
        return;
    }
    float red[LANES], green[LANES], blue[LANES];
    scatter(radiance.x, red);
    scatter(radiance.y, green);
    scatter(radiance.z, blue);
    for (uint lane = 0; lane < count; ++lane) {
        const float4 before = accumulate ? pixels[lane] : (float4)(0.0f);
        const float4 light = (float4)(red[lane], green[lane], blue[lane], 0.0f) + before;
        pixels[lane] = (float4)(light.xyz, 1.0f);
    }
}
