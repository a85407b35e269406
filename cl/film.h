// Writes one RGBA pixel for every lane, alpha 1, to where a launch's light goes. Every engine ends here: its kernel
// takes a FilmPart and FILM_PARAMETER, begins with gathered_light, and gives the sum to store_pixels. As light is
// summed on, and never added up from sums, a pixel has the same bits however many launches it takes.
#pragma once
#include "check_size.h"
#include "lanes.h"

// The pixels of a launch, and where their light goes: a buffer, by rows. Built with -D IMAGE or -D HALVES, the last
// launch of a pixel writes it to an image or to half floats instead, and the buffer only has what earlier ones have
// gathered.
typedef struct {
    uint first;   // index of the first pixel (or ray), row by row from the top left
    uint count;   // pixels
    uint slot;    // where in the buffer the first pixel goes, in pixels
    uint width;   // pixels in a row of the image
    uint adds;    // 1: light begins with what the buffer has; 0: with none
    uint is_last; // 1: no launch adds to these pixels any more
} FilmPart;
CHECK_SIZE(FilmPart, SIZEOF_FILMPART);

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

// The buffer, and where finished pixels go if that is elsewhere.
#define FILM_PARAMETER __global float4 *const restrict pixels IMAGE_PARAMETER
#define FILM_ARGUMENT pixels IMAGE_ARGUMENT

// Where channels are stored, and the function that stores a vector of them.
#ifdef HALVES
typedef __global half *Channels;
#define STORE(n) JOIN(vstore_half, n)
#else
typedef __global float *Channels;
#define STORE(n) JOIN(vstore, n)
#endif

#if !defined(NO_SHUFFLES) && !defined(IMAGE)
#define STORES_WHOLE
bool stores_whole(const FilmPart *const part) {
#ifdef HALVES
    return part->is_last;
#else
    return true;
#endif
}

Channels channels_of(const FilmPart *const part, const uint index, FILM_PARAMETER) {
#ifdef HALVES
    return image + 4u * (part->first + index);
#else
    return (Channels)(pixels + part->slot + index);
#endif
}
#endif

// Clamps light to what half floats hold, where pixels are stored as such.
#ifdef HALF_RANGE
#define IN_RANGE(light) min(light, 65504.0f)
#else
#define IN_RANGE(light) (light)
#endif

// How many lanes have a pixel where `left` pixels are left.
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

// Stores half the lanes' pixels, in two places, woven from their channels: red with green and blue with alpha, then
// pairs with pairs. Written element by element, the same costs a torus of 64 divisions a tenth of its frame.
void store_half(const Channels near, const Channels far, const HALF_FLOATS red, const HALF_FLOATS green,
                const HALF_FLOATS blue) {
    floatv red_green = splat(0.0f), blue_alpha = splat(1.0f);
    red_green.even = red, red_green.odd = green, blue_alpha.even = blue;
    pairv first = (pairv)(0), second = (pairv)(0);
    first.even = as_pairv(red_green).lo, first.odd = as_pairv(blue_alpha).lo;
    second.even = as_pairv(red_green).hi, second.odd = as_pairv(blue_alpha).hi;
    STORE(LANES)(IN_RANGE(as_floatv(first)), 0, near);
    STORE(LANES)(IN_RANGE(as_floatv(second)), 0, far);
}
#endif

// Writes all lanes, half of them in each of two places.
INLINE void store_all_pixels(const Channels first_half, const Channels second_half, const float3v color) {
#if LANES == 1
    STORE(4)(IN_RANGE((float4)(color.x, color.y, color.z, 1.0f)), 0, first_half);
#else
    store_half(first_half, first_half + LANES, color.x.lo, color.y.lo, color.z.lo);
    store_half(second_half, second_half + LANES, color.x.hi, color.y.hi, color.z.hi);
#endif
}

INLINE void store_pixel(const FilmPart *const part, const uint index, const float4 light, FILM_PARAMETER) {
    const float4 pixel = (float4)(light.xyz, 1.0f);
#ifdef IMAGE
    if (part->is_last) {
        const int place = (int)(part->first + index), width = (int)part->width;
        write_imagef(image, (int2)(place % width, place / width), IN_RANGE(pixel));
        return;
    }
#elif defined(HALVES)
    if (part->is_last) {
        vstore_half4(IN_RANGE(pixel), part->first + index, image);
        return;
    }
#endif
    pixels[part->slot + index] = pixel;
}

// How lanes are stored one by one: as pixels of a block of `block_width` columns, `pitch` pixels from one row to the
// next, of which the image has some.
typedef struct {
    uint first_lane; // of this work-item in the block
    uint block_width, pitch;
    uint columns, rows; // that the image has
} Clip;

// Returns what earlier launches have gathered for the lanes' pixels; those that the image has not repeat others.
INLINE float3v gathered_clipped(const FilmPart *const part, const uint corner, const Clip *const clip,
                                __global const float4 *const pixels) {
    __global const float *const channels = (__global const float *)(pixels + part->slot + corner);
    const uintv place = clip->first_lane + LANE_NUMBERS;
    const uintv column = min(place % clip->block_width, (uintv)(clip->columns - 1u));
    const uintv row = min(place / clip->block_width, (uintv)(clip->rows - 1u));
    const intv at = as_intv(4u * (row * clip->pitch + column));
    const float3v light = {gather(channels, at), gather(channels, at + 1), gather(channels, at + 2)};
    return light;
}

INLINE void store_clipped(const FilmPart *const part, const uint corner, const Clip *const clip, const float3v color,
                          FILM_PARAMETER) {
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
        store_pixel(part, corner + row * clip->pitch + column, light, FILM_ARGUMENT);
    }
}

// Returns what the light of LANES consecutive pixels begins with, `begin` pixels after the part's first.
INLINE float3v gathered_light(const FilmPart *const part, const uint begin, __global const float4 *const pixels) {
    if (!part->adds)
        return uniform3((float4)(0.0f));
    const Clip clip = {0, LANES, 0, part->count - begin, 1};
    return gathered_clipped(part, begin, &clip, pixels);
}

// Writes the light of LANES consecutive pixels, `begin` pixels after the part's first; nothing of those beyond its end.
INLINE void store_pixels(const FilmPart *const part, const uint begin, const float3v light, FILM_PARAMETER) {
    const uint count = LAST_LANES(part->count - begin);
#ifdef STORES_WHOLE
    if (count == LANES && stores_whole(part)) {
        const Channels channels = channels_of(part, begin, FILM_ARGUMENT);
        store_all_pixels(channels, channels + 4 * LANES / 2, light);
        return;
    }
#endif
    const Clip clip = {0, LANES, 0, count, 1};
    store_clipped(part, begin, &clip, light, FILM_ARGUMENT);
}

// Writes the light of a block of whole rows side by side, of which the image has so many columns and rows; `corner` is
// its first pixel in the part, `pitch` pixels lie from one row to the next.
INLINE void store_rows(const FilmPart *const part, const uint corner, const Clip *const clip, const float3v light,
                       FILM_PARAMETER) {
#if defined(STORES_WHOLE) && LANES > 1
    const bool is_whole = clip->columns >= clip->block_width && clip->rows * clip->block_width >= LANES;
    if (is_whole && stores_whole(part)) {
        // A vector of channels is a row of four pixels, or half a row.
        const uint a_vector = LANES / 4u, a_row = clip->block_width / a_vector;
        Channels places[4];
        for (uint at = 0u; at < 4u; ++at)
            places[at] = channels_of(part, corner + at / a_row * clip->pitch + at % a_row * a_vector, FILM_ARGUMENT);
        store_half(places[0], places[1], light.x.lo, light.y.lo, light.z.lo);
        store_half(places[2], places[3], light.x.hi, light.y.hi, light.z.hi);
        return;
    }
#endif
    store_clipped(part, corner, clip, light, FILM_ARGUMENT);
}
