// The same as closed_form.h for 1 over the squared distance (Sakai 2006): the integral of the light times n^2 / f^2
// over v, a quadratic over a quadratic.
#pragma once
#include "closed_form.h"

#ifndef HALF_PI // a test spoils it
#define HALF_PI 1.57079633f
#endif

// Integrates from 1 / f^2 at four Gauss-Legendre nodes, for a stretch so short that f hardly changes. It begins with
// f^2 = middle2 in its middle; half of `rise` is added at its end and taken away at its beginning, and `bulge` added at
// both.
INLINE floatv short_square_over(const Ends *const ends, const floatv middle2, const floatv rise, const floatv bulge) {
    const float node[2] = {0.861136312f, 0.339981044f}, weight[2] = {0.347854845f, 0.652145155f};
    const floatv mean_l = 0.5f * (ends->l0 + ends->l1), half_l = 0.5f * (ends->l1 - ends->l0);
    const floatv mean_n = 0.5f * (ends->n0 + ends->n1), half_n = 0.5f * (ends->n1 - ends->n0);
    floatv sum = splat(0.0f);
#pragma unroll
    for (int k = 0; k < 4; ++k) {
        const float x = k < 2 ? node[k & 1] : -node[k & 1];
        const floatv f2 = fma(fma(bulge, splat(x), 0.5f * rise), splat(x), middle2);
        const floatv light = fma(half_l, splat(x), mean_l) * fma(half_n, splat(x), mean_n);
        sum = fma(light * inverse(f2), splat(weight[k & 1]), sum);
    }
    return 0.5f * ends->advance * sum;
}

// Integrates over a longer stretch: with f^2 = a y^2 + f_least^2, y counted from the peak, the integrals of 1, y and
// y^2, each over f^2, are an angle, a logarithm, and what is left of the stretch.
INLINE floatv long_square_over(const Ends *const ends, const floatv least, const floatv rise) {
    const floatv per_a = inverse(max(ends->a, 1e-30f));
    const floatv d = ends->advance, per_d = inverse(max(d, 1e-30f));
    const floatv root = 0.5f * twice_sqrt(max(least, 1e-36f)) * ends->rate; // of a c - b^2
    const floatv per_root = inverse(max(root, 1e-30f));

    // The peak sees the stretch under an angle. Half of it, or half of what it lacks to pi, has the tangent t.
    const floatv per_sum = inverse(max(ends->f0f1 + fabs(ends->g), 1e-36f));
    const floatv t = min(root * d * per_sum, 1.0f);
    const floatv arc = arctangent_ratio(t * t);
    const floatv beyond = 2.0f * d * per_sum * arc;
    const floatv angle = select(beyond, fma(splat(2.0f * HALF_PI), per_root, -beyond), ends->g < 0.0f);
    const floatv growth = LN_2 * binary_logarithm(ends->f1 * inverse(max(ends->f0, 1e-18f)));

    // What is linear in v, at the peak, and its slope.
    const floatv to_peak = -0.5f * rise * per_a * per_d * per_d; // from the middle, of the stretch
    const floatv slope_l = ends->l1 - ends->l0, slope_n = ends->n1 - ends->n0;
    const floatv peak_l = fma(slope_l, to_peak, 0.5f * (ends->l0 + ends->l1));
    const floatv peak_n = fma(slope_n, to_peak, 0.5f * (ends->n0 + ends->n1));
    const floatv curvature = slope_l * slope_n * per_d * per_d * per_a;
    const floatv slope = fma(peak_l, slope_n, peak_n * slope_l) * per_d * per_a;
    const floatv at_peak = fma(-curvature * per_a, root * root, peak_l * peak_n);
    return fma(at_peak, angle, fma(slope, growth, curvature * d));
}

INLINE floatv inverse_square_over(const Ends *const ends, const floatv least) {
    const floatv d = ends->advance;
    const floatv rise = (ends->f1 - ends->f0) * (ends->f1 + ends->f0);
    const floatv bulge = 0.25f * ends->a * d * d;
    const floatv middle2 = fma(splat(0.5f), fma(ends->f0, ends->f0, ends->f1 * ends->f1), -bulge);
    const intv is_short = bulge <= 0.1f * middle2;
    floatv integral = splat(0.0f);
    if (any_lane(is_short))
        integral = short_square_over(ends, middle2, rise, bulge);
    if (any_lane(!is_short))
        integral = select(long_square_over(ends, least, rise), integral, is_short);
    return integral;
}
