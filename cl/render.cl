// The image: each work-item renders LANES consecutive pixels.
#include "radiance.h"
#include "ray.h"
#include "store.h"

__kernel void render(const View view, const Launch launch, __global const Node *const restrict nodes,
                     __global const Sphere *const restrict spheres, __global const Cylinder *const restrict cylinders,
                     __global const Beam *const restrict beams, __global const Torus *const restrict tori,
                     __global const Curve *const restrict curves,
                     __global const SplinePiece *const restrict spline_pieces, __global uint *const restrict counts,
                     __global const float *const restrict depths,
                     __global float4 *const restrict pixels IMAGE_PARAMETER) {
    const uint begin = get_global_id(0) * LANES;
    if (begin >= launch.count)
        return;
    const Sources sources = {spheres, cylinders, beams, tori, curves, spline_pieces};
    const Quadrature quadrature = {
        nodes, launch.node_count, decay_of(&view), view.torus_threshold, view.curve_threshold, counts};
    const Screen screen = {&view, depths};
    const Ray ray = pixel_ray(&screen, launch.first + begin);
    const float3v radiance = radiance_along(&ray, &sources, &quadrature, &launch);
    const Canvas canvas = canvas_of(pixels, &launch, view.width);
    store_pixels(&canvas, begin, LAST_LANES(launch.count - begin), radiance IMAGE_ARGUMENT);
}
