// Cylinder, an infinite line: 1 over the distance to the line (Watanabe, Abe, Konno 2015, eq. 3), or over its square.
// The distance of P is
// |(P - M) x D|, a cross product instead of the printed difference of squares, which cancels near the line.
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
} cylinder_path;

// From a ray to a line.
INLINE Quadratic distance2_to_line(const Ray *const ray, const float4 point, const float4 point_rest,
                                   const float4 direction, const float4 direction_rest) {
    const float3v along = uniform3(direction);
    const float3v from_point = subtract3(ray->origin, uniform3(point));
    const float3v span = cross3(ray->span, along);
    Quadratic distance2 = squared_length_along(cross3(from_point, along), span, length3(span));
    const fine3v closest = fine_between(ray, nearest_along(&distance2), point, point_rest);
    const float3v from_line = from_fine3(fine_cross3(closest, fine3(direction, direction_rest)));
    distance2.least = squared_length_beside(&distance2, from_line, span);
    return doubled(distance2, ray->softening2);
}

INLINE cylinder_path cylinder_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Cylinder *const cylinder = &sources->cylinders[index];
    const Quadratic distance2 =
        distance2_to_line(ray, cylinder->point, cylinder->point_rest, cylinder->direction, cylinder->direction_rest);
    const cylinder_path path = {distance2, 4.0f * ray->floor2, IS_SQUARE(cylinder)};
    return path;
}

floatv cylinder_field(const cylinder_path *const path, const floatv s) {
    return profiled(twice_inverse_sqrt(max(quadratic_at(&path->distance2, s), path->floor2)), path->is_square);
}
