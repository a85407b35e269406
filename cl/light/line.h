// Straight cores: the irradiance of a stretch of a line in closed form.
//
// With p = y.T at the parameter 0, h = y - p T, u = t + p and R = sqrt(h^2 + u^2), the integral over u of
// (n.h + u n.T) / R^3 is n.h [u/R]/h^2 - n.T [1/R], and of u times that n.h [-1/R] + n.T [asinh(u/h) - u/R].
#pragma once
#include "stretch.h"

// Returns [u/R]/h^2: differences of numbers of one sign without cancelling.
floatv difference_of_sines(const floatv u0, const floatv r0, const floatv u1, const floatv r1, const floatv h2) {
    const intv begins = isinf(u0), goes_on = isinf(u1);
    const floatv s0 = select(u0 / r0, splat(-1.0f), begins), s1 = select(u1 / r1, splat(1.0f), goes_on);
    const floatv between = (u1 - u0) / r0 * (u1 + u0) / (r1 * (u1 * r0 + u0 * r1));
    const floatv one_sign = select(select(between, 1.0f / (r0 * (r0 + u0)), goes_on), 1.0f / (r1 * (r1 - u1)), begins);
    return select(one_sign, (s1 - s0) / h2, (u0 > 0.0f) ^ (u1 > 0.0f));
}

// Returns [1/R].
floatv difference_of_inverses(const floatv u0, const floatv r0, const floatv u1, const floatv r1) {
    const floatv between = (u0 - u1) / r0 * (u1 + u0) / (r1 * (r0 + r1));
    return select(between, 1.0f / r1 - 1.0f / r0, isinf(u0) | isinf(u1));
}

// Returns what is above the horizon.
Stretches line_above(__global const CastLight *const line, const float3v y, const float3v normal) {
    Stretches above = no_stretch();
    floatv from = splat(line->from), to = splat(line->to);
#ifndef WITHOUT_HORIZON
    const floatv height = FACING(normal, y), rise = FACING(normal, uniform3(line->along));
    const floatv cut = -height / rise;
    from = select(from, fmax(from, cut), rise > 0.0f);
    to = select(to, fmin(to, cut), rise < 0.0f);
    to = select(to, from, (rise == 0.0f) & (height <= 0.0f));
#endif
    add_stretch(&above, from, to);
    return above;
}

float3v line_irradiance(__global const CastLight *const line, const float3v y, const float3v normal, const floatv from,
                        const floatv to) {
    const float3v direction = uniform3(line->along);
    const floatv p = dot3(y, direction);
    const float3v beside = fma3(direction, -p, y);
    const floatv h2 = dot3(beside, beside) + line->place.w;
    const floatv u0 = from + p, u1 = to + p;
    const floatv r0 = sqrt(fma(u0, u0, h2)), r1 = sqrt(fma(u1, u1, h2));
    const floatv across = FACING(normal, beside), along = FACING(normal, direction);
    const floatv sines = difference_of_sines(u0, r0, u1, r1, h2);
    const floatv inverses = difference_of_inverses(u0, r0, u1, r1);
    const floatv even = across * sines - along * inverses;
    if (is_even(line))
        return scale3(uniform3(line->light), even);
    // Light is that in the middle, and grows evenly from there.
    const float length = line->to - line->from;
    const floatv middle = 0.5f * (u0 + u1);
    const floatv a0 = select(u0 + r0, h2 / (r0 - u0), u0 < 0.0f);
    const floatv a1 = select(u1 + r1, h2 / (r1 - u1), u1 < 0.0f);
    const floatv moment = along * (LN_2 * binary_logarithm(a1 / a0) - h2 * sines) - across * inverses;
    const floatv s = (0.5f * (from + to) - line->from) / length;
    const float3v light = fma3(uniform3(line->slope), s, uniform3(line->light));
    return fma3(uniform3(line->slope), (moment - middle * even) / length, scale3(light, even));
}

#ifdef IS_HIDDEN
// Returns a parameter of a stretch, s from 0 to 1: in equal steps; towards an infinite end in equal angles, as seen
// from where the stretch ends, or is nearest.
float line_parameter(__global const CastLight *const line, const float3v y, const float from, const float to,
                     const float s) {
    if (!isinf(from) && !isinf(to))
        return from + s * (to - from);
    const float3v direction = uniform3(line->along);
    const float p = dot3(y, direction);
    const float3v beside = fma3(direction, -p, y);
    const float h2 = dot3(beside, beside) + line->place.w;
    if (isinf(from) && isinf(to))
        return s <= 0.0f ? from : s >= 1.0f ? to : sqrt(h2) * tan(PI_F * (s - 0.5f)) - p;
    if (isinf(to))
        return s >= 1.0f ? to : from + sqrt(h2 + (from + p) * (from + p)) * tan(0.5f * PI_F * s);
    return s <= 0.0f ? from : to - sqrt(h2 + (to + p) * (to + p)) * tan(0.5f * PI_F * (1.0f - s));
}
#endif
