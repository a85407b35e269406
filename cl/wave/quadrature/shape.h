// The integral over a stretch of a ray whose squared distance is a quadratic, of a field of any shape (profile.h): in
// closed form, or by nodes, on both sides of the closest approach, as far as there is light.
#pragma once
#include "../source/names.h"
#include "closed_form.h"
#include "closed_form_shape.h"
#include "panel.h"
#include "quadrature.h"

#if defined(SHAPES) && defined(EXACT)
typedef struct {
    Stretch stretch;
    Quadratic distance2;
    Profile profile;
    floatv left2; // what the least squared distance lacks to where light ends
} stretch_peaks;

INLINE uint stretch_panels(const stretch_peaks *const peaks, const Quadrature *const quadrature, floatv *const from,
                           floatv *const to, floatv *const integral) {
    from[1] = peaks->stretch.from;
    to[0] = peaks->stretch.to;
    to[1] = from[0] = clamp(peaks->distance2.nearest, from[1], to[0]);
    *integral = splat(0.0f);
    return 2;
}

// The stretch beside a point of the ray. Lengths are doubled.
typedef struct {
    floatv ahead, slope, least; // squared distance (ahead + slope x)^2 + least
    floatv light, growth, left2;
#ifdef WIDENS
    floatv bare_ahead, bare_slope; // of the squared distance without softening
#endif
    Profile profile;
} stretch_near;

INLINE stretch_near stretch_approach(const stretch_peaks *const peaks, const floatv from, const floatv to,
                                     Peak *const peak, floatv *const base) {
    const Quadratic *const distance2 = &peaks->distance2;
    const Stretch *const stretch = &peaks->stretch;
    const floatv per_slope = inverse(max(distance2->slope, 1e-18f));
    *base = clamp(distance2->nearest, from, to);
    stretch_near near;
    near.ahead = along_at(distance2, *base, splat(0.0f));
    near.slope = distance2->slope;
    near.least = distance2->least;
    near.growth = (stretch->light_to - stretch->light_from) * inverse(max(stretch->to - stretch->from, 1e-30f));
    near.light = fma(near.growth, *base - stretch->from, stretch->light_from);
    near.profile = peaks->profile;
    near.left2 = peaks->left2;
#ifdef WIDENS
    near.bare_slope = distance2->bare_slope;
    near.bare_ahead = fma(distance2->bare_slope, *base - distance2->bare_nearest, distance2->bare_ahead);
#endif
    peak->re = -near.ahead * per_slope;
    peak->im = 0.5f * twice_sqrt(max(near.least, peaks->profile.floor2)) * per_slope;
    peak->is_flat = near.least < peaks->profile.floor2;
    return near;
}

// Returns the field times the light at s = base + x.
INLINE floatv stretch_near_field(const stretch_near *const near, const floatv x) {
    const floatv ahead = fma(near->slope, x, near->ahead);
    const floatv distance2 = fma(ahead, ahead, near->least);
    const floatv per_distance = coarse_twice_inverse_sqrt(max(distance2, near->profile.floor2));
#ifdef WIDENS
    const floatv bare_ahead = fma(near->bare_slope, x, near->bare_ahead);
#else
    const floatv bare_ahead = ahead;
#endif
    const floatv left2 = max(fma(-bare_ahead, bare_ahead, near->left2), 0.0f);
    return fma(near->growth, x, near->light) * shaped(&near->profile, distance2, left2, per_distance);
}

#define stretch_has_kinks 1 // a window is less smooth than a peak
#define KIND stretch
#include "adaptive.h" // stretch_integral_of
#undef KIND

// Integrates over what is lit of a stretch.
CALL_IF_SCALAR floatv shape_over(const Stretch whole, const Quadratic *const distance2, const Profile *const profile,
                                 const Quadrature *const quadrature) {
    const floatv left2 = left_at_least(profile, distance2);
#if !defined(FADING) && !defined(SQUARED)
    floatv closed;
    if (quadrature->decay.beta == 0.0f && closed_shape_over(&whole, distance2, profile, left2, &closed))
        return quadrature->decay.strength * closed;
#endif
    stretch_peaks peaks = {whole, *distance2, *profile, left2};
    intv is_lit = whole.to > whole.from;
    floatv from = whole.from, to = whole.to;
    if (HAS_END(profile)) {
#ifdef WIDENS
        const floatv per_slope = inverse(max(distance2->bare_slope, 1e-18f));
        const floatv middle = fma(-distance2->bare_ahead, per_slope, distance2->bare_nearest);
#else
        const floatv per_slope = inverse(max(distance2->slope, 1e-18f));
        const floatv middle = fma(-distance2->ahead, per_slope, distance2->nearest);
#endif
        const floatv half_length = 0.5f * twice_sqrt(max(left2, 1e-30f)) * per_slope;
        is_lit = left2 > 0.0f;
        from = max(from, middle - half_length), to = min(to, middle + half_length);
    }
#ifdef FADING
    to = min(to, darkness(quadrature->decay));
    const bool is_trimmed = true;
#else
    const bool is_trimmed = HAS_END(profile);
#endif
    if (is_trimmed) {
        const intv is_there = is_lit & (to > from);
        if (!any_lane(is_there))
            return splat(0.0f);
        const floatv growth = (whole.light_to - whole.light_from) * inverse(max(whole.to - whole.from, 1e-30f));
        peaks.stretch.from = select(whole.from, from, is_there);
        peaks.stretch.to = select(whole.from, to, is_there);
        peaks.stretch.light_from = fma(growth, peaks.stretch.from - whole.from, whole.light_from);
        peaks.stretch.light_to = fma(growth, peaks.stretch.to - whole.from, whole.light_from);
    }
    return stretch_integral_of(&peaks, quadrature);
}
#endif
