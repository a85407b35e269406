// The integral of a field whose squared distance is a quadratic, over a stretch of a ray: in closed form, 1 / distance
// or its square, and finite where the ray meets the core; by nodes where the field has another shape.
#pragma once
#include "closed_form.h"
#include "closed_form_square.h"
#include "quadrature.h"
#include "shape.h"

INLINE floatv without_floor(const Quadratic *const distance2, const Decay decay, const Stretch stretch, const floatv x0,
                            const floatv x1, const uint is_square) {
    const Ends ends = ends_of(distance2, decay, stretch, x0, x1);
    return is_square ? inverse_square_over(&ends, distance2->least) : inverse_over(&ends, distance2->least);
}

Stretch part_of(const Stretch stretch, const floatv from, const floatv to) {
    const floatv per_length = inverse(max(stretch.to - stretch.from, 1e-30f));
    const floatv growth = (stretch.light_to - stretch.light_from) * per_length;
    const Stretch part = {from,
                          to,
                          fma(growth, from - stretch.from, stretch.light_from),
                          fma(growth, to - stretch.from, stretch.light_from),
                          splat(0.0f),
                          splat(0.0f)};
    return part;
}

// Returns the mean of x over a stretch, 0 at its beginning and 1 at its end, weighted with the decay: -r (log r + u) /
// u^2 for a nearness that falls by the factor r = 1 - u.
floatv middle_of(const floatv n0, const floatv n1) {
    const floatv r = n1 * inverse(n0), u = max((n0 - n1) * inverse(n0), 0.0f);
    const floatv series = fma(fma(fma(splat(0.2f), u, splat(0.25f)), u, splat(1.0f / 3.0f)), u, splat(0.5f));
    const floatv exact = -(LN_2 * binary_logarithm(max(r, 1e-30f)) + u) * inverse(max(u * u, 1e-6f));
    return r * select(exact, series, u < 0.03f);
}

// Integrates where the ray comes closer to the core than the floor of all distances, within which the field is
// constant: a ray in a million. So short a part has no digits left in s, only in x = slope s + offset.
CALL_IF_SCALAR floatv with_floor(const Quadratic *const distance2, const floatv floor2, const Decay decay,
                                 const Stretch stretch, const floatv x0, const floatv x1, const uint is_square) {
    const floatv per_slope = inverse(max(distance2->slope, 1e-18f));
    const floatv reach = 0.5f * twice_sqrt(max(floor2 - distance2->least, 1e-36f));
    const floatv x_begin = clamp(-reach, x0, x1), x_end = clamp(reach, x0, x1);
    floatv begin = clamp(fma(x_begin - distance2->ahead, per_slope, distance2->nearest), stretch.from, stretch.to);
    begin = select(select(begin, stretch.from, x0 >= -reach), stretch.to, x1 <= -reach);
    floatv end = clamp(fma(x_end - distance2->ahead, per_slope, distance2->nearest), stretch.from, stretch.to);
    end = select(select(end, stretch.to, x1 <= reach), stretch.from, x0 >= reach);
    const Stretch before = part_of(stretch, stretch.from, begin), after = part_of(stretch, end, stretch.to);
    const intv is_all = (x0 > -reach) & (x1 < reach);
    const floatv length = select((x_end - x_begin) * per_slope, stretch.to - stretch.from, is_all);
    const floatv n0 = nearness(decay, begin), n1 = nearness(decay, end);
    const floatv inside = decay.beta > 0.0f ? length * n0 * n1 * decay.per_beta : length;
    const floatv light = fma(after.light_from - before.light_to, middle_of(n0, n1), before.light_to);
    const floatv field = profiled(0.5f * twice_inverse_sqrt_(floor2), is_square);
    floatv integral = inside * light * field;
    Stretch side = before;
    floatv side_x0 = x0, side_x1 = x_begin;
#pragma unroll 1
    for (uint k = 0; k < 2; ++k) {
        integral += without_floor(distance2, decay, side, side_x0, side_x1, is_square);
        side = after, side_x0 = x_end, side_x1 = x1;
    }
    return integral;
}

// Integrates over a stretch. Lengths are doubled, the integral is not.
INLINE floatv integral_over(const Stretch stretch, const Quadratic *const distance2, const Profile *const profile,
                            const Quadrature *const quadrature) {
#if defined(SHAPES) && defined(EXACT)
    if (IS_SHAPED(profile))
        return shape_over(stretch, distance2, profile, quadrature);
#endif
    const Decay decay = quadrature->decay;
    const floatv floor2 = profile->floor2;
    const uint is_square = IS_SQUARE(profile);
    const floatv x0 = along_at(distance2, stretch.from, stretch.from_rest);
    const floatv x1 = along_at(distance2, stretch.to, stretch.to_rest);
    floatv over_v = without_floor(distance2, decay, stretch, x0, x1, is_square);
    const intv is_floored = distance2->least < floor2;
    if (any_lane(is_floored))
        over_v = select(over_v, with_floor(distance2, floor2, decay, stretch, x0, x1, is_square), is_floored);
    return (is_square ? 4.0f : 2.0f) * decay.strength * over_v;
}

// A height over a plane, along a ray.
typedef struct {
    floatv at, slope;
} Height;

// A ray whose height does not leave 0 by more than this of its size runs within the plane.
#define WITHIN_PLANE 1e-12f

// Returns a ray's height over the plane through a point, perpendicular to a direction.
INLINE Height height_over(const Ray *const ray, const float4 point, const float4 point_rest, const fine3v direction) {
    const fine3v from_point = fine_between(ray, splat(0.0f), point, point_rest);
    Height height = {from_finev(fine_dot3(from_point, direction)),
                     ray->stretch * from_finev(fine_dot3(ray->fine_toward, direction))};
    const floatv most = max(fabs(height.at), fabs(height.at + height.slope));
    if (any_lane(most < 1e-6f * ray->length)) {
        const float3v size = from_fine3(from_point);
        const intv is_within = most < WITHIN_PLANE * (fabs(size.x) + fabs(size.y) + fabs(size.z) + ray->length);
        height.at = select(height.at, splat(0.0f), is_within);
        height.slope = select(height.slope, splat(0.0f), is_within);
    }
    return height;
}

floatv height_at(const Height *const height, const floatv s) {
    return fma(height->slope, s, height->at);
}

// Returns where a value that is linear along a ray is 0; a ray where it never is stays on its side.
floatv zero_along(const floatv at, const floatv slope, const floatv end) {
    return clamp(-at / select(slope, splat(1e-30f), fabs(slope) < 1e-30f), 0.0f, end);
}

// Returns where a ray climbs through a plane: there a stretch ends.
Cut climbs_through(const Height *const height, const floatv end) {
    return cut_at(zero_along(height->at, height->slope, end));
}

// A ray this many floors from a core, or closer, needs all digits of where a stretch ends at the core.
#define FLOORS_OFF 100.0f

// Refines such a cut in the lanes where the ray passes that close.
INLINE void refine_cut(Cut *const cut, const Ray *const ray, const Height *const height, const float4 point,
                       const float4 point_rest, const fine3v direction, const intv is_close) {
    const intv counts = is_close & (cut->s > 0.0f) & (cut->s < ray->end) & (height->slope != 0.0f);
    if (!any_lane(counts))
        return;
    const floatv missed = from_finev(fine_dot3(fine_between(ray, cut->s, point, point_rest), direction));
    const floatv slope = select(splat(1.0f), height->slope, counts);
    cut->rest = select(splat(0.0f), clamp(-missed / slope, -1e-6f, 1e-6f), counts);
}
