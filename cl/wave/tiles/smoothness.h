// Whether a source's light on a tile is so smooth that its values at the nodes tell all others.
#pragma once
#include "clearance.h"
#include "tile.h"

// Within this many times a tile's side from a core, its light counts as rough without a look.
#ifndef LEAST_CLEARANCE
#define LEAST_CLEARANCE 0.5f
#endif

// Returns whether 16 shared numbers are all numbers, and none is above 0.
bool none_is_positive(__local const float *const values) {
    bool none_is = true;
    for (uint ray = 0; ray < TILE_RAYS; ray += LANES)
        none_is &= !any_lane(!(shown(ray, values) <= 0.0f));
    return none_is;
}

// How far a pixel is from the nearest node at most, in sides of a tile, with some to spare.
#ifndef MOST_BETWEEN // a test spoils it
#define MOST_BETWEEN 0.5f
#endif

float least_of(__local const float *const values) {
    float least = values[0];
    for (uint ray = 1; ray < TILE_RAYS; ++ray)
        least = min(least, values[ray]);
    return least;
}

float greatest_of(__local const float *const values) {
    float greatest = values[0];
    for (uint ray = 1; ray < TILE_RAYS; ++ray)
        greatest = max(greatest, values[ray]);
    return greatest;
}

// Where nodes see parts of a curve that lie farther apart than this, in pieces of its local intensity, what lies
// between may show between the nodes: a short curve far away throws a stripe as wide as itself.
#ifndef MOST_SPREAD
#define MOST_SPREAD 0.5f
#endif

bool all_see_one_part(__local float (*const seen)[TILE_RAYS]) {
    float most = 0.0f;
    for (uint k = 0; k < PLACES_SEEN; ++k) {
        float low = seen[k][0], high = low;
        for (uint ray = 1; ray < TILE_RAYS; ++ray)
            low = min(low, seen[k][ray]), high = max(high, seen[k][ray]);
        most = max(most, high - low);
    }
    return most <= MOST_SPREAD;
}

// By how much an interpolation may be off where it is tested; spoiled builds redefine it.
#ifndef MOST_ERROR
#define MOST_ERROR(pass) ((pass)->most_error)
#endif

// How much the light at an end counts that differs from what the nodes tell; spoiled builds redefine it.
#ifndef END_ERROR_WEIGHT
#define END_ERROR_WEIGHT 1.0f
#endif

// The largest of the highest two Chebyshev coefficients of four rows of values at once: of an even and an odd function.
typedef struct {
    float even, odd;
} Coefficients;

float largest(const float4 v) {
    const float2 two = max(fabs(v.lo), fabs(v.hi));
    return max(two.x, two.y);
}

Coefficients highest_coefficients(const float q, const float4 v0, const float4 v1, const float4 v2, const float4 v3) {
    const float scale = 0.25f / (1.0f - q * q);
    const float4 even = (v0 + v3) - (v1 + v2), odd = (v3 - v0) - (v2 - v1) * (1.0f / q);
    const Coefficients c = {scale * largest(even), 0.5f * scale * largest(odd)};
    return c;
}

// Returns whether values at the nodes look like those of a function that can be interpolated: the highest coefficients
// are small beside the least value, or as small as an error may be of a least light. Never where a value is not a
// number.
bool seems_smooth(const TilePass *const pass, const float least_light, __local const float *const values) {
    const float4 v0 = vload4(0, values), v1 = vload4(1, values), v2 = vload4(2, values), v3 = vload4(3, values);
    const float4 sizes = min(min(fabs(v0), fabs(v1)), min(fabs(v2), fabs(v3)));
    const float2 two = min(sizes.lo, sizes.hi);
    const float least = min(two.x, two.y), absolute = pass->most_error * least_light;
    const float q = inner_place(pass);
    const Coefficients down = highest_coefficients(q, v0, v1, v2, v3);
    const Coefficients across =
        highest_coefficients(q, (float4)(v0.x, v1.x, v2.x, v3.x), (float4)(v0.y, v1.y, v2.y, v3.y),
                             (float4)(v0.z, v1.z, v2.z, v3.z), (float4)(v0.w, v1.w, v2.w, v3.w));
    const float4 sums = (v0 + v1) + (v2 + v3);
    const bool are_numbers = !isnan((sums.x + sums.y) + (sums.z + sums.w));
    return are_numbers && max(down.even, across.even) <= max(pass->most_even * least, absolute) &&
           max(down.odd, across.odd) <= max(pass->most_odd * least, absolute);
}
