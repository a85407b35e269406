// A torus' field beside a point of a ray, with the digits that it needs close to the ring.
#pragma once
#include "../../../fine.h"
#include "../../../roots.h"
#include "peaks.h"

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
