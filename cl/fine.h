// Positions with more digits than float32 has. Close to a core everything depends on the small distance between two
// large coordinates: these are taken in float64 where the device has it, else in pairs of float32, and what is left in
// float32. The host sends such numbers as two: the value in float32, and the rest.
#pragma once
#include "lanes.h"

#if defined(cl_khr_fp64) && !defined(NO_DOUBLES)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#if LANES == 1
typedef double finev;
#define to_finev convert_double
#define from_finev convert_float
#else
typedef JOIN(double, LANES) finev;
#define to_finev JOIN(convert_double, LANES)
#define from_finev JOIN(convert_float, LANES)
#endif
#define count_to_finev to_finev
#define uniform_fine(value, rest) ((finev)((double)(value) + (double)(rest)))
#define join_fine(value, rest) (to_finev(value) + to_finev(rest))
#define IS_ONE_NUMBER

#elif defined(SHORT_PAIRS)
// Spoiled: the rest is left out.
typedef floatv finev;
#define to_finev(x) (x)
#define from_finev(x) (x)
#define count_to_finev to_floatv
#define uniform_fine(value, rest) ((finev)((value) + (rest)))
#define join_fine(value, rest) ((value) + (rest))
#define IS_ONE_NUMBER

#endif

#ifdef IS_ONE_NUMBER
#define fine_add(a, b) ((a) + (b))
#define fine_subtract(a, b) ((a) - (b))
#define fine_negate(a) (-(a))
#define fine_halve(a) ((a) * (finev)(0.5f))
#define fine_multiply(a, b) ((a) * (b))
#define fine_fma(a, b, c) fma(a, b, c)

#else
// A pair: a number rounded to float32, and what that leaves of it (Dekker 1971). Nothing here may be contracted.
typedef struct {
    floatv value, rest;
} finev;

finev to_finev(const floatv value) {
    const finev r = {value, splat(0.0f)};
    return r;
}

// Exact up to 2^24.
finev count_to_finev(const uintv count) {
    return to_finev(to_floatv(count));
}

floatv from_finev(const finev a) {
    return a.value + a.rest;
}

// Makes a pair of two numbers, the second much smaller than the first.
finev join_fine(const floatv value, const floatv rest) {
#pragma OPENCL FP_CONTRACT OFF
    const floatv sum = value + rest;
    const finev r = {sum, rest - (sum - value)};
    return r;
}

#define uniform_fine(value, rest) join_fine(splat(value), splat(rest))

finev fine_add(const finev a, const finev b) {
#pragma OPENCL FP_CONTRACT OFF
    const floatv sum = a.value + b.value;
    const floatv of_b = sum - a.value;
    const floatv lost = (a.value - (sum - of_b)) + (b.value - of_b); // Knuth's two-sum
    return join_fine(sum, lost + (a.rest + b.rest));
}

finev fine_negate(const finev a) {
    const finev r = {-a.value, -a.rest};
    return r;
}

finev fine_subtract(const finev a, const finev b) {
    return fine_add(a, fine_negate(b));
}

finev fine_halve(const finev a) {
    const finev r = {0.5f * a.value, 0.5f * a.rest};
    return r;
}

#ifndef FP_FAST_FMAF
// Returns the upper half of a number's digits.
floatv upper_digits(const floatv a) {
#pragma OPENCL FP_CONTRACT OFF
    const floatv scaled = a * 4097.0f; // 2^12 + 1
    return scaled - (scaled - a);
}
#endif

// Returns what float32 leaves of the product of two numbers.
floatv product_rest(const floatv a, const floatv b, const floatv product) {
#ifdef FP_FAST_FMAF
    return fma(a, b, -product);
#else
#pragma OPENCL FP_CONTRACT OFF
    const floatv a_upper = upper_digits(a), b_upper = upper_digits(b);
    const floatv a_lower = a - a_upper, b_lower = b - b_upper;
    return ((a_upper * b_upper - product) + a_upper * b_lower + a_lower * b_upper) + a_lower * b_lower;
#endif
}

finev fine_multiply(const finev a, const finev b) {
#pragma OPENCL FP_CONTRACT OFF
    const floatv product = a.value * b.value;
    const floatv rest = product_rest(a.value, b.value, product);
    return join_fine(product, rest + (a.value * b.rest + a.rest * b.value));
}

finev fine_fma(const finev a, const finev b, const finev c) {
    return fine_add(fine_multiply(a, b), c);
}
#endif

typedef struct {
    finev x, y, z;
} fine3v;

fine3v fine3(const float4 value, const float4 rest) {
    const fine3v r = {uniform_fine(value.x, rest.x), uniform_fine(value.y, rest.y), uniform_fine(value.z, rest.z)};
    return r;
}

float3v from_fine3(const fine3v v) {
    const float3v r = {from_finev(v.x), from_finev(v.y), from_finev(v.z)};
    return r;
}

fine3v fine_subtract3(const fine3v a, const fine3v b) {
    const fine3v r = {fine_subtract(a.x, b.x), fine_subtract(a.y, b.y), fine_subtract(a.z, b.z)};
    return r;
}

// Returns a k + b.
fine3v fine_fma3(const fine3v a, const finev k, const fine3v b) {
    const fine3v r = {fine_fma(a.x, k, b.x), fine_fma(a.y, k, b.y), fine_fma(a.z, k, b.z)};
    return r;
}

finev fine_dot3(const fine3v a, const fine3v b) {
    return fine_fma(a.x, b.x, fine_fma(a.y, b.y, fine_multiply(a.z, b.z)));
}

fine3v fine_cross3(const fine3v a, const fine3v b) {
    const fine3v r = {fine_fma(a.y, b.z, fine_negate(fine_multiply(a.z, b.y))),
                      fine_fma(a.z, b.x, fine_negate(fine_multiply(a.x, b.z))),
                      fine_fma(a.x, b.y, fine_negate(fine_multiply(a.y, b.x)))};
    return r;
}
