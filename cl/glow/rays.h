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
    float3v toward;                   // the direction, of length 1
    floatv per_z;                     // the length along a ray in which it goes 1 along the axis of view
    floatv begin, end;                // the stretch that light is gathered on, lengths from the eye, or its plane
    float middle_x, middle_y, spread; // slope, or offset, of the block's middle, and how far its rays are from that
    float4 middle;                    // the direction there, of length 1
} Block;

// Returns the rays of a block of pixels.
INLINE Block block_at(const GlowView *const view, const uint column, const uint row,
                      __global const float *const depths) {
    const uintv columns = min(column + LANE_NUMBERS % BLOCK_COLUMNS, (uintv)(view->width - 1u));
    const uintv rows = min(row + LANE_NUMBERS / BLOCK_COLUMNS, (uintv)(view->height - 1u));
    const floatv x = fma(to_floatv(columns), splat(view->step_x), splat(view->first_x));
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
    if (view->has_depth) {
        const floatv depth = gather(depths, as_intv(rows * view->width + columns));
        block.end = min(block.end, view->is_along_axis ? depth * block.per_z : depth);
    }
    const float across = 0.5f * (float)(BLOCK_COLUMNS - 1u), down = 0.5f * (float)(BLOCK_ROWS - 1u);
    block.middle_x = fma((float)column + across, view->step_x, view->first_x);
    block.middle_y = fma((float)row + down, view->step_y, view->first_y);
    const float spread_x = across * view->step_x, spread_y = down * view->step_y;
    block.spread = 1.001f * sqrt(fma(spread_x, spread_x, spread_y * spread_y)) + 1e-6f;
    block.middle = normalize((float4)(block.middle_x, block.middle_y, 1.0f, 0.0f));
    if (view->is_parallel)
        block.middle = (float4)(0.0f, 0.0f, 1.0f, 0.0f);
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
