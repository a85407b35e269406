// The irradiance of listed points, for hosts and tests: a work-item for each.
#include "irradiance.h"

__kernel void light_points(const uint count, __global const float4 *const restrict points,
                           __global const float4 *const restrict normals,
                           __global const CastLight *const restrict lights, const uint light_count,
                           const uint shadow_samples, __global float4 *const restrict irradiances) {
    const uint index = get_global_id(0);
    if (index >= count)
        return;
    const float3 light = irradiance_at(LIGHTS_ARGUMENTS, points[index].xyz, normals[index].xyz);
    irradiances[index] = (float4)(light, 0.0f);
}
