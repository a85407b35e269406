// How light falls off across a straight core, or from a point: what a ray gets that passes it at a distance. Lengths
// are pixels. Without reach and decay, across a core of thickness b, 1/q gives -2 ln R and what its surroundings add,
// 1/q^2 pi / R, 1/q^3 2 / R^2, a Gaussian a Gaussian, R^2 = distance^2 + b^2; here without factors.
#pragma once
#include "../../elementary.h"
#include "../../roots.h"
#include "../source/profile.h"

#define PI 3.14159265f
#define ROOT_OF_2_PI 2.50662827f

// Profiles as types.h numbers them: those that fall off with the logarithm, those of a distance without softening.
#define IS_INVERSE(profile) ((profile) == 0u || (profile) == 4u)
#define IS_BARE(profile) ((profile) == 3u || (profile) == 4u)
#define CONVOLVED 5u

typedef struct {
    uint profile;     // as types.h says
    floatv thickness; // b; of a Gaussian its standard deviation
    bool has_end;     // of 1/q, 1/q^2, 1/q^3: whether it ends at a reach
    floatv per_reach2;
} Across;

// So thick a core is at least: the mean of 1/q^2 and 1/q^3 over a bare one is infinite.
#define LEAST_THICKNESS 0.015625f

// Smeared light looks as that of 1/q with so many standard deviations as its thickness: exp(-gamma / 2) sqrt(2).
#define SMEARED_THICKNESS 1.0597f

floatv natural_logarithm(const floatv x) {
    return LN_2 * binary_logarithm(x);
}

floatv root_of(const floatv x) {
    return 0.5f * twice_sqrt(max(x, 1e-36f));
}

// Returns atan(x / y) for x, y > 0.
floatv arctangent_of(const floatv x, const floatv y) {
    const floatv ratio = min(x, y) * inverse(max(x, y));
    const floatv angle = ratio * arctangent_ratio(ratio * ratio);
    return select(angle, 0.5f * PI - angle, x > y);
}

#ifdef SHAPES
#define IS_GAUSSIAN(across) ((across)->profile == 3u)
floatv gaussian_of(const floatv distance2, const floatv deviation) {
    const floatv per_deviation = inverse(deviation);
    return fading(0.5f * distance2 * per_deviation * per_deviation);
}
#else
#define IS_GAUSSIAN(across) 0
#endif

// Returns the light at a distance, squared, were there no reach.
INLINE floatv core_across(const Across *const across, const floatv distance2) {
    const floatv b = across->thickness, r2 = fma(b, b, distance2);
#ifdef SHAPES
    if (IS_GAUSSIAN(across))
        return gaussian_of(distance2, b);
#endif
    switch (across->profile) {
    case 1:
        return 0.5f * twice_inverse_sqrt_(r2);
    case 2:
        return inverse(r2);
    default:
        return -0.5f * natural_logarithm(r2);
    }
}

// Returns what a reach h takes of it: the window (1 - d^2 / h^2)^2 is (c - q^2 / h^2)^2, so that a sum of powers of q
// is left, over the ray's chord.
INLINE floatv lost_across(const Across *const across, const floatv distance2) {
    floatv lost = splat(0.0f);
#ifdef SHAPES
    if (!across->has_end)
        return lost;
    const floatv b2 = across->thickness * across->thickness, per_reach2 = across->per_reach2;
    const floatv reach2 = inverse(per_reach2), r2 = b2 + distance2, r = root_of(r2);
    const floatv x2 = max(reach2 - distance2, 1e-36f), x = root_of(x2), q = root_of(r2 + x2); // half of the chord
    const floatv first = per_reach2 * inverse(fma(b2, per_reach2, splat(1.0f))), second = 0.5f * first * first;
    const floatv all = core_across(across, distance2), area = natural_logarithm((x + q) * inverse(r));
    const floatv of_q = fma(x, q, r2 * area); // the integral of q; all the same without their factors
    switch (across->profile) {
    case 1:
        lost = (2.0f / PI) * (inverse(r) * arctangent_of(r, x) + 2.0f * first * x -
                              2.0f * second * x * fma(x2, splat(1.0f / 3.0f), r2));
        break;
    case 2:
        lost = all - (x * inverse(r2 * q) - 2.0f * first * area + second * of_q);
        break;
    default:
        lost = all - (area - first * of_q + second * fma(0.5f * x * q, q * q, 0.75f * r2 * of_q));
    }
    lost = select(lost, all, distance2 >= reach2);
#endif
    return lost;
}
