// Which part of a path is nearest next, as a ray moves on.
//
// All squared distances from a ray that moves on by x are parabolas a x^2 + 2 b x + c: to a corner, and to the line of
// a piece, which counts between the planes through its ends. The nearest part is the least of them. Where another
// becomes less is a root of their difference; a little off it costs little, as both distances are equal there.
#pragma once
#include "rows.h"

// A squared distance as the ray moves on by x: a x^2 + 2 b x + c.
typedef struct {
    floatv a, b, c;
} Parabola;

INLINE Parabola parabola_less(const Parabola p, const Parabola q) {
    const Parabola r = {p.a - q.a, p.b - q.b, p.c - q.c};
    return r;
}

floatv parabola_at(const Parabola p, const floatv x) {
    return fma(fma(p.a, x, 2.0f * p.b), x, p.c);
}

// Beyond every ray.
#define NOWHERE 1e30f

// Returns the least x >= 0 at which a difference falls below 0; where it is less already, 0.
INLINE floatv parabola_falls(const Parabola p) {
    const floatv discriminant = fma(p.b, p.b, -p.a * p.c);
    const floatv root = 0.5f * twice_sqrt(max(discriminant, 1e-36f));
    const floatv soon = p.c * inverse(max(root - p.b, 1e-30f)), late = (root + p.b) * inverse(max(-p.a, 1e-30f));
    const floatv falls = select(select(splat(NOWHERE), soon, p.b < 0.0f), late, (p.b >= 0.0f) & (p.a < 0.0f));
    return select(select(falls, splat(NOWHERE), discriminant < 0.0f), splat(0.0f), p.c <= 0.0f);
}

// Returns how far a step goes at most: far from where a part is closest, differences of squared distances have too few
// digits to tell which part is nearest there.
#ifdef SERIES
#define FAR_AWAY 4.0f
#else
#define FAR_AWAY 64.0f
#endif
INLINE floatv path_far_step(const Parabola *const part, const floatv beyond) {
    const floatv closest = -part->b * inverse(max(part->a, 1e-30f));
    const floatv least = fma(part->b, closest, part->c);
    const intv is_far = (part->b < 0.0f) & (part->c > FAR_AWAY * fabs(least));
    return select(beyond, min(beyond, 0.875f * closest), is_far);
}

// Returns how far a step goes at least: to the next float32. A ray that stands still sees equally near parts take turns
// until it has no steps left.
#ifndef NEXT_FLOAT // a test lets it stand still
#define NEXT_FLOAT 1.2e-7f
#endif
floatv path_least_step(const floatv s) {
    return NEXT_FLOAT * max(s, 0.01f);
}

// Another part takes over where its squared distance is less by this share: parts that are all but equally near do not
// take turns. Far from a path, short pieces then are points.
#ifndef PATH_SLACK
#if defined(COARSE) && !defined(SERIES) // light that changes along the core jumps with the nearest part
#define PATH_SLACK 1e-3f
#else
#define PATH_SLACK 4e-6f // with less, float32 lets parts that are equally near take turns
#endif
#endif

// Returns by how much another part is farther than the nearest one, with what it has to be nearer.
INLINE Parabola path_excess(const Parabola other, const Parabola nearest) {
    const Parabola excess = {fma(splat(PATH_SLACK), other.a, other.a - nearest.a),
                             fma(splat(PATH_SLACK), other.b, other.b - nearest.b),
                             fma(splat(PATH_SLACK), other.c, other.c - nearest.c)};
    return excess;
}

// More than a ray can need: corners, and pieces between them, seen from both sides.
#ifdef SERIES // and each in several steps
#define MOST_PATH_STEPS(rows) (16u * (rows)->corner_count + 1024u)
#else
#define MOST_PATH_STEPS(rows) (4u * (rows)->corner_count + 16u)
#endif

// Between the planes through a piece's ends: from where to where.
typedef struct {
    floatv from, to;
} path_slab;

// Returns where a height, at `height` and rising with `slope`, lies between 0 and a length.
INLINE path_slab path_slab_of(const floatv height, const floatv slope, const floatv length) {
    const intv is_level = fabs(slope) < 1e-30f;
    const floatv per_slope = inverse(select(slope, splat(1e-30f), is_level));
    const floatv at_begin = -height * per_slope, at_end = (length - height) * per_slope;
    const intv is_within = (height > 0.0f) & (height < length);
    const path_slab slab = {select(min(at_begin, at_end), splat(0.0f), is_level),
                            select(max(at_begin, at_end), select(splat(-1.0f), splat(NOWHERE), is_within), is_level)};
    return slab;
}

// A part of a path seen from a spot of a ray.
typedef struct {
    float3v corner, corner_rest, along;
    Parabola distance2;
    floatv height, rise, length; // over the plane through its corner, along its line; and that line's length
} path_view;

INLINE path_view path_view_of(const path_rows *const path, const Ray *const ray, const path_spot *const spot,
                              const path_place *const place) {
    path_view view;
    view.corner = path_gather3(path, place->corner, 0), view.corner_rest = path_gather3(path, place->corner, 1);
    view.along = path_gather3(path, place->corner, 2);
    view.length = gather((__global const float *)path->corners, 16 * place->corner + 3);
    const float3v from_corner = add3(subtract3(spot->at, view.corner), subtract3(spot->rest, view.corner_rest));
    view.height = dot3(from_corner, view.along), view.rise = dot3(ray->span, view.along);
    const floatv length2 = ray->length * ray->length, approach = dot3(ray->span, from_corner);
    const float3v across = fma3(view.along, -view.height, from_corner);
    view.distance2.a = select(length2, max(fma(-view.rise, view.rise, length2), 0.0f), place->is_line);
    view.distance2.b = select(approach, fma(-view.height, view.rise, approach), place->is_line);
    view.distance2.c = select(dot3(from_corner, from_corner), dot3(across, across), place->is_line);
    return view;
}

// Returns whether a ball can hold what is nearer than a part, as the ray moves on by up to `most`: the squared distance
// to its centre, less that to the part, less twice radius times distance, is concave but for its sag.
INLINE intv path_may_pass(const float4 ball, const Ray *const ray, const path_spot *const spot, const Parabola part,
                          const floatv most) {
    const float3v from_ball = subtract3(spot->at, uniform3(ball));
    const Parabola to_center = {ray->length * ray->length, dot3(ray->span, from_ball), dot3(from_ball, from_ball)};
    const Parabola more = parabola_less(to_center, part);
    const floatv now = 0.5f * twice_sqrt(max(part.c, 1e-36f));
    const floatv then = 0.5f * twice_sqrt(max(parabola_at(part, most), 1e-36f));
    const floatv at_begin = fma(splat(-2.0f * ball.w), now, more.c);
    const floatv at_last = fma(splat(-2.0f * ball.w), then, parabola_at(more, most));
    const floatv sag = 0.25f * more.a * most * most;
    return (min(at_begin, at_last) - sag < ball.w * ball.w) & (most > 0.0f);
}

// Keeps the groups that may be nearer than what is nearest at either end of a stretch of a ray.
INLINE void path_keep_near(path_groups *const groups, const path_rows *const path, const Ray *const ray,
                           const path_spot *const spot, const path_place *const at_begin,
                           const path_place *const at_end, const floatv most) {
    path_place first = *at_begin, last = *at_end;
    first.is_line = last.is_line = (intv)(0); // corners count everywhere
    const Parabola to_first = path_view_of(path, ray, spot, &first).distance2;
    const Parabola to_last = path_view_of(path, ray, spot, &last).distance2;
    FOR_EACH_GROUP(group, groups) {
        const float4 ball = path->balls[group];
        if (!any_lane(path_may_pass(ball, ray, spot, to_first, most) & path_may_pass(ball, ray, spot, to_last, most)))
            groups->words[word] &= ~(left & -left);
    }
}

#ifdef SHAPES
// Keeps the groups whose light a ray meets, and the stretch of the ray where it may do so.
INLINE void path_keep_lit(path_groups *const groups, const path_rows *const path, const Ray *const ray,
                          const float reach, floatv *const begin, floatv *const end) {
    const floatv per_length2 = inverse(ray->length * ray->length);
    floatv first = *end, last = *begin;
    FOR_EACH_GROUP(group, groups) {
        const float4 ball = path->balls[group];
        const float3v from_ball = subtract3(ray->origin, uniform3(ball));
        const floatv middle = -dot3(from_ball, ray->span) * per_length2;
        const float3v nearest = fma3(ray->span, middle, from_ball);
        const float radius = 1.0001f * (ball.w + reach);
        const floatv left2 = fma(splat(radius), splat(radius), -dot3(nearest, nearest)) * per_length2;
        const floatv half_length = 0.5f * twice_sqrt(max(left2, 1e-30f));
        const floatv enters = max(middle - half_length, *begin), leaves = min(middle + half_length, *end);
        const intv is_lit = (left2 > 0.0f) & (enters < leaves);
        first = select(first, min(first, enters), is_lit);
        last = select(last, max(last, leaves), is_lit);
        if (!any_lane(is_lit))
            groups->words[word] &= ~(left & -left);
    }
    *begin = min(first, last), *end = last;
}
#endif

// What a search for the part that is nearest next knows.
typedef struct {
    Parabola here;
    const path_place *now;
    path_place next;
} path_search;

// A corner, seen in a search.
typedef struct {
    float3v from;       // to the spot
    Parabola distance2; // to it
    Parabola excess;    // over that of the nearest part
    floatv least;       // no excess is less before the next part that was found
} path_corner;

INLINE path_corner path_see(const path_search *const search, const path_rows *const path, const Ray *const ray,
                            const path_spot *const spot, const uint k) {
    path_corner corner;
    corner.from = path_from(spot, path->corners[4u * k], path->corners[4u * k + 1u]);
    const Parabola distance2 = {ray->length * ray->length, dot3(ray->span, corner.from),
                                dot3(corner.from, corner.from)};
    corner.distance2 = distance2;
    corner.excess = path_excess(distance2, search->here);
    const floatv x = search->next.x, sag = 0.25f * corner.excess.a * x * x;
    corner.least = min(corner.excess.c, parabola_at(corner.excess, x)) - sag;
    return corner;
}

INLINE void path_take(path_search *const search, const uint k, const bool is_line, const floatv x, const intv counts) {
    const path_place place = {(intv)((int)k), (intv)(is_line ? -1 : 0), search->here.c, x};
    search->next = select_place(search->next, place, (x < search->next.x) & counts);
}

// Looks whether the line of a piece takes over before what was found.
INLINE void path_look_at_line(path_search *const search, const path_rows *const path, const Ray *const ray,
                              const path_corner *const begin, const uint k) {
    const float3v along = uniform3(path->corners[4u * k + 2u]);
    const floatv height = dot3(begin->from, along), rise = dot3(ray->span, along);
    const path_slab slab = path_slab_of(height, rise, splat(path->corners[4u * k].w));
    const floatv from = max(slab.from, 0.0f);
    const float3v beside = fma3(along, -height, begin->from);
    const Parabola to_line = {max(fma(-rise, rise, begin->distance2.a), 0.0f), fma(-height, rise, begin->distance2.b),
                              dot3(beside, beside)};
    const Parabola excess = path_excess(to_line, search->here);
    const Parabola later = {excess.a, fma(excess.a, from, excess.b), parabola_at(excess, from)};
    const floatv x = from + parabola_falls(later);
    const intv is_own = search->now->is_line & (search->now->corner == (int)k);
    path_take(search, k, true, x, (x <= slab.to) & !is_own);
}

// Looks whether a corner of a group, or the line of a piece, takes over before what was found. No line is nearer than
// an end by more than half its length, squared.
INLINE void path_look_into(path_search *const search, const path_rows *const path, const Ray *const ray,
                           const path_spot *const spot, const uint group) {
    const path_place *const now = search->now;
    const uint first = group * path->group_size, end = min(first + path->group_size, path->corner_count);
    path_corner corner = path_see(search, path, ray, spot, first);
    for (uint k = first; k < end; ++k) {
        if (any_lane(corner.least < 0.0f)) {
            const intv own_ends = (now->corner == (int)k) | (now->is_line & (now->corner + 1 == (int)k));
            path_take(search, k, false, parabola_falls(corner.excess), !own_ends);
        }
        if (k + 1u == path->corner_count)
            return;
        const path_corner next = path_see(search, path, ray, spot, k + 1u);
        const float half_length = 0.5005f * path->corners[4u * k].w;
        if (half_length > 0.0f && any_lane(min(corner.least, next.least) < half_length * half_length))
            path_look_at_line(search, path, ray, &corner, k);
        corner = next;
    }
}

// Finds the part that is nearest after `now`, and where it begins to be, at most `most` further on.
INLINE path_place path_next(const path_rows *const path, const path_groups *const groups, const Ray *const ray,
                            const path_spot *const spot, const path_place *const now, const path_view *const view,
                            const floatv most) {
    path_search search = {view->distance2, now, *now};
    // The end of its own line.
    const floatv leaves = min(max(path_slab_of(view->height, view->rise, view->length).to, 0.0f), most);
    search.next.x = most;
    const intv is_far_end = fma(view->rise, leaves, view->height) > 0.5f * view->length;
    const path_place at_end = {now->corner + select((intv)(0), (intv)(1), is_far_end), (intv)(0), search.here.c,
                               leaves};
    search.next = select_place(search.next, at_end, now->is_line & (leaves < most));

    // The group of the part itself comes first: what follows is likely there, and others are then soon ruled out.
    const uint own = (uint)first_lane(now->corner) / path->group_size;
    path_look_into(&search, path, ray, spot, own);
    FOR_EACH_GROUP(group, groups) {
        if (group != own && any_lane(path_may_pass(path->balls[group], ray, spot, search.here, search.next.x)))
            path_look_into(&search, path, ray, spot, group);
    }
    return search.next;
}
