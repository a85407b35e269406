// Torus: 1 / sqrt((rho - R)^2 + z^2), rho the distance to the axis, z the height over the ring's plane (Watanabe, Abe,
// Konno 2015, eq. 7), or its square. Along a ray rho^2 is a quadratic and z is linear.
//
// Where the field peaks along a ray: in complex s its squared distance (rho - R)^2 + z^2 is (rho - R + i z) (rho - R -
// i z), which is 0 where rho^2 = (R + i z)^2, that is |P|^2 = R^2 + 2 i R z: a quadratic equation in s, P seen from the
// ring's centre. Its two roots are the ray's two passes at the ring; beside the ring's axis, where rho has a kink or
// nearly so, the ray is cut.
#pragma once
#include "../../fine.h"
#include "../../roots.h"
#include "../../view.h"
#include "../footprint/closest.h"
#include "../quadrature/panel.h"
#include "../quadrature/quadrature.h"
#include "../tiles/clearance.h"
#include "names.h"
#include "profile.h"
#include "quadratic.h"
#include "sources.h"

typedef struct Torus {
    float4 center, center_rest;
    float4 axis, axis_rest; // unit
    float4 emission;
    float major_radius, major_radius_rest;
    uint padding_0, padding_1;
    Falloff falloff;
} Torus;
CHECK_SIZE(Torus, SIZEOF_TORUS);

#define torus_is_quick 0

#define torus_has_peaks_along 1
#define torus_has_two_panels 1 // on both sides of the axis

// Lengths are doubled, but for rho^2, whose root doubles.
typedef struct {
    Quadratic rho2;
    floatv height, height_slope;
    float major_radius;
    Profile profile;
} torus_path;

INLINE torus_path torus_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Torus *const torus = &sources->torus_list[index];
    const float3v axis = uniform3(torus->axis);
    const float3v from_center = subtract3(ray->origin, uniform3(torus->center));
    const float3v span = cross3(ray->span, axis);
    const torus_path path = {squared_length_along(cross3(from_center, axis), span, length3(span)),
                             2.0f * dot3(from_center, axis), 2.0f * dot3(ray->span, axis), 2.0f * torus->major_radius,
                             profile_of(ray, &torus->falloff)};
    return path;
}

floatv torus_field(const torus_path *const path, const floatv s) {
    const floatv from_ring = twice_sqrt_less(quadratic_at(&path->rho2, s), splat(path->major_radius));
    const floatv height = fma(path->height_slope, s, path->height);
    const floatv distance2 = fma(from_ring, from_ring, fma(height, height, path->profile.softening2));
    return field_at(&path->profile, distance2);
}

#ifdef SHAPES
#ifndef TORUS_BENDS // a test spoils it
#define TORUS_BENDS 1.0f
#endif

// Returns the squared distance at s, without softening, its slope there, and half of its curvature, or more: of a ring
// that the ray is within, as if the way to it did not bend.
INLINE floatv torus_offset2(const torus_path *const path, const floatv s, floatv *const slope,
                            floatv *const half_curvature) {
    const floatv across = fma(path->rho2.slope, s, path->rho2.offset);
    const floatv rho = twice_sqrt(fma(across, across, path->rho2.least));
    const floatv height = fma(path->height_slope, s, path->height);
    const floatv from_ring = rho - path->major_radius;
    const floatv per_rho = inverse(rho), rho_slope = 4.0f * across * path->rho2.slope * per_rho;
    const floatv bent = 4.0f * path->rho2.slope * per_rho, rho_curvature = bent * bent * path->rho2.least * per_rho;
    *slope = 2.0f * fma(from_ring, rho_slope, height * path->height_slope);
    *half_curvature = fma(rho_slope, rho_slope, path->height_slope * path->height_slope) +
                      TORUS_BENDS * max(from_ring, 0.0f) * rho_curvature;
    return fma(from_ring, from_ring, height * height);
}
#endif

typedef struct {
    torus_path path;
    Peak first, second;
    floatv begin, end; // where the ray is lit
    const Ray *ray;
    __global const Torus *torus;
} torus_peaks;

INLINE torus_peaks torus_peaks_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Torus *const torus = &sources->torus_list[index];
    torus_peaks peaks;
    peaks.path = torus_along(ray, sources, index);
    peaks.ray = ray;
    peaks.torus = torus;
    const float radius = torus->major_radius;
    const floatv per_length = inverse(ray->length);
    const float3v direction = scale3(ray->span, per_length);
    const float3v from_center = subtract3(ray->origin, uniform3(torus->center));
    const floatv to_nearest = -dot3(from_center, direction); // the point next to the centre, a length along the ray
    const float3v nearest = fma3(direction, to_nearest, from_center);
    const floatv height = dot3(nearest, uniform3(torus->axis));
    const floatv climb = 0.5f * peaks.path.height_slope * per_length;
    const floatv across = radius * peaks.path.rho2.slope * per_length;

    // s |E - S| = to_nearest + i R climb +- sqrt(re + i im)
    const floatv re = fma(across, across, -dot3(nearest, nearest));
    const floatv im = 2.0f * radius * height;
    const floatv size = 0.5f * twice_sqrt(max(fma(re, re, im * im), 1e-36f));
    const floatv larger = 0.5f * twice_sqrt(max(0.5f * (size + fabs(re)), 1e-18f));
    const floatv smaller = 0.5f * im * inverse(larger);
    const floatv root_re = select(fabs(smaller), larger, re > 0.0f) * per_length;
    const floatv root_im = select(copysign(larger, im), smaller, re > 0.0f);
    const floatv middle = to_nearest * per_length;
    const floatv lift = radius * climb;
    const floatv blur2 = 0.25f * peaks.path.profile.softening2 + 0.5f * ray->floor2;
    const floatv below = lift - root_im, above = lift + root_im;
    peaks.first.re = middle - root_re;
    peaks.second.re = middle + root_re;
    peaks.first.im = 0.5f * twice_sqrt(fma(below, below, blur2)) * per_length;
    peaks.second.im = 0.5f * twice_sqrt(fma(above, above, blur2)) * per_length;
    peaks.first.is_flat = below * below < ray->floor2;
    peaks.second.is_flat = above * above < ray->floor2;
    peaks.begin = splat(0.0f), peaks.end = ray->end;
    if (HAS_END(&peaks.path.profile))
        clip_to_ball(ray, torus->center, radius, &peaks.path.profile, &peaks.begin, &peaks.end);
    return peaks;
}

#ifdef SHAPES
INLINE floatv torus_edge_distance2(const torus_peaks *const peaks, const floatv s, floatv *const slope,
                                   floatv *const half_curvature) {
    return torus_offset2(&peaks->path, s, slope, half_curvature);
}
#endif

// Cuts the ray into panels, the last one first.
INLINE uint torus_panels(const torus_peaks *const peaks, const Quadrature *const quadrature, floatv *const from,
                         floatv *const to, floatv *const integral) {
    const Quadratic *const rho2 = &peaks->path.rho2;
    to[0] = peaks->end;
    to[1] = from[0] = clamp(rho2->nearest, peaks->begin, to[0]);
    from[1] = peaks->begin;
    *integral = splat(0.0f);
    return 2;
}

// The field beside a point of the ray. rho^2 - R^2 is a polynomial there that loses no digits at the ring. Lengths are
// doubled, but for those of rho^2, whose root doubles.
typedef struct {
    floatv across, across_slope, rho2_least; // rho^2 = (across + slope x)^2 + least
    floatv excess, excess_slope;             // rho^2 - R^2 and its derivative, doubled
    floatv height, height_slope;
    float major_radius;
    floatv softening2, floor2;
    Profile profile;
#ifdef SHAPES
    floatv rho, from_ring, left2; // at the base; left2 is what the squared distance there lacks to where light ends
#endif
} torus_near;

INLINE torus_near torus_near_at(const torus_peaks *const peaks, const floatv base) {
    const torus_path *const path = &peaks->path;
    const float radius2 = path->major_radius * path->major_radius;
    torus_near near;
    near.across = fma(path->rho2.slope, base, path->rho2.offset);
    near.across_slope = path->rho2.slope;
    near.rho2_least = path->rho2.least;
    near.major_radius = path->major_radius;
    near.excess = fma(fma(near.across, near.across, near.rho2_least), splat(4.0f), splat(-radius2));
    near.excess_slope = 8.0f * near.across * near.across_slope;
    near.height = fma(path->height_slope, base, path->height);
    near.height_slope = path->height_slope;
    near.softening2 = path->profile.softening2;
    near.floor2 = path->profile.floor2;
    near.profile = path->profile;
    return near;
}

// Refines the two values that are small differences close to the ring.
INLINE void torus_near_refine(const torus_peaks *const peaks, const floatv base, torus_near *const near) {
    __global const Torus *const torus = peaks->torus;
    const fine3v from_center = fine_between(peaks->ray, base, torus->center, torus->center_rest);
    const finev height = fine_dot3(from_center, fine3(torus->axis, torus->axis_rest));
    const finev radius = uniform_fine(torus->major_radius, torus->major_radius_rest);
    const finev beside = fine_fma(fine_negate(height), height, fine_dot3(from_center, from_center));
    near->height = 2.0f * from_finev(height);
    near->excess = 4.0f * from_finev(fine_subtract(beside, fine_multiply(radius, radius)));
}

#ifdef SHAPES
// Finds what the squared distance at the base lacks to where light ends: there its last digits count.
INLINE void torus_near_left(const torus_peaks *const peaks, const floatv base, torus_near *const near) {
    __global const Torus *const torus = peaks->torus;
    const Profile *const profile = &near->profile;
    if (!HAS_END(profile))
        return;
    const fine3v from_center = fine_between(peaks->ray, base, torus->center, torus->center_rest);
    const finev height = fine_dot3(from_center, fine3(torus->axis, torus->axis_rest));
    const finev height2 = fine_multiply(height, height);
    const finev rho2 = fine_subtract(fine_dot3(from_center, from_center), height2);
    const floatv rho = 0.5f * twice_sqrt(max(from_finev(rho2), 1e-30f));
    const finev fine_rho = to_finev(rho);
    const floatv rest = 0.5f * inverse(rho) * from_finev(fine_subtract(rho2, fine_multiply(fine_rho, fine_rho)));
    const finev radius = uniform_fine(torus->major_radius, torus->major_radius_rest);
    const finev from_ring = fine_subtract(fine_add(fine_rho, to_finev(rest)), radius);
    const finev distance2 = fine_fma(from_ring, from_ring, height2);
    const finev end2 = uniform_fine(profile->end2, profile->end2_rest);
    near->rho = 2.0f * rho;
    near->from_ring = 2.0f * from_finev(from_ring);
    near->left2 = from_finev(fine_fma(distance2, to_finev(splat(-4.0f)), end2));
}
#endif

// Distance from the ring within the plane through its axis, with its slope along the ray.
typedef struct {
    floatv from_ring, from_ring_slope, slope2;
} torus_offset;

INLINE torus_offset torus_offset_of(const torus_near *const near) {
    const floatv rho = twice_sqrt(fma(near->across, near->across, near->rho2_least));
    torus_offset offset;
    offset.from_ring = near->excess * inverse(rho + near->major_radius);
    offset.from_ring_slope = 0.5f * near->excess_slope * inverse(rho);
    offset.slope2 = fma(offset.from_ring_slope, offset.from_ring_slope, near->height_slope * near->height_slope);
    offset.slope2 = max(offset.slope2, 1e-30f);
    return offset;
}

INLINE torus_near torus_approach_core(const torus_peaks *const peaks, const floatv from, const floatv to,
                                      Peak *const peak, floatv *const base) {
    const torus_path *const path = &peaks->path;
    const float radius2 = path->major_radius * path->major_radius;
    *peak = nearer_peak(peaks->first, peaks->second, from, to);
    *base = clamp(peak->re, from, to);
    torus_near near = torus_near_at(peaks, *base);
    const intv is_close =
        max(fabs(near.excess), near.height * near.height) < (IS_SQUARE(&path->profile) ? 0.5f : 0.02f) * radius2;
    if (!any_lane(is_close)) {
        peak->re -= *base;
        return near;
    }

    // Close to the ring more digits are needed. Next to it the ring is straight, but for rays along it, and the root of
    // the quadratic may have lost too many.
    torus_near_refine(peaks, *base, &near);
    torus_offset offset = torus_offset_of(&near);
    const floatv distance2 = fma(offset.from_ring, offset.from_ring, near.height * near.height);
    const intv is_next =
        (distance2 < 1e-4f * radius2) & (offset.slope2 > 0.2f * peaks->ray->length * peaks->ray->length);
    // A ray along the ring is within the floor, or the softening, for as long as its distance grows with the square,
    // and has kinks where it leaves it.
    const floatv blur2 = path->profile.softening2 + path->profile.floor2, blur = 0.5f * twice_sqrt(blur2);
    const floatv bend = 2.0f * near.across_slope * near.across_slope * inverse(splat(path->major_radius));
    const floatv blurred = 0.5f * twice_inverse_sqrt_(fma(bend, blur, offset.slope2)) * blur;
    peak->im = select(peak->im, max(peak->im, blurred), is_close);
    peak->is_flat |= is_close & (distance2 < 4.0f * blur2);
    if (!any_lane(is_next)) {
        peak->re -= *base;
        return near;
    }
    const floatv to_nearest = -fma(offset.from_ring, offset.from_ring_slope, near.height * near.height_slope);
    const floatv nearer = clamp(fma(to_nearest, inverse(offset.slope2), *base), from, to);
    *base = select(*base, nearer, is_next);
    near = torus_near_at(peaks, *base);
    torus_near_refine(peaks, *base, &near);
    offset = torus_offset_of(&near);
    const floatv per_slope2 = inverse(offset.slope2);
    const floatv ahead = -fma(offset.from_ring, offset.from_ring_slope, near.height * near.height_slope) * per_slope2;
    const floatv aside = fma(offset.from_ring, near.height_slope, -near.height * offset.from_ring_slope);
    const floatv least = fma(aside * per_slope2, aside, path->profile.softening2);
    const floatv lifted = floored(least, path->profile.floor2, IS_SQUARE(&path->profile));
    const intv is_thin = is_next & (path->profile.floor2 < 1e-4f * radius2);
    near.softening2 += select(splat(0.0f), lifted - least, is_thin);
    near.floor2 = select(near.floor2, 0.5f * near.floor2, is_thin);
    peak->re = select(peak->re - *base, ahead, is_next);
    peak->im = select(peak->im, 0.5f * twice_sqrt(lifted * per_slope2), is_next);
    peak->is_flat &= !is_thin;
    return near;
}

INLINE torus_near torus_approach(const torus_peaks *const peaks, const floatv from, const floatv to, Peak *const peak,
                                 floatv *const base) {
    torus_near near = torus_approach_core(peaks, from, to, peak, base);
#ifdef SHAPES
    torus_near_left(peaks, *base, &near);
#endif
    return near;
}

// Returns the field at s = base + x: 1 / sqrt((rho - R)^2 + z^2) with rho - R = (rho^2 - R^2) / (rho + R).
INLINE floatv torus_near_field(const torus_near *const near, const floatv x) {
    const floatv across = fma(near->across_slope, x, near->across);
    const floatv sum = twice_sqrt_less(fma(across, across, near->rho2_least), splat(-near->major_radius));
    const floatv curvature = 4.0f * near->across_slope * near->across_slope;
    const floatv excess = fma(fma(curvature, x, near->excess_slope), x, near->excess);
    const floatv height = fma(near->height_slope, x, near->height);
    const floatv aside2 = fma(height, height, near->softening2);
    const floatv sum2 = sum * sum;
    const floatv scaled2 = max(fma(excess, excess, aside2 * sum2), near->floor2 * sum2);
    const floatv per_distance = sum * coarse_twice_inverse_sqrt(clamp(scaled2, 1e-36f, 1e38f));
#ifdef SHAPES
    if (IS_SHAPED(&near->profile)) {
        floatv left2 = splat(0.0f);
        if (HAS_END(&near->profile)) {
            const floatv rho = sum - near->major_radius, climbed = near->height_slope * x;
            const floatv farther = fma(curvature, x, near->excess_slope) * x * inverse(rho + near->rho);
            left2 = near->left2 - fma(farther, fma(splat(2.0f), near->from_ring, farther),
                                      climbed * fma(splat(2.0f), near->height, climbed));
        }
        return shaped(&near->profile, scaled2 * inverse(sum2), max(left2, 0.0f), per_distance);
    }
#endif
    return field_of(&near->profile, splat(0.0f), per_distance);
}

#ifdef SHAPES
// Finds where the ray comes closest to the ring, which far from it is not where it peaks, by Newton steps, and returns
// the squared distance there.
INLINE floatv torus_least_offset2(const torus_peaks *const peaks, floatv *const s) {
    floatv slope, half_curvature;
    for (int step = 0; step < 4; ++step) {
        torus_offset2(&peaks->path, *s, &slope, &half_curvature);
        *s = clamp(fma(-0.5f * slope, inverse(max(half_curvature, 1e-30f)), *s), 0.0f, peaks->ray->end);
    }
    return torus_offset2(&peaks->path, *s, &slope, &half_curvature);
}
#endif

Clearance torus_clearance(const Ray *const ray, const Sources *const sources, const uint index,
                          const float pixel_step) {
    const torus_peaks peaks = torus_peaks_along(ray, sources, index);
    const Profile *const profile = &peaks.path.profile;
    Clearance clearance = nearer_of(peak_clearance(ray, peaks.first, profile, pixel_step),
                                    peak_clearance(ray, peaks.second, profile, pixel_step));
#ifdef SHAPES
    floatv s[2] = {clamp(peaks.first.re, 0.0f, ray->end), clamp(peaks.second.re, 0.0f, ray->end)};
    for (int k = 0; k < 2 && HAS_END(profile); ++k) {
        const floatv distance2 = torus_least_offset2(&peaks, &s[k]);
        const Clearance found = clear_by(ray, pixel_step, s[k], distance2 + profile->softening2, profile);
        clearance.to_light = k == 0 ? found.to_light : min(clearance.to_light, found.to_light);
    }
#endif
    return clearance;
}

#ifdef FOOTPRINT
Closest torus_closest(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Torus *const torus = &sources->torus_list[index];
    const torus_peaks peaks = torus_peaks_along(ray, sources, index);
    floatv s[2] = {clamp(peaks.first.re, 0.0f, ray->end), clamp(peaks.second.re, 0.0f, ray->end)};
    floatv beside[2] = {peaks.first.im, peaks.second.im};
#ifdef SHAPES
    for (int k = 0; k < 2 && HAS_END(&peaks.path.profile); ++k)
        beside[k] = sqrt(torus_least_offset2(&peaks, &s[k]));
#endif
    for (int k = 0; k < 2; ++k)
        beside[k] *= inverse(fma(ray->stretch, s[k], splat(1.0f)));
    s[0] = select(s[0], s[1], beside[1] < beside[0]);
    const float3v axis = uniform3(torus->axis);
    const fine3v from_center = fine_between(ray, s[0], torus->center, torus->center_rest);
    const float3v at = from_fine3(from_center);
    const float3v in_plane = fma3(axis, -dot3(at, axis), at);
    const float3v outward = scale3(in_plane, 0.5f * twice_inverse_sqrt_(max(dot3(in_plane, in_plane), 1e-36f)));
    const Closest closest = {s[0],
                             fma3(outward, splat(torus->major_radius), scale3(at, splat(-1.0f))),
                             cross3(axis, outward),
                             splat(0.0f),
                             splat(1.0f),
                             (intv)(0)};
    return closest;
}
#endif

#ifdef EXACT
#define KIND torus
#include "../quadrature/adaptive.h" // torus_integral
#undef KIND
#endif
