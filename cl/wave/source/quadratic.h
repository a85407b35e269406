// Squared distance from the points of a ray to a fixed point, or to a line seen along it: a quadratic in s, kept as
// (slope s + offset)^2 + least, in which nothing cancels near the least distance. Next to it, slope s + offset has more
// digits as slope (s - nearest) + ahead: where a stretch of a ray ends at a core, they count.
#pragma once
#include "../../fine.h"
#include "../../roots.h"
#include "../../view.h"
#include "profile.h"

#if defined(SHAPES) && defined(SERIES) // a core may get thicker along the ray
#define WIDENS
#endif

typedef struct {
    floatv slope;
    floatv offset;
    floatv least;          // never 0: its root may be divided by
    floatv nearest, ahead; // the parameter of the least, or next to it, and slope s + offset there
#ifdef SHAPES
    floatv bare, bare_rest; // the least without softening, and what float32 leaves of it
#endif
#ifdef WIDENS
    floatv bare_slope, bare_nearest, bare_ahead; // the same of the squared distance without softening
#endif
} Quadratic;

// Returns |start + s span|^2 for a span of length `slope`.
INLINE Quadratic squared_length_along(const float3v start, const float3v span, const floatv slope) {
    const floatv per_slope = inverse(slope);
    const floatv ahead = -dot3(start, span) * per_slope; // to the nearest point, a length
    const float3v closest = fma3(span, ahead * per_slope, start);
    const Quadratic q = {slope, -ahead, max(dot3(closest, closest), 1e-30f), ahead * per_slope, splat(0.0f)};
    return q;
}

// Refines a squared length by the vector at the parameter of the least, which float32 has missed by a little. Far from
// the ray, where one all but parallel to a line comes closest to it, there are no more digits.
INLINE void refine(Quadratic *const q, const float3v at_nearest, const float3v span) {
    const Quadratic rough = *q;
    const floatv per_slope = inverse(q->slope);
    q->ahead = dot3(at_nearest, span) * per_slope;
    const float3v beside = fma3(span, -q->ahead * per_slope, at_nearest);
    q->least = max(dot3(beside, beside), 1e-30f);
    q->offset = fma(-q->slope, q->nearest, q->ahead);
    const intv is_far = fabs(q->nearest) > 1e3f;
    if (any_lane(is_far)) {
        q->ahead = select(q->ahead, rough.ahead, is_far);
        q->least = select(q->least, rough.least, is_far);
        q->offset = select(q->offset, rough.offset, is_far);
    }
}

#ifdef SHAPES
// Returns what the least lacks to where light ends.
floatv left_at_least(const Profile *const profile, const Quadratic *const q) {
    return (profile->end2 - q->bare) + (profile->end2_rest - q->bare_rest);
}

// Refines the least further: where light ends, its last digits count.
INLINE void refine_bare(Quadratic *const q, const fine3v at_nearest) {
    const floatv rest = from_finev(fine_subtract(fine_dot3(at_nearest, at_nearest), to_finev(q->least)));
    q->bare = q->least;
    q->bare_rest = select(fma(-q->ahead, q->ahead, rest), splat(0.0f), fabs(q->nearest) > 1e3f);
#ifdef WIDENS
    q->bare_slope = q->slope, q->bare_nearest = q->nearest, q->bare_ahead = q->ahead;
#endif
}
#endif

// Returns slope s + offset at the parameter s + rest, with all digits next to the least.
floatv along_at(const Quadratic *const q, const floatv s, const floatv rest) {
    return fma(q->slope, (s - q->nearest) + rest, q->ahead);
}

floatv length3(const float3v v) {
    return 0.5f * twice_sqrt(max(dot3(v, v), 1e-36f));
}

// Returns the same with all lengths doubled, softened; the softening's is doubled already.
Quadratic doubled(const Quadratic q, const floatv softening2) {
    Quadratic d = {2.0f * q.slope, 2.0f * q.offset, fma(splat(4.0f), q.least, softening2), q.nearest, 2.0f * q.ahead};
#ifdef SHAPES
    d.bare = 4.0f * q.bare, d.bare_rest = 4.0f * q.bare_rest;
#endif
#ifdef WIDENS
    d.bare_slope = 2.0f * q.bare_slope, d.bare_nearest = q.bare_nearest, d.bare_ahead = 2.0f * q.bare_ahead;
#endif
    return d;
}

floatv quadratic_at(const Quadratic *const q, const floatv s) {
    const floatv x = fma(q->slope, s, q->offset);
    return fma(x, x, q->least);
}

// Returns the squared distance from a ray to a point of each lane, doubled, with the softening of a profile.
INLINE Quadratic distance2_to_points(const Ray *const ray, const float3v point, const fine3v fine_point,
                                     const floatv softening2) {
    const float3v from_point = subtract3(ray->origin, point);
    Quadratic distance2 = squared_length_along(from_point, ray->span, ray->length);
    const fine3v closest = fine_from(ray, distance2.nearest, fine_point);
    refine(&distance2, from_fine3(closest), ray->span);
#ifdef SHAPES
    refine_bare(&distance2, closest);
#endif
    return doubled(distance2, softening2);
}

// Returns the same for a point that is that of all lanes.
INLINE Quadratic distance2_to_point(const Ray *const ray, const float4 point, const float4 point_rest,
                                    const floatv softening2) {
    return distance2_to_points(ray, uniform3(point), fine3(point, point_rest), softening2);
}

// The sine of the angle between a ray and a line below which float32 has too few digits of it.
#define ALONG 0.03f

// Returns the squared distance from a ray to a line of each lane. The distance of P is |(P - M) x D|, a cross product
// instead of the difference of squares that Watanabe, Abe, Konno 2015, eq. 3 prints, which cancels near the line.
INLINE Quadratic distance2_to_lines(const Ray *const ray, const float3v point, const fine3v fine_point,
                                    const float3v along, const fine3v fine_along, const floatv softening2) {
    const float3v from_point = subtract3(ray->origin, point);
    float3v start = cross3(from_point, along), span = cross3(ray->span, along);
    // Of a ray along the line float32 leaves nothing but noise.
    const intv is_along = dot3(span, span) < ALONG * ALONG * ray->length * ray->length;
    if (any_lane(is_along)) {
        const fine3v fine_start = fine_from(ray, splat(0.0f), fine_point);
        start = select3(start, from_fine3(fine_cross3(fine_start, fine_along)), is_along);
        const float3v turned = scale3(from_fine3(fine_cross3(ray->fine_toward, fine_along)), ray->stretch);
        span = select3(span, turned, is_along);
    }
    Quadratic distance2 = squared_length_along(start, span, length3(span));
    const fine3v closest = fine_from(ray, distance2.nearest, fine_point);
    const fine3v beside = fine_cross3(closest, fine_along);
    refine(&distance2, from_fine3(beside), span);
#ifdef SHAPES
    refine_bare(&distance2, beside);
#endif
    return doubled(distance2, softening2);
}

// Returns the same for a line that is that of all lanes.
INLINE Quadratic distance2_to_line(const Ray *const ray, const float4 point, const float4 point_rest,
                                   const float4 direction, const float4 direction_rest, const floatv softening2) {
    return distance2_to_lines(ray, uniform3(point), fine3(point, point_rest), uniform3(direction),
                              fine3(direction, direction_rest), softening2);
}

INLINE Quadratic select_quadratic(const Quadratic a, const Quadratic b, const intv is_b) {
    Quadratic q = {select(a.slope, b.slope, is_b), select(a.offset, b.offset, is_b), select(a.least, b.least, is_b),
                   select(a.nearest, b.nearest, is_b), select(a.ahead, b.ahead, is_b)};
#ifdef SHAPES
    q.bare = select(a.bare, b.bare, is_b), q.bare_rest = select(a.bare_rest, b.bare_rest, is_b);
#endif
#ifdef WIDENS
    q.bare_slope = select(a.bare_slope, b.bare_slope, is_b);
    q.bare_nearest = select(a.bare_nearest, b.bare_nearest, is_b);
    q.bare_ahead = select(a.bare_ahead, b.bare_ahead, is_b);
#endif
    return q;
}

#ifdef SERIES
// Adds the square of a thickness that changes along the ray: so thick at the parameter of the least, and by so much
// thicker with s. The sum of two squares is (slope s + offset)^2 + least again.
INLINE Quadratic widened(const Quadratic q, const floatv thickness, const floatv widening) {
    const floatv slope2 = fma(q.slope, q.slope, widening * widening);
    const floatv slope = 0.5f * twice_sqrt(max(slope2, 1e-36f));
    const floatv per_slope = inverse(slope);
    // From there on, the sum is slope2 x^2 + 2 (..) x + ..
    const floatv to_least = -fma(q.slope, q.ahead, widening * thickness) * per_slope * per_slope;
    const floatv beside = fma(q.slope, thickness, -widening * q.ahead) * per_slope;
    Quadratic w = q;
    w.slope = slope;
    w.nearest = q.nearest + to_least;
    w.ahead = splat(0.0f);
    w.offset = -slope * w.nearest;
    w.least = fma(beside, beside, q.least);
    return w;
}
#endif
