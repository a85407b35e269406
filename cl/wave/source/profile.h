// How a field falls off with the distance d to its core: a profile of q, q^2 = d^2 + radius^2, times a window that ends
// at the source's reach. 1/q and its square without a window have closed forms (quadrature/stretch.h); of what else
// there is, shapes, some have where light does not fade (quadrature/closed_form_shape.h). Only programs for scenes with
// inverse squares (-D INVERSE_SQUARES), or with shapes (-D SHAPES), contain them.
#pragma once
#include "../../elementary.h"
#include "../../view.h"
#include "../types.h"

// Of a path, whose lengths are doubled.
typedef struct {
    floatv softening2; // in every squared distance, of the source and of the scene
    floatv floor2;     // no squared distance is taken below this
    uint is_square;
#ifdef SHAPES
    uint number;                  // as types.h says
    float per_reach2, per_width2; // 1 over the squared reach, and over twice the squared width of a Gaussian
    float end2, end2_rest;        // squared distance at which light ends, without softening; what float32 leaves of it
#endif
} Profile;

#ifdef INVERSE_SQUARES
#define IS_SQUARE(profile) ((profile)->is_square)
#else
#define IS_SQUARE(profile) 0u
#endif

#if defined(FADING) || defined(SQUARED) // have no closed forms
#define IS_SHAPED(profile) 1
#define HAS_END(profile) ((profile)->end2 < ENDLESS)
#elif defined(SHAPES)
#define IS_SHAPED(profile) ((profile)->number > 1u || (profile)->per_reach2 > 0.0f)
#define HAS_END(profile) ((profile)->end2 < ENDLESS)
#else
#define IS_SHAPED(profile) 0
#define HAS_END(profile) 0
#endif

// A squared distance beyond all.
#define ENDLESS 1e36f

// Beyond so many standard deviations a Gaussian is 0.
#ifndef GAUSSIAN_END // a test spoils it
#define GAUSSIAN_END 9.0f
#endif

INLINE Profile profile_of(const Ray *const ray, __global const Falloff *const falloff) {
    Profile profile;
    profile.softening2 = 4.0f * (ray->softening2 + falloff->radius2);
    profile.floor2 = 4.0f * ray->floor2;
    profile.is_square = falloff->profile == 1u;
#ifdef SHAPES
    profile.number = falloff->profile;
    profile.per_reach2 = falloff->reach2 > 0.0f ? 0.25f / falloff->reach2 : 0.0f;
    profile.per_width2 = falloff->radius2 > 0.0f ? 0.125f / falloff->radius2 : 0.0f;
    profile.end2 = profile.number == 3u ? 4.0f * GAUSSIAN_END * GAUSSIAN_END * falloff->radius2 : ENDLESS;
    profile.end2_rest = 0.0f;
    if (falloff->reach2 > 0.0f && 4.0f * falloff->reach2 <= profile.end2)
        profile.end2 = 4.0f * falloff->reach2, profile.end2_rest = 4.0f * falloff->reach2_rest;
#endif
    return profile;
}

// Returns the field of a closed form, from 1 over the distance.
floatv profiled(const floatv per_distance, const uint is_square) {
    return is_square ? per_distance * per_distance : per_distance;
}

#ifdef SHAPES
// Returns exp(-x) for x >= 0, as far as a Gaussian goes.
floatv fading(const floatv x) {
    const float end = 0.5f * GAUSSIAN_END * GAUSSIAN_END;
    return select(power_of_two(-min(x, end) * (1.0f / LN_2)), splat(0.0f), x > end);
}

// Returns erf(x) / x for x > 0: Abramowitz, Stegun 1964, 7.1.26, within 2e-7, and the series where x is small.
floatv error_function_ratio(const floatv x) {
    const floatv x2 = x * x;
    const floatv t = inverse(fma(splat(0.3275911f), x, splat(1.0f)));
    floatv sum = fma(splat(1.061405429f), t, splat(-1.453152027f));
    sum = fma(fma(fma(sum, t, splat(1.421413741f)), t, splat(-0.284496736f)), t, splat(0.254829592f));
    const floatv far = fma(-sum * t, fading(x2), splat(1.0f)) * inverse(max(x, 1e-3f));
    floatv series = fma(splat(-1.0f / 1320.0f), x2, splat(1.0f / 216.0f));
    series = fma(fma(fma(series, x2, splat(-1.0f / 42.0f)), x2, splat(0.1f)), x2, splat(-1.0f / 3.0f));
    return select(far, 1.128379167f * fma(series, x2, splat(1.0f)), x2 < 0.25f);
}

// Returns what a squared distance without softening lacks to where light ends, a reach; 0 beyond.
INLINE floatv left_of(const Profile *const profile, const floatv bare2) {
    return max((profile->end2 - bare2) + profile->end2_rest, 0.0f);
}

// Returns the field of any shape, from the squared distance with softening, what it lacks to where light ends, and 1
// over the distance.
INLINE floatv shaped(const Profile *const profile, const floatv distance2, const floatv left2,
                     const floatv per_distance) {
    const floatv bare2 = max(distance2 - profile->softening2, 0.0f);
    floatv field;
    switch (profile->number) {
    case 0:
        field = per_distance;
        break;
    case 1:
        field = per_distance * per_distance;
        break;
    case 2:
        field = per_distance * per_distance * per_distance;
        break;
    case 3:
        field = fading(bare2 * profile->per_width2);
        break;
    default: {
        const float per_width = 2.0f * sqrt(profile->per_width2);
        field = per_width * error_function_ratio(0.5f * per_width * 0.5f * twice_sqrt(max(bare2, 1e-30f)));
    }
    }
    floatv inside = splat(1.0f);
    if (profile->per_reach2 > 0.0f) // a Gaussian may end before its reach
        inside = profile->end2 * profile->per_reach2 > 0.999f
                     ? left2 * profile->per_reach2
                     : max(fma(bare2, splat(-profile->per_reach2), splat(1.0f)), 0.0f);
#ifndef window2 // a test spoils it
#define window2 (inside * inside)
#endif
    return field * window2;
}
#endif

// Returns the field, from the squared distance with softening, and 1 over the distance.
INLINE floatv field_of(const Profile *const profile, const floatv distance2, const floatv per_distance) {
#ifdef SHAPES
    if (IS_SHAPED(profile))
        return shaped(profile, distance2, left_of(profile, distance2 - profile->softening2), per_distance);
#endif
#ifdef INVERSE_SQUARES
    return profiled(per_distance, profile->is_square);
#else
    return per_distance;
#endif
}

INLINE floatv field_at(const Profile *const profile, const floatv distance2) {
    return field_of(profile, distance2, twice_inverse_sqrt(max(distance2, profile->floor2)));
}

// Returns the field of a core whose thickness is its own: from the squared distance without softening, and with it.
INLINE floatv field_of_core(const Profile *const profile, const floatv bare2, const floatv distance2) {
#ifdef SHAPES
    if (IS_SHAPED(profile))
        return shaped(profile, distance2, left_of(profile, bare2), twice_inverse_sqrt(max(distance2, profile->floor2)));
#endif
    return field_at(profile, distance2);
}

// Clips a part of a ray to where a core within a ball can light it.
INLINE void clip_to_ball(const Ray *const ray, const float4 center, const float radius, const Profile *const profile,
                         floatv *const begin, floatv *const end) {
#ifdef SHAPES
    const float reach = 1.0001f * (radius + 0.5f * sqrt(profile->end2));
    const float3v from_center = subtract3(ray->origin, uniform3(center));
    const floatv per_length2 = inverse(ray->length * ray->length);
    const floatv middle = -dot3(from_center, ray->span) * per_length2;
    const float3v nearest = fma3(ray->span, middle, from_center);
    const floatv left2 = fma(splat(reach), splat(reach), -dot3(nearest, nearest));
    const floatv half_length = 0.5f * twice_sqrt(max(left2 * per_length2, 1e-30f));
    *begin = clamp(middle - half_length, *begin, *end);
    *end = select(*begin, clamp(middle + half_length, *begin, *end), left2 > 0.0f);
#endif
}
