// The mean of the light of a straight core, or of a point, over a pixel's square. Lengths are pixels.
//
// The mean over a square of a function of the distance to a line is the mean over two intervals one after the other, of
// the lengths of the square's sides across the line: a difference of differences of the function's second integral.
// That of a function of the distance to a point is a sum over the square's sides. What is smooth is taken at three
// places (Gauss, Legendre).
#pragma once
#include "across.h"

// Returns the second integral of the light over a distance from 0 on, of either sign.
INLINE floatv second_integral_across(const Across *const across, const floatv distance) {
    const floatv x = max(fabs(distance), 1e-9f), b = across->thickness;
    const floatv r2 = fma(x, x, b * b), r = 0.5f * twice_sqrt(r2);
#ifdef SHAPES
    if (IS_GAUSSIAN(across)) {
        const floatv u = x * inverse(b) * 0.707106781f;
        return fma(x * x * 0.707106781f * 1.25331414f, error_function_ratio(u), b * b * gaussian_of(x * x, b));
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
        return b2 * (1.0f - gaussian_of(distance * distance, b));
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

// Three places across a pixel, and what they count: the middle and two beside it.
#define PLACE_ASIDE 0.387298335f
#define SHARE_OF_MIDDLE (8.0f / 18.0f)
#define SHARE_ASIDE (5.0f / 18.0f)

// From so far on light is smooth.
#define SMOOTH_FROM 2.0f

typedef struct {
    floatv core, lost; // without a reach, and what that takes
} MeanLight;

// Adds light that counts so much.
INLINE MeanLight add_share(MeanLight sum, const MeanLight light, const float share) {
    sum.core = fma(splat(share), light.core, sum.core);
    sum.lost = fma(splat(share), light.lost, sum.lost);
    return sum;
}

INLINE MeanLight select_mean(MeanLight a, const MeanLight b, const intv is_b) {
    a.core = select(a.core, b.core, is_b);
    a.lost = select(a.lost, b.lost, is_b);
    return a;
}

// Returns by how much of the second two means differ.
INLINE floatv difference_of(const MeanLight a, const MeanLight b) {
    const floatv light = b.core - b.lost;
    return fabs(a.core - a.lost - light) * inverse(max(fabs(light), 1e-30f));
}

// Adds the light at a place beside the core, which counts so much.
INLINE MeanLight add_place(const MeanLight mean, const Across *const across, const floatv distance2,
                           const float share) {
    const MeanLight light = {core_across(across, distance2), lost_across(across, distance2)};
    return add_share(mean, light, share);
}

// Returns where the light of a core, or of its end, needs a closed form.
INLINE intv is_rough_across(const Across *const across, const floatv distance2) {
#ifdef SHAPES
    if (IS_GAUSSIAN(across))
        return across->thickness < 0.5f * SMOOTH_FROM;
#endif
    const intv is_rough = fma(across->thickness, across->thickness, distance2) < SMOOTH_FROM * SMOOTH_FROM;
    return across->has_end ? is_rough & (distance2 * across->per_reach2 < 0.25f) : is_rough;
}

// Returns the mean over a pixel of the light of a line at an offset from its centre across, which ends so far along;
// the offset grows by so much with every pixel to the right and below.
INLINE MeanLight mean_across(const Across *const across, const floatv offset, const floatv along, const floatv right,
                             const floatv below) {
    const floatv along2 = along * along, distance2 = fma(offset, offset, along2);
    const floatv before = offset - PLACE_ASIDE, after = offset + PLACE_ASIDE;
    MeanLight mean = {splat(0.0f), splat(0.0f)};
    mean = add_place(mean, across, distance2, SHARE_OF_MIDDLE);
    mean = add_place(mean, across, fma(before, before, along2), SHARE_ASIDE);
    mean = add_place(mean, across, fma(after, after, along2), SHARE_ASIDE);
    const intv is_rough = is_rough_across(across, distance2);
    if (any_lane(is_rough)) {
        Across thick = *across; // the squares of what lies along and of the thickness add; Gaussians of them multiply
        floatv share = splat(1.0f);
#ifdef SHAPES
        if (IS_GAUSSIAN(across))
            share = gaussian_of(along2, across->thickness);
        else
#endif
            thick.thickness = root_of(fma(across->thickness, across->thickness, along2));
        mean.core = select(mean.core, share * mean_beside_line(&thick, fabs(offset), right, below), is_rough);
    }
    return mean;
}

#ifdef SHAPES
// Returns the second integral of x^(5/2) from 0 on; 0 where x < 0.
INLINE floatv second_integral_of_rim(const floatv x) {
    const floatv lit = max(x, 0.0f), lit2 = lit * lit;
    return (4.0f / 63.0f) * lit2 * lit2 * root_of(lit);
}

// Returns the mean over a pixel at the rim of the light, over what a ray gets that passes so far inside: the window
// lets light fall off as the power 5/2 of that.
INLINE floatv mean_at_rim(const floatv inside, const floatv right, const floatv below, const floatv of_ray) {
    const floatv u = max(fabs(right), LEAST_SIDE), v = max(fabs(below), LEAST_SIDE);
    const floatv outer = 0.5f * (u + v), inner = 0.5f * (u - v);
    const floatv sum = (second_integral_of_rim(inside + outer) - second_integral_of_rim(inside + inner)) -
                       (second_integral_of_rim(inside - inner) - second_integral_of_rim(inside - outer));
    return sum * inverse(u * v * of_ray * of_ray * root_of(of_ray));
}
#endif
