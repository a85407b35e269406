// The light that the cores of waves cast on points of surfaces, a point a lane: E = integral of
// I' max(0, n.y) / |y|^3 over all cores.
//
// What sees a core from the point is up to the program that includes this: without IS_HIDDEN nothing is hidden. With
// it, IS_HIDDEN(from, to) says whether something lies between two places, and VISIBILITY_PARAMETERS and
// VISIBILITY_ARGUMENTS, which begin with a comma, hand on what it needs to know; such a program has one lane. The part
// of a core above the horizon is cut into pieces, each is as visible as its middle, and where neighbours differ the
// edge is halved four times: a point that sees all of a core has its light exactly.
#pragma once
#include "curve.h"
#include "line.h"
#include "ring.h"
#include "stretch.h"

#define LIGHTS_PARAMETERS __global const CastLight *const lights, const uint light_count, const uint shadow_samples
#define LIGHTS_ARGUMENTS lights, light_count, shadow_samples

#ifndef IS_HIDDEN
#define VISIBILITY_PARAMETERS
#define VISIBILITY_ARGUMENTS
#elif LANES != 1
#error "points have no shadows side by side"
#endif

#define HALVINGS 4

// A core as it is seen from a point of a surface.
typedef struct {
    __global const CastLight *core;
    float3v y, normal;
    SeenRing ring;
} SeenCore;

// Returns what is above the horizon.
Stretches stretches_above(const SeenCore *const seen) {
    switch (seen->core->form) {
    case LINE_FORM:
        return line_above(seen->core, seen->y, seen->normal);
    case RING_FORM:
        return ring_above(seen->core, &seen->ring);
    default:
        return curve_above(seen->core, seen->y, seen->normal);
    }
}

// Returns the irradiance by a stretch.
float3v stretch_irradiance(const SeenCore *const seen, const floatv from, const floatv to) {
    switch (seen->core->form) {
    case LINE_FORM:
        return line_irradiance(seen->core, seen->y, seen->normal, from, to);
    case RING_FORM:
        return ring_irradiance(seen->core, &seen->ring, from, to);
    default:
        return curve_irradiance(seen->core, seen->y, seen->normal, from, to);
    }
}

float3v point_irradiance(__global const CastLight *const point, const float3v y, const float3v normal) {
    const floatv inverse = 0.5f * twice_inverse_sqrt(dot3(y, y) + point->place.w);
    const floatv facing = FACING(normal, y);
#ifdef WITHOUT_HORIZON
    const floatv above = facing;
#else
    const floatv above = fmax(facing, 0.0f);
#endif
    return scale3(uniform3(point->light), above * (inverse * inverse * inverse));
}

#ifdef IS_HIDDEN
// Returns the parameter at s, from 0 to 1 over a stretch.
float stretch_parameter(const SeenCore *const seen, const float from, const float to, const float s) {
    if (seen->core->form == LINE_FORM)
        return line_parameter(seen->core, seen->y, from, to, s);
    return from + s * (to - from);
}

// Returns whether the place of a core at a parameter is seen from a point.
int is_seen(const SeenCore *const seen, const float3v place, const float parameter VISIBILITY_PARAMETERS) {
    float3v y;
    switch (seen->core->form) {
    case LINE_FORM:
        y = fma3(uniform3(seen->core->along), parameter, seen->y);
        break;
    case RING_FORM:
        y = ring_place(seen->core, seen->y, parameter);
        break;
    default:
        y = curve_place(seen->core, seen->y, parameter);
    }
    return !IS_HIDDEN(place, add3(place, y));
}

// Returns the irradiance by what is seen of a stretch.
float3v lit_irradiance(const SeenCore *const seen, const float3v place, const float from, const float to,
                       const uint samples VISIBILITY_PARAMETERS) {
#define IS_SEEN_AT(s) is_seen(seen, place, stretch_parameter(seen, from, to, s) VISIBILITY_ARGUMENTS)
    const float step = 1.0f / samples;
    float3v sum = uniform3((float4)(0.0f));
    float begin = from;
    int was_seen = IS_SEEN_AT(0.5f * step);
    for (uint k = 1; k < samples; ++k) {
        const int now = IS_SEEN_AT((k + 0.5f) * step);
        if (now == was_seen)
            continue;
        float before = (k - 0.5f) * step, behind = (k + 0.5f) * step;
        for (int halving = 0; halving < HALVINGS; ++halving) {
            const float middle = 0.5f * (before + behind);
            if (IS_SEEN_AT(middle) == was_seen)
                before = middle;
            else
                behind = middle;
        }
        const float edge = stretch_parameter(seen, from, to, 0.5f * (before + behind));
        if (was_seen)
            sum = add3(sum, stretch_irradiance(seen, begin, edge));
        begin = edge;
        was_seen = now;
    }
    return was_seen ? add3(sum, stretch_irradiance(seen, begin, to)) : sum;
#undef IS_SEEN_AT
}
#define LIT_IRRADIANCE(seen, from, to) lit_irradiance(seen, place, from, to, shadow_samples VISIBILITY_ARGUMENTS)
#define IS_POINT_HIDDEN(y) IS_HIDDEN(place, add3(place, y))
#else
#define LIT_IRRADIANCE(seen, from, to) stretch_irradiance(seen, from, to)
#define IS_POINT_HIDDEN(y) 0
#endif

// Returns the irradiance, linear RGB, of points of surfaces with these normals, of length 1.
float3v irradiance_at(LIGHTS_PARAMETERS, const float3v place, const float3v normal VISIBILITY_PARAMETERS) {
    const float3v nothing = uniform3((float4)(0.0f));
    float3v sum = nothing;
    for (uint index = 0; index < light_count; ++index) {
        SeenCore seen;
        seen.core = lights + index;
        seen.y = subtract3(uniform3(seen.core->place), place);
        seen.normal = normal;
        if (seen.core->form == POINT_FORM) {
            if (!IS_POINT_HIDDEN(seen.y))
                sum = add3(sum, point_irradiance(seen.core, seen.y, normal));
            continue;
        }
        if (seen.core->form == RING_FORM)
            seen.ring = see_ring(seen.core, seen.y, normal);
        const Stretches above = stretches_above(&seen);
        for (int k = 0; k < 2; ++k) {
            const intv is_some = above.to[k] > above.from[k];
            if (any_lane(is_some))
                sum = add3(sum, select3(nothing, LIT_IRRADIANCE(&seen, above.from[k], above.to[k]), is_some));
        }
    }
    return sum;
}
