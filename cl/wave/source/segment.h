// Segment, a finite line: 1 over the distance to its nearest point, or over its square. The planes through its ends,
// perpendicular to it, cut a ray into three stretches, past one end, past the line and past the other end, each with a
// closed form.
#pragma once
#include "../../view.h"
#include "../quadrature/quadrature.h"
#include "../quadrature/stretch.h"
#include "../tiles/clearance.h"
#include "profile.h"
#include "quadratic.h"
#include "sources.h"

typedef struct Segment {
    float4 from, from_rest;
    float4 to, to_rest;
    float4 point, point_rest;         // the point of the whole line nearest to the eye
    float4 direction, direction_rest; // unit, from one end to the other
    float4 emission;
    uint is_square;
    uint padding_0, padding_1, padding_2;
} Segment;
CHECK_SIZE(Segment, SIZEOF_SEGMENT);

// Lengths are doubled, but for heights.
typedef struct {
    Quadratic to_line, to_first, to_last; // squared distances: to the line, and to its ends
    floatv over_first, over_last;         // heights over the planes through the ends, along the line
    floatv height_slope;
    floatv floor2;
    uint is_square;
} segment_path;

INLINE floatv segment_height(const Ray *const ray, const float4 end, const float4 end_rest, const fine3v direction) {
    return from_finev(fine_dot3(fine_between(ray, splat(0.0f), end, end_rest), direction));
}

INLINE segment_path segment_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Segment *const segment = &sources->segment_list[index];
    const fine3v direction = fine3(segment->direction, segment->direction_rest);
    segment_path path;
    path.to_line =
        distance2_to_line(ray, segment->point, segment->point_rest, segment->direction, segment->direction_rest);
    path.to_first = distance2_to_point(ray, segment->from, segment->from_rest);
    path.to_last = distance2_to_point(ray, segment->to, segment->to_rest);
    path.over_first = segment_height(ray, segment->from, segment->from_rest, direction);
    path.over_last = segment_height(ray, segment->to, segment->to_rest, direction);
    path.height_slope = ray->stretch * from_finev(fine_dot3(ray->fine_toward, direction));
    path.floor2 = 4.0f * ray->floor2;
    path.is_square = IS_SQUARE(segment);
    return path;
}

floatv segment_field(const segment_path *const path, const floatv s) {
    const floatv over_first = fma(path->height_slope, s, path->over_first);
    const floatv over_last = fma(path->height_slope, s, path->over_last);
    const floatv beside = quadratic_at(&path->to_line, s);
    const floatv before = quadratic_at(&path->to_first, s), beyond = quadratic_at(&path->to_last, s);
    const floatv distance2 = select(select(beside, beyond, over_last > 0.0f), before, over_first < 0.0f);
    return profiled(twice_inverse_sqrt(max(distance2, path->floor2)), path->is_square);
}

INLINE Quadratic segment_select(const Quadratic a, const Quadratic b, const intv is_b) {
    const Quadratic q = {select(a.slope, b.slope, is_b), select(a.offset, b.offset, is_b),
                         select(a.least, b.least, is_b), select(a.nearest, b.nearest, is_b),
                         select(a.missed, b.missed, is_b)};
    return q;
}

INLINE floatv segment_integral(const Ray *const ray, const Sources *const sources, const uint index,
                               const Quadrature *const quadrature) {
    const segment_path path = segment_along(ray, sources, index);
    const Decay decay = quadrature->decay;
    const intv is_falling = path.height_slope <= -1e-30f;
    const floatv at_first = climbs_through(path.over_first, path.height_slope, ray->end);
    const floatv at_last = climbs_through(path.over_last, path.height_slope, ray->end);
    const floatv begin = min(at_first, at_last), end = max(at_first, at_last);
    const Quadratic to_near = segment_select(path.to_first, path.to_last, is_falling);
    const Quadratic to_far = segment_select(path.to_last, path.to_first, is_falling);
    return integral_over(evenly_lit(splat(0.0f), begin), &to_near, path.floor2, decay, path.is_square) +
           integral_over(evenly_lit(begin, end), &path.to_line, path.floor2, decay, path.is_square) +
           integral_over(evenly_lit(end, ray->end), &to_far, path.floor2, decay, path.is_square);
}

// Returns the clearance of the line where the ray passes between the ends, else of the nearer end. Lengths are doubled.
Clearance segment_clearance(const Ray *const ray, const Sources *const sources, const uint index,
                            const float pixel_step) {
    const segment_path path = segment_along(ray, sources, index);
    const floatv s = clamp(path.to_line.nearest, 0.0f, ray->end);
    const intv is_beside =
        (fma(path.height_slope, s, path.over_first) >= 0.0f) & (fma(path.height_slope, s, path.over_last) <= 0.0f);
    const floatv of_line = quadratic_clearance(ray, &path.to_line, pixel_step).distance2;
    const floatv of_first = quadratic_clearance(ray, &path.to_first, pixel_step).distance2;
    const floatv of_ends = min(of_first, quadratic_clearance(ray, &path.to_last, pixel_step).distance2);
    return clear_by(select(of_ends, min(of_line, of_ends), is_beside));
}
