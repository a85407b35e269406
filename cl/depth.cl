// Turns the depths that a host has in its own memory into what ends rays (view.h): a length for every pixel, by rows
// from the top left, infinite where nothing is. Depths of clip space become lengths along the axis of view as ClipDepth
// has them (src/image/clip.rs): d = b / (depth - a) of a perspective projection, (depth - a) / b of an orthographic
// one. Far away nearly all digits of depth - a cancel out: it is taken in more than float32 has, in float64 to the very
// bit.
//
// What would be refused if it were in the host's memory, no number, a negative length, a depth beyond the planes,
// cannot be told of without reading back: there nothing hides the light.
#include "check_size.h"
#include "fine.h"

typedef struct {
    float4 scale; // what values are multiplied with; a number in three parts, whose sum it is
    float4 a, b;  // of the projection, likewise
    uint first;   // where the first row begins in the memory, in values
    uint row;     // from a row to the next, in values
    uint column;  // from a pixel to its right neighbour, in values
    uint width, height;
    uint is_bottom_up; // whether the first row is the lowest
    uint format;       // what a value is stored as: STORED_FLOAT, STORED_HALF or STORED_SHORT
    uint meaning;      // what it is: LENGTHS, PERSPECTIVE or ORTHOGRAPHIC depths
    float begin, span; // of a value v, begin + span v is the depth of clip space
    float low;         // the least depth of clip space; the greatest is 1
    uint is_reversed;  // whether near depths are greater than far ones
} StoredDepths;
CHECK_SIZE(StoredDepths, SIZEOF_STOREDDEPTHS);

// Depths beyond the planes by no more than this lie on them.
#define BEYOND 1e-4f

#ifdef IS_ONE_NUMBER
#define quotient(a, b) from_finev((a) / (b))
#else
#define quotient(a, b) (from_finev(a) / from_finev(b))
#endif

finev sum_of_parts(const float4 parts) {
    return fine_add(uniform_fine(parts.x, parts.y), to_finev(parts.z));
}

float stored_value(__global const uchar *const values, const uint format, const size_t at) {
    if (format == STORED_HALF)
        return vload_half(at, (__global const half *)values);
    if (format == STORED_SHORT)
        return quotient(to_finev(convert_float(((__global const ushort *)values)[at])), to_finev(65535.0f));
    return ((__global const float *)values)[at];
}

float length_of_clip(const StoredDepths *const form, const finev depth) {
    const float above = from_finev(fine_subtract(depth, to_finev(form->low)));
    const float below = from_finev(fine_subtract(to_finev(1.0f), depth));
    const bool is_between = above >= -BEYOND && below >= -BEYOND; // which no NaN is
    const float before_far = form->is_reversed ? above : below;
    if (!is_between || before_far <= 0.0f)
        return INFINITY;
    const bool is_near = (form->is_reversed ? below : above) <= 0.0f;
    const finev near = to_finev(form->is_reversed ? 1.0f : form->low);
    const finev above_a = fine_subtract(is_near ? near : depth, sum_of_parts(form->a));
    const finev b = sum_of_parts(form->b);
    if (form->meaning == ORTHOGRAPHIC)
        return quotient(above_a, b);
    const float length = quotient(b, above_a);
    return length > 0.0f ? length : INFINITY;
}

float length_of(const StoredDepths *const form, const float value) {
    if (value == INFINITY)
        return INFINITY;
    const finev scaled = fine_multiply(to_finev(value), sum_of_parts(form->scale));
    if (form->meaning != LENGTHS)
        return length_of_clip(form, fine_fma(scaled, to_finev(form->span), to_finev(form->begin)));
    const float length = from_finev(scaled);
    return length >= 0.0f ? length : INFINITY;
}

__kernel void lengths_of_depths(const StoredDepths form, __global const uchar *const restrict values,
                                __global float *const restrict lengths) {
    const uint pixel = get_global_id(0);
    if (pixel >= form.width * form.height)
        return;
    const uint row = pixel / form.width, column = pixel - row * form.width;
    const uint stored_row = form.is_bottom_up ? form.height - 1u - row : row;
    const size_t at = form.first + (size_t)stored_row * form.row + (size_t)column * form.column;
    lengths[pixel] = length_of(&form, stored_value(values, form.format, at));
}
