// One step of the pyramid: from a fine size to one half as wide and high, and back. src/bloom/steps.rs mirrors it.
#pragma once
#include "../check_size.h"

typedef struct {
    uint fine_width, fine_height; // pixels; of the first step they are the picture's
    uint width, height;           // half of that, rounded up
    uint fine_at, at;             // where either begins among the levels, pixels
    uint across, down;            // where the weights of columns and of rows begin, five of each
    uint inner_begin, inner_end;  // columns that have the weights 1, 4, 6, 4 and 1, divided by 16
    uint pieces;                  // work-items that share a row
    uint span;                    // columns of each, but for the last
    float fine_share;             // what the fine size counts in what is spread
    float share;                  // what the coarse one counts, once it has all that is coarser
} BloomStep;
CHECK_SIZE(BloomStep, SIZEOF_BLOOMSTEP);

// Some columns of a row of the coarse size.
typedef struct {
    uint row, begin, end;
} Piece;

INLINE Piece piece_of(const BloomStep *const step, const uint number) {
    const uint begin = number % step->pieces * step->span;
    const Piece piece = {number / step->pieces, begin, min(begin + step->span, step->width)};
    return piece;
}

typedef __global const float *Channels4; // four of each pixel

#define PIXEL(row, column) vload4(0, (row) + 4u * (column))
#define PAIR(row, column) vload8(0, (row) + 4u * (column))

// Two pixels side by side, and either of them. With -D NO_SHUFFLES element by element: oclgrind 21.10 ends on others.
#ifdef NO_SHUFFLES
#define BOTH(a, b) ((float8)((a).x, (a).y, (a).z, (a).w, (b).x, (b).y, (b).z, (b).w))
#define FIRST(pair) ((float4)((pair).s0, (pair).s1, (pair).s2, (pair).s3))
#define SECOND(pair) ((float4)((pair).s4, (pair).s5, (pair).s6, (pair).s7))
#else
#define BOTH(a, b) ((float8)(a, b))
#define FIRST(pair) ((pair).lo)
#define SECOND(pair) ((pair).hi)
#endif

// Returns whether all channels are finite, also where a compiler takes for granted that they are.
INLINE bool is_finite_pixel(const float4 light) {
    const uint4 bits = as_uint4(light) & 0x7fffffffu;
    return max(max(bits.x, bits.y), max(bits.z, bits.w)) < 0x7f800000u;
}
