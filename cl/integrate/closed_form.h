// The integral of zeta(s) / sqrt((slope s + offset)^2 + least) over a part of a ray, in closed form: a point or a
// straight line of light (Abe, Watanabe 2010, eq. 8; with decay the same after the change of variable in decay.h).
//
// With n = beta / (s + beta), or 1, and f = n times the distance, f^2 is a quadratic a v^2 + .. in v. Let D be the
// advance of v and F the sum of f at both ends. Then sqrt(a) / 2 times the integral of dv / f is artanh(m), m = sqrt(a)
// D / F, the potential of a line seen from a point, and of n dv / f what follows from it with 1/a taken out by hand: no
// difference of large terms is left, neither for far nor for near ends, nor where a is 0.
#pragma once
#include "../decay.h"
#include "../elementary.h"
#include "../field/quadratic.h"

// (artanh(m) / m - 1) / m^2 for m^2 up to 0.2.
floatv artanh_series(const floatv m2) {
    floatv series = splat(1.0f / 21.0f);
    for (int odd = 19; odd > 1; odd -= 2)
        series = fma(series, m2, splat(1.0f / odd));
    return series;
}

#ifndef HALF_LN_2 // a test spoils it
#define HALF_LN_2 0.346573590f
#endif

INLINE floatv without_floor(const Quadratic *const distance2, const Decay decay, const floatv from, const floatv to) {
    const floatv least = distance2->least;
    const floatv x0 = fma(distance2->slope, from, distance2->offset);
    const floatv x1 = fma(distance2->slope, to, distance2->offset);
    const floatv n0 = nearness(decay, from), n1 = nearness(decay, to);
    const floatv d = advance(decay, from, n0, to, n1);
    const floatv f0 = 0.5f * n0 * twice_sqrt(fma(x0, x0, least));
    const floatv f1 = 0.5f * n1 * twice_sqrt(fma(x1, x1, least));
    const floatv ratio = d * inverse(f0 + f1);

    // f^2 = a v^2 + 2 b v + ..; without decay both are the squared slope.
    const floatv rate = decay.beta > 0.0f ? -decay.beta * distance2->slope : distance2->slope;
    const floatv x_pole = decay.beta > 0.0f ? fma(splat(-decay.beta), distance2->slope, distance2->offset) : rate;
    const floatv a = decay.beta > 0.0f ? fma(x_pole, x_pole, least) : rate * rate;
    const floatv b = rate * x_pole;

    // artanh(m) is half the logarithm of (F + sqrt(a) D)^2 / (F^2 - a D^2), where F^2 - a D^2 = 2 (f0 f1 + g) and (f0
    // f1)^2 - g^2 = least (rate D)^2.
    const floatv sum = f0 + f1, f0f1 = f0 * f1;
    const floatv g = n0 * n1 * fma(x0, x1, least);
    const intv is_between = g < 0.0f;
    const floatv per_root = 0.5f * twice_inverse_sqrt_(max(a, 1e-30f));
    const floatv whole = fma(a * per_root, d, sum);
    const floatv turn = rate * d;
    const floatv above = whole * whole * select(splat(1.0f), f0f1 - g, is_between);
    const floatv below = 2.0f * select(f0f1 + g, least * turn * turn, is_between);
    const floatv artanh = HALF_LN_2 * binary_logarithm(above * inverse(max(below, 1e-36f)));
    const floatv mean = 0.5f * (n0 + n1), per_a = per_root * per_root;
    floatv integral = fma(ratio, fma(-b, per_a, mean), b * per_a * per_root * artanh);
    const floatv m2 = a * ratio * ratio;
    const intv is_small = m2 < 0.2f;
    if (any_lane(is_small))
        integral = select(integral, ratio * fma(b * ratio * ratio, artanh_series(m2), mean), is_small);
    return 2.0f * decay.strength * integral;
}

// Where the ray is closer to the core than the floor of all distances the field is constant; a ray in a million.
floatv with_floor(const Quadratic *const distance2, const floatv floor2, const Decay decay, const floatv from,
                  const floatv to) {
    const floatv per_slope = inverse(max(distance2->slope, 1e-18f));
    const floatv nearest = -distance2->offset * per_slope;
    const floatv reach = 0.5f * twice_sqrt(max(floor2 - distance2->least, 1e-36f)) * per_slope;
    const floatv begin = clamp(nearest - reach, from, to), end = clamp(nearest + reach, from, to);
    const floatv inside = advance(decay, begin, nearness(decay, begin), end, nearness(decay, end));
    const floatv flat = 0.5f * decay.strength * inside * twice_inverse_sqrt_(floor2);
    return without_floor(distance2, decay, from, begin) + flat + without_floor(distance2, decay, end, to);
}

INLINE floatv closed_form(const Quadratic *const distance2, const floatv floor2, const Decay decay, const floatv from,
                          const floatv to) {
    const floatv integral = without_floor(distance2, decay, from, to);
    const intv is_floored = distance2->least < floor2;
    if (!any_lane(is_floored))
        return integral;
    return select(integral, with_floor(distance2, floor2, decay, from, to), is_floored);
}
