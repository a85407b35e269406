// Single device functions, for tests/device/device_functions.rs: each work-item takes LANES values of every list.
#include "elementary.h"
#include "wave/radiance.h"

#if LANES == 1
#define LOAD(list) (list)[get_global_id(0)]
#define STORE(value, list) (list)[get_global_id(0)] = (value)
#else
#define LOAD(list) JOIN(vload, LANES)(get_global_id(0), list)
#define STORE(value, list) JOIN(vstore, LANES)(value, get_global_id(0), list)
#endif

__kernel void cube_root(__global const float *a, __global float *result) {
    STORE(inverse_cube_root(LOAD(a)), result);
}

__kernel void powers(__global const float *x, __global float *result) {
    STORE(power_of_two(LOAD(x)), result);
}

__kernel void logarithms(__global const float *x, __global float *result) {
    STORE(binary_logarithm(LOAD(x)), result);
}

// atan(x) for x from 0 to 1.
__kernel void arctangents(__global const float *x, __global float *result) {
    STORE(LOAD(x) * arctangent_ratio(LOAD(x) * LOAD(x)), result);
}

__kernel void third(__global const float *x, __global float *result) {
    STORE(cosine_of_third(LOAD(x)), result);
}

// The least and the greatest real root; both are the single root where there is one.
__kernel void cubic(__global const float *ps, __global const float *hs, __global float *least,
                    __global float *greatest) {
    const floatv p = LOAD(ps), h = LOAD(hs);
    const floatv discriminant = fma(h, h, p * p * p);
    const floatv single = single_root(p, h, discriminant);
    floatv low, high;
    outer_roots(p, h, &low, &high);
    STORE(select(low, single, discriminant > 0.0f), least);
    STORE(select(high, single, discriminant > 0.0f), greatest);
}

__kernel void spline(__global const float4 *pieces, __global const float *count, __global const float *ts,
                     __global float *result) {
    STORE(spline_at(pieces, (uint)count[0], LOAD(ts)), result);
}
