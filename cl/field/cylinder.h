// Cylinder, an infinite line: 1 over the distance to the line (Watanabe, Abe, Konno 2015, eq. 3). The distance of P is
// |(P - M) x D|, a cross product instead of the printed difference of squares, which cancels near the line.
#pragma once
#include "../ray.h"
#include "../roots.h"
#include "../sources.h"
#include "quadratic.h"

// Lengths are doubled.
typedef struct {
    Quadratic distance2;
    floatv floor2;
} cylinder_path;

INLINE cylinder_path cylinder_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Cylinder *const cylinder = &sources->cylinders[index];
    const float3v direction = uniform3(cylinder->direction);
    const float3v from_point = subtract3(ray->origin, uniform3(cylinder->point));
    const float3v span = cross3(ray->span, direction);
    Quadratic distance2 = squared_length_along(cross3(from_point, direction), span, length3(span));
    const fine3v closest = fine_between(ray, nearest_along(&distance2), cylinder->point, cylinder->point_rest);
    distance2.least = fine_squared_length(fine_cross3(closest, fine3(cylinder->direction, cylinder->direction_rest)));
    const cylinder_path path = {doubled(distance2, ray->softening2), 4.0f * ray->floor2};
    return path;
}

floatv cylinder_field(const cylinder_path *const path, const floatv s) {
    return twice_inverse_sqrt(max(quadratic_at(&path->distance2, s), path->floor2));
}
