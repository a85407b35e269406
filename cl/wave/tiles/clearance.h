// How far from a core's image a pixel is, and which part of the core lights it. Less than a pixel or so from a core the
// image is not smooth; nor is it where neighbours see different parts of a curve with a local intensity.
#pragma once
#include "../../view.h"
#include "../quadrature/panel.h"
#include "../source/quadratic.h"

#define PLACES_SEEN 3

typedef struct {
    floatv distance2;         // between ray and core, squared, in pixels as large as they are there
    floatv seen[PLACES_SEEN]; // from the ray's closest approach, its begin and its end: where on the core the nearest
                              // point lies, in pieces of a local intensity; 0 where there is none
} Clearance;

// Returns a squared distance from the point s of the ray, in pixels; `pixel_step` is the side of one on the projection
// plane.
floatv in_pixels2(const Ray *const ray, const float pixel_step, const floatv s, const floatv distance2) {
    const floatv side = pixel_step * fma(ray->stretch, s, splat(1.0f));
    return distance2 * inverse(side * side);
}

Clearance clear_by(const floatv distance2) {
    const Clearance clearance = {distance2, {splat(0.0f), splat(0.0f), splat(0.0f)}};
    return clearance;
}

// Returns the clearance of a quadratic squared distance. Lengths are doubled.
Clearance quadratic_clearance(const Ray *const ray, const Quadratic *const distance2, const float pixel_step) {
    const floatv s = clamp(distance2->nearest, 0.0f, ray->end);
    return clear_by(in_pixels2(ray, pixel_step, s, 0.25f * quadratic_at(distance2, s)));
}

// Returns the squared distance of a peak from the ray, where it lies in the complex plane.
floatv peak_clearance2(const Ray *const ray, const Peak peak, const float pixel_step) {
    const floatv s = clamp(peak.re, 0.0f, ray->end);
    const floatv beyond = peak.re - s;
    const floatv distance2 = fma(beyond, beyond, peak.im * peak.im) * ray->length * ray->length;
    return in_pixels2(ray, pixel_step, s, distance2);
}
