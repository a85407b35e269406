// Quadratic curve: S(t*) / |P - C(t*)|, C(t*) the nearest point (Watanabe, Abe, Konno 2015, eq. 8-17). In the curve's
// own frame it is a plane parabola; P runs linearly through the frame, and with it the coefficients of the cubic for
// t*.
#pragma once
#include "../../../roots.h"
#include "../../../view.h"
#include "../cubic.h"
#include "../profile.h"
#include "../sources.h"
#include "../spline.h"

// A value that is linear along the ray: at + s slope.
typedef struct {
    floatv at, slope;
} Linear;

Linear linear(const floatv at, const floatv slope) {
    const Linear l = {at, slope};
    return l;
}

floatv linear_at(const Linear l, const floatv s) {
    return fma(l.slope, s, l.at);
}

// Lengths are doubled; p, h and the parameter are not lengths.
typedef struct {
    Linear along, across, normal; // P in the curve's frame, from C(1/2)
    Linear p, h;                  // of the cubic u^3 + 3 p u + 2 h = 0 for u = t - 1/2 + vertex
    float velocity_along, velocity_across, bend, vertex;
    float inverse_speed2; // 1 / |C'(1/2)|^2, 0 for a point
    uint is_straight, is_line, spline_count;
    __global const float4 *pieces;
    Profile profile;
} curve_path;

INLINE curve_path curve_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Curve *const curve = &sources->curve_list[index];
    const float3v from_middle = subtract3(ray->origin, uniform3(curve->middle));
    const float3v along = uniform3(curve->along), across = uniform3(curve->across), normal = uniform3(curve->normal);
    curve_path path;
    path.along = linear(2.0f * dot3(from_middle, along), 2.0f * dot3(ray->span, along));
    path.across = linear(2.0f * dot3(from_middle, across), 2.0f * dot3(ray->span, across));
    path.normal = linear(2.0f * dot3(from_middle, normal), 2.0f * dot3(ray->span, normal));
    path.velocity_along = 2.0f * curve->velocity_along;
    path.velocity_across = 2.0f * curve->velocity_across;
    path.bend = 2.0f * curve->bend;
    path.vertex = curve->vertex;
    path.is_straight = curve->is_straight > 0u, path.is_line = curve->is_straight == 2u;
    path.spline_count = curve->spline_count;
    path.pieces = sources->rows + curve->spline_begin;
    path.profile = profile_of(ray, &curve->falloff);

    // From |C2|^2 (2 u^3) + (velocity^2 - 2 bend Y) u - velocity X = 0, (X, Y) = P from the parabola's vertex.
    const float speed2 = fma(path.velocity_along, path.velocity_along, path.velocity_across * path.velocity_across);
    path.inverse_speed2 = speed2 > 1e-36f ? 1.0f / speed2 : 0.0f;
    const float turn = path.velocity_along / (path.is_straight ? 1.0f : path.bend);
    const float per_bend = 1.0f / (path.is_straight ? 1.0f : path.bend);
    const float vertex2 = path.vertex * path.vertex;
    path.p.at = fma(turn, turn * 0.5f, -vertex2) / 3.0f - path.across.at * (per_bend / 3.0f);
    path.p.slope = -path.across.slope * (per_bend / 3.0f);
    path.h.at = -0.25f * turn * fma(path.along.at, splat(per_bend), splat(turn * path.vertex));
    path.h.slope = -0.25f * turn * per_bend * path.along.slope;
    return path;
}

// A point of the ray in the curve's frame, seen from the core point C(1/2 + core), with its cubic.
typedef struct {
    floatv along, across, normal;
    floatv p, h;
    floatv core;
} curve_point;

INLINE curve_point curve_point_at(const curve_path *const path, const floatv s) {
    const curve_point point = {linear_at(path->along, s), linear_at(path->across, s), linear_at(path->normal, s),
                               linear_at(path->p, s),     linear_at(path->h, s),      splat(0.0f)};
    return point;
}

// From C(1/2 + x) to the point, in the plane of the curve.
typedef struct {
    floatv along, across;
} curve_offset;

INLINE curve_offset offset_from_curve(const curve_path *const path, const curve_point *const point, const floatv x) {
    const floatv ahead = x - point->core;
    const floatv chord_across = fma(splat(path->bend), x + point->core, splat(path->velocity_across));
    const curve_offset offset = {fma(-path->velocity_along, ahead, point->along),
                                 fma(-chord_across, ahead, point->across)};
    return offset;
}

// Returns the squared distance to C(1/2 + x), without softening.
INLINE floatv curve_distance2(const curve_path *const path, const curve_point *const point, const floatv x) {
    const curve_offset offset = offset_from_curve(path, point, x);
    return fma(offset.along, offset.along, fma(offset.across, offset.across, point->normal * point->normal));
}

// Returns the across component of C'(1/2 + x); the one along is velocity_along.
floatv curve_velocity_across(const curve_path *const path, const floatv x) {
    return fma(splat(2.0f * path->bend), x, splat(path->velocity_across));
}

// Finds the nearest point of a curve that is a line, run through evenly: the foot of the perpendicular, or an end.
INLINE floatv nearest_on_line(const curve_path *const path, const curve_point *const point, floatv *const distance2) {
    const floatv foot = fma(point->along, path->velocity_along * path->inverse_speed2, point->core);
    const floatv x = clamp(foot, -0.5f, 0.5f), beyond = path->velocity_along * (foot - x);
    *distance2 = fma(beyond, beyond, fma(point->across, point->across, point->normal * point->normal));
    return x;
}

// Finds the nearest point of a curve that is all but straight: the foot on the tangent at the core point, corrected for
// the bend by Newton steps; or an end, where the curve turns away.
floatv nearest_on_straight(const curve_path *const path, const curve_point *const point, floatv *const distance2) {
    const floatv to_foot = fma(point->along, path->velocity_along, point->across * path->velocity_across);
    floatv x = clamp(fma(to_foot, path->inverse_speed2, point->core), -0.5f, 0.5f);
    for (int step = 0; step < 2; ++step) {
        const curve_offset offset = offset_from_curve(path, point, x);
        const floatv slope = fma(offset.along, path->velocity_along, offset.across * curve_velocity_across(path, x));
        const floatv curvature = max(1.0f - 2.0f * path->bend * offset.across * path->inverse_speed2, 0.25f);
        x = clamp(fma(slope / curvature, path->inverse_speed2, x), -0.5f, 0.5f);
    }
    *distance2 = curve_distance2(path, point, x);
    for (float end = -0.5f; end < 1.0f; end += 1.0f) {
        const floatv to_end = curve_distance2(path, point, splat(end));
        x = select(x, splat(end), to_end < *distance2);
        *distance2 = min(*distance2, to_end);
    }
    return x;
}

// Returns where the cubic has three real roots.
INLINE intv has_three_roots(const floatv p, const floatv h) {
    return fma(p * p, p, h * h) <= 0.0f;
}

// Which numbers of roots occur among the lanes.
typedef struct {
    bool one, three;
} RootCounts;

INLINE RootCounts roots_at(const curve_point *const point) {
    const intv has_three = has_three_roots(point->p, point->h);
    const RootCounts counts = {any_lane(!has_three), any_lane(has_three)};
    return counts;
}

// Finds x = t* - 1/2 of the nearest point, and its squared distance. The middle root of three is a greatest distance;
// the outer ones, clamped to the curve, stand for its ends too. Of two equally near points the one with less t wins.
INLINE floatv nearest_of_roots(const curve_path *const path, const curve_point *const point, const RootCounts counts,
                               floatv *const distance2) {
    if (path->is_line)
        return nearest_on_line(path, point, distance2);
    if (path->is_straight)
        return nearest_on_straight(path, point, distance2);
    const floatv p = point->p, h = point->h;
    const floatv discriminant = fma(p * p, p, h * h);
    floatv nearest = splat(0.0f);
    *distance2 = splat(0.0f);
    if (counts.one) {
        nearest = clamp(single_root(p, h, discriminant) - path->vertex, -0.5f, 0.5f);
        *distance2 = curve_distance2(path, point, nearest);
    }
    if (counts.three) {
        floatv first, second;
        outer_roots(p, h, &first, &second);
        first = clamp(first - path->vertex, -0.5f, 0.5f);
        second = clamp(second - path->vertex, -0.5f, 0.5f);
        const floatv to_first = curve_distance2(path, point, first);
        const floatv to_second = curve_distance2(path, point, second);
        const intv has_three = discriminant <= 0.0f;
        *distance2 = select(*distance2, min(to_first, to_second), has_three);
        nearest = select(nearest, select(first, second, to_second < to_first), has_three);
    }
    return nearest;
}

INLINE floatv nearest_on_curve(const curve_path *const path, const curve_point *const point, floatv *const distance2) {
    return nearest_of_roots(path, point, roots_at(point), distance2);
}

// Returns the local intensity at C(1/2 + x).
INLINE floatv curve_intensity(const curve_path *const path, const floatv x) {
    return spline_at(path->pieces, SERIES_LENGTH(path), x + 0.5f);
}

INLINE floatv curve_field(const curve_path *const path, const floatv s) {
    const curve_point point = curve_point_at(path, s);
    floatv distance2;
    const floatv x = nearest_on_curve(path, &point, &distance2);
    const floatv field = field_at(&path->profile, distance2 + path->profile.softening2);
    return SERIES_LENGTH(path) ? field * curve_intensity(path, x) : field;
}
