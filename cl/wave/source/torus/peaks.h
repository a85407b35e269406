// Where a torus' field peaks along a ray: in complex s its squared distance (rho - R)^2 + z^2 is (rho - R + i z) (rho -
// R - i z), which is 0 where rho^2 = (R + i z)^2, that is |P|^2 = R^2 + 2 i R z: a quadratic equation in s, P seen from
// the ring's centre. Its two roots are the ray's two passes at the ring; beside the ring's axis, where rho has a kink
// or nearly so, the ray is cut.
#pragma once
#include "../../quadrature/panel.h"

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
    return peaks;
}

#ifdef SHAPES
INLINE EdgeView torus_edge_view(const torus_peaks *const peaks, const floatv s) {
    EdgeView view;
    view.distance2 = torus_offset2(&peaks->path, s, &view.slope, &view.half_curvature);
    return view;
}
#endif

#ifdef SHAPES
// Clips both panels to where a core can light them: to rho within R +- reach and z within +- reach, a square around the
// circle of what is lit.
INLINE void torus_clip(const torus_peaks *const peaks, floatv *const from, floatv *const to) {
    const torus_path *const path = &peaks->path;
    const Quadratic *const rho2 = &path->rho2;
    const float reach = 0.5001f * sqrt(path->profile.end2), radius = 0.5f * path->major_radius;
    const float inner = max(radius - reach, 0.0f), outer = radius + reach;
    const floatv per_slope = inverse(max(rho2->slope, 1e-18f));
    const floatv near = 0.5f * twice_sqrt(max(inner * inner - rho2->least, 1e-36f)) * per_slope;
    const floatv far = 0.5f * twice_sqrt(max(outer * outer - rho2->least, 1e-36f)) * per_slope;
    const intv is_level = fabs(path->height_slope) < 1e-18f;
    const floatv per_climb = inverse(select(path->height_slope, splat(1e-18f), is_level));
    const floatv middle = -path->height * per_climb, half_length = 2.0f * reach * fabs(per_climb);
    from[0] = clamp(max(rho2->nearest + near, middle - half_length), from[0], to[0]);
    to[0] = clamp(min(rho2->nearest + far, middle + half_length), from[0], to[0]);
    to[1] = clamp(min(rho2->nearest - near, middle + half_length), from[1], to[1]);
    from[1] = clamp(max(rho2->nearest - far, middle - half_length), from[1], to[1]);
}
#endif

// Cuts the ray into panels, the last one first.
INLINE uint torus_panels(const torus_peaks *const peaks, const Quadrature *const quadrature, floatv *const from,
                         floatv *const to, floatv *const integral) {
    const Quadratic *const rho2 = &peaks->path.rho2;
    to[0] = peaks->end;
    to[1] = from[0] = clamp(rho2->nearest, peaks->begin, to[0]);
    from[1] = peaks->begin;
#ifdef SHAPES
    if (HAS_END(&peaks->path.profile))
        torus_clip(peaks, from, to);
#endif
    *integral = splat(0.0f);
    return 2;
}
