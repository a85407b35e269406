// 1 / field at the point S + s (E - S), for the first source of a kind; tests/device/device_functions.rs writes its
// name for KIND and its type for TYPE.
__kernel void KIND_distance(__global const TYPE *first, __global const float4 *rows, __global const float *ox,
                            __global const float *oy, __global const float *oz, __global const float *dx,
                            __global const float *dy, __global const float *dz, __global const float *ss,
                            __global float *result) {
    Sources sources = {0};
    sources.KIND_list = first;
    sources.rows = rows;
    const fine3v origin = {to_finev(LOAD(ox)), to_finev(LOAD(oy)), to_finev(LOAD(oz))};
    const fine3v span = {to_finev(LOAD(dx)), to_finev(LOAD(dy)), to_finev(LOAD(dz))};
    const Ray ray = make_ray(origin, span, splat(1.0f), length3(from_fine3(span)), 0.0f);
    const KIND_path path = KIND_along(&ray, &sources, 0);
    STORE(1.0f / KIND_field(&path, LOAD(ss)), result);
}
