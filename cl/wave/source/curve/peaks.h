// Where a curve's field peaks along a ray, and the field beside such a point.
//
// Seen along the ray the curve is a plane parabola, and the ray a point: where they come closest solves a cubic
// equation again. There the squared distance is about q(s) = e (s - s0)^2 + .., which has the field's value, slope and
// curvature: e = |Q|^2 - (Q.C')^2 / (|C'|^2 - (P - C).C''), Q = E - S.
#pragma once
#include "../../quadrature/panel.h"
#include "field.h"

typedef struct {
    curve_path path;
    floatv span2;         // |E - S|^2
    floatv first, second; // parameters s of the closest approaches; the same where there is but one
    floatv first_distance2, second_distance2;
    intv are_two;
    Linear beyond_first, beyond_last; // (P - C).C' at both ends
    floatv begin, end;                // where the ray is lit
    const Ray *ray;
    __global const Curve *curve;
} curve_peaks;

// Finds the outer roots of the depressed cubic; both are the single root where there is one.
INLINE intv least_and_greatest_root(const floatv p, const floatv h, floatv *const least, floatv *const greatest) {
    const floatv discriminant = fma(p * p, p, h * h);
    const intv has_three = discriminant <= 0.0f;
    const floatv single = single_root(p, h, discriminant);
    *least = single, *greatest = single;
    if (any_lane(has_three)) {
        floatv low, high;
        outer_roots(p, h, &low, &high);
        *least = select(single, low, has_three);
        *greatest = select(single, high, has_three);
    }
    return has_three;
}

// Returns the parameter s at which the ray passes closest to C(1/2 + x), and its squared distance there.
floatv closest_to_core(const curve_path *const path, const floatv span2, const floatv x, floatv *const distance2) {
    curve_point origin = curve_point_at(path, splat(0.0f));
    const curve_offset offset = offset_from_curve(path, &origin, x);
    const floatv s = -fma(offset.along, path->along.slope,
                          fma(offset.across, path->across.slope, origin.normal * path->normal.slope)) *
                     inverse(span2);
    const floatv a = fma(s, path->along.slope, offset.along), b = fma(s, path->across.slope, offset.across);
    const floatv c = fma(s, path->normal.slope, origin.normal);
    *distance2 = fma(a, a, fma(b, b, c * c));
    return s;
}

// Returns (P - C).C' at an end of the curve, along the ray.
Linear beyond_end(const curve_path *const path, const float x) {
    const float velocity_across = fma(2.0f * path->bend, x, path->velocity_across);
    const float end_along = path->velocity_along * x;
    const float end_across = fma(path->bend, x, path->velocity_across) * x;
    return linear(
        fma(path->along.at - end_along, splat(path->velocity_along), (path->across.at - end_across) * velocity_across),
        fma(path->along.slope, splat(path->velocity_along), path->across.slope * velocity_across));
}

CALL_IF_SCALAR curve_peaks curve_peaks_along(const Ray *const ray, const Sources *const sources, const uint index) {
    curve_peaks peaks;
    peaks.path = curve_along(ray, sources, index);
    peaks.ray = ray;
    peaks.curve = &sources->curve_list[index];
    const curve_path *const path = &peaks.path;
    peaks.span2 = 4.0f * dot3(ray->span, ray->span);
    const floatv per_length = 0.5f * twice_inverse_sqrt_(peaks.span2);
    const floatv along = path->along.slope * per_length, across = path->across.slope * per_length;
    const floatv normal = path->normal.slope * per_length;
    floatv x_first, x_second;
    if (path->is_straight) {
        // The foot of the common perpendicular.
        const floatv climb = fma(along, path->velocity_along, across * path->velocity_across);
        const floatv to_origin = fma(path->along.at, along, fma(path->across.at, across, path->normal.at * normal));
        const floatv speed2 = fma(-climb, climb, splat(1.0f / max(path->inverse_speed2, 1e-36f)));
        const floatv foot = fma(path->along.at, path->velocity_along, path->across.at * path->velocity_across);
        x_first = clamp(fma(-climb, to_origin, foot) * inverse(max(speed2, 1e-36f)), -0.5f, 0.5f);
        x_second = x_first;
        peaks.are_two = x_first > x_second;
    } else {
        // The cubic of the parabola seen along the ray, from its vertex, in units of the bend.
        const float per_bend = 1.0f / path->bend, turn = path->velocity_along * per_bend;
        const floatv x = fma(path->along.at, splat(per_bend), splat(turn * path->vertex));
        const floatv y = fma(path->across.at, splat(per_bend), splat(path->vertex * path->vertex));
        const floatv to_origin = fma(x, along, fma(y, across, path->normal.at * per_bend * normal));
        const floatv x0 = fma(-to_origin, along, x), y0 = fma(-to_origin, across, y);
        const floatv flat = max(fma(along, along, normal * normal), 1e-3f);
        const floatv per_flat = inverse(flat);
        const floatv shift = 0.5f * turn * along * across * per_flat;
        const floatv linear_term = fma(splat(0.5f * turn * turn), fma(across, across, normal * normal), -y0) * per_flat;
        const floatv last_term = -0.5f * turn * x0 * per_flat;
        const floatv p = fma(-shift, shift, linear_term * (1.0f / 3.0f));
        const floatv h = 0.5f * fma(shift, fma(-2.0f * shift, shift, linear_term), last_term);
        const intv has_three = least_and_greatest_root(p, h, &x_first, &x_second);
        x_first = clamp(x_first + shift - path->vertex, -0.5f, 0.5f);
        x_second = clamp(x_second + shift - path->vertex, -0.5f, 0.5f);
        peaks.are_two = has_three & (x_second - x_first > 1e-3f);
    }
    peaks.first = closest_to_core(path, peaks.span2, x_first, &peaks.first_distance2);
    peaks.second = closest_to_core(path, peaks.span2, x_second, &peaks.second_distance2);
    peaks.beyond_first = beyond_end(path, -0.5f);
    peaks.beyond_last = beyond_end(path, 0.5f);
    peaks.begin = splat(0.0f), peaks.end = ray->end;
    if (HAS_END(&path->profile)) {
        const float speed =
            sqrt(path->velocity_along * path->velocity_along + path->velocity_across * path->velocity_across);
        const float radius = 0.25f * speed + 0.125f * fabs(path->bend);
        clip_to_ball(ray, peaks.curve->middle, radius, &path->profile, &peaks.begin, &peaks.end);
    }
    return peaks;
}

#ifdef SHAPES
// A curve that is bent towards the ray lets its nearest point slide faster, by so much at most.
#define MOST_SLIDING 10.0f

// Returns the squared distance at s, without softening, its slope there, and half of its curvature: of the way to the
// nearest point, which slides along the curve unless it is an end.
INLINE EdgeView curve_edge_view(const curve_peaks *const peaks, const floatv s) {
    const curve_path *const path = &peaks->path;
    const curve_point point = curve_point_at(path, s);
    EdgeView view;
    const floatv x = nearest_on_curve(path, &point, &view.distance2);
    const curve_offset offset = offset_from_curve(path, &point, x);
    view.slope = 2.0f * fma(offset.along, path->along.slope,
                            fma(offset.across, path->across.slope, point.normal * path->normal.slope));
    const floatv velocity_across = curve_velocity_across(path, x);
    const floatv climb = fma(path->along.slope, splat(path->velocity_along), path->across.slope * velocity_across);
    const floatv speed2 = fma(velocity_across, velocity_across, splat(path->velocity_along * path->velocity_along));
    const floatv facing = fma(-2.0f * path->bend, offset.across, speed2);
    const floatv slid = climb * climb * inverse(max(max(facing, speed2 * (1.0f / MOST_SLIDING)), 1e-30f));
    view.half_curvature = select(peaks->span2, max(peaks->span2 - slid, 0.0f), fabs(x) < 0.5f);
    return view;
}
#endif

// Returns L(s) - C(1/2 + x).
INLINE fine3v fine_offset_from_core(const curve_peaks *const peaks, const floatv s, const floatv x) {
    __global const Curve *const curve = peaks->curve;
    const finev back = to_finev(-x);
    const fine3v from_middle = fine_between(peaks->ray, s, curve->middle, curve->middle_rest);
    const fine3v velocity = fine3(curve->velocity, curve->velocity_rest);
    const fine3v second = fine3(curve->second, curve->second_rest);
    // C(1/2) - C(1/2 + x) = -x (C'(1/2) + x C2)
    const fine3v chord = fine_fma3(second, fine_negate(back), velocity);
    return fine_fma3(chord, back, from_middle);
}

// Returns the same in the curve's frame, doubled.
CALL_IF_SCALAR float3v offset_from_core(const curve_peaks *const peaks, const floatv s, const floatv x) {
    __global const Curve *const curve = peaks->curve;
    const float3v offset = from_fine3(fine_offset_from_core(peaks, s, x));
    const float3v in_frame = {2.0f * dot3(offset, uniform3(curve->along)), 2.0f * dot3(offset, uniform3(curve->across)),
                              2.0f * dot3(offset, uniform3(curve->normal))};
    return in_frame;
}

#ifdef SHAPES
// Returns what the squared distance of L(s) to C(1/2 + x) lacks to where light ends: there its last digits count.
CALL_IF_SCALAR floatv curve_left2(const curve_peaks *const peaks, const floatv s, const floatv x) {
    const Profile *const profile = &peaks->path.profile;
    const fine3v offset = fine_offset_from_core(peaks, s, x);
    const finev end2 = uniform_fine(profile->end2, profile->end2_rest);
    return from_finev(fine_fma(fine_dot3(offset, offset), to_finev(splat(-4.0f)), end2));
}
#endif

// What a node sees: x of the nearest point, and the field without intensity.
typedef struct {
    floatv x, plain;
} curve_node_sight;

// The curve beside a point of the ray: the path from there on, seen from the nearest point of the curve.
typedef struct {
    curve_path path;
    floatv core;
    bool is_polished; // whether roots of the cubic are improved
    RootCounts counts;
    curve_node_sight sight; // of the last point that was asked for
#ifdef SHAPES
    floatv left2; // what the squared distance of the point itself lacks to where light ends
#endif
} curve_near;

// Returns whether the roots of the cubic have too few digits for such a squared distance. They lose the more, the
// farther the parabola's vertex is from the curve's middle.
bool needs_polish(const curve_path *const path, const floatv distance2) {
#ifdef COARSE
    const float size = fabs(path->velocity_along) + fabs(path->velocity_across) + path->bend;
    const float error = 3e-5f * (1.0f + fabs(path->vertex)) * size;
    return any_lane(distance2 < error * error);
#else
    return true;
#endif
}

// Moves a core point C(1/2 + x), from which `offset` begins, to the nearest one that float32 can name: the cubic has
// missed it by some digits.
INLINE floatv nearest_core(const curve_path *const path, const floatv x, float3v *const offset) {
    const floatv velocity_across = curve_velocity_across(path, x);
    const floatv speed2 = fma(velocity_across, velocity_across, splat(path->velocity_along * path->velocity_along));
    const floatv facing = max(fma(-2.0f * path->bend, offset->y, speed2), max(0.1f * speed2, 1e-30f));
    const floatv behind = fma(offset->x, path->velocity_along, offset->y * velocity_across);
    const floatv missed = clamp(behind * inverse(facing), -1e-5f, 1e-5f);
    const floatv nearest = select(x, clamp(x + missed, -0.5f, 0.5f), fabs(x) < 0.5f);
    const floatv moved = nearest - x;
    offset->x -= path->velocity_along * moved;
    offset->y -= fma(splat(path->bend), moved, velocity_across) * moved;
    return nearest;
}

// What stands for the floor serves a whole peak only: one that ends a panel, or is this many floors from there or less,
// is taken as it is, with its kinks.
#define FLOORS_TO_END 100.0f

INLINE curve_near curve_approach(const curve_peaks *const peaks, const floatv from, const floatv to, Peak *const peak,
                                 floatv *const base) {
    const curve_path *const path = &peaks->path;
    const floatv per_span2 = inverse(peaks->span2);
    const floatv first_im2 = peaks->first_distance2 * per_span2, second_im2 = peaks->second_distance2 * per_span2;
    const floatv first_inside = clamp(peaks->first, from, to), second_inside = clamp(peaks->second, from, to);
    const floatv to_first = peaks->first - first_inside, to_second = peaks->second - second_inside;
    const intv is_second = fma(to_second, to_second, second_im2) < fma(to_first, to_first, first_im2);
    *base = select(first_inside, second_inside, is_second);

    const curve_point point = curve_point_at(path, *base);
    floatv distance2;
    floatv x = nearest_on_curve(path, &point, &distance2);
    const curve_offset seen = offset_from_curve(path, &point, x);
    float3v offset = {seen.along, seen.across, point.normal};
    const float3v from_middle = {point.along, point.across, point.normal};
    const floatv size2 = dot3(from_middle, from_middle) + path->velocity_along * path->velocity_along;
    if (any_lane(distance2 < 1e-3f * size2)) {
        offset = offset_from_core(peaks, *base, x);
        x = nearest_core(path, x, &offset);
        distance2 = dot3(offset, offset);
    }
    const floatv velocity_across = curve_velocity_across(path, x);
    const floatv speed2 = fma(velocity_across, velocity_across, splat(path->velocity_along * path->velocity_along));
    const floatv facing = fma(-2.0f * path->bend, offset.y, speed2);
    const floatv climb = fma(path->along.slope, splat(path->velocity_along), path->across.slope * velocity_across);
    const floatv per_facing = inverse(max(max(facing, 1e-3f * speed2), 1e-30f));
    const floatv slid = climb * climb * per_facing;
    // What float32 has missed the nearest point by is no distance from the curve.
    const floatv behind = fma(offset.x, splat(path->velocity_along), offset.y * velocity_across);
    const floatv missed = select(splat(0.0f), behind * per_facing, fabs(x) < 0.5f);
    const floatv curvature = max(select(peaks->span2, peaks->span2 - slid, fabs(x) < 0.5f), 1e-6f * peaks->span2);
    const float3v span = {path->along.slope, path->across.slope, path->normal.slope};
    const floatv slope = fma(-missed, climb, dot3(offset, span));
    const floatv per_curvature = inverse(curvature);
    const floatv softened = max(fma(-missed, behind, distance2), 0.0f) + path->profile.softening2;
    const floatv lowest = max(fma(-slope * per_curvature, slope, softened), 0.0f);
    peak->re = -slope * per_curvature;
    const floatv blurred = fma(max(lowest, 1e-3f * softened), per_curvature, 0.5f * path->profile.floor2 * per_span2);
    peak->im = 0.5f * twice_sqrt(blurred);

    // Where the ray runs along the curve, the floor cuts off more than a point of it.
    const intv is_floored = lowest < path->profile.floor2;
    intv is_thin = is_floored & (path->profile.floor2 < 1e-6f * size2) & (curvature > 0.02f * peaks->span2);
    peak->is_flat = is_floored & !is_thin;
    if (any_lane(is_thin)) {
        const floatv peak_at = *base + peak->re, to_end = min(fabs(peak_at - from), fabs(peak_at - to));
        const intv is_cut = is_thin & (to_end < FLOORS_TO_END * CORE_FLOOR);
        is_thin &= !is_cut;
        peak->is_flat |= is_cut & (peak->re * peak->re * curvature < 1.1f * path->profile.floor2);
    }
    curve_near near = {*path, x, !path->is_line && needs_polish(path, lowest), {true, true}, {x, splat(0.0f)}};
    near.path.profile.softening2 +=
        select(splat(0.0f), floored(lowest, path->profile.floor2, IS_SQUARE(&path->profile)) - lowest, is_thin);
    near.path.profile.floor2 = select(path->profile.floor2, 0.5f * path->profile.floor2, is_thin);
#ifdef SHAPES
    near.left2 = HAS_END(&path->profile) ? curve_left2(peaks, *base, x) : splat(0.0f);
#endif
    near.path.along.at = offset.x;
    near.path.across.at = offset.y;
    near.path.normal.at = offset.z;
    near.path.p.at = point.p;
    near.path.h.at = point.h;
    return near;
}

// Finds which numbers of roots occur at any node, so that no node has to ask.
INLINE void curve_look_ahead(curve_near *const near, const floatv *const left, const floatv *const right,
                             const uint count) {
    if (near->path.is_straight)
        return;
    intv has_three = left[0] != left[0], has_one = has_three;
    for (uint k = 0; k < count; ++k) {
        const Linear p = near->path.p, h = near->path.h;
        const intv left_three = has_three_roots(linear_at(p, left[k]), linear_at(h, left[k]));
        const intv right_three = has_three_roots(linear_at(p, right[k]), linear_at(h, right[k]));
        has_three |= left_three | right_three;
        has_one |= !(left_three & right_three);
    }
    near->counts.one = any_lane(has_one);
    near->counts.three = any_lane(has_three);
}

// Improves a nearest point between the ends, and its squared distance, by a Newton step on the derivative of the
// distance: seen from the core close by, that has more digits than the cubic.
INLINE floatv polished(const curve_path *const path, const curve_point *const point, const floatv x,
                       floatv *const distance2) {
    const curve_offset offset = offset_from_curve(path, point, x);
    const floatv velocity_across = curve_velocity_across(path, x);
    const floatv speed2 = fma(velocity_across, velocity_across, splat(path->velocity_along * path->velocity_along));
    const floatv facing = max(fma(-2.0f * path->bend, offset.across, speed2), max(0.1f * speed2, 1e-30f));
    const floatv behind = fma(offset.along, path->velocity_along, offset.across * velocity_across);
    // The step is too small for the digits of x.
    const floatv step = clamp(behind * inverse(facing), -0.5f - x, 0.5f - x);
    const floatv gained = step * fma(-facing, step, 2.0f * behind);
    const intv is_inner = fabs(x) < 0.5f;
    *distance2 = max(*distance2 - select(splat(0.0f), max(gained, 0.0f), is_inner), 0.0f);
    return select(x, x + step, is_inner);
}

#ifdef SHAPES
// Returns what the squared distance at s = base + x lacks to where light ends, given the nearest point there.
INLINE floatv curve_near_left2(const curve_near *const near, const floatv x, const floatv nearest) {
    const curve_path *const path = &near->path;
    const floatv ahead = nearest - near->core;
    const floatv chord_across = fma(splat(path->bend), nearest + near->core, splat(path->velocity_across));
    const floatv along = fma(-path->velocity_along, ahead, path->along.slope * x);
    const floatv across = fma(-chord_across, ahead, path->across.slope * x), normal = path->normal.slope * x;
    const floatv farther2 =
        fma(along, fma(splat(2.0f), path->along.at, along),
            fma(across, fma(splat(2.0f), path->across.at, across), normal * fma(splat(2.0f), path->normal.at, normal)));
    return max(near->left2 - farther2, 0.0f);
}
#endif

// Returns the field at s = base + x.
INLINE floatv curve_near_field(curve_near *const near, const floatv x) {
    curve_point point = curve_point_at(&near->path, x);
    point.core = near->core;
    floatv distance2;
    floatv nearest = nearest_of_roots(&near->path, &point, near->counts, &distance2);
    if (near->is_polished)
        nearest = polished(&near->path, &point, nearest, &distance2);
    const floatv softened2 = distance2 + near->path.profile.softening2;
    const floatv per_distance = coarse_twice_inverse_sqrt(max(softened2, near->path.profile.floor2));
    near->sight.x = nearest;
#ifdef SHAPES
    near->sight.plain = IS_SHAPED(&near->path.profile)
                            ? shaped(&near->path.profile, softened2, curve_near_left2(near, x, nearest), per_distance)
                            : field_of(&near->path.profile, softened2, per_distance);
#else
    near->sight.plain = field_of(&near->path.profile, softened2, per_distance);
#endif
    return SERIES_LENGTH(&near->path) ? near->sight.plain * curve_intensity(&near->path, nearest) : near->sight.plain;
}
