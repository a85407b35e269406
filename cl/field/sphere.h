// Sphere: 1 / |P - M| (Watanabe, Abe, Konno 2015, eq. 2).
#pragma once
#include "../ray.h"
#include "../roots.h"
#include "../sources.h"
#include "quadratic.h"

// Lengths are doubled.
typedef struct {
    Quadratic distance2;
    floatv floor2;
} sphere_path;

INLINE sphere_path sphere_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Sphere *const sphere = &sources->spheres[index];
    const float3v from_center = subtract3(ray->origin, uniform3(sphere->center));
    Quadratic distance2 = squared_length_along(from_center, ray->span, ray->length);
    const fine3v closest = fine_between(ray, nearest_along(&distance2), sphere->center, sphere->center_rest);
    distance2.least = fine_squared_length(closest);
    const sphere_path path = {doubled(distance2, ray->softening2), 4.0f * ray->floor2};
    return path;
}

floatv sphere_field(const sphere_path *const path, const floatv s) {
    return twice_inverse_sqrt(max(quadratic_at(&path->distance2, s), path->floor2));
}
