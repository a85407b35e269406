// Squared distance from the points of a ray to a fixed point, or to a line seen along it: a quadratic in s, kept as
// (slope s + offset)^2 + least, in which nothing cancels near the least distance.
#pragma once
#include "../fine.h"
#include "../roots.h"

typedef struct {
    floatv slope;
    floatv offset;
    floatv least; // never 0: its root may be divided by
} Quadratic;

// |start + s span|^2 for a span of length `slope`.
INLINE Quadratic squared_length_along(const float3v start, const float3v span, const floatv slope) {
    const floatv per_slope = inverse(slope);
    const floatv ahead = -dot3(start, span) * per_slope; // to the nearest point, a length
    const float3v closest = fma3(span, ahead * per_slope, start);
    const Quadratic q = {slope, -ahead, max(dot3(closest, closest), 1e-30f)};
    return q;
}

floatv length3(const float3v v) {
    return 0.5f * twice_sqrt(max(dot3(v, v), 1e-36f));
}

// The parameter s of the least.
floatv nearest_along(const Quadratic *const q) {
    return -q->offset * inverse(q->slope);
}

// The same with all lengths doubled, softened.
Quadratic doubled(const Quadratic q, const floatv softening2) {
    const Quadratic d = {2.0f * q.slope, 2.0f * q.offset, 4.0f * (q.least + softening2)};
    return d;
}

floatv quadratic_at(const Quadratic *const q, const floatv s) {
    const floatv x = fma(q->slope, s, q->offset);
    return fma(x, x, q->least);
}

// On a ray that passes a core at a distance h below the floor f the field is cut off at 1 / f. Its integral is that of
// a field without floor past the core at the distance (c + f) e^(-c/f), c^2 = f^2 - h^2: the square of it from the
// squares of h and f, by a polynomial within 0.1 %.
INLINE floatv floored(const floatv least, const floatv floor2) {
    const intv is_below = least < floor2;
    if (!any_lane(is_below))
        return least;
    const floatv t = min(least * inverse(floor2), 1.0f);
    const floatv raised =
        fma(fma(fma(fma(splat(0.2287136f), t, splat(-0.2680140f)), t, splat(0.2481982f)), t, splat(0.2482847f)), t,
            splat(0.5418592f));
    return select(least, raised * floor2, is_below);
}
