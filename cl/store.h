// Writes one RGBA pixel for every lane, alpha 1.
#pragma once
#include "lanes.h"
#include "types.h"

// Where the pixels of a launch go: a buffer, by rows. Built with -D IMAGE or -D HALVES, the last launch of a pixel
// writes it to an image or to half floats instead, and the buffer only has what earlier ones have gathered.
typedef struct {
    __global float4 *pixels; // from the launch's first on
    uint first, width;       // its number in the image, and the image's width
    bool accumulates, is_last;
} Canvas;

Canvas canvas_of(__global float4 *const buffer, const Launch *const launch, const uint width) {
    const Canvas canvas = {buffer + launch->slot, launch->first, width, launch->accumulate != 0, launch->is_last != 0};
    return canvas;
}

#if defined(IMAGE)
#define IMAGE_PARAMETER , __write_only image2d_t image
#define IMAGE_ARGUMENT , image
#elif defined(HALVES)
#define IMAGE_PARAMETER , __global half *const image
#define IMAGE_ARGUMENT , image
#else
#define IMAGE_PARAMETER
#define IMAGE_ARGUMENT
#endif

// Vectors of channels, and where those of pixels that are stored as a whole go.
#ifdef HALVES
typedef __global half *Channels;
#define STORE(n) JOIN(vstore_half, n)
#else
typedef __global float *Channels;
#define STORE(n) JOIN(vstore, n)
#endif

#if !defined(NO_SHUFFLES) && !defined(IMAGE)
#define STORES_WHOLE
bool stores_whole(const Canvas *const canvas) {
#ifdef HALVES
    return canvas->is_last && !canvas->accumulates;
#else
    return !canvas->accumulates;
#endif
}

Channels channels_of(const Canvas *const canvas, const uint index IMAGE_PARAMETER) {
#ifdef HALVES
    return image + 4u * (canvas->first + index);
#else
    return (Channels)(canvas->pixels + index);
#endif
}
#endif

// How many lanes have a pixel, when so many pixels are left.
#ifndef LAST_LANES
#define LAST_LANES(left) min(left, (uint)LANES)
#endif

#if LANES > 1
#define HALF_FLOATS JOIN(float, HALF_LANES)
#if LANES == 16
#define HALF_LANES 8
typedef ulong8 pairv;
#define as_pairv as_ulong8
#elif LANES == 8
#define HALF_LANES 4
typedef ulong4 pairv;
#define as_pairv as_ulong4
#else
#define HALF_LANES 2
typedef ulong2 pairv;
#define as_pairv as_ulong2
#endif

// Half the lanes' pixels from their channels: red with green and blue with alpha, then pairs with pairs. Said element
// by element the same costs a torus of 64 divisions a tenth of its frame.
void store_half(const Channels channels, const HALF_FLOATS red, const HALF_FLOATS green, const HALF_FLOATS blue) {
    floatv red_green = splat(0.0f), blue_alpha = splat(1.0f);
    red_green.even = red, red_green.odd = green, blue_alpha.even = blue;
    pairv first = (pairv)(0), second = (pairv)(0);
    first.even = as_pairv(red_green).lo, first.odd = as_pairv(blue_alpha).lo;
    second.even = as_pairv(red_green).hi, second.odd = as_pairv(blue_alpha).hi;
    STORE(LANES)(as_floatv(first), 0, channels);
    STORE(LANES)(as_floatv(second), 1, channels);
}
#endif

// Writes all lanes, half of them in each of two places.
INLINE void store_all_pixels(const Channels first_half, const Channels second_half, const float3v color) {
#if LANES == 1
    STORE(4)((float4)(color.x, color.y, color.z, 1.0f), 0, first_half);
#else
    store_half(first_half, color.x.lo, color.y.lo, color.z.lo);
    store_half(second_half, color.x.hi, color.y.hi, color.z.hi);
#endif
}

INLINE void store_pixel(const Canvas *const canvas, const uint index, const float4 light IMAGE_PARAMETER) {
    const float4 before = canvas->accumulates ? canvas->pixels[index] : (float4)(0.0f);
    const float4 pixel = (float4)((light + before).xyz, 1.0f);
#ifdef IMAGE
    if (canvas->is_last) {
        const int place = (int)(canvas->first + index), width = (int)canvas->width;
        write_imagef(image, (int2)(place % width, place / width), pixel);
        return;
    }
#elif defined(HALVES)
    if (canvas->is_last) {
        vstore_half4(pixel, canvas->first + index, image);
        return;
    }
#endif
    canvas->pixels[index] = pixel;
}

// The lanes one by one: pixels of a block of so many columns, `pitch` pixels from one row to the next, of which the
// image has some.
typedef struct {
    uint first_lane; // of this work-item in the block
    uint block_width, pitch;
    uint columns, rows; // that the image has
} Clip;

INLINE void store_clipped(const Canvas *const canvas, const uint corner, const Clip *const clip,
                          const float3v color IMAGE_PARAMETER) {
    float red[LANES], green[LANES], blue[LANES];
    scatter(color.x, red);
    scatter(color.y, green);
    scatter(color.z, blue);
    for (uint lane = 0; lane < LANES; ++lane) {
        const uint column = (clip->first_lane + lane) % clip->block_width;
        const uint row = (clip->first_lane + lane) / clip->block_width;
        if (column >= clip->columns || row >= clip->rows)
            continue;
        const float4 light = (float4)(red[lane], green[lane], blue[lane], 0.0f);
        store_pixel(canvas, corner + row * clip->pitch + column, light IMAGE_ARGUMENT);
    }
}

// Writes (or adds to) pixels[begin .. begin + count), count at most LANES.
INLINE void store_pixels(const Canvas *const canvas, const uint begin, const uint count,
                         const float3v color IMAGE_PARAMETER) {
#ifdef STORES_WHOLE
    if (count == LANES && stores_whole(canvas)) {
        const Channels channels = channels_of(canvas, begin IMAGE_ARGUMENT);
        store_all_pixels(channels, channels + 4 * LANES / 2, color);
        return;
    }
#endif
    const Clip clip = {0, LANES, 0, count, 1};
    store_clipped(canvas, begin, &clip, color IMAGE_ARGUMENT);
}
