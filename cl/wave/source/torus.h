// Torus: 1 / sqrt((rho - R)^2 + z^2), rho the distance to the axis, z the height over the ring's plane (Watanabe, Abe,
// Konno 2015, eq. 7), or its square. Along a ray rho^2 is a quadratic and z is linear.
//
// Where it peaks along a ray is in torus/peaks.h, what it is next to a peak in torus/near.h.
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

// These use the struct.
#include "torus/near.h"
#include "torus/peaks.h"

#ifdef SHAPES
// Finds where the ray comes closest to the ring, which far from it is not where it peaks, by Newton steps, and returns
// the squared distance there. Within the ring they are too short, so that one that is short tells nothing: all are
// taken.
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
