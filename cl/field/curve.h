// Quadratic curve: S(t*) / |P - C(t*)|, C(t*) the nearest point (Watanabe, Abe, Konno 2015, eq. 8-17). In the curve's
// own frame it is a plane parabola; P runs linearly through the frame, and with it the coefficients of the cubic for
// t*.
#pragma once
#include "../ray.h"
#include "../sources.h"
#include "cubic.h"
#include "spline.h"

// A value that is linear along the ray: at + s slope.
typedef struct {
    floatv at, slope;
} Linear;

floatv linear_at(const Linear l, const floatv s) {
    return fma(l.slope, s, l.at);
}

typedef struct {
    Linear along, across, normal; // P in the curve's frame, from C(1/2)
    Linear p, h;                  // of the cubic u^3 + 3 p u + 2 h = 0 for u = t - 1/2 + vertex
    float velocity_along, velocity_across, bend, vertex;
    float inverse_speed2; // 1 / |C'(1/2)|^2, 0 for a point
    uint is_straight, spline_count;
    __global const SplinePiece *pieces;
    floatv softening2, floor2;
} curve_path;

curve_path curve_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Curve *const curve = &sources->curves[index];
    const float3v from_middle = subtract3(ray->origin, uniform3(curve->middle));
    const float3v along = uniform3(curve->along), across = uniform3(curve->across), normal = uniform3(curve->normal);
    curve_path path;
    path.along.at = dot3(from_middle, along), path.along.slope = dot3(ray->span, along);
    path.across.at = dot3(from_middle, across), path.across.slope = dot3(ray->span, across);
    path.normal.at = dot3(from_middle, normal), path.normal.slope = dot3(ray->span, normal);
    path.velocity_along = curve->velocity_along;
    path.velocity_across = curve->velocity_across;
    path.bend = curve->bend;
    path.vertex = curve->vertex;
    path.is_straight = curve->is_straight;
    path.spline_count = curve->spline_count;
    path.pieces = sources->spline_pieces + curve->spline_begin;
    path.softening2 = ray->softening2;
    path.floor2 = ray->floor2;

    // From |C2|^2 (2 u^3) + (velocity^2 - 2 bend Y) u - velocity X = 0, (X, Y) = P from the parabola's vertex.
    const float speed2 = fma(path.velocity_along, path.velocity_along, path.velocity_across * path.velocity_across);
    path.inverse_speed2 = speed2 > 0.0f ? 1.0f / speed2 : 0.0f;
    const float turn = path.velocity_along / (path.is_straight ? 1.0f : path.bend);
    const float per_bend = 1.0f / (path.is_straight ? 1.0f : path.bend);
    const float vertex2 = path.vertex * path.vertex;
    path.p.at = fma(turn, turn * 0.5f, -vertex2) / 3.0f - path.across.at * (per_bend / 3.0f);
    path.p.slope = -path.across.slope * (per_bend / 3.0f);
    path.h.at = -0.25f * turn * fma(path.along.at, splat(per_bend), splat(turn * path.vertex));
    path.h.slope = -0.25f * turn * per_bend * path.along.slope;
    return path;
}

// Squared distance from a point of the frame to C(1/2 + x), without softening.
floatv curve_distance2(const curve_path *const path, const floatv along, const floatv across, const floatv normal,
                       const floatv x) {
    const floatv a = fma(-path->velocity_along, x, along);
    const floatv b = fma(-fma(splat(path->bend), x, splat(path->velocity_across)), x, across);
    return fma(a, a, fma(b, b, normal * normal));
}

// Nearest point of a curve that is all but straight: the foot on the tangent at C(1/2), then corrected for the bend.
floatv nearest_on_straight(const curve_path *const path, const floatv along, const floatv across) {
    const floatv to_foot = fma(along, path->velocity_along, across * path->velocity_across);
    floatv x = clamp(to_foot * path->inverse_speed2, -0.5f, 0.5f);
    for (int step = 0; step < 2; ++step) {
        const floatv a = fma(-path->velocity_along, x, along);
        const floatv b = fma(-fma(splat(path->bend), x, splat(path->velocity_across)), x, across);
        const floatv velocity_across = fma(splat(2.0f * path->bend), x, splat(path->velocity_across));
        const floatv slope = fma(a, path->velocity_along, b * velocity_across);
        x = clamp(fma(slope, path->inverse_speed2, x), -0.5f, 0.5f);
    }
    return x;
}

// x = t* - 1/2 of the nearest point, and its squared distance. The middle root of three is a greatest distance; the
// outer ones, clamped to the curve, stand for its ends too. Of two equally near points the one with less t wins.
floatv nearest_on_curve(const curve_path *const path, const floatv s, floatv *const distance2) {
    const floatv along = linear_at(path->along, s);
    const floatv across = linear_at(path->across, s);
    const floatv normal = linear_at(path->normal, s);
    if (path->is_straight) {
        const floatv x = nearest_on_straight(path, along, across);
        *distance2 = curve_distance2(path, along, across, normal, x);
        return x;
    }
    const floatv p = linear_at(path->p, s);
    const floatv h = linear_at(path->h, s);
    const floatv discriminant = fma(h, h, p * p * p);
    const intv is_single = discriminant > 0.0f;
    floatv first = single_root(p, h, discriminant);
    floatv second = first;
    if (any_lane(!is_single)) {
        floatv least, greatest;
        outer_roots(p, h, &least, &greatest);
        first = select(least, first, is_single);
        second = select(greatest, second, is_single);
    }
    first = clamp(first - path->vertex, -0.5f, 0.5f);
    second = clamp(second - path->vertex, -0.5f, 0.5f);
    const floatv to_first = curve_distance2(path, along, across, normal, first);
    const floatv to_second = curve_distance2(path, along, across, normal, second);
    *distance2 = min(to_first, to_second);
    return select(first, second, to_second < to_first);
}

floatv curve_field(const curve_path *const path, const floatv s) {
    floatv distance2;
    const floatv x = nearest_on_curve(path, s, &distance2);
    const floatv field = inverse_sqrt(max(distance2 + path->softening2, path->floor2));
    return path->spline_count ? field * spline_at(path->pieces, path->spline_count, x + 0.5f) : field;
}
