// The rays of pixels, in blocks side by side, and what holds them.
#pragma once
#include "../block.h"
#include "rays.h"

// The rays of a block of pixels.
typedef struct {
    floatv offset_x, offset_y;
    floatv slope_x, slope_y;
    floatv per_z;  // the length along a ray in which it goes 1 along the axis of view
    float least_z; // before that, along the axis of view, no depth ends a ray
    Rays rays;
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
        block.per_z = block.rays.toward.z = splat(1.0f);
    } else {
        block.offset_x = block.offset_y = splat(0.0f);
        block.slope_x = x, block.slope_y = y;
        const floatv per_z2 = fma(x, x, fma(y, y, splat(1.0f)));
        block.rays.toward.z = 0.5f * twice_inverse_sqrt_(per_z2);
        block.per_z = per_z2 * block.rays.toward.z;
    }
    block.rays.toward.x = block.slope_x * block.rays.toward.z,
    block.rays.toward.y = block.slope_y * block.rays.toward.z;
    block.rays.begin = view->near * block.per_z;
    block.rays.end = block.rays.begin + view->ray_length;
    block.rays.length = splat(view->ray_length), block.rays.beta = splat(view->beta);
    block.least_z = INFINITY;
    if (view->has_depth) {
        const floatv depth = gather(depths, as_intv(rows * view->width + columns));
        const floatv end = view->is_along_axis ? depth * block.per_z : depth;
        block.rays.end = min(block.rays.end, end);
        float ends[LANES];
        scatter(end * inverse(block.per_z), ends);
        for (uint lane = 0u; lane < LANES; ++lane)
            block.least_z = fmin(block.least_z, 0.9999f * ends[lane]);
    }
    return block;
}

// Returns how rays pass a point. Their points at the point's depth are close to it, so nothing cancels: of
// |p|^2 - (p D)^2 float32 keeps little.
INLINE Passing passing(const Block *const block, const float x, const float y, const float z) {
    const float3v toward = block->rays.toward;
    Passing it;
    const floatv aside_x = fma(block->slope_x, splat(z), block->offset_x - x);
    const floatv aside_y = fma(block->slope_y, splat(z), block->offset_y - y);
    const floatv along = fma(aside_x, toward.x, aside_y * toward.y);
    const floatv at = fma(splat(z), block->per_z, -along);
    it.low = block->rays.begin - at, it.high = block->rays.end - at;
#ifdef SQUARED_DISTANCE
    // Spoiled.
    const floatv px = x - block->offset_x, py = y - block->offset_y;
    const floatv to = px * toward.x + py * toward.y + z * toward.z;
    it.d2 = max(px * px + py * py + z * z - to * to, 0.0f);
    it.way.x = sqrt(it.d2), it.way.y = it.way.z = splat(0.0f);
#else
    it.d2 = max(fma(aside_x, aside_x, fma(aside_y, aside_y, -along * along)), splat(0.0f));
    it.way.x = fma(-along, toward.x, aside_x);
    it.way.y = fma(-along, toward.y, aside_y);
    it.way.z = -along * toward.z;
#endif
    return it;
}
