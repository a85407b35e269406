// Halving, the transpose of doubling divided by how much of the picture a pixel stands for (src/image/bloom/axis.rs).
#pragma once
#include "step.h"

// One column of five rows, with their weights.
typedef struct {
    Channels4 rows[5];
    float weights[5];
} Column;

// Halves around a border, or around light without end, of which nothing is spread where `is_picture`. Where a weight is
// 0 there may be no pixel, and any will do.
float4 halved_with_care(const BloomStep *const step, const Column *const column, __global const float *const across,
                        const uint center, const bool is_picture) {
    float4 sum = (float4)(0.0f);
    for (uint tap = 0; tap < 5; ++tap) {
        const uint place = clamp(2 * (int)center + (int)tap - 2, 0, (int)step->fine_width - 1);
        float4 all = (float4)(0.0f);
        for (uint row = 0; row < 5; ++row) {
            const float4 light = PIXEL(column->rows[row], place);
            all += column->weights[row] * (is_picture && !is_finite_pixel(light) ? (float4)(0.0f) : light);
        }
        sum += across[5u * center + tap] * all;
    }
    return sum;
}

// Two columns of all five rows.
INLINE float8 two_columns(const Column *const column, const uint first) {
    return column->weights[0] * PAIR(column->rows[0], first) + column->weights[1] * PAIR(column->rows[1], first) +
           column->weights[2] * PAIR(column->rows[2], first) + column->weights[3] * PAIR(column->rows[3], first) +
           column->weights[4] * PAIR(column->rows[4], first);
}

#ifndef MIDDLE_WEIGHT
#define MIDDLE_WEIGHT 0.375f
#endif

// Halves a piece of a row.
INLINE void halve_piece(const BloomStep *const step, __global const float *const weights, const Channels4 fine,
                        __global float *const coarse, const uint number, const bool is_picture) {
    const Piece piece = piece_of(step, number);
    __global const float *const across = weights + step->across;
    __global float *const to = coarse + 4u * (size_t)(piece.row * step->width);
    Column column;
    for (uint row = 0; row < 5; ++row) {
        const uint place = clamp(2 * (int)piece.row + (int)row - 2, 0, (int)step->fine_height - 1);
        column.rows[row] = fine + 4u * ((size_t)place * step->fine_width);
        column.weights[row] = weights[step->down + 5u * piece.row + row];
    }
    const uint begin = clamp(step->inner_begin, piece.begin, piece.end);
    const uint end = clamp(step->inner_end, begin, piece.end);
    for (uint center = piece.begin; center < begin; ++center)
        vstore4(halved_with_care(step, &column, across, center, is_picture), center, to);
    if (begin < end) {
        const float8 before_weights = BOTH((float4)(0.25f), (float4)(MIDDLE_WEIGHT));
        const float8 after_weights = BOTH((float4)(0.25f), (float4)(0.0625f));
        float4 first = FIRST(two_columns(&column, 2u * begin - 2u));
        float8 before = two_columns(&column, 2u * begin - 1u);
        for (uint center = begin; center < end; ++center) {
            const float8 after = two_columns(&column, 2u * center + 1u);
            const float8 both = before_weights * before + after_weights * after;
            float4 light = 0.0625f * first + FIRST(both) + SECOND(both);
            if (is_picture && !is_finite_pixel(light))
                light = halved_with_care(step, &column, across, center, is_picture);
            vstore4(light, center, to);
            first = SECOND(before), before = after;
        }
    }
    for (uint center = end; center < piece.end; ++center)
        vstore4(halved_with_care(step, &column, across, center, is_picture), center, to);
}
