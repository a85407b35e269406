// Cubic curves y(t) = y + c1 t + c2 t^2 + c3 t^3 that hardly differ from quadratic ones, and have no vertex but at
// their ends: Gauss' rule over v, t = t0 + w sinh(v), where t0 is nearest and w |c'| about the distance there; parts
// end at the horizon and at t0. From afar plainly over t.
#pragma once
#include "stretch.h"

float3v curve_place(__global const CastLight *const curve, const float3v y, const floatv t) {
    const float3v bent = fma3(uniform3(curve->last), t, uniform3(curve->across));
    return fma3(fma3(bent, t, uniform3(curve->along)), t, y);
}

float3v curve_velocity(__global const CastLight *const curve, const floatv t) {
    const float3v bent = fma3(uniform3(3.0f * curve->last), t, uniform3(2.0f * curve->across));
    return fma3(bent, t, uniform3(curve->along));
}

// The powers of t in n.y(t).
typedef struct {
    floatv of_0, of_1, of_2, of_3;
} CurveHeights;

floatv height_of_curve(const CurveHeights *const heights, const floatv t) {
    return fma(fma(fma(heights->of_3, t, heights->of_2), t, heights->of_1), t, heights->of_0);
}

// Gives the two places within [0,1] at which n.y(t) turns, in their order; 0 where there are none.
void turns_of_curve(const CurveHeights *const heights, floatv *const first, floatv *const second) {
    const floatv a = 3.0f * heights->of_3, b = 2.0f * heights->of_2, c = heights->of_1;
    const floatv discriminant = fma(b, b, -4.0f * a * c);
    const floatv q = -0.5f * (b + copysign(sqrt(fmax(discriminant, 0.0f)), b));
    const floatv one = q / a, other = c / q, zero = splat(0.0f);
    const intv are_there = discriminant > 0.0f;
    *first = select(zero, clamp(fmin(one, other), zero, splat(1.0f)), are_there);
    *second = select(zero, clamp(fmax(one, other), zero, splat(1.0f)), are_there);
}

// Returns where n.y(t) is 0 between two places at which it has different signs: Newton's steps, halvings where they
// leave the bracket.
floatv horizon_of_curve(const CurveHeights *const heights, floatv from, floatv to) {
    const intv rises = height_of_curve(heights, to) > 0.0f;
    floatv t = 0.5f * (from + to);
    for (int step = 0; step < 8; ++step) {
        const floatv height = height_of_curve(heights, t);
        const intv is_behind = (height > 0.0f) == rises;
        to = select(to, t, is_behind);
        from = select(t, from, is_behind);
        const floatv rise = fma(fma(3.0f * heights->of_3, t, 2.0f * heights->of_2), t, heights->of_1);
        const floatv next = t - height / rise;
        t = select(0.5f * (from + to), next, (next >= from) & (next <= to));
    }
    return t;
}

// Returns what is above the horizon.
Stretches curve_above(__global const CastLight *const curve, const float3v y, const float3v normal) {
    Stretches above = no_stretch();
#ifdef WITHOUT_HORIZON
    add_stretch(&above, splat(0.0f), splat(1.0f));
#else
    const CurveHeights heights = {FACING(normal, y), FACING(normal, uniform3(curve->along)),
                                  FACING(normal, uniform3(curve->across)), FACING(normal, uniform3(curve->last))};
    // Between its turns it rises or falls.
    floatv ends[4];
    ends[0] = splat(0.0f), ends[3] = splat(1.0f);
    turns_of_curve(&heights, ends + 1, ends + 2);
    floatv begin = splat(0.0f);
    intv was_above = heights.of_0 > 0.0f;
    for (int k = 0; k < 3; ++k) {
        const intv is_above = height_of_curve(&heights, ends[k + 1]) > 0.0f;
        const intv crosses = is_above != was_above;
        if (!any_lane(crosses))
            continue;
        const floatv horizon = horizon_of_curve(&heights, ends[k], ends[k + 1]);
        add_stretch(&above, begin, select(begin, horizon, crosses & was_above));
        begin = select(begin, horizon, crosses);
        was_above = is_above;
    }
    add_stretch(&above, begin, select(begin, splat(1.0f), was_above));
#endif
    return above;
}

// Returns (n.y) |c'| / |y|^3.
floatv curve_integrand(__global const CastLight *const curve, const float3v y, const float3v normal, const floatv t) {
    const float3v place = curve_place(curve, y, t), velocity = curve_velocity(curve, t);
    const floatv inverse = 0.5f * twice_inverse_sqrt(dot3(place, place) + curve->place.w);
    const floatv speed = 0.5f * twice_sqrt(dot3(velocity, velocity));
    return FACING(normal, place) * speed * (inverse * inverse * inverse);
}

void add_curve_node(LitSum *const sum, __global const CastLight *const curve, const float3v y, const float3v normal,
                    const floatv t, const floatv weight) {
    add_lit(sum, curve, weight * curve_integrand(curve, y, normal, t), t);
}

// Where a curve is nearest to a point, also before it begins or behind its end, and the w of there.
typedef struct {
    floatv t, w;
} CurveNearest;

// Finds it for a curve that has its vertex at an end.
CurveNearest nearest_of_curve(__global const CastLight *const curve, const float3v y) {
    const float3v across = uniform3(curve->across), last = uniform3(3.0f * curve->last);
    floatv least = splat(INFINITY), t = splat(0.0f);
    for (int k = 0; k <= 4; ++k) {
        const floatv there = splat(0.25f * k);
        const float3v place = curve_place(curve, y, there);
        const floatv distance2 = dot3(place, place);
        t = select(t, there, distance2 < least);
        least = fmin(least, distance2);
    }
    floatv speed2 = splat(0.0f), curvature = splat(0.0f);
    for (int k = 0; k < 4; ++k) {
        const float3v place = curve_place(curve, y, t), velocity = curve_velocity(curve, t);
        // A half of each derivative of |y|^2; where the second is small, Newton's step goes too far.
        speed2 = dot3(velocity, velocity);
        curvature = fma(splat(2.0f), dot3(place, fma3(last, t, across)), speed2);
        const floatv slope = fmax(curvature, 0.25f * speed2);
        t = clamp(t - dot3(place, velocity) / slope, splat(-1.0f), splat(2.0f));
    }
    const float3v place = curve_place(curve, y, t);
    const floatv distance2 = dot3(place, place) + curve->place.w;
    const CurveNearest nearest = {t, sqrt(distance2 / fmax(curvature, 0.01f * speed2))};
    return nearest;
}

// Adds the integral from one v to another, which is none where they are in no order.
void add_part_of_curve(LitSum *const sum, __global const CastLight *const curve, const float3v y, const float3v normal,
                       const CurveNearest *const nearest, const floatv begin, const floatv end) {
    const floatv middle = 0.5f * (begin + end), half_width = fmax(0.5f * (end - begin), 0.0f);
    if (!any_lane(half_width > 0.0f))
        return;
    // By how far the integrand's poles, about pi/2 beside the nearest place, are in widths.
    const Rule rule = any_lane(half_width > 2.0f)    ? RULE_12
                      : any_lane(half_width > 1.3f)  ? RULE_8
                      : any_lane(half_width > 0.75f) ? RULE_6
                                                     : RULE_4;
    const floatv grown = power_of_two(LOG2_E * middle), shrunk = inverse(grown);
    const floatv half_w = 0.5f * nearest->w;
    for (uint node = rule.first; node < rule.end; ++node) {
        const floatv more = power_of_two(LOG2_E * GAUSS_NODES[node] * half_width), less = inverse(more);
        const floatv weight = GAUSS_WEIGHTS[node] * half_width * half_w;
        floatv up = grown * more, down = shrunk * less;
        add_curve_node(sum, curve, y, normal, fma(half_w, up - down, nearest->t), weight * (up + down));
        up = grown * less, down = shrunk * more;
        add_curve_node(sum, curve, y, normal, fma(half_w, up - down, nearest->t), weight * (up + down));
    }
}

// Adds the integral over a part that is far away.
void add_far_curve(LitSum *const sum, __global const CastLight *const curve, const float3v y, const float3v normal,
                   const floatv from, const floatv to) {
    const floatv middle = 0.5f * (from + to), half_width = 0.5f * (to - from);
    for (uint node = RULE_4.first; node < RULE_4.end; ++node) {
        const floatv off = GAUSS_NODES[node] * half_width, weight = GAUSS_WEIGHTS[node] * half_width;
        add_curve_node(sum, curve, y, normal, middle - off, weight);
        add_curve_node(sum, curve, y, normal, middle + off, weight);
    }
}

float3v curve_irradiance(__global const CastLight *const curve, const float3v y, const float3v normal,
                         const floatv from, const floatv to) {
    const float3v center = curve_place(curve, y, splat(0.5f));
    const float size = length(curve->along.xyz) + 2.0f * length(curve->across.xyz) + 3.0f * length(curve->last.xyz);
    const intv is_near = dot3(center, center) <= 4.0f * size * size;
    LitSum sum = no_light();
    if (any_lane(!is_near)) // the near part of what is far goes nowhere
        add_far_curve(&sum, curve, y, normal, from, select(to, from, is_near));
    if (any_lane(is_near)) {
        const CurveNearest nearest = nearest_of_curve(curve, y);
        const floatv begin = inverse_hyperbolic_sine((from - nearest.t) / nearest.w);
        const floatv end = select(begin, inverse_hyperbolic_sine((to - nearest.t) / nearest.w), is_near);
        const floatv middle = fmin(fmax(begin, 0.0f), end);
        add_part_of_curve(&sum, curve, y, normal, &nearest, begin, middle);
        add_part_of_curve(&sum, curve, y, normal, &nearest, middle, end);
    }
    return light_of(curve, sum);
}
