// How far from a core's image a pixel is, and which part of the core lights it. Less than a pixel or so from a core the
// image is not smooth; nor is it where neighbours see different parts of a curve with a local intensity.
#pragma once
#include "field/beam.h"
#include "field/cylinder.h"
#include "field/sphere.h"
#include "peaks/curve_panels.h"
#include "peaks/torus.h"

#define PLACES_SEEN 3

typedef struct {
    floatv distance2;         // between ray and core, squared, in pixels as large as they are there
    floatv seen[PLACES_SEEN]; // from the ray's closest approach, its begin and its end: where on the core the nearest
                              // point lies, in pieces of a local intensity; 0 where there is none
} Clearance;

// A squared distance from the point s of the ray, in pixels; `pixel_step` is the side of one on the projection plane.
floatv in_pixels2(const Ray *const ray, const float pixel_step, const floatv s, const floatv distance2) {
    const floatv side = pixel_step * fma(ray->stretch, s, splat(1.0f));
    return distance2 * inverse(side * side);
}

Clearance clear_by(const floatv distance2) {
    const Clearance clearance = {distance2, {splat(0.0f), splat(0.0f), splat(0.0f)}};
    return clearance;
}

// Lengths are doubled.
Clearance quadratic_clearance(const Ray *const ray, const Quadratic *const distance2, const float pixel_step) {
    const floatv s = clamp(nearest_along(distance2), 0.0f, ray->end);
    return clear_by(in_pixels2(ray, pixel_step, s, 0.25f * quadratic_at(distance2, s)));
}

Clearance sphere_clearance(const Ray *const ray, const Sources *const sources, const uint index,
                           const float pixel_step) {
    const sphere_path path = sphere_along(ray, sources, index);
    return quadratic_clearance(ray, &path.distance2, pixel_step);
}

Clearance cylinder_clearance(const Ray *const ray, const Sources *const sources, const uint index,
                             const float pixel_step) {
    const cylinder_path path = cylinder_along(ray, sources, index);
    return quadratic_clearance(ray, &path.distance2, pixel_step);
}

// The line ahead of the tip, or the tip. Lengths are doubled.
Clearance beam_clearance(const Ray *const ray, const Sources *const sources, const uint index, const float pixel_step) {
    const beam_path path = beam_along(ray, sources, index);
    const floatv s = clamp(nearest_along(&path.to_line), 0.0f, ray->end);
    const floatv ahead = path.has_taper ? fma(path.taper_slope, s, path.taper) : fma(path.height_slope, s, path.height);
    const Clearance of_line = quadratic_clearance(ray, &path.to_line, pixel_step);
    const Clearance of_tip = quadratic_clearance(ray, &path.to_tip, pixel_step);
    Clearance clearance = clear_by(select(of_tip.distance2, min(of_line.distance2, of_tip.distance2), ahead >= 0.0f));
    // Where line and cap differ, light has a kink where the plane through the tip passes the begin or the end of rays.
    const floatv jump = splat(!path.has_taper && path.line != path.cap ? 1.0f : 0.0f);
    clearance.seen[1] = select(splat(0.0f), jump, path.height < 0.0f);
    clearance.seen[2] = select(splat(0.0f), jump, fma(path.height_slope, ray->end, path.height) < 0.0f);
    return clearance;
}

// The distance of a peak from the ray, which it has in the complex plane.
floatv peak_clearance2(const Ray *const ray, const Peak peak, const float pixel_step) {
    const floatv s = clamp(peak.re, 0.0f, ray->end);
    const floatv beyond = peak.re - s;
    const floatv distance2 = fma(beyond, beyond, peak.im * peak.im) * ray->length * ray->length;
    return in_pixels2(ray, pixel_step, s, distance2);
}

Clearance torus_clearance(const Ray *const ray, const Sources *const sources, const uint index,
                          const float pixel_step) {
    const torus_peaks peaks = torus_peaks_along(ray, sources, index);
    return clear_by(min(peak_clearance2(ray, peaks.first, pixel_step), peak_clearance2(ray, peaks.second, pixel_step)));
}

// Both closest approaches of the ray's line, where the ray has them. Lengths are doubled.
Clearance curve_clearance(const Ray *const ray, const Sources *const sources, const uint index,
                          const float pixel_step) {
    const curve_peaks peaks = curve_peaks_along(ray, sources, index);
    const curve_path *const path = &peaks.path;
    const curve_sight first = curve_seen_from(path, clamp(peaks.first, 0.0f, ray->end));
    const curve_sight second = curve_seen_from(path, clamp(peaks.second, 0.0f, ray->end));
    const floatv to_first2 = in_pixels2(ray, pixel_step, first.s, first.distance2 + path->softening2);
    const floatv to_second2 = in_pixels2(ray, pixel_step, second.s, second.distance2 + path->softening2);
    Clearance clearance = clear_by(0.25f * min(to_first2, to_second2));
    if (path->spline_count) {
        const float pieces = (float)path->spline_count;
        clearance.seen[0] = pieces * select(first.x, second.x, to_second2 < to_first2);
        clearance.seen[1] = pieces * curve_seen_from(path, splat(0.0f)).x;
        clearance.seen[2] = pieces * curve_seen_from(path, ray->end).x;
    }
    return clearance;
}
