// How far from a core's image a pixel is, and which part of the core lights it. Less than a pixel or so from a core the
// image is not smooth; nor is it where neighbours see different parts of a curve with a local intensity.
#pragma once
#include "../../view.h"
#include "../quadrature/panel.h"
#include "../source/profile.h"
#include "../source/quadratic.h"

#define PLACES_SEEN 3

#ifdef FOOTPRINT
#define SEEN_BEYOND 0.75f
#else
#define SEEN_BEYOND 0.0f
#endif

typedef struct {
    floatv distance2;         // between ray and core, squared, in pixels as large as they are there
    floatv to_light;          // between ray and light, in such pixels; less than 0 where the ray is lit
    floatv seen[PLACES_SEEN]; // from the ray's closest approach, its begin and its end: where on the core the nearest
                              // point lies, in pieces of a local intensity; 0 where there is none
} Clearance;

// Returns the clearance of a core that a ray passes at the point s, from the squared distance with softening, doubled;
// `pixel_step` is the side of a pixel on the projection plane.
INLINE Clearance clear_by(const Ray *const ray, const float pixel_step, const floatv s, const floatv distance2,
                          const Profile *const profile) {
    const floatv per_side = inverse(pixel_step * fma(ray->stretch, s, splat(1.0f)));
    Clearance clearance = {
        0.25f * distance2 * per_side * per_side, splat(-1.0f), {splat(0.0f), splat(0.0f), splat(0.0f)}};
#ifdef SHAPES
    const floatv bare = 0.5f * twice_sqrt(max(distance2 - profile->softening2, 1e-30f));
    if (HAS_END(profile))
        clearance.to_light = fma(0.5f * (bare - sqrt(profile->end2)), per_side, splat(-SEEN_BEYOND));
#endif
    return clearance;
}

// Returns the clearance of a quadratic squared distance. Lengths are doubled.
Clearance quadratic_clearance(const Ray *const ray, const Quadratic *const distance2, const Profile *const profile,
                              const float pixel_step) {
    const floatv s = clamp(distance2->nearest, 0.0f, ray->end);
    return clear_by(ray, pixel_step, s, quadratic_at(distance2, s), profile);
}

// Returns the clearance of two parts of a core: the lesser one.
Clearance nearer_of(Clearance a, const Clearance b) {
    a.distance2 = min(a.distance2, b.distance2);
    a.to_light = min(a.to_light, b.to_light);
    return a;
}

Clearance select_clearance(Clearance a, const Clearance b, const intv is_b) {
    a.distance2 = select(a.distance2, b.distance2, is_b);
    a.to_light = select(a.to_light, b.to_light, is_b);
    return a;
}

// Returns the clearance of a peak, where it lies in the complex plane.
Clearance peak_clearance(const Ray *const ray, const Peak peak, const Profile *const profile, const float pixel_step) {
    const floatv s = clamp(peak.re, 0.0f, ray->end);
    const floatv beyond = peak.re - s;
    const floatv distance2 = fma(beyond, beyond, peak.im * peak.im) * ray->length * ray->length;
    return clear_by(ray, pixel_step, s, 4.0f * distance2, profile);
}
