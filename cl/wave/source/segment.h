// Segment, a finite line: 1 over the distance to its nearest point, or over its square. The planes through its ends,
// perpendicular to it, cut a ray into three stretches, past one end, past the line and past the other end, each with a
// closed form. With -D CONVOLUTION there are segments all of whose points are added up (convolution.h).
#pragma once
#include "../../view.h"
#include "../footprint/closest.h"
#include "../quadrature/quadrature.h"
#include "../quadrature/stretch.h"
#include "../tiles/clearance.h"
#ifdef CONVOLUTION
#include "convolution.h"
#endif
#include "profile.h"
#include "quadratic.h"
#include "sources.h"

typedef struct Segment {
    float4 from, from_rest;
    float4 to, to_rest;
    float4 point, point_rest;         // the point of the whole line nearest to the eye
    float4 direction, direction_rest; // unit, from one end to the other
    float4 emission;
    Falloff falloff;
} Segment;
CHECK_SIZE(Segment, SIZEOF_SEGMENT);

#define segment_is_quick 1

// Lengths are doubled, but for heights.
typedef struct {
    Quadratic to_line, to_first, to_last; // squared distances: to the line, and to its ends
    Height over_first, over_last;         // over the planes through the ends, along the line
    Profile profile;
#ifdef CONVOLUTION
    bool is_convolved;
    float length; // doubled too
#endif
} segment_path;

// Leaves the distances to the ends out.
INLINE segment_path segment_line_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Segment *const segment = &sources->segment_list[index];
    const fine3v direction = fine3(segment->direction, segment->direction_rest);
    segment_path path;
    path.profile = profile_of(ray, &segment->falloff);
#ifdef CONVOLUTION
    // What is added up is softened, and has no other floor.
    path.is_convolved = segment->falloff.profile == 5u;
    if (path.is_convolved)
        path.profile.softening2 += path.profile.floor2;
    const float4 span = (segment->to - segment->from) + (segment->to_rest - segment->from_rest);
    path.length = 2.0f * sqrt(dot(span, span));
#endif
    const floatv softening2 = path.profile.softening2;
    path.to_line = distance2_to_line(ray, segment->point, segment->point_rest, segment->direction,
                                     segment->direction_rest, softening2);
    path.over_first = height_over(ray, segment->from, segment->from_rest, direction);
    path.over_last = height_over(ray, segment->to, segment->to_rest, direction);
    // A ray within one of the planes is level with the other.
    const intv is_level = (path.over_first.slope == 0.0f) | (path.over_last.slope == 0.0f);
    path.over_first.slope = select(path.over_first.slope, splat(0.0f), is_level);
    path.over_last.slope = select(path.over_last.slope, splat(0.0f), is_level);
    return path;
}

INLINE void segment_add_ends(segment_path *const path, const Ray *const ray, const Sources *const sources,
                             const uint index) {
    __global const Segment *const segment = &sources->segment_list[index];
    path->to_first = distance2_to_point(ray, segment->from, segment->from_rest, path->profile.softening2);
    path->to_last = distance2_to_point(ray, segment->to, segment->to_rest, path->profile.softening2);
}

PER_RAY_IF_WIDE segment_path segment_along(const Ray *const ray, const Sources *const sources, const uint index) {
    segment_path path = segment_line_along(ray, sources, index);
    segment_add_ends(&path, ray, sources, index);
    return path;
}

#ifdef SHAPES
// Returns whether the line alone lights the rays: where it does, they are beside it.
INLINE bool segment_is_line(const segment_path *const path, const Ray *const ray) {
    const Profile *const profile = &path->profile;
    const Quadratic *const to_line = &path->to_line;
    if (!HAS_END(profile))
        return false;
    const floatv left2 = left_at_least(profile, to_line);
    const floatv per_slope = inverse(max(to_line->slope, 1e-18f));
    const floatv half_length = 0.5f * twice_sqrt(max(left2, 1e-30f)) * per_slope;
    const floatv middle = fma(-to_line->ahead, per_slope, to_line->nearest);
    const floatv from = clamp(middle - half_length, 0.0f, ray->end), to = clamp(middle + half_length, 0.0f, ray->end);
    const floatv above = min(height_at(&path->over_first, from), height_at(&path->over_first, to));
    const floatv below = max(height_at(&path->over_last, from), height_at(&path->over_last, to));
    return !any_lane((left2 > 0.0f) & (to > from) & !((above >= 0.0f) & (below <= 0.0f)));
}
#endif

#ifdef CONVOLUTION
INLINE ConvolvedPiece segment_piece(const segment_path *const path) {
    ConvolvedPiece piece = {path->to_line,   path->to_first, path->to_last, path->over_first,
                            path->over_last, path->length,   1.0f,          0.0f};
    piece.over_first.at *= 2.0f, piece.over_first.slope *= 2.0f;
    piece.over_last.at *= 2.0f, piece.over_last.slope *= 2.0f;
    return piece;
}
#endif

floatv segment_field(const segment_path *const path, const floatv s) {
#ifdef CONVOLUTION
    if (path->is_convolved) {
        const ConvolvedPiece piece = segment_piece(path);
        return convolved_at(&piece, s);
    }
#endif
    const floatv over_first = height_at(&path->over_first, s), over_last = height_at(&path->over_last, s);
    const floatv beside = quadratic_at(&path->to_line, s);
    const floatv before = quadratic_at(&path->to_first, s), beyond = quadratic_at(&path->to_last, s);
    const floatv distance2 = select(select(beside, beyond, over_last > 0.0f), before, over_first < 0.0f);
    return field_at(&path->profile, distance2);
}

PER_RAY_IF_WIDE floatv segment_integral(const Ray *const ray, const Sources *const sources, const uint index,
                                        const Quadrature *const quadrature) {
    segment_path path = segment_line_along(ray, sources, index);
#ifdef SHAPES
    if (segment_is_line(&path, ray))
        return integral_over(evenly_lit(splat(0.0f), ray->end), &path.to_line, &path.profile, quadrature);
#endif
    segment_add_ends(&path, ray, sources, index);
#if defined(CONVOLUTION) && defined(EXACT)
    if (path.is_convolved) {
        const ConvolvedPiece piece = segment_piece(&path);
        return convolved_over(&piece, ray->end, quadrature);
    }
#endif
    const intv is_falling = path.over_first.slope <= -1e-30f;
    __global const Segment *const segment = &sources->segment_list[index];
    const fine3v direction = fine3(segment->direction, segment->direction_rest);
    const floatv close2 = FLOORS_OFF * FLOORS_OFF * path.profile.floor2;
    Cut at_first = climbs_through(&path.over_first, ray->end), at_last = climbs_through(&path.over_last, ray->end);
    refine_cut(&at_first, ray, &path.over_first, segment->from, segment->from_rest, direction,
               path.to_first.least < close2);
    refine_cut(&at_last, ray, &path.over_last, segment->to, segment->to_rest, direction, path.to_last.least < close2);
    const intv is_last_first = at_last.s < at_first.s;
    const Cut enters = select_cut(at_first, at_last, is_last_first),
              leaves = select_cut(at_last, at_first, is_last_first);
    const Quadratic to_near = select_quadratic(path.to_first, path.to_last, is_falling);
    const Quadratic to_far = select_quadratic(path.to_last, path.to_first, is_falling);
    return integral_over(between(cut_at(splat(0.0f)), enters), &to_near, &path.profile, quadrature) +
           integral_over(between(enters, leaves), &path.to_line, &path.profile, quadrature) +
           integral_over(between(leaves, cut_at(ray->end)), &to_far, &path.profile, quadrature);
}

// Returns the clearance of the line where the ray passes between the ends, else of the nearer end. Lengths are doubled.
Clearance segment_clearance(const Ray *const ray, const Sources *const sources, const uint index,
                            const float pixel_step) {
    const segment_path path = segment_along(ray, sources, index);
    const floatv s = clamp(path.to_line.nearest, 0.0f, ray->end);
    const intv is_beside = (height_at(&path.over_first, s) >= 0.0f) & (height_at(&path.over_last, s) <= 0.0f);
    const Clearance of_line = quadratic_clearance(ray, &path.to_line, &path.profile, pixel_step);
    const Clearance of_ends = nearer_of(quadratic_clearance(ray, &path.to_first, &path.profile, pixel_step),
                                        quadratic_clearance(ray, &path.to_last, &path.profile, pixel_step));
    return select_clearance(of_ends, nearer_of(of_line, of_ends), is_beside);
}

#ifdef FOOTPRINT
Closest segment_closest(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Segment *const segment = &sources->segment_list[index];
    const segment_path path = segment_along(ray, sources, index);
    const floatv s = path.to_line.nearest;
    const intv is_before = height_at(&path.over_first, s)<0.0f, is_beyond = height_at(&path.over_last, s)> 0.0f;
    const Closest to_line =
        closest_to_line(ray, fine3(segment->point, segment->point_rest), uniform3(segment->direction), s);
    const Closest to_first = closest_to_point(ray, fine3(segment->from, segment->from_rest), path.to_first.nearest);
    const Closest to_last = closest_to_point(ray, fine3(segment->to, segment->to_rest), path.to_last.nearest);
    Closest closest = select_closest(select_closest(to_line, to_first, is_before), to_last, is_beyond);
    closest.along = to_line.along;
    closest.is_end = is_before | is_beyond;
    return closest;
}
#endif
