// Writes one RGBA pixel for every lane, alpha 1.
#pragma once
#include "lanes.h"

// How many lanes have a pixel, when so many pixels are left.
#ifndef LAST_LANES
#define LAST_LANES(left) min(left, (uint)LANES)
#endif

// Writes (or adds to) pixels[0 .. count), count at most LANES.
void store_pixels(__global float4 *const pixels, const uint count, const float3v radiance, const uint accumulate) {
#if LANES == 1
    const float4 before = accumulate ? pixels[0] : (float4)(0.0f);
    pixels[0] = (float4)(radiance.x + before.x, radiance.y + before.y, radiance.z + before.z, 1.0f);
#else
    float red[LANES], green[LANES], blue[LANES];
    JOIN(vstore, LANES)(radiance.x, 0, red);
    JOIN(vstore, LANES)(radiance.y, 0, green);
    JOIN(vstore, LANES)(radiance.z, 0, blue);
    for (uint lane = 0; lane < count; ++lane) {
        const float4 before = accumulate ? pixels[lane] : (float4)(0.0f);
        const float4 light = (float4)(red[lane], green[lane], blue[lane], 0.0f) + before;
        pixels[lane] = (float4)(light.xyz, 1.0f);
    }
#endif
}
