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

sphere_path sphere_along(const Ray *const ray, const Sources *const sources, const uint index) {
    const float3v center = uniform3(sources->spheres[index].center);
    const Quadratic distance2 = squared_length_along(subtract3(ray->origin, center), ray->span);
    const sphere_path path = {doubled(distance2, ray->softening2), 4.0f * ray->floor2};
    return path;
}

floatv sphere_field(const sphere_path *const path, const floatv s) {
    return twice_inverse_sqrt(max(quadratic_at(&path->distance2, s), path->floor2));
}
