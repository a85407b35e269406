// Single rays instead of an image, to check the device against known integrals: each work-item takes LANES rays.
#include "radiance.h"
#include "ray.h"
#include "store.h"

// The rays first .. first + count of a list; lanes beyond the end repeat the last one.
Ray listed_ray(__global const RayRecord *const rays, const uintv index, const float softening2) {
    __global const float *const values = (__global const float *)rays;
    const intv at = as_intv(index) * (int)(sizeof(RayRecord) / sizeof(float));
    const float3v origin = {gather(values, at), gather(values, at + 1), gather(values, at + 2)};
    const float3v span = {gather(values, at + 4), gather(values, at + 5), gather(values, at + 6)};
    return make_ray(origin, span, softening2);
}

__kernel void trace(const View view, const Launch launch, __global const Node *const restrict nodes,
                    __global const Sphere *const restrict spheres, __global const Cylinder *const restrict cylinders,
                    __global const Torus *const restrict tori, __global const Curve *const restrict curves,
                    __global const SplinePiece *const restrict spline_pieces, __global float4 *const restrict radiances,
                    __global const RayRecord *const restrict rays) {
    const uint begin = get_global_id(0) * LANES;
    if (begin >= launch.count)
        return;
    const Sources sources = {spheres, cylinders, tori, curves, spline_pieces};
    const Quadrature quadrature = {nodes, launch.node_count, decay_of(&view), view.threshold};
    const uintv index = min(begin + LANE_NUMBERS, (uintv)(launch.count - 1));
    const Ray ray = listed_ray(rays, launch.first + index, view.softening2);
    const float3v radiance = radiance_along(&ray, &sources, &quadrature, &launch);
    store_pixels(radiances + launch.slot + begin, LAST_LANES(launch.count - begin), radiance, launch.accumulate);
}
