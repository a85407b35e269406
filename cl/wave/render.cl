// The image: each work-item renders LANES consecutive pixels.
#include "../film.h"
#include "../view.h"
#include "radiance.h"

__kernel void render(const View view, const FilmPart part, const Integrand integrand, const Launch launch,
                     __global const Node *const restrict nodes,
                     KINDS(SOURCE_PARAMETER) __global const float4 *const restrict rows,
                     __global uint *const restrict counts, __global const float *const restrict depths,
                     FILM_PARAMETER) {
    const uint begin = get_global_id(0) * LANES;
    if (begin >= part.count)
        return;
    const Sources sources = {KINDS(SOURCE_VALUE) rows};
    const Quadrature quadrature = quadrature_of(&integrand, nodes, counts + launch.first_count, splat(view.ray_length),
                                                part.first + begin + LANE_NUMBERS);
    const Screen screen = {&view, depths, integrand.softening2};
    const Ray ray = pixel_ray(&screen, part.first + begin);
    const float3v before = gathered_light(&part, begin, pixels);
    const float3v radiance = radiance_along(&view, &ray, &sources, &quadrature, &launch, before);
    store_pixels(&part, begin, radiance, FILM_ARGUMENT);
}
