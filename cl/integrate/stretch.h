// The integral of a field whose squared distance is a quadratic, over a stretch of a ray: in closed form, 1 / distance
// or its square, and finite where the ray meets the core.
#pragma once
#include "closed_form.h"
#include "closed_form_square.h"

INLINE floatv without_floor(const Quadratic *const distance2, const Decay decay, const Stretch stretch,
                            const uint is_square) {
    const Ends ends = ends_of(distance2, decay, stretch);
    const floatv over_v =
        is_square ? inverse_square_over(&ends, distance2->least) : inverse_over(&ends, distance2->least);
    return decay.strength * over_v;
}

// Where the ray is closer to the core than the floor of all distances the field is constant; a ray in a million.
floatv with_floor(const Quadratic *const distance2, const floatv floor2, const Decay decay, const Stretch stretch,
                  const uint is_square) {
    const floatv per_slope = inverse(max(distance2->slope, 1e-18f));
    const floatv nearest = -distance2->offset * per_slope;
    const floatv reach = 0.5f * twice_sqrt(max(floor2 - distance2->least, 1e-36f)) * per_slope;
    const floatv begin = clamp(nearest - reach, stretch.from, stretch.to);
    const floatv end = clamp(nearest + reach, stretch.from, stretch.to);
    const Stretch flat = part_of(stretch, begin, end);
    const floatv field = profiled(0.5f * twice_inverse_sqrt_(floor2), is_square);
    const floatv light = 0.5f * (flat.light_from + flat.light_to);
    const floatv inside = advance(decay, begin, nearness(decay, begin), end, nearness(decay, end));
    const floatv before = without_floor(distance2, decay, part_of(stretch, stretch.from, begin), is_square);
    const floatv after = without_floor(distance2, decay, part_of(stretch, end, stretch.to), is_square);
    return before + decay.strength * inside * light * field + after;
}

// Lengths are doubled, the integral is not.
INLINE floatv integral_over(const Stretch stretch, const Quadratic *const distance2, const floatv floor2,
                            const Decay decay, const uint is_square) {
    floatv integral = without_floor(distance2, decay, stretch, is_square);
    const intv is_floored = distance2->least < floor2;
    if (any_lane(is_floored))
        integral = select(integral, with_floor(distance2, floor2, decay, stretch, is_square), is_floored);
    return (is_square ? 4.0f : 2.0f) * integral;
}
