// Squared distance from the points of a ray to a fixed point, or to a line seen along it: a quadratic in s, kept as
// (slope s + offset)^2 + least, in which nothing cancels near the least distance.
#pragma once
#include "../lanes.h"
#include "../roots.h"

typedef struct {
    floatv slope;
    floatv offset;
    floatv least; // never 0: its root may be divided by
} Quadratic;

// |start + s span|^2
Quadratic squared_length_along(const float3v start, const float3v span) {
    const floatv span2 = max(dot3(span, span), 1e-36f);
    const floatv slope = 0.5f * twice_sqrt(span2);
    const floatv nearest = -dot3(start, span) * inverse(span2);
    const float3v closest = fma3(span, nearest, start);
    const Quadratic q = {slope, -slope * nearest, max(dot3(closest, closest), 1e-30f)};
    return q;
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
