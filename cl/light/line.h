// Straight cores: the irradiance of a stretch of a line in closed form.
//
// With p = y.T at the parameter 0, h = y - p T, u = t + p and R = sqrt(h^2 + u^2), the integral over u of
// (n.h + u n.T) / R^3 is n.h [u/R]/h^2 - n.T [1/R], and of u times that n.h [-1/R] + n.T [asinh(u/h) - u/R].
#pragma once
#include "stretch.h"

// Returns [u/R]/h^2: differences of numbers of one sign without cancelling.
float difference_of_sines(const float u0, const float r0, const float u1, const float r1, const float h2) {
    if ((u0 > 0.0f) != (u1 > 0.0f)) {
        const float s0 = isinf(u0) ? -1.0f : u0 / r0;
        const float s1 = isinf(u1) ? 1.0f : u1 / r1;
        return (s1 - s0) / h2;
    }
    if (isinf(u1))
        return 1.0f / (r0 * (r0 + u0));
    if (isinf(u0))
        return 1.0f / (r1 * (r1 - u1));
    return (u1 - u0) / r0 * (u1 + u0) / (r1 * (u1 * r0 + u0 * r1));
}

// Returns [1/R].
float difference_of_inverses(const float u0, const float r0, const float u1, const float r1) {
    if (isinf(u0) || isinf(u1))
        return 1.0f / r1 - 1.0f / r0;
    return (u0 - u1) / r0 * (u1 + u0) / (r1 * (r0 + r1));
}

// Returns what is above the horizon.
Stretches line_above(__global const CastLight *const line, const float3 y, const float3 normal) {
    Stretches above = {{0.0f, 0.0f}, {0.0f, 0.0f}, 0};
    float from = line->from, to = line->to;
#ifndef WITHOUT_HORIZON
    const float height = FACING(normal, y), rise = FACING(normal, line->along.xyz);
    const float cut = -height / rise;
    if (rise > 0.0f)
        from = fmax(from, cut);
    else if (rise < 0.0f)
        to = fmin(to, cut);
    else if (height <= 0.0f)
        return above;
#endif
    add_stretch(&above, from, to);
    return above;
}

float3 line_irradiance(__global const CastLight *const line, const float3 y, const float3 normal, const float from,
                       const float to) {
    const float3 direction = line->along.xyz;
    const float p = dot(y, direction);
    const float3 beside = y - p * direction;
    const float h2 = dot(beside, beside) + line->place.w;
    const float u0 = from + p, u1 = to + p;
    const float r0 = sqrt(h2 + u0 * u0), r1 = sqrt(h2 + u1 * u1);
    const float across = FACING(normal, beside), along = FACING(normal, direction);
    const float sines = difference_of_sines(u0, r0, u1, r1, h2);
    const float inverses = difference_of_inverses(u0, r0, u1, r1);
    const float even = across * sines - along * inverses;
    if (is_even(line))
        return even * line->light.xyz;
    // Light is that in the middle, and grows evenly from there.
    const float length = line->to - line->from;
    const float middle = 0.5f * (u0 + u1);
    const float a0 = u0 < 0.0f ? h2 / (r0 - u0) : u0 + r0;
    const float a1 = u1 < 0.0f ? h2 / (r1 - u1) : u1 + r1;
    const float moment = along * (log(a1 / a0) - h2 * sines) - across * inverses;
    const float3 light = light_at(line, (0.5f * (from + to) - line->from) / length);
    return even * light + (moment - middle * even) / length * line->slope.xyz;
}

// Returns a parameter of a stretch, s from 0 to 1: in equal steps; towards an infinite end in equal angles, as seen
// from where the stretch ends, or is nearest.
float line_parameter(__global const CastLight *const line, const float3 y, const float from, const float to,
                     const float s) {
    if (!isinf(from) && !isinf(to))
        return from + s * (to - from);
    const float3 direction = line->along.xyz;
    const float p = dot(y, direction);
    const float3 beside = y - p * direction;
    const float h2 = dot(beside, beside) + line->place.w;
    if (isinf(from) && isinf(to))
        return s <= 0.0f ? from : s >= 1.0f ? to : sqrt(h2) * tan(PI_F * (s - 0.5f)) - p;
    if (isinf(to))
        return s >= 1.0f ? to : from + sqrt(h2 + (from + p) * (from + p)) * tan(0.5f * PI_F * s);
    return s <= 0.0f ? from : to - sqrt(h2 + (to + p) * (to + p)) * tan(0.5f * PI_F * (1.0f - s));
}
