// Sphere: 1 / |P - M| (Watanabe, Abe, Konno 2015, eq. 2), or its square.
#pragma once
#include "../ray.h"
#include "../roots.h"
#include "../sources.h"
#include "profile.h"
#include "quadratic.h"

// Lengths are doubled.
typedef struct {
    Quadratic distance2;
    floatv floor2;
    uint is_square;
} sphere_path;

// From a ray to a point.
INLINE Quadratic distance2_to_point(const Ray *const ray, const float4 point, const float4 point_rest) {
    const float3v from_point = subtract3(ray->origin, uniform3(point));
    Quadratic distance2 = squared_length_along(from_point, ray->span, ray->length);
    const fine3v closest = fine_between(ray, nearest_along(&distance2), point, point_rest);
    distance2.least = squared_length_beside(&distance2, from_fine3(closest), ray->span);
    return doubled(distance2, ray->softening2);
}

INLINE sphere_path sphere_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Sphere *const sphere = &sources->spheres[index];
    const sphere_path path = {distance2_to_point(ray, sphere->center, sphere->center_rest), 4.0f * ray->floor2,
                              IS_SQUARE(sphere)};
    return path;
}

floatv sphere_field(const sphere_path *const path, const floatv s) {
    return profiled(twice_inverse_sqrt(max(quadratic_at(&path->distance2, s), path->floor2)), path->is_square);
}
