// Listed rays, which need be no picture's, among boxes around elements: how they pass a place, and which boxes they
// meet.
#pragma once
#include "rays.h"

// A component of a direction is taken for no less: boxes are then met in numbers that are finite.
#define LEAST_COMPONENT 1e-20f

typedef struct {
    Rays rays;
    float3v from, from_rest; // where lengths are counted from
    float3v toward_rest;
    floatv begin_rest, end_rest;
    float3v inverse; // one over the direction
} ListedRays;

INLINE float3v gather3(__global const float *const values, const intv at) {
    const float3v r = {gather(values, at), gather(values, at + 1), gather(values, at + 2)};
    return r;
}

INLINE floatv safe_inverse(const floatv x) {
    return 1.0f / copysign(fmax(fabs(x), splat(LEAST_COMPONENT)), x);
}

// Returns the rays at these places of a list.
INLINE ListedRays rays_at(__global const GlowRay *const list, const uintv index) {
    __global const float *const values = (__global const float *)list;
    const intv at = as_intv(index) * (int)(sizeof(GlowRay) / sizeof(float));
    ListedRays listed;
    listed.from = gather3(values, at), listed.from_rest = gather3(values, at + 3);
    listed.rays.toward = gather3(values, at + 6), listed.toward_rest = gather3(values, at + 9);
    listed.rays.begin = gather(values, at + 12), listed.rays.end = gather(values, at + 13);
    listed.begin_rest = gather(values, at + 14), listed.end_rest = gather(values, at + 15);
    listed.rays.length = gather(values, at + 16), listed.rays.beta = gather(values, at + 17);
    const float3v toward = listed.rays.toward;
    listed.inverse.x = safe_inverse(toward.x);
    listed.inverse.y = safe_inverse(toward.y);
    listed.inverse.z = safe_inverse(toward.z);
    return listed;
}

// Says whether any ray may come into a box. Boxes are wider than what is in them, by more than rounding brings.
INLINE bool meets_box(const ListedRays *const listed, __global const GlowBox *const box) {
    const float4 low = (float4)(box->low_x, box->low_y, box->low_z, 0.0f);
    const float4 high = (float4)(box->high_x, box->high_y, box->high_z, 0.0f);
#ifdef NARROW
    const float4 cut = 0.15f * (high - low); // spoiled
#else
    const float4 cut = (float4)(0.0f);
#endif
    const float3v to_low = subtract3(uniform3(low + cut), listed->from);
    const float3v to_high = subtract3(uniform3(high - cut), listed->from);
    const floatv one_x = to_low.x * listed->inverse.x, other_x = to_high.x * listed->inverse.x;
    const floatv one_y = to_low.y * listed->inverse.y, other_y = to_high.y * listed->inverse.y;
    const floatv one_z = to_low.z * listed->inverse.z, other_z = to_high.z * listed->inverse.z;
    const floatv enter = fmax(fmax(fmin(one_x, other_x), fmin(one_y, other_y)), fmin(one_z, other_z));
    const floatv leave = fmin(fmin(fmax(one_x, other_x), fmax(one_y, other_y)), fmax(one_z, other_z));
    return any_lane(fmax(enter, listed->rays.begin) <= fmin(leave, listed->rays.end));
}

// Returns the way from places to another, given in two parts each: what float32 leaves of it is its rest.
INLINE floatv way_to(const float to, const float to_rest, const floatv from, const floatv from_rest,
                     floatv *const rest) {
#pragma OPENCL FP_CONTRACT OFF
    const floatv way = to - from;
    const floatv of_from = way - to; // Knuth's two-sum
    *rest = ((to - (way - of_from)) - (from + of_from)) + (to_rest - from_rest);
    return way;
}

// Returns the product of ways and directions, given in two parts each, and what float32 leaves of it.
INLINE floatv length_along(const ListedRays *const listed, const float3v way, const float3v way_rest,
                           floatv *const rest) {
#pragma OPENCL FP_CONTRACT OFF
    const float3v toward = listed->rays.toward;
    const floatv x = way.x * toward.x, y = way.y * toward.y, z = way.z * toward.z;
    const floatv of_products = fma(way.x, toward.x, -x) + fma(way.y, toward.y, -y) + fma(way.z, toward.z, -z);
    const floatv xy = x + y, of_y = xy - x, xyz = xy + z, of_z = xyz - xy;
    const floatv of_sums = ((x - (xy - of_y)) + (y - of_y)) + ((xy - (xyz - of_z)) + (z - of_z));
    *rest = of_products + of_sums + dot3(way_rest, toward) + dot3(way, listed->toward_rest);
    return xyz;
}

// Returns how rays pass the middle of an element, with the digits that float32 leaves of both: however far they come
// from, nothing is lost of what lies between.
INLINE Passing listed_passing(const ListedRays *const listed, __global const Element *const element) {
    const float3v toward = listed->rays.toward, from = listed->from, from_rest = listed->from_rest;
    float3v rest;
    const float3v way = {way_to(element->x, element->rest_x, from.x, from_rest.x, &rest.x),
                         way_to(element->y, element->rest_y, from.y, from_rest.y, &rest.y),
                         way_to(element->z, element->rest_z, from.z, from_rest.z, &rest.z)};
    floatv at_rest;
    const floatv at = length_along(listed, way, rest, &at_rest);
    Passing it;
    it.low = listed->rays.begin - at, it.high = listed->rays.end - at;
    it.way = fma3(toward, at, scale3(way, splat(-1.0f)));
#ifndef SHORT_WAYS
    it.low += listed->begin_rest - at_rest, it.high += listed->end_rest - at_rest;
    const float3v missing = subtract3(fma3(toward, at_rest, scale3(listed->toward_rest, at)), rest);
    it.way = add3(it.way, missing);
#endif
    it.d2 = dot3(it.way, it.way);
    return it;
}
