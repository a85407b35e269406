// Sphere: 1 / |P - M| (Watanabe, Abe, Konno 2015, eq. 2), or its square; its integral in closed form.
#pragma once
#include "../../view.h"
#include "../footprint/closest.h"
#include "../quadrature/quadrature.h"
#include "../quadrature/stretch.h"
#include "../tiles/clearance.h"
#include "profile.h"
#include "quadratic.h"
#include "sources.h"

typedef struct Sphere {
    float4 center, center_rest;
    float4 emission;
    Falloff falloff;
} Sphere;
CHECK_SIZE(Sphere, SIZEOF_SPHERE);

#define sphere_is_quick 1

// Lengths are doubled.
typedef struct {
    Quadratic distance2;
    Profile profile;
} sphere_path;

INLINE sphere_path sphere_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Sphere *const sphere = &sources->sphere_list[index];
    sphere_path path;
    path.profile = profile_of(ray, &sphere->falloff);
    path.distance2 = distance2_to_point(ray, sphere->center, sphere->center_rest, path.profile.softening2);
    return path;
}

floatv sphere_field(const sphere_path *const path, const floatv s) {
    return field_at(&path->profile, quadratic_at(&path->distance2, s));
}

PER_RAY_IF_WIDE floatv sphere_integral(const Ray *const ray, const Sources *const sources, const uint index,
                                       const Quadrature *const quadrature) {
    const sphere_path path = sphere_along(ray, sources, index);
    const Stretch all = evenly_lit(splat(0.0f), ray->end);
    return integral_over(all, &path.distance2, &path.profile, quadrature);
}

Clearance sphere_clearance(const Ray *const ray, const Sources *const sources, const uint index,
                           const float pixel_step) {
    const sphere_path path = sphere_along(ray, sources, index);
    return quadratic_clearance(ray, &path.distance2, &path.profile, pixel_step);
}

#ifdef FOOTPRINT
Closest sphere_closest(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Sphere *const sphere = &sources->sphere_list[index];
    const sphere_path path = sphere_along(ray, sources, index);
    return closest_to_point(ray, fine3(sphere->center, sphere->center_rest), path.distance2.nearest);
}
#endif
