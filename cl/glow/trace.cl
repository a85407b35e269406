// Integrates balls and streaks of light along listed rays, LANES side by side: down the tree of boxes, in its order, so
// that a ray's sum is the same whatever rays are beside it.
#include "../film.h"
#include "element.h"
#include "listed.h"

__kernel void trace_particles(const FilmPart part, const GlowView view, __global const Element *const restrict elements,
                              __global const GlowBox *const restrict boxes, const uint box_count,
                              __global const GlowRay *const restrict rays, FILM_PARAMETER) {
    const uint begin = get_global_id(0) * LANES;
    if (begin >= part.count)
        return;
    // Lanes beyond the end repeat the last ray.
    const uintv index = min(begin + LANE_NUMBERS, (uintv)(part.count - 1u));
    const ListedRays listed = rays_at(rays, part.first + index);
    float3v sum = uniform3((float4)(0.0f));
    uint number = 0u;
    while (number < box_count) {
        __global const GlowBox *const box = boxes + number;
        ++number;
        if (!meets_box(&listed, box)) {
            number = box->count > 0u ? number : box->next;
            continue;
        }
        for (uint at = 0u; at < box->count; ++at) {
            __global const Element *const element = elements + box->next + at;
            const Passing way = listed_passing(&listed, element);
            floatv light;
            if (element->form & IS_STRETCH)
                light = stretch_light(&view, &listed.rays, &way, element);
            else
                light = ball_light(&view, &listed.rays, &way, element);
            sum.x = fma(light, splat(element->red), sum.x);
            sum.y = fma(light, splat(element->green), sum.y);
            sum.z = fma(light, splat(element->blue), sum.z);
        }
    }
    // Over the parameter of each ray.
    const float3v before = gathered_light(&part, begin, pixels);
    store_pixels(&part, begin, fma3(sum, 1.0f / listed.rays.length, before), FILM_ARGUMENT);
}
