// What the end of light at its reach takes from that of a core, where that ends so close that its pixels tell: of
// (1 - d^2 / h^2)^2 times 1/q^2, or 1/q^3, in the units of mean.h. Lengths are pixels.
#pragma once
#include "mean.h"

// What is taken at a distance from the core, and what more of it the mean over a pixel has than its centre.
typedef struct {
    floatv here, of_mean;
} Taken;

#ifdef SHAPES
// Light that ends is that of a core up to this share of its reach; beyond, hardly any is left.
#define REACH_SHARE 0.9f

// Returns the distance from its centre at which a ray leaves the light, which it passes at a distance of r2, squared.
INLINE floatv half_chord(const floatv distance2, const floatv reach2) {
    return 0.5f * twice_sqrt(max(reach2 - distance2, 1e-6f * reach2));
}

INLINE Taken taken_at_reach(const Across *const across, const floatv distance, const intv is_point) {
    const floatv per_reach2 = across->per_reach2, reach2 = inverse(per_reach2),
                 b2 = across->thickness * across->thickness;
    const floatv distance2 = min(distance * distance, reach2), u2 = distance2 * per_reach2, r2 = distance2 + b2;
    const floatv x = half_chord(distance2, reach2), r = 0.5f * twice_sqrt(r2);
    // (1 - d^2 / h^2)^2 = (c - q^2 / h^2)^2
    const floatv per_c = inverse(fma(b2, per_reach2, splat(1.0f)));
    const floatv first = per_c * per_reach2, second = first * first;
    Taken taken;
    if (across->profile == 1u) {
        const floatv sum = 2.0f * inverse(r) * arctangent_of(r, x) + 4.0f * first * x -
                           2.0f * second * x * fma(x * x, splat(1.0f / 3.0f), r2);
        // Its second derivative, and what the slope adds around a point.
        const floatv bend = fma(u2, fma(u2 * u2, splat(-4.648f), splat(-4.388f)), splat(5.273f));
        const floatv around = select(splat(0.0f), fma(u2, splat(-2.19f), splat(5.333f)), is_point);
        taken.here = (1.0f / PI) * sum;
        taken.of_mean = (-1.0f / (24.0f * PI)) * (bend + around) * per_reach2 * 0.5f * twice_sqrt(per_reach2);
    } else {
        const floatv q = 0.5f * twice_sqrt(r2 + x * x), area = natural_logarithm((x + q) * inverse(r));
        const floatv kept = x * inverse(r2 * q) - 2.0f * first * area + 0.5f * second * fma(x, q, r2 * area);
        const floatv bend = fma(u2, splat(-7.0f), splat(3.0f)) - 4.0f * inverse(u2 + 0.25f * per_reach2);
        taken.here = inverse(r2) - kept;
        taken.of_mean = (-1.0f / 48.0f) * bend * per_reach2 * per_reach2;
    }
    return taken;
}
#endif
