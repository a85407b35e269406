// Single rays instead of an image, to check the device against known integrals: each work-item takes LANES rays.
#include "../film.h"
#include "../view.h"
#include "radiance.h"

// Loads a vector and, four values on, its rest.
fine3v gather_fine3(__global const float *const values, const intv at) {
    const fine3v r = {join_fine(gather(values, at), gather(values, at + 4)),
                      join_fine(gather(values, at + 1), gather(values, at + 5)),
                      join_fine(gather(values, at + 2), gather(values, at + 6))};
    return r;
}

// Loads the rays at these places of a list; lanes beyond the end repeat the last one.
Ray listed_ray(__global const RayRecord *const rays, const uintv index, const float softening2) {
    __global const float *const values = (__global const float *)rays;
    const intv at = as_intv(index) * (int)(sizeof(RayRecord) / sizeof(float));
    const fine3v span = gather_fine3(values, at + 8);
    const float3v toward = from_fine3(span);
    const floatv length = 0.5f * twice_sqrt(dot3(toward, toward));
    return make_ray(gather_fine3(values, at), span, splat(1.0f), length, softening2);
}

__kernel void trace(const FilmPart part, const Integrand integrand, const Launch launch,
                    __global const Node *const restrict nodes,
                    KINDS(SOURCE_PARAMETER) __global const float4 *const restrict rows,
                    __global uint *const restrict counts, FILM_PARAMETER,
                    __global const RayRecord *const restrict rays) {
    const uint begin = get_global_id(0) * LANES;
    if (begin >= part.count)
        return;
    const Sources sources = {KINDS(SOURCE_VALUE) rows};
    const uintv index = min(begin + LANE_NUMBERS, (uintv)(part.count - 1));
    const Ray ray = listed_ray(rays, part.first + index, integrand.softening2);
    const Quadrature quadrature =
        quadrature_of(&integrand, nodes, counts + launch.first_count, ray.length, part.first + index);
    const float3v before = gathered_light(&part, begin, pixels);
    const float3v radiance = radiance_along(0, &ray, &sources, &quadrature, &launch, before);
    store_pixels(&part, begin, radiance, FILM_ARGUMENT);
}
