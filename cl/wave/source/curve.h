// Quadratic curve (Watanabe, Abe, Konno 2015, eq. 8-17): its struct, what it says of itself, and how clear of it a ray
// is. The field along a ray is in curve/field.h, where it peaks in curve/peaks.h, where a ray is cut in curve/panels.h.
#pragma once
#include "../footprint/closest.h"
#include "../quadrature/quadrature.h"
#include "../tiles/clearance.h"
#include "names.h"
#include "sources.h"

// C(t) - C(1/2) = along * (velocity_along x) + across * (velocity_across x + bend x^2), with x = t - 1/2.
typedef struct Curve {
    float4 middle, middle_rest;     // C(1/2)
    float4 velocity, velocity_rest; // C'(1/2)
    float4 second, second_rest;     // C2: C(t) = C(1/2) + C'(1/2) x + C2 x^2
    float4 along;                   // unit, in the plane of the curve, perpendicular to C2
    float4 across;                  // unit, in the plane of the curve, along C2
    float4 normal;                  // unit, perpendicular to the plane
    float4 emission;
    float velocity_along;
    float velocity_across;
    float bend;        // |C2|
    float vertex;      // x of the parabola's vertex, negated
    uint is_straight;  // 1: so straight that the cubic for the nearest point degenerates; 2: a line, run through evenly
    uint spline_begin; // row of the first of its pieces
    uint spline_count; // pieces of its local-intensity series; 0: intensity 1
    uint padding;
    Falloff falloff;
} Curve;
CHECK_SIZE(Curve, SIZEOF_CURVE);

#define curve_is_quick 0

#define curve_has_parts 1 // of its local intensity
#define curve_has_peaks_along 1
#define curve_has_kinks 1       // where the nearest point jumps;
#define curve_has_jumps 1       // with a local intensity the field does so too
#define curve_has_closed_ends 1 // panels from which an end is nearest
#define curve_has_dark_parts 1  // of its local intensity
#define curve_has_more_cuts 1   // for the pieces of its local intensity
#define curve_has_look_ahead 1  // for the numbers of roots

// These use the struct.
#include "curve/field.h"
#include "curve/panels.h"
#include "curve/peaks.h"

// Returns the clearance of both closest approaches of the ray's line, where the ray has them. Lengths are doubled.
Clearance curve_clearance(const Ray *const ray, const Sources *const sources, const uint index,
                          const float pixel_step) {
    const curve_peaks peaks = curve_peaks_along(ray, sources, index);
    const curve_path *const path = &peaks.path;
    const curve_sight first = curve_seen_from(path, clamp(peaks.first, 0.0f, ray->end));
    const curve_sight second = curve_seen_from(path, clamp(peaks.second, 0.0f, ray->end));
    const floatv softening2 = path->profile.softening2;
    const Clearance of_first = clear_by(ray, pixel_step, first.s, first.distance2 + softening2, &path->profile);
    const Clearance of_second = clear_by(ray, pixel_step, second.s, second.distance2 + softening2, &path->profile);
    Clearance clearance = nearer_of(of_first, of_second);
    if (SERIES_LENGTH(path)) {
        const float pieces = (float)SERIES_LENGTH(path);
        clearance.seen[0] = pieces * select(first.x, second.x, of_second.distance2 < of_first.distance2);
        clearance.seen[1] = pieces * curve_seen_from(path, splat(0.0f)).x;
        clearance.seen[2] = pieces * curve_seen_from(path, ray->end).x;
    }
    return clearance;
}

#ifdef FOOTPRINT
Closest curve_closest(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Curve *const curve = &sources->curve_list[index];
    const curve_peaks peaks = curve_peaks_along(ray, sources, index);
    const curve_path *const path = &peaks.path;
    const curve_sight first = curve_seen_from(path, clamp(peaks.first, 0.0f, ray->end));
    const curve_sight second = curve_seen_from(path, clamp(peaks.second, 0.0f, ray->end));
    const floatv per_first = inverse(fma(ray->stretch, first.s, splat(1.0f)));
    const floatv per_second = inverse(fma(ray->stretch, second.s, splat(1.0f)));
    const intv is_second = second.distance2 * per_second * per_second < first.distance2 * per_first * per_first;
    const floatv s = select(first.s, second.s, is_second), x = select(first.x, second.x, is_second);
    const curve_point point = curve_point_at(path, s);
    const curve_offset offset = offset_from_curve(path, &point, x);
    const float3v along = uniform3(curve->along), across = uniform3(curve->across), normal = uniform3(curve->normal);
    const float3v in_plane = fma3(across, offset.across, scale3(along, offset.along));
    const float3v tangent = fma3(across, curve_velocity_across(path, x), scale3(along, splat(path->velocity_along)));
    const Closest closest = {
        s,           scale3(fma3(normal, point.normal, in_plane), splat(-0.5f)),   tangent,
        splat(0.0f), SERIES_LENGTH(path) ? curve_intensity(path, x) : splat(1.0f), fabs(x) >= 0.5f};
    return closest;
}
#endif

#ifdef EXACT
#define KIND curve
#include "../quadrature/adaptive.h" // curve_integral
#undef KIND
#endif
