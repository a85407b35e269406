// How much light a straight core, or a point, throws on a pixel's square: the mean of what a ray gets that passes it at
// a distance. Lengths are pixels. Without reach and decay, across a core of thickness b, 1/q gives -2 ln R and what its
// surroundings add, 1/q^2 pi / R, 1/q^3 2 / R^2, a Gaussian a Gaussian, R^2 = distance^2 + b^2; here without factors.
//
// The mean over a square of a function of the distance to a line is the mean over two intervals one after the other, of
// the lengths of the square's sides across the line: a difference of differences of the function's second integral.
// That of a function of the distance to a point is a sum over the square's sides.
#pragma once
#include "../../elementary.h"
#include "../../roots.h"
#include "../source/profile.h"

#define PI 3.14159265f

floatv natural_logarithm(const floatv x) {
    return LN_2 * binary_logarithm(x);
}

// Returns atan(x / y) for x, y > 0.
floatv arctangent_of(const floatv x, const floatv y) {
    const floatv ratio = min(x, y) * inverse(max(x, y));
    const floatv angle = ratio * arctangent_ratio(ratio * ratio);
    return select(angle, 0.5f * PI - angle, x > y);
}

// Profiles as types.h numbers them: those that fall off with the logarithm, those of a distance without softening.
#define IS_INVERSE(profile) ((profile) == 0u || (profile) == 4u)
#define IS_BARE(profile) ((profile) == 3u || (profile) == 4u)
#define CONVOLVED 5u

// How light falls off across a core.
typedef struct {
    uint profile;     // as types.h says
    floatv thickness; // b; of a Gaussian its standard deviation
    bool has_end;     // of 1/q^2 and 1/q^3: whether it ends at a reach
    floatv per_reach2;
} Across;

// So thick a core is at least, in pixels: the mean of 1/q^2 and 1/q^3 over a bare one is infinite.
#define LEAST_THICKNESS 0.015625f

// Smeared light looks as that of 1/q with so many standard deviations as its thickness: exp(-gamma / 2) sqrt(2).
#define SMEARED_THICKNESS 1.0597f

#ifdef SHAPES
#define IS_GAUSSIAN(across) ((across)->profile == 3u)
floatv gaussian_of(const floatv distance, const floatv deviation) {
    const floatv ratio = distance * inverse(deviation);
    return fading(0.5f * ratio * ratio);
}
#else
#define IS_GAUSSIAN(across) 0
#endif

// Returns the light at a distance.
INLINE floatv light_across(const Across *const across, const floatv distance) {
    const floatv b = across->thickness, r2 = fma(distance, distance, b * b);
#ifdef SHAPES
    if (IS_GAUSSIAN(across))
        return gaussian_of(distance, b);
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

// Returns the second integral of the light over a distance from 0 on, of either sign.
INLINE floatv second_integral_across(const Across *const across, const floatv distance) {
    const floatv x = max(fabs(distance), 1e-9f), b = across->thickness;
    const floatv r2 = fma(x, x, b * b), r = 0.5f * twice_sqrt(r2);
#ifdef SHAPES
    if (IS_GAUSSIAN(across)) {
        const floatv u = x * inverse(b) * 0.707106781f;
        return fma(x * x * 0.707106781f * 1.25331414f, error_function_ratio(u), b * b * gaussian_of(x, b));
    }
#endif
    switch (across->profile) {
    case 1:
        return fma(x, natural_logarithm((x + r) * inverse(b)), -r);
    case 2:
        return fma(x * inverse(b), arctangent_of(x, b), -0.5f * natural_logarithm(r2));
    default:
        return -fma(0.25f * (x * x - b * b), natural_logarithm(r2), -0.25f * fma(x, 3.0f * x, b * b)) -
               b * x * arctangent_of(x, b);
    }
}

// The least side across a line: differences of less lose their digits.
#define LEAST_SIDE 0.05f

// Returns the mean over a pixel of the light of a line at a distance from its centre, whose distance grows by so much
// with every pixel to the right and below.
INLINE floatv mean_beside_line(const Across *const across, const floatv distance, const floatv right,
                               const floatv below) {
    const floatv u = max(fabs(right), LEAST_SIDE), v = max(fabs(below), LEAST_SIDE);
    const floatv outer = 0.5f * (u + v), inner = 0.5f * (u - v);
    const floatv sum =
        (second_integral_across(across, distance + outer) - second_integral_across(across, distance + inner)) -
        (second_integral_across(across, distance - inner) - second_integral_across(across, distance - outer));
    return sum * inverse(u * v);
}

// Returns the integral of light times distance from 0 on.
INLINE floatv moment_across(const Across *const across, const floatv distance) {
    const floatv b = across->thickness, b2 = b * b, r2 = fma(distance, distance, b2);
#ifdef SHAPES
    if (IS_GAUSSIAN(across))
        return b2 * (1.0f - gaussian_of(distance, b));
#endif
    switch (across->profile) {
    case 1:
        return 0.5f * twice_sqrt(r2) - b;
    case 2:
        return 0.5f * natural_logarithm(r2 * inverse(b2));
    default:
        return -0.25f * (fma(r2, natural_logarithm(r2), -b2 * natural_logarithm(b2)) - distance * distance);
    }
}

// Returns asinh(x).
floatv area_of_sine(const floatv x) {
    const floatv size = fabs(x);
    return copysign(natural_logarithm(size + 0.5f * twice_sqrt(fma(size, size, splat(1.0f)))), x);
}

// Returns what the triangle adds from a point to a side of the square, `height` away, that reaches from one place to
// another beside the foot: the integral of the moment over the angle, as sinh u of it, which is smooth in u however
// close the point is.
INLINE floatv moment_to_side(const Across *const across, const floatv height, const floatv from, const floatv to) {
    const float places[5] = {0.046910077f, 0.230765345f, 0.5f, 0.769234655f, 0.953089923f}; // Gauss, Legendre
    const float weights[5] = {0.118463443f, 0.239314335f, 0.284444444f, 0.239314335f, 0.118463443f};
    const floatv high = max(fabs(height), 1e-6f), per_high = inverse(high);
    const floatv first = area_of_sine(from * per_high), span = area_of_sine(to * per_high) - first;
    floatv sum = splat(0.0f);
    for (uint k = 0; k < 5; ++k) {
        const floatv u = fma(span, splat(places[k]), first), power = power_of_two(u * (1.0f / LN_2));
        const floatv cosine = 0.5f * (power + inverse(power));
        sum = fma(splat(weights[k]) * inverse(cosine), moment_across(across, high * cosine), sum);
    }
    return copysign(span * sum, height);
}

// Returns the mean over a pixel of the light of a point that lies so many pixels to the right of its centre, and below.
INLINE floatv mean_beside_point(const Across *const across, const floatv right, const floatv below) {
    const floatv from_left = right + 0.5f, from_right = 0.5f - right, from_top = below + 0.5f,
                 from_bottom = 0.5f - below;
    return moment_to_side(across, from_left, -from_top, from_bottom) +
           moment_to_side(across, from_right, -from_top, from_bottom) +
           moment_to_side(across, from_top, -from_left, from_right) +
           moment_to_side(across, from_bottom, -from_left, from_right);
}
