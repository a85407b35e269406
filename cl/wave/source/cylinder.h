// Cylinder, an infinite line: 1 over the distance to the line (Watanabe, Abe, Konno 2015, eq. 3), or over its square;
// its integral in closed form.
#pragma once
#include "../../view.h"
#include "../footprint/closest.h"
#include "../quadrature/quadrature.h"
#include "../quadrature/stretch.h"
#include "../tiles/clearance.h"
#include "profile.h"
#include "quadratic.h"
#include "sources.h"

typedef struct Cylinder {
    float4 point, point_rest;         // the point of the line nearest to the eye
    float4 direction, direction_rest; // unit
    float4 emission;
    Falloff falloff;
} Cylinder;
CHECK_SIZE(Cylinder, SIZEOF_CYLINDER);

#define cylinder_is_quick 1

// Lengths are doubled.
typedef struct {
    Quadratic distance2;
    Profile profile;
} cylinder_path;

PER_RAY_IF_WIDE cylinder_path cylinder_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Cylinder *const cylinder = &sources->cylinder_list[index];
    cylinder_path path;
    path.profile = profile_of(ray, &cylinder->falloff);
    path.distance2 = distance2_to_line(ray, cylinder->point, cylinder->point_rest, cylinder->direction,
                                       cylinder->direction_rest, path.profile.softening2);
    return path;
}

floatv cylinder_field(const cylinder_path *const path, const floatv s) {
    return field_at(&path->profile, quadratic_at(&path->distance2, s));
}

PER_RAY_IF_WIDE floatv cylinder_integral(const Ray *const ray, const Sources *const sources, const uint index,
                                         const Quadrature *const quadrature) {
    const cylinder_path path = cylinder_along(ray, sources, index);
    const Stretch all = evenly_lit(splat(0.0f), ray->end);
    return integral_over(all, &path.distance2, &path.profile, quadrature);
}

Clearance cylinder_clearance(const Ray *const ray, const Sources *const sources, const uint index,
                             const float pixel_step) {
    const cylinder_path path = cylinder_along(ray, sources, index);
    return quadratic_clearance(ray, &path.distance2, &path.profile, pixel_step);
}

#ifdef FOOTPRINT
Closest cylinder_closest(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Cylinder *const cylinder = &sources->cylinder_list[index];
    const cylinder_path path = cylinder_along(ray, sources, index);
    return closest_to_line(ray, fine3(cylinder->point, cylinder->point_rest), uniform3(cylinder->direction),
                           path.distance2.nearest);
}
#endif
