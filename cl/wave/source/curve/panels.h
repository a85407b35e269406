// Where a ray's view of a curve changes: where it passes the reach of an end, and where the nearest point jumps. Panels
// end there; those that belong to an end of the curve have a closed form.
#pragma once
#include "../../quadrature/stretch.h"
#include "peaks.h"

// Returns where a value that is linear along the ray is 0; 0 where it never is.
floatv zero_of(const Linear value) {
    const intv never = fabs(value.slope) < 1e-30f;
    return select(-value.at / select(value.slope, splat(1.0f), never), splat(0.0f), never);
}

// Returns the ray's crossing of the plane through an end, where that end becomes the nearest point, or ceases to be.
floatv end_cut(const curve_path *const path, const Linear beyond, const float x) {
    const floatv s = zero_of(beyond);
    const float velocity_across = fma(2.0f * path->bend, x, path->velocity_across);
    const float speed2 = fma(path->velocity_along, path->velocity_along, velocity_across * velocity_across);
    const float end_across = fma(path->bend, x, path->velocity_across) * x;
    const floatv across = linear_at(path->across, s) - end_across;
    return select(splat(0.0f), s, speed2 - 2.0f * path->bend * across > 0.0f);
}

// Returns where the ray is equally far from C(1/2 + x) and C(1/2 + y), x and y apart; 0 where it never is. The
// difference of the distances is small beside them, and where it is 0 the field may jump.
CALL_IF_SCALAR floatv equidistant(const curve_peaks *const peaks, const floatv x, const floatv y) {
    __global const Curve *const curve = peaks->curve;
    const fine3v velocity = fine3(curve->velocity, curve->velocity_rest);
    const fine3v second = fine3(curve->second, curve->second_rest);
    const finev fine_x = to_finev(x), fine_y = to_finev(y);
    const finev sum = fine_add(fine_x, fine_y);
    const finev half_squares = fine_halve(fine_fma(fine_x, fine_x, fine_multiply(fine_y, fine_y)));
    const fine3v chord = fine_fma3(second, sum, velocity); // towards one from the other, in units of x - y
    const fine3v origin = fine_between(peaks->ray, splat(0.0f), curve->middle, curve->middle_rest);
    const fine3v from_middle =
        fine_fma3(velocity, fine_negate(fine_halve(sum)), fine_fma3(second, fine_negate(half_squares), origin));
    const floatv closing = peaks->ray->stretch * from_finev(fine_dot3(peaks->ray->fine_toward, chord));
    const floatv gap = -from_finev(fine_dot3(from_middle, chord));
    const intv never = fabs(closing) < 1e-30f;
    return select(gap / select(closing, splat(1.0f), never), splat(0.0f), never);
}

// Returns where both ends are nearest points of their parts, and equally far.
INLINE floatv ends_cut(const curve_peaks *const peaks, const Linear beyond_first, const Linear beyond_last) {
    const curve_path *const path = &peaks->path;
    const Linear difference =
        linear(fma(path->along.at, splat(path->velocity_along),
                   (path->across.at - 0.25f * path->bend) * path->velocity_across),
               fma(path->along.slope, splat(path->velocity_along), path->across.slope * path->velocity_across));
    const floatv s = zero_of(difference);
    const intv is_there = (linear_at(beyond_first, s) <= 0.0f) & (linear_at(beyond_last, s) >= 0.0f);
    if (!any_lane(is_there))
        return splat(0.0f);
    return select(splat(0.0f), equidistant(peaks, splat(-0.5f), splat(0.5f)), is_there);
}

// Returns where the nearest point jumps across the parabola's axis; else between two close approaches.
INLINE floatv middle_cut(const curve_peaks *const peaks) {
    const curve_path *const path = &peaks->path;
    const floatv between = select(splat(0.0f), 0.5f * (peaks->first + peaks->second), peaks->are_two);
    if (path->is_straight)
        return between;
    const floatv reach2 = -3.0f * linear_at(path->p, zero_of(path->h));
    const float reach = min(0.5f - path->vertex, 0.5f + path->vertex);
    const intv jumps = (reach2 > 0.0f) & (reach2 < reach * fabs(reach));
    if (!any_lane(jumps))
        return between;
    return select(between, equidistant(peaks, splat(-1.0f - path->vertex), splat(1.0f - path->vertex)), jumps);
}

// A point of the ray, the parameter of the curve's point nearest to it, and their squared distance. A call: it is asked
// for in many places, and rarely.
typedef struct {
    floatv s, x, distance2;
} curve_sight;

CALL_IF_SCALAR curve_sight curve_seen_from(const curve_path *const path, const floatv s) {
    const curve_point point = curve_point_at(path, s);
    curve_sight sight;
    sight.s = s;
    sight.x = nearest_on_curve(path, &point, &sight.distance2);
    return sight;
}

// Returns whether there may be a nearest point of its part between the ends, given that the end at x is one and the
// other is not: beyond a turning point +-sqrt(-p) of the cubic that lies on the curve, the one on the far side from x.
INLINE intv may_be_between(const curve_path *const path, const curve_point *const point, const floatv x) {
    const float first = path->vertex - 0.5f, last = path->vertex + 0.5f;
    const floatv near_end = select(splat(-last), splat(first), x < 0.0f);
    const floatv far_end = select(splat(-first), splat(last), x < 0.0f);
    const floatv turning2 = -point->p;
    return has_three_roots(point->p, point->h) & (far_end > 0.0f) & (turning2 < far_end * far_end) &
           ((near_end < 0.0f) | (turning2 > near_end * near_end));
}

// Returns whether the end of the curve at x is its point nearest to a point of the ray. Where the other end is a
// nearest point of its part too, only that one competes.
INLINE intv end_is_nearest(const curve_peaks *const peaks, const floatv x, const floatv s) {
    const curve_path *const path = &peaks->path;
    const curve_point point = curve_point_at(path, s);
    const intv is_first = linear_at(peaks->beyond_first, s) <= 0.0f, is_last = linear_at(peaks->beyond_last, s) >= 0.0f;
    const intv are_both = is_first & is_last;
    intv is_nearest = select(is_last, is_first, x < 0.0f);
    if (any_lane(are_both))
        is_nearest &= !are_both | (curve_distance2(path, &point, x) <= curve_distance2(path, &point, -x));
    const intv is_open = is_nearest & !are_both & (path->is_straight ? x == x : may_be_between(path, &point, x));
    if (any_lane(is_open))
        is_nearest &= !is_open | (curve_seen_from(path, s).x == x);
    return is_nearest;
}

// Returns whether one end of the curve is the nearest point from all of a panel, and at which x it is: the points
// nearest to an end form a convex set, so both ends of the panel tell.
CALL_IF_SCALAR intv curve_is_closed(const curve_peaks *const peaks, const floatv from, const floatv to,
                                    floatv *const x) {
    const curve_path *const path = &peaks->path;
    const floatv middle = 0.5f * (from + to), inside = 1e-4f * (to - from);
    const intv is_first = linear_at(peaks->beyond_first, middle) <= 0.0f;
    const intv is_last = linear_at(peaks->beyond_last, middle) >= 0.0f;
    const intv is_closed = (is_first | is_last) & (to > from);
    *x = splat(0.0f);
    if (!any_lane(is_closed))
        return is_closed;
    intv is_last_nearer = is_last;
    if (any_lane(is_first & is_last)) {
        const curve_point point = curve_point_at(path, middle);
        const floatv to_first = curve_distance2(path, &point, splat(-0.5f));
        is_last_nearer &= !is_first | (curve_distance2(path, &point, splat(0.5f)) < to_first);
    }
    *x = select(splat(-0.5f), splat(0.5f), is_last_nearer);
    return is_closed & end_is_nearest(peaks, *x, from + inside) & end_is_nearest(peaks, *x, to - inside);
}

// Returns the integral of a panel from all of which the end of the curve at x is the nearest point.
CALL_IF_SCALAR floatv curve_closed_form(const curve_peaks *const peaks, const Quadrature *const quadrature,
                                        const floatv x, const floatv from, const floatv to) {
    const curve_path *const path = &peaks->path;
    floatv least;
    const floatv nearest = closest_to_core(path, peaks->span2, x, &least);
    const floatv length = 0.5f * twice_sqrt(peaks->span2);
    Quadratic to_end = {length, -length * nearest, least, nearest, splat(0.0f)};
    if (any_lane(least < 1e-5f * peaks->span2)) {
        const float3v span = {path->along.slope, path->across.slope, path->normal.slope};
        refine(&to_end, offset_from_core(peaks, nearest, x), span);
    }
#ifdef SHAPES
    if (HAS_END(&path->profile)) {
        const floatv left2 = fma(to_end.ahead, to_end.ahead, curve_left2(peaks, nearest, x));
        to_end.bare = splat(path->profile.end2), to_end.bare_rest = path->profile.end2_rest - left2;
    }
    bare_as_it_is(&to_end);
#endif
    to_end.least += path->profile.softening2;
    const floatv integral = integral_over(evenly_lit(from, to), &to_end, &path->profile, quadrature);
    return SERIES_LENGTH(path) ? integral * curve_intensity(path, x) : integral;
}

// Finds in which lanes a panel is closed, and its integral there.
INLINE intv curve_closed(const curve_peaks *const peaks, const Quadrature *const quadrature, const floatv from,
                         const floatv to, floatv *const integral) {
    floatv x;
    const intv is_closed = curve_is_closed(peaks, from, to, &x);
    *integral = splat(0.0f);
    if (any_lane(is_closed))
        *integral = select(splat(0.0f), curve_closed_form(peaks, quadrature, x, from, to), is_closed);
    return is_closed;
}

// Cuts the ray into panels, the last one first, and returns the integral of those that are closed: the parts that
// belong to an end are one stretch of the ray. A lane that is done with a panel finds it empty.
CALL_IF_SCALAR uint curve_panels(const curve_peaks *const peaks, const Quadrature *const quadrature, floatv *const from,
                                 floatv *const to, floatv *const integral) {
    const curve_path *const path = &peaks->path;
    const floatv begin = peaks->begin, end = peaks->end;
    const floatv a = clamp(end_cut(path, peaks->beyond_first, -0.5f), begin, end);
    const floatv b = clamp(end_cut(path, peaks->beyond_last, 0.5f), begin, end);
    const floatv c = clamp(ends_cut(peaks, peaks->beyond_first, peaks->beyond_last), begin, end);
    const floatv d = clamp(middle_cut(peaks), begin, end);
    const floatv less_ab = min(a, b), more_ab = max(a, b), less_cd = min(c, d), more_cd = max(c, d);
    const floatv inner = max(less_ab, less_cd), outer = min(more_ab, more_cd);
    to[0] = end;
    to[1] = from[0] = max(more_ab, more_cd);
    to[2] = from[1] = max(inner, outer);
    to[3] = from[2] = min(inner, outer);
    to[4] = from[3] = min(less_ab, less_cd);
    from[4] = begin;

    floatv first_from = end, first_to = begin, last_from = end, last_to = begin;
    for (uint k = 0; k < 5; ++k) {
        if (!any_lane(to[k] > from[k]))
            continue;
        floatv x;
        const intv is_closed = curve_is_closed(peaks, from[k], to[k], &x);
        const intv is_first = is_closed & (x < 0.0f), is_last = is_closed & (x > 0.0f);
        first_from = select(first_from, min(first_from, from[k]), is_first);
        first_to = select(first_to, max(first_to, to[k]), is_first);
        last_from = select(last_from, min(last_from, from[k]), is_last);
        last_to = select(last_to, max(last_to, to[k]), is_last);
        to[k] = select(to[k], from[k], is_closed);
    }
    // What lies between is closed too, whatever rounding said of it.
    for (uint k = 0; k < 5; ++k) {
        const intv in_first = (from[k] >= first_from) & (to[k] <= first_to);
        const intv in_last = (from[k] >= last_from) & (to[k] <= last_to);
        to[k] = select(to[k], from[k], in_first | in_last);
    }
    const floatv of_first = curve_closed_form(peaks, quadrature, splat(-0.5f), first_from, max(first_to, first_from));
    const floatv of_last = curve_closed_form(peaks, quadrature, splat(0.5f), last_from, max(last_to, last_from));
    *integral = of_first + of_last;
    return 5;
}

// Returns whether all panels must be seen before errors can be measured by what they add up to: some may be dark.
INLINE bool curve_is_uneven(const curve_peaks *const peaks) {
    return SERIES_LENGTH(&peaks->path) > 0;
}

// Returns further cuts: every piece of a local intensity may need panels of its own, and what is dark to nodes all
// around must be found.
INLINE uint curve_more_cuts(const curve_peaks *const peaks) {
    const uint pieces = SERIES_LENGTH(&peaks->path);
    return pieces ? 128 + 4 * pieces : 0;
}

curve_sight select_sight(const curve_sight a, const curve_sight b, const intv is_b) {
    const curve_sight sight = {select(a.s, b.s, is_b), select(a.x, b.x, is_b), select(a.distance2, b.distance2, is_b)};
    return sight;
}

// What the nodes of one side of a panel see, from its end inwards: x of the nearest points; the end and the outermost
// node are where x leaves an end of the curve, if it does.
typedef struct {
    floatv end, outermost, last;
    intv jumps; // whether x changes more than smoothly beyond the outermost node, or leaves an end of the curve
} curve_side;

typedef struct {
    curve_side left, right;
    floatv leap;  // the farthest from one x to the next
    floatv plain; // sum over the nodes of weight times field without intensity
} curve_view;

#define MOST_PASSED 1.0f     // pieces of a local intensity from one node to the next
#define PASSED_BETWEEN 0.15f // the share of a panel between two nodes,
#define BEYOND_NODES 0.03f   // and beyond its outermost one;
#define BEYOND_KINKS 5e-4f   // what a kink there may come to, about half the square of that
#define DARK 0.01f           // of the light without intensity: what begins beyond the nodes of such a panel counts
#define SMOOTH_LEAP 0.6f     // what x may change beyond the outermost node where it is smooth, of what it does inwards

curve_side curve_side_from(const floatv end) {
    const curve_side side = {end, end, end, (intv)(0)};
    return side;
}

// Returns whether a panel's nodes may miss what matters.
INLINE bool curve_has_view(const curve_peaks *const peaks) {
#ifdef COARSE
    return SERIES_LENGTH(&peaks->path) > 0;
#else
    return true;
#endif
}

// Begins with what is seen from the ends of a panel.
INLINE curve_view curve_view_from(const curve_peaks *const peaks, const floatv from, const floatv to) {
    const curve_path *const path = &peaks->path;
    floatv first = splat(0.0f), last = first;
    if (curve_has_view(peaks)) {
        const floatv inside = 1e-4f * (to - from);
        first = curve_seen_from(path, from + inside).x, last = curve_seen_from(path, to - inside).x;
    }
    const curve_view view = {curve_side_from(first), curve_side_from(last), splat(0.0f), splat(0.0f)};
    return view;
}

#ifndef SEEN_END // a test is blind to it
#define SEEN_END 0.5f
#endif

// Takes note of what a side's node sees, the outermost being number 0.
INLINE void curve_see(curve_view *const view, curve_side *const side, const curve_node_sight sight, const floatv weight,
                      const int number) {
    const floatv leap = fabs(sight.x - side->last);
    const intv leaves_end = (fabs(side->last) >= SEEN_END) & (fabs(sight.x) < SEEN_END);
    if (number == 0)
        side->outermost = sight.x;
    if (number == 1)
        side->jumps |= fabs(side->end - side->outermost) > SMOOTH_LEAP * leap;
    side->end = select(side->end, side->last, leaves_end);
    side->outermost = select(side->outermost, sight.x, leaves_end);
    side->jumps |= leaves_end;
    view->leap = max(view->leap, leap);
    view->plain = fma(weight, sight.plain, view->plain);
    side->last = sight.x;
}

// Returns how much the local intensity changes between an end of a panel and the outermost node, in these lanes.
CALL_IF_SCALAR floatv curve_step(const curve_path *const path, const curve_side *const side, const intv counts) {
    if (!any_lane(counts))
        return splat(0.0f);
    const floatv step = fabs(curve_intensity(path, side->end) - curve_intensity(path, side->outermost));
    return select(splat(0.0f), step, counts);
}

// Returns the light that may lie between a panel's nodes, from the sum of theirs: where the nearest point jumps beside
// the outermost node, unseen by all others, the field has a kink, which counts when tolerances are tight, and with a
// local intensity a jump. Or where it passes over so much of a local intensity that the nodes cannot tell what.
INLINE floatv curve_unseen(const curve_peaks *const peaks, const curve_view *const view, const floatv sum) {
    const curve_path *const path = &peaks->path;
    const curve_side *const left = &view->left, *const right = &view->right;
    floatv unseen = splat(0.0f);
    if (SERIES_LENGTH(path)) {
        const intv is_dark =
            fabs(sum)<DARK * view->plain, passes = (float)SERIES_LENGTH(path) * view->leap> MOST_PASSED;
        const floatv step = max(curve_step(path, left, left->jumps | is_dark), //
                                curve_step(path, right, right->jumps | is_dark));
        unseen = select(BEYOND_NODES * step, splat(PASSED_BETWEEN), passes) * view->plain;
    }
#ifndef COARSE
    const intv jumps = (left->jumps & (fabs(left->end - left->outermost) > 0.1f)) |
                       (right->jumps & (fabs(right->end - right->outermost) > 0.1f));
    unseen += select(splat(0.0f), BEYOND_KINKS * fabs(sum), jumps);
#endif
    return unseen;
}

// Returns where to cut a panel that is not resolved: where the nearest point jumps, or else in the middle. Halving
// closes in on the fastest change; then both sides, continued as they are, meet in the jump.
CALL_IF_SCALAR floatv curve_split(const curve_peaks *const peaks, const floatv from, const floatv to,
                                  const floatv middle) {
    const curve_path *const path = &peaks->path;
    intv can_jump = from > to;
    for (float share = 0.0f; share < 1.1f; share += 0.25f) {
        const floatv s = fma(to - from, splat(share), from);
        const floatv p = linear_at(path->p, s), h = linear_at(path->h, s);
        can_jump |= has_three_roots(p, h);
    }
    if (path->is_straight || !any_lane(can_jump))
        return middle;
    const floatv inside = 1e-4f * (to - from);
    curve_sight left = curve_seen_from(path, from + inside), right = curve_seen_from(path, to - inside);
    const floatv change = fabs(right.x - left.x);
    floatv s = 0.5f * (left.s + right.s);
    for (int step = 0; step < 7; ++step) {
        const curve_sight sight = curve_seen_from(path, s);
        const intv is_left = fabs(sight.x - left.x) < fabs(sight.x - right.x);
        left = select_sight(left, sight, is_left);
        right = select_sight(sight, right, is_left);
        s = 0.5f * (left.s + right.s);
    }
    // Points seen from closer by are nearer to those that the jump joins, and the square of what is missing counts.
    for (int step = 0; step < 2; ++step) {
        s = clamp(equidistant(peaks, left.x, right.x), left.s, right.s);
        const curve_sight before = curve_seen_from(path, max(s - inside, left.s));
        const curve_sight behind = curve_seen_from(path, min(s + inside, right.s));
        left = select_sight(left, before, fabs(before.x - left.x) < fabs(before.x - right.x));
        right = select_sight(right, behind, fabs(behind.x - right.x) < fabs(behind.x - left.x));
    }
    s = clamp(equidistant(peaks, left.x, right.x), left.s, right.s);
    const intv jumps = fabs(right.x - left.x) > max(0.25f * change, 1e-3f);
    const intv is_inside = (s > from + inside) & (s < to - inside);
    return select(middle, s, jumps & is_inside);
}
