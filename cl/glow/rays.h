// A block of rays side by side, and how light fades along them.
#pragma once
#include "../block.h"
#include "../elementary.h"
#include "../lanes.h"
#include "../roots.h"
#include "types.h"

#define TINY 1e-30f

typedef struct {
    floatv offset_x, offset_y;
    floatv slope_x, slope_y;
    float3v toward;    // the direction, of length 1
    floatv per_z;      // the length along a ray in which it goes 1 along the axis of view
    floatv begin, end; // the stretch that light is gathered on, lengths from the eye, or its plane
    float least_z;     // before that, along the axis of view, no depth ends a ray
} Block;

// What holds rays side by side: their middle, and how far they spread from it.
typedef struct {
    float x, y;    // offset of the middle ray; of an eye 0
    float4 toward; // its direction, of length 1
    float spread;  // of slopes, or of offsets
} Cone;

// Returns that of a rectangle of pixels.
Cone cone_of(const GlowView *const view, const uint column, const uint row, const uint columns, const uint rows) {
    const float across = 0.5f * (float)(columns - 1u), down = 0.5f * (float)(rows - 1u);
    const float begin_x = fma((float)row + down, view->skew_x, view->first_x);
    const float x = fma((float)column + across, view->step_x, begin_x);
    const float y = fma((float)row + down, view->step_y, view->first_y);
    const float spread_x = fma(across, view->step_x, down * fabs(view->skew_x)), spread_y = down * view->step_y;
    Cone cone;
    cone.x = view->is_parallel ? x : 0.0f, cone.y = view->is_parallel ? y : 0.0f;
    cone.toward = view->is_parallel ? (float4)(0.0f, 0.0f, 1.0f, 0.0f) : normalize((float4)(x, y, 1.0f, 0.0f));
    cone.spread = 1.001f * sqrt(fma(spread_x, spread_x, spread_y * spread_y)) + 1e-6f;
    return cone;
}

// Returns the rays of a block of pixels.
INLINE Block block_at(const GlowView *const view, const uint column, const uint row,
                      __global const float *const depths) {
    const uintv columns = min(column + LANE_NUMBERS % BLOCK_COLUMNS, (uintv)(view->width - 1u));
    const uintv rows = min(row + LANE_NUMBERS / BLOCK_COLUMNS, (uintv)(view->height - 1u));
    const floatv begin_x = fma(to_floatv(rows), splat(view->skew_x), splat(view->first_x));
    const floatv x = fma(to_floatv(columns), splat(view->step_x), begin_x);
    const floatv y = fma(to_floatv(rows), splat(view->step_y), splat(view->first_y));
    Block block;
    if (view->is_parallel) {
        block.offset_x = x, block.offset_y = y;
        block.slope_x = block.slope_y = splat(0.0f);
        block.per_z = block.toward.z = splat(1.0f);
    } else {
        block.offset_x = block.offset_y = splat(0.0f);
        block.slope_x = x, block.slope_y = y;
        const floatv per_z2 = fma(x, x, fma(y, y, splat(1.0f)));
        block.toward.z = 0.5f * twice_inverse_sqrt_(per_z2);
        block.per_z = per_z2 * block.toward.z;
    }
    block.toward.x = block.slope_x * block.toward.z, block.toward.y = block.slope_y * block.toward.z;
    block.begin = view->near * block.per_z;
    block.end = block.begin + view->ray_length;
    block.least_z = INFINITY;
    if (view->has_depth) {
        const floatv depth = gather(depths, as_intv(rows * view->width + columns));
        const floatv end = view->is_along_axis ? depth * block.per_z : depth;
        block.end = min(block.end, end);
        float ends[LANES];
        scatter(end * inverse(block.per_z), ends);
        for (uint lane = 0u; lane < LANES; ++lane)
            block.least_z = fmin(block.least_z, 0.9999f * ends[lane]);
    }
    return block;
}

// Returns what of light reaches the eye from lengths behind the projection plane, times the measure.
INLINE floatv fading(const GlowView *const view, const floatv behind) {
    floatv left = splat(view->scale);
    if (view->power > 0u) {
        const floatv w = inverse(fma(behind, splat(view->per_length), splat(view->beta * view->per_length)));
        for (uint factor = 0u; factor < view->power; ++factor)
            left *= w;
    }
    if (view->absorbed > 0.0f)
        left *= power_of_two(-min(view->absorbed * behind, 100.0f));
    return left;
}
