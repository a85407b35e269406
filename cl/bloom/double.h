// Doubling by the weights 1, 4, 6, 4 and 1, divided by 8: an even pixel has an eighth, three quarters and an eighth of
// the three coarse ones around, an odd one half of either. Beyond a border counts the last.
#pragma once
#include "step.h"

// The coarse rows around two fine ones.
typedef struct {
    Channels4 before, near, after;
} Rows;

INLINE Rows rows_around(const BloomStep *const step, const Channels4 coarse, const uint row) {
    const size_t pitch = 4u * (size_t)step->width;
    const Rows rows = {coarse + pitch * max(row, 1u) - pitch, coarse + pitch * row,
                       coarse + pitch * min(row + 1u, step->height - 1u)};
    return rows;
}

// A coarse column, doubled downwards: what the even row has, and the odd one.
INLINE float8 two_rows(const Rows *const rows, const uint column) {
    const float4 near = PIXEL(rows->near, column), after = PIXEL(rows->after, column);
    const float4 even = 0.125f * (PIXEL(rows->before, column) + after) + 0.75f * near, odd = 0.5f * (near + after);
    return BOTH(even, odd);
}

// Three columns, of which the two fine ones at the middle are made.
typedef struct {
    float8 before, near, after;
} Around;

INLINE Around first_around(const Rows *const rows, const BloomStep *const step, const uint column) {
    const Around around = {two_rows(rows, max(column, 1u) - 1u), two_rows(rows, column),
                           two_rows(rows, min(column + 1u, step->width - 1u))};
    return around;
}

INLINE Around next_around(const Around *const last, const Rows *const rows, const BloomStep *const step,
                          const uint column) {
    const Around around = {last->near, last->after, two_rows(rows, min(column + 1u, step->width - 1u))};
    return around;
}

// Both rows of the even column, and of the odd one.
INLINE float8 even_column(const Around *const around) {
    return 0.125f * (around->before + around->after) + 0.75f * around->near;
}

INLINE float8 odd_column(const Around *const around) {
    return 0.5f * (around->near + around->after);
}

// Adds a piece of what is coarser to the share of a finer level.
INLINE void double_piece(const BloomStep *const step, __global float *const levels, const uint number) {
    const Piece piece = piece_of(step, number);
    const Rows rows = rows_around(step, levels + 4u * (size_t)step->at, piece.row);
    const size_t pitch = 4u * (size_t)step->fine_width;
    __global float *const even_row = levels + 4u * (size_t)step->fine_at + pitch * (2u * piece.row);
    const bool has_odd_row = 2u * piece.row + 1u < step->fine_height;
    __global float *const odd_row = has_odd_row ? even_row + pitch : even_row;
    Around around = first_around(&rows, step, piece.begin);
    for (uint column = piece.begin; column < piece.end; ++column) {
        const float8 even = step->share * even_column(&around), odd = step->share * odd_column(&around);
        if (2u * column + 1u < step->fine_width) {
            const float8 upper = step->fine_share * vload8(column, even_row) + BOTH(FIRST(even), FIRST(odd));
            const float8 lower = step->fine_share * vload8(column, odd_row) + BOTH(SECOND(even), SECOND(odd));
            vstore8(upper, column, even_row);
            if (has_odd_row)
                vstore8(lower, column, odd_row);
        } else {
            const float4 upper = step->fine_share * vload4(2u * column, even_row) + FIRST(even);
            const float4 lower = step->fine_share * vload4(2u * column, odd_row) + SECOND(even);
            vstore4(upper, 2u * column, even_row);
            if (has_odd_row)
                vstore4(lower, 2u * column, odd_row);
        }
        around = next_around(&around, &rows, step, column + 1u);
    }
}
