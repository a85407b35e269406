// Cubic curves y(t) = y + c1 t + c2 t^2 + c3 t^3 that hardly differ from quadratic ones, and have no vertex but at
// their ends: Gauss' rule over v, t = t0 + w sinh(v), where t0 is nearest and w |c'| about the distance there; parts
// end at the horizon and at t0. From afar plainly over t.
#pragma once
#include "stretch.h"

float3 curve_place(__global const CastLight *const curve, const float3 y, const float t) {
    return y + t * (curve->along.xyz + t * (curve->across.xyz + t * curve->last.xyz));
}

float3 curve_velocity(__global const CastLight *const curve, const float t) {
    return curve->along.xyz + t * (2.0f * curve->across.xyz + 3.0f * t * curve->last.xyz);
}

// Returns the real roots of a t^2 + b t + c in their order, within [0,1]; 0 where there are none.
float2 roots_within(const float a, const float b, const float c) {
    const float discriminant = b * b - 4.0f * a * c;
    if (!(discriminant > 0.0f))
        return (float2)(0.0f);
    const float q = -0.5f * (b + copysign(sqrt(discriminant), b));
    const float one = q / a, other = c / q;
    return clamp((float2)(fmin(one, other), fmax(one, other)), 0.0f, 1.0f);
}

float height_of_curve(const float4 heights, const float t) {
    return heights.x + t * (heights.y + t * (heights.z + t * heights.w));
}

// Returns where n.y(t) is 0 between two places at which it has different signs: Newton's steps, halvings where they
// leave the bracket.
float horizon_of_curve(const float4 heights, float from, float to) {
    const int rises = height_of_curve(heights, to) > 0.0f;
    float t = 0.5f * (from + to);
    for (int step = 0; step < 8; ++step) {
        const float height = height_of_curve(heights, t);
        if ((height > 0.0f) == rises)
            to = t;
        else
            from = t;
        const float rise = heights.y + t * (2.0f * heights.z + 3.0f * t * heights.w);
        const float next = t - height / rise;
        t = next >= from && next <= to ? next : 0.5f * (from + to);
    }
    return t;
}

// Returns what is above the horizon.
Stretches curve_above(__global const CastLight *const curve, const float3 y, const float3 normal) {
    Stretches above = {{0.0f, 0.0f}, {0.0f, 0.0f}, 0};
#ifdef WITHOUT_HORIZON
    add_stretch(&above, 0.0f, 1.0f);
#else
    const float4 heights = (float4)(FACING(normal, y), FACING(normal, curve->along.xyz),
                                    FACING(normal, curve->across.xyz), FACING(normal, curve->last.xyz));
    // Between its extremes it rises or falls.
    const float2 extremes = roots_within(3.0f * heights.w, 2.0f * heights.z, heights.y);
    const float ends[4] = {0.0f, extremes.x, extremes.y, 1.0f};
    float begin = 0.0f;
    int was_above = heights.x > 0.0f;
    for (int k = 0; k < 3; ++k) {
        const int is_above = height_of_curve(heights, ends[k + 1]) > 0.0f;
        if (is_above == was_above)
            continue;
        const float horizon = horizon_of_curve(heights, ends[k], ends[k + 1]);
        if (was_above)
            add_stretch(&above, begin, horizon);
        begin = horizon;
        was_above = is_above;
    }
    if (was_above)
        add_stretch(&above, begin, 1.0f);
#endif
    return above;
}

// Returns (n.y) |c'| / |y|^3.
floatv curve_integrand(__global const CastLight *const curve, const float3 y, const float3 normal, const floatv t) {
    const float3v along = uniform3(curve->along), across = uniform3(curve->across), last = uniform3(curve->last);
    const float3v bent = fma3(last, t, across);
    const float3v place = fma3(fma3(bent, t, along), t, uniform3((float4)(y, 0.0f)));
    const float3v velocity = fma3(add3(scale3(bent, splat(2.0f)), scale3(last, t)), t, along);
    const floatv distance2 = dot3(place, place) + curve->place.w;
    return FACING3(normal, place) * sqrt(dot3(velocity, velocity)) / (distance2 * sqrt(distance2));
}

// Finds where a curve that has its vertex at an end is nearest, also before it begins or behind its end; gives the w of
// there, too.
float2 nearest_of_curve(__global const CastLight *const curve, const float3 y) {
    float least = INFINITY, t = 0.0f;
    for (int k = 0; k <= 4; ++k) {
        const float3 place = curve_place(curve, y, 0.25f * k);
        const float distance2 = dot(place, place);
        t = distance2 < least ? 0.25f * k : t;
        least = fmin(least, distance2);
    }
    float speed2 = 0.0f, curvature = 0.0f;
    for (int k = 0; k < 4; ++k) {
        const float3 place = curve_place(curve, y, t);
        const float3 velocity = curve_velocity(curve, t);
        // A half of each derivative of |y|^2; where the second is small, Newton's step goes too far.
        speed2 = dot(velocity, velocity);
        curvature = speed2 + 2.0f * dot(place, curve->across.xyz + 3.0f * t * curve->last.xyz);
        const float slope = fmax(curvature, 0.25f * speed2);
        t = clamp(t - dot(place, velocity) / slope, -1.0f, 2.0f);
    }
    const float3 place = curve_place(curve, y, t);
    const float distance2 = dot(place, place) + curve->place.w;
    return (float2)(t, sqrt(distance2 / fmax(curvature, 0.01f * speed2)));
}

// Returns the integral from one v to another.
float3 part_of_curve(__global const CastLight *const curve, const float3 y, const float3 normal, const float2 nearest,
                     const float begin, const float end) {
    const float middle = 0.5f * (begin + end), half_width = 0.5f * (end - begin);
    float3 sum = (float3)(0.0f);
    for (uint first = 0; first < GAUSS_COUNT; first += LANES) {
        const floatv grown = exp(fma(splat(half_width), LOAD_LANES(GAUSS_NODES + first), splat(middle)));
        const floatv shrunk = 1.0f / grown;
        const floatv t = nearest.x + 0.5f * nearest.y * (grown - shrunk);
        const floatv per_v = 0.5f * nearest.y * (grown + shrunk);
        sum += lit_sum(curve, LOAD_LANES(GAUSS_WEIGHTS + first) * per_v * curve_integrand(curve, y, normal, t), t);
    }
    return half_width * sum;
}

float3 curve_irradiance(__global const CastLight *const curve, const float3 y, const float3 normal, const float from,
                        const float to) {
    const float3 center = curve_place(curve, y, 0.5f);
    const float size = length(curve->along.xyz) + 2.0f * length(curve->across.xyz) + 3.0f * length(curve->last.xyz);
    if (dot(center, center) > 4.0f * size * size) {
        const float middle = 0.5f * (from + to), half_width = 0.5f * (to - from);
        float3 sum = (float3)(0.0f);
        for (uint first = 0; first < FAR_COUNT; first += LANES) {
            const floatv t = fma(splat(half_width), LOAD_LANES(FAR_NODES + first), splat(middle));
            sum += lit_sum(curve, LOAD_LANES(FAR_WEIGHTS + first) * curve_integrand(curve, y, normal, t), t);
        }
        return half_width * sum;
    }
    const float2 nearest = nearest_of_curve(curve, y);
    const float begin = asinh((from - nearest.x) / nearest.y), end = asinh((to - nearest.x) / nearest.y);
    if (begin >= 0.0f || end <= 0.0f)
        return part_of_curve(curve, y, normal, nearest, begin, end);
    return part_of_curve(curve, y, normal, nearest, begin, 0.0f) + part_of_curve(curve, y, normal, nearest, 0.0f, end);
}
