// Torus: 1 / sqrt((rho - R)^2 + z^2), rho the distance to the axis, z the height over the ring's plane (Watanabe, Abe,
// Konno 2015, eq. 7), or its square. Along a ray rho^2 is a quadratic and z is linear.
#pragma once
#include "../ray.h"
#include "../roots.h"
#include "../sources.h"
#include "profile.h"
#include "quadratic.h"

// Lengths are doubled, but for rho^2, whose root doubles.
typedef struct {
    Quadratic rho2;
    floatv height, height_slope;
    float major_radius;
    floatv softening2, floor2;
    uint is_square;
} torus_path;

INLINE torus_path torus_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Torus *const torus = &sources->tori[index];
    const float3v axis = uniform3(torus->axis);
    const float3v from_center = subtract3(ray->origin, uniform3(torus->center));
    const float3v span = cross3(ray->span, axis);
    const torus_path path = {squared_length_along(cross3(from_center, axis), span, length3(span)),
                             2.0f * dot3(from_center, axis),
                             2.0f * dot3(ray->span, axis),
                             2.0f * torus->major_radius,
                             4.0f * ray->softening2,
                             4.0f * ray->floor2,
                             IS_SQUARE(torus)};
    return path;
}

floatv torus_field(const torus_path *const path, const floatv s) {
    const floatv from_ring = twice_sqrt_less(quadratic_at(&path->rho2, s), splat(path->major_radius));
    const floatv height = fma(path->height_slope, s, path->height);
    const floatv distance2 = fma(from_ring, from_ring, fma(height, height, path->softening2));
    return profiled(twice_inverse_sqrt(max(distance2, path->floor2)), path->is_square);
}
