// Where a ray comes closest to a core.
#pragma once
#include "../../view.h"

typedef struct {
    floatv s;
    float3v beside;    // from the ray to the core there
    float3v along;     // the core's direction there, of any length; 0 at a point
    floatv thickness2; // squared, of the core, beyond its profile's radius
    floatv light;      // its light there, of what its field has; 0 where that is not known
    intv is_end;       // whether the core ends there
} Closest;

Closest closest_to_point(const Ray *const ray, const fine3v point, const floatv s) {
    const float3v beside = from_fine3(fine_from(ray, s, point));
    const Closest closest = {s,        scale3(beside, splat(-1.0f)), uniform3((float4)(0.0f)), splat(0.0f), splat(1.0f),
                             (intv)(0)};
    return closest;
}

// `along` is a unit vector.
Closest closest_to_line(const Ray *const ray, const fine3v point, const float3v along, const floatv s) {
    Closest closest = closest_to_point(ray, point, s);
    closest.beside = fma3(along, -dot3(closest.beside, along), closest.beside);
    closest.along = along;
    return closest;
}

Closest select_closest(const Closest a, const Closest b, const intv is_b) {
    const Closest closest = {select(a.s, b.s, is_b),          select3(a.beside, b.beside, is_b),
                             select3(a.along, b.along, is_b), select(a.thickness2, b.thickness2, is_b),
                             select(a.light, b.light, is_b),  (is_b & b.is_end) | (~is_b & a.is_end)};
    return closest;
}
