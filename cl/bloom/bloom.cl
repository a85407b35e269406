// Bloom on the device: the pyramid of src/image/bloom/ (Burt and Adelson 1983), over a picture that a film holds. The
// picture is read twice and written once; all sizes from half of it on are levels, one behind the other in a buffer.
#include "../film.h"
#include "double.h"
#include "halve.h"

// Halves the picture to the first level.
__kernel void halve_picture(__global const BloomStep *const restrict steps,
                            __global const float *const restrict weights, __global const float4 *const restrict pixels,
                            __global float *const restrict levels) {
    const BloomStep step = steps[0];
    const uint number = get_global_id(0);
    if (number < step.pieces * step.height)
        halve_piece(&step, weights, (Channels4)pixels, levels + 4u * (size_t)step.at, number, true);
}

// Halves a level to the next.
__kernel void halve_level(__global const BloomStep *const restrict steps, const uint first,
                          __global const float *const restrict weights, __global float *const levels) {
    const BloomStep step = steps[first];
    const uint number = get_global_id(0);
    if (number < step.pieces * step.height)
        halve_piece(&step, weights, levels + 4u * (size_t)step.fine_at, levels + 4u * (size_t)step.at, number, false);
}

// Halves small levels from step `first` on and adds them up again, before step `end`: by one group, whose launches
// would take longer than the work.
__kernel void small_levels(__global const BloomStep *const restrict steps, const uint first, const uint end,
                           __global const float *const restrict weights, __global float *const levels) {
    for (uint number = first; number < end; ++number) {
        const BloomStep step = steps[number];
        const uint pieces = step.pieces * step.height;
        for (uint piece = get_local_id(0); piece < pieces; piece += get_local_size(0))
            halve_piece(&step, weights, levels + 4u * (size_t)step.fine_at, levels + 4u * (size_t)step.at, piece,
                        false);
        barrier(CLK_GLOBAL_MEM_FENCE);
    }
    for (uint number = end; number > first; --number) {
        const BloomStep step = steps[number - 1u];
        const uint pieces = step.pieces * step.height;
        for (uint piece = get_local_id(0); piece < pieces; piece += get_local_size(0))
            double_piece(&step, levels, piece);
        barrier(CLK_GLOBAL_MEM_FENCE);
    }
}

// Adds what is coarser to a level.
__kernel void double_level(__global const BloomStep *const restrict steps, const uint first,
                           __global float *const levels) {
    const BloomStep step = steps[first];
    const uint number = get_global_id(0);
    if (number < step.pieces * step.height)
        double_piece(&step, levels, number);
}

// Finishes a pixel: its light less what it spreads, and what comes from all around. Light without end stays.
INLINE float4 bloomed(const float4 light, const float4 spread, const float kept) {
    float4 pixel = kept * light + spread;
    pixel.w = light.w;
    return is_finite_pixel(light) ? pixel : light;
}

INLINE void finish_pixel(const FilmPart *const part, const uint place, const float4 spread, const float kept,
                         FILM_PARAMETER) {
    const float4 pixel = bloomed(pixels[part->slot + place], spread, kept);
#if defined(IMAGE)
    const int index = (int)(part->first + place), width = (int)part->width;
    write_imagef(image, (int2)(index % width, index / width), IN_RANGE(pixel));
#elif defined(HALVES)
    vstore_half4(IN_RANGE(pixel), part->first + place, image);
#else
    pixels[part->slot + place] = pixel;
#endif
}

// Doubles the first level, and gives the picture its light.
__kernel void finish(__global const BloomStep *const restrict steps, __global const float *const restrict levels,
                     const float strength, const FilmPart part, FILM_PARAMETER) {
    const BloomStep step = steps[0];
    const uint number = get_global_id(0);
    if (number >= step.pieces * step.height)
        return;
    const Piece piece = piece_of(&step, number);
    const Rows rows = rows_around(&step, levels + 4u * (size_t)step.at, piece.row);
    const float kept = 1.0f - strength, given = strength * step.share;
    const uint above = 2u * piece.row * step.fine_width, below = above + step.fine_width;
    const bool has_odd_row = 2u * piece.row + 1u < step.fine_height;
    Around around = first_around(&rows, &step, piece.begin);
    for (uint column = piece.begin; column < piece.end; ++column) {
        const float8 even = given * even_column(&around), odd = given * odd_column(&around);
        const uint upper = above + 2u * column, lower = below + 2u * column;
        const bool has_odd_column = 2u * column + 1u < step.fine_width;
        finish_pixel(&part, upper, FIRST(even), kept, FILM_ARGUMENT);
        if (has_odd_column)
            finish_pixel(&part, upper + 1u, FIRST(odd), kept, FILM_ARGUMENT);
        if (has_odd_row)
            finish_pixel(&part, lower, SECOND(even), kept, FILM_ARGUMENT);
        if (has_odd_row && has_odd_column)
            finish_pixel(&part, lower + 1u, SECOND(odd), kept, FILM_ARGUMENT);
        around = next_around(&around, &rows, &step, column + 1u);
    }
}
