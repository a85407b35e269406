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

// (artanh(m) / m - 1) / m^2, from m^2 and from 1 - m^2, which the caller knows to all digits.
floatv artanh_excess(const floatv m2, const floatv rest) {
    floatv series = splat(1.0f / 21.0f);
    for (int odd = 19; odd > 1; odd -= 2)
        series = fma(series, m2, splat(1.0f / odd));
    const intv is_large = m2 > 0.2f;
    if (!any_lane(is_large))
        return series;
    const floatv inverse_m = 0.5f * twice_inverse_sqrt_(max(m2, 0.1f));
    const floatv sum = 1.0f + m2 * inverse_m;
    const floatv artanh = 0.5f * logarithm(sum * sum * inverse(rest));
    return select(series, fma(artanh, inverse_m, splat(-1.0f)) * inverse_m * inverse_m, is_large);
}

// A ray closer to the core than the floor f of all distances keeps the integral of its floored field when its least
// squared distance h^2 is replaced by this one, within 0.03 f^2.
floatv floored(const floatv least, const floatv floor2) {
    return max(least, fma(least, splat(0.459f), 0.541f * floor2));
}

// Squared distance in units that `scale` brings to world units: `scale` is 2 for doubled lengths.
INLINE floatv closed_form(const Quadratic *const distance2, const floatv floor2, const Decay decay, const floatv from,
                          const floatv to) {
    const floatv least = floored(distance2->least, floor2);
    const floatv x0 = fma(distance2->slope, from, distance2->offset);
    const floatv x1 = fma(distance2->slope, to, distance2->offset);
    const floatv n0 = nearness(decay, from), n1 = nearness(decay, to);
    const floatv d = advance(decay, from, n0, to, n1);
    const floatv f0 = 0.5f * n0 * twice_sqrt(fma(x0, x0, least));
    const floatv f1 = 0.5f * n1 * twice_sqrt(fma(x1, x1, least));
    const floatv per_sum = inverse(f0 + f1);
    const floatv ratio = d * per_sum;

    // f^2 = a v^2 + 2 b v + ..; without decay both are the squared slope.
    const floatv rate = decay.beta > 0.0f ? -decay.beta * distance2->slope : distance2->slope;
    const floatv x_pole = decay.beta > 0.0f ? fma(splat(-decay.beta), distance2->slope, distance2->offset) : rate;
    const floatv a = decay.beta > 0.0f ? fma(x_pole, x_pole, least) : rate * rate;
    const floatv b = rate * x_pole;

    // 1 - m^2 = 2 (f0 f1 + g) / F^2, where (f0 f1)^2 - g^2 = least (rate D)^2.
    const floatv f0f1 = f0 * f1;
    const floatv g = n0 * n1 * fma(x0, x1, least);
    const floatv turned = rate * rate * least * d * d * inverse(f0f1 + fabs(g));
    const floatv rest = 2.0f * select(f0f1 + g, turned, g < 0.0f) * per_sum * per_sum;
    const floatv excess = artanh_excess(a * ratio * ratio, max(rest, 1e-30f));
    return 2.0f * decay.strength * ratio * fma(b * ratio, ratio * excess, 0.5f * (n0 + n1));
}
