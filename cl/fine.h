// Positions with more digits than float32 has. Close to a core everything depends on the small distance between two
// large coordinates: these are taken in float64 where the device has it, and what is left in float32. The host sends
// such numbers as two: the value in float32, and the rest.
#pragma once
#include "lanes.h"

#if defined(cl_khr_fp64) && !defined(NO_DOUBLES)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
typedef double fine;
#define count_to_finev to_finev
#if LANES == 1
typedef double finev;
#define to_finev convert_double
#define from_finev convert_float
#else
typedef JOIN(double, LANES) finev;
#define to_finev JOIN(convert_double, LANES)
#define from_finev JOIN(convert_float, LANES)
#endif
#else
typedef float fine;
typedef floatv finev;
#define to_finev(x) (x)
#define count_to_finev to_floatv
#define from_finev(x) (x)
#endif

typedef struct {
    finev x, y, z;
} fine3v;

fine3v fine3(const float4 value, const float4 rest) {
    const fine3v r = {(finev)((fine)value.x + (fine)rest.x), (finev)((fine)value.y + (fine)rest.y),
                      (finev)((fine)value.z + (fine)rest.z)};
    return r;
}

float3v from_fine3(const fine3v v) {
    const float3v r = {from_finev(v.x), from_finev(v.y), from_finev(v.z)};
    return r;
}

fine3v fine_subtract3(const fine3v a, const fine3v b) {
    const fine3v r = {a.x - b.x, a.y - b.y, a.z - b.z};
    return r;
}

// Returns a k + b.
fine3v fine_fma3(const fine3v a, const finev k, const fine3v b) {
    const fine3v r = {fma(a.x, k, b.x), fma(a.y, k, b.y), fma(a.z, k, b.z)};
    return r;
}

finev fine_dot3(const fine3v a, const fine3v b) {
    return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}

fine3v fine_cross3(const fine3v a, const fine3v b) {
    const fine3v r = {fma(a.y, b.z, -a.z * b.y), fma(a.z, b.x, -a.x * b.z), fma(a.x, b.y, -a.y * b.x)};
    return r;
}
