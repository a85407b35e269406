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

// The squared length of what stands at the parameter of the least, which float32 has missed by a little: without what
// lies along the span. Never 0.
floatv squared_length_beside(const Quadratic *const q, const float3v start, const float3v span) {
    const floatv per_slope = inverse(q->slope);
    const floatv missed = clamp(-dot3(start, span) * per_slope * per_slope, -1e-4f, 1e-4f);
    const float3v beside = fma3(span, missed, start);
    return max(dot3(beside, beside), 1e-30f);
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
