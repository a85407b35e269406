// How far from a core's image a pixel is: the squared distance between ray and core, in pixels as large as they are
// there. Less than a pixel or so from a core the image is not smooth.
#pragma once
#include "field/cylinder.h"
#include "field/sphere.h"
#include "peaks/curve_panels.h"
#include "peaks/torus.h"

// A squared distance from the point s of the ray, in pixels; `pixel_step` is the side of one on the projection plane.
floatv in_pixels2(const Ray *const ray, const float pixel_step, const floatv s, const floatv distance2) {
    const floatv side = pixel_step * fma(ray->stretch, s, splat(1.0f));
    return distance2 * inverse(side * side);
}

// Lengths are doubled.
floatv quadratic_clearance2(const Ray *const ray, const Quadratic *const distance2, const float pixel_step) {
    const floatv s = clamp(nearest_along(distance2), 0.0f, 1.0f);
    return in_pixels2(ray, pixel_step, s, 0.25f * quadratic_at(distance2, s));
}

floatv sphere_clearance2(const Ray *const ray, const Sources *const sources, const uint index, const float pixel_step) {
    const sphere_path path = sphere_along(ray, sources, index);
    return quadratic_clearance2(ray, &path.distance2, pixel_step);
}

floatv cylinder_clearance2(const Ray *const ray, const Sources *const sources, const uint index,
                           const float pixel_step) {
    const cylinder_path path = cylinder_along(ray, sources, index);
    return quadratic_clearance2(ray, &path.distance2, pixel_step);
}

// The distance of a peak from the ray, which it has in the complex plane.
floatv peak_clearance2(const Ray *const ray, const Peak peak, const float pixel_step) {
    const floatv s = clamp(peak.re, 0.0f, 1.0f);
    const floatv beyond = peak.re - s;
    const floatv distance2 = fma(beyond, beyond, peak.im * peak.im) * ray->length * ray->length;
    return in_pixels2(ray, pixel_step, s, distance2);
}

floatv torus_clearance2(const Ray *const ray, const Sources *const sources, const uint index, const float pixel_step) {
    const torus_peaks peaks = torus_peaks_along(ray, sources, index);
    return min(peak_clearance2(ray, peaks.first, pixel_step), peak_clearance2(ray, peaks.second, pixel_step));
}

// Both closest approaches of the ray's line, where the ray has them, and both ends of the ray. Lengths are doubled.
floatv curve_clearance2(const Ray *const ray, const Sources *const sources, const uint index, const float pixel_step) {
    const curve_peaks peaks = curve_peaks_along(ray, sources, index);
    const curve_path *const path = &peaks.path;
    const floatv first = clamp(peaks.first, 0.0f, 1.0f), second = clamp(peaks.second, 0.0f, 1.0f);
    const floatv to_first2 = curve_seen_from(path, first).distance2 + path->softening2;
    const floatv to_second2 = curve_seen_from(path, second).distance2 + path->softening2;
    return 0.25f * min(in_pixels2(ray, pixel_step, first, to_first2), in_pixels2(ray, pixel_step, second, to_second2));
}
