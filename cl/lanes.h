// The lane width: one source for scalar devices (LANES 1, GPUs) and vector devices (LANES 4, 8 or 16, CPUs). A lane is
// one ray; floatv, intv and uintv hold one value for each lane, float3v a vector of space for each.
#pragma once

// For functions that run once a sample: PoCL 3.1 leaves their calls in place, which costs a curve 15 % of its time.
#ifndef INLINE
#define INLINE static __attribute__((always_inline))
#endif

// For what is long, taken in several places, and not once a sample: copies cost compilers half their time and GPUs
// registers, and save nothing.
#ifndef CALL
#define CALL __attribute__((noinline))
#endif

// The same for what every ray needs: vectors have no time for a call.
#if LANES == 1
#define CALL_IF_SCALAR CALL
#else
#define CALL_IF_SCALAR INLINE
#endif

// Integrals along a ray: a kernel that takes them in several places has them as calls, -D PER_RAY=CALL. Intel's
// compiler for GPUs keeps more than it can hold across them, and decides itself. What is short is copied on GPUs, where
// a ray would have to lie in memory.
#ifndef PER_RAY
#define PER_RAY INLINE
#elif LANES == 1 && defined(cl_intel_subgroups)
#undef PER_RAY
#define PER_RAY
#endif
#if LANES == 1
#define PER_RAY_IF_WIDE INLINE
#else
#define PER_RAY_IF_WIDE PER_RAY
#endif

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

#if LANES == 1
typedef float floatv;
typedef int intv;
typedef uint uintv;
#define LANE_NUMBERS 0u
#define as_floatv as_float
#define as_intv as_int
#define to_floatv convert_float
#define to_intv_down convert_int_rtz
#else
typedef JOIN(float, LANES) floatv;
typedef JOIN(int, LANES) intv;
typedef JOIN(uint, LANES) uintv;
#define as_floatv JOIN(as_float, LANES)
#define as_intv JOIN(as_int, LANES)
#define to_floatv JOIN(convert_float, LANES)
#define to_intv_down JOIN(JOIN(convert_int, LANES), _rtz)
#if LANES == 4
#define LANE_NUMBERS ((uintv)(0, 1, 2, 3))
#elif LANES == 8
#define LANE_NUMBERS ((uintv)(0, 1, 2, 3, 4, 5, 6, 7))
#elif LANES == 16
#define LANE_NUMBERS ((uintv)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))
#else
#error "LANES must be 1, 4, 8 or 16"
#endif
#endif

#if LANES == 1
#define first_lane(v) (v)
#else
#define first_lane(v) ((v).s0)
#endif

// The same value in every lane.
#define splat(value) ((floatv)(value))

// x86 processors of 512 bits have comparisons in masks; clang offers them in OpenCL C too.
#if LANES == 16 && !defined(NO_SHUFFLES) && defined(__AVX512DQ__) && defined(__has_builtin)
#if __has_builtin(__builtin_ia32_cvtd2mask512)
#define mask_of_lanes(condition) ((uint)(ushort)__builtin_ia32_cvtd2mask512((condition) != 0))
#endif
#endif

// Returns whether a comparison holds in any lane. Halves are joined until two words are left: any() takes the lanes one
// by one on PoCL 3.1, which costs a curve 7 % of its time. With -D NO_SHUFFLES vectors stay whole: oclgrind 21.10 takes
// the halves for uninitialised.
bool any_lane(const intv condition) {
#if LANES == 1
    return condition != 0;
#elif defined(mask_of_lanes)
    return mask_of_lanes(condition) != 0u;
#elif defined(NO_SHUFFLES)
    return any(condition);
#else
#if LANES == 16
    const int8 eight = condition.lo | condition.hi;
    const int4 four = eight.lo | eight.hi;
#elif LANES == 8
    const int4 four = condition.lo | condition.hi;
#else
    const int4 four = condition;
#endif
    const ulong2 two = as_ulong2(four);
    return (two.x | two.y) != 0;
#endif
}

// Returns a bit for each lane in which a comparison holds, the first lane's the lowest.
uint lane_bits(const intv condition) {
#if LANES == 1
    return condition != 0;
#elif defined(mask_of_lanes)
    return mask_of_lanes(condition);
#else
    int lanes[LANES];
    uint bits = 0u;
    JOIN(vstore, LANES)(condition, 0, lanes);
    for (uint lane = 0u; lane < LANES; ++lane)
        bits |= (uint)(lanes[lane] & 1) << lane;
    return bits;
#endif
}

// Returns the lane of the lowest bit.
#define LOWEST_LANE(bits) (31u - (uint)clz((bits) & -(bits)))

typedef struct {
    floatv x, y, z;
} float3v;

float3v uniform3(const float4 v) {
    const float3v r = {splat(v.x), splat(v.y), splat(v.z)};
    return r;
}

float3v add3(const float3v a, const float3v b) {
    const float3v r = {a.x + b.x, a.y + b.y, a.z + b.z};
    return r;
}

float3v positive3(const float3v a) {
    const float3v r = {max(a.x, 0.0f), max(a.y, 0.0f), max(a.z, 0.0f)};
    return r;
}

float3v subtract3(const float3v a, const float3v b) {
    const float3v r = {a.x - b.x, a.y - b.y, a.z - b.z};
    return r;
}

float3v scale3(const float3v a, const floatv k) {
    const float3v r = {a.x * k, a.y * k, a.z * k};
    return r;
}

// Returns a k + b.
float3v fma3(const float3v a, const floatv k, const float3v b) {
    const float3v r = {fma(a.x, k, b.x), fma(a.y, k, b.y), fma(a.z, k, b.z)};
    return r;
}

float3v select3(const float3v a, const float3v b, const intv is_b) {
    const float3v r = {select(a.x, b.x, is_b), select(a.y, b.y, is_b), select(a.z, b.z, is_b)};
    return r;
}

floatv dot3(const float3v a, const float3v b) {
    return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}

float3v cross3(const float3v a, const float3v b) {
    const float3v r = {fma(a.y, b.z, -a.z * b.y), fma(a.z, b.x, -a.x * b.z), fma(a.x, b.y, -a.y * b.x)};
    return r;
}

// Loads and stores LANES values that lie side by side, in whatever memory.
#if LANES == 1
#define LOAD_LANES(from) (*(from))
#define STORE_LANES(value, to) (*(to) = (value))
#else
#define LOAD_LANES(from) JOIN(vload, LANES)(0, from)
#define STORE_LANES(value, to) JOIN(vstore, LANES)(value, 0, to)
#endif

// Writes the lanes one by one into LANES values.
void scatter(const floatv value, float *const lanes) {
    STORE_LANES(value, lanes);
}

// Returns the sum of all lanes.
float sum_lanes(const floatv value) {
#if LANES == 1
    return value;
#elif defined(NO_SHUFFLES)
    float lanes[LANES], sum = 0.0f;
    scatter(value, lanes);
    for (uint lane = 0; lane < LANES; ++lane)
        sum += lanes[lane];
    return sum;
#else
#if LANES == 16
    const float8 eight = value.lo + value.hi;
    const float4 four = eight.lo + eight.hi;
#elif LANES == 8
    const float4 four = value.lo + value.hi;
#else
    const float4 four = value;
#endif
    return (four.x + four.y) + (four.z + four.w);
#endif
}

// Loads LANES consecutive values.
floatv load_lanes(__global const float *const values) {
#if LANES == 1
    return values[0];
#else
    return JOIN(vload, LANES)(0, values);
#endif
}

// x86 processors of 512 bits do so in one instruction, which clang offers in OpenCL C too.
#if !defined(PORTABLE_ROOTS) && defined(__has_builtin)
#if LANES == 16 && defined(__AVX512F__)
#if __has_builtin(__builtin_ia32_gathersiv16sf)
#define gather_lanes(values, index)                                                                                    \
    __builtin_ia32_gathersiv16sf(splat(0.0f), (const float *)(size_t)(values), index, (ushort)0xffff, 4)
#endif
#if __has_builtin(__builtin_ia32_gathersiv8di)
#define gather_8_pairs(values, index)                                                                                  \
    as_float16(__builtin_ia32_gathersiv8di((long8)(0), (const void *)(size_t)(values), index, (uchar)0xff, 4))
#endif
#endif
#endif

// Loads one value for each lane, from places that need not be consecutive.
floatv gather(__global const float *const values, const intv index) {
#if LANES == 1
    return values[index];
#elif defined(gather_lanes)
    return gather_lanes(values, index);
#else
    int at[LANES];
    float found[LANES];
    JOIN(vstore, LANES)(index, 0, at);
    for (uint lane = 0; lane < LANES; ++lane)
        found[lane] = values[at[lane]];
    return JOIN(vload, LANES)(0, found);
#endif
}

// Loads two values for each lane that lie side by side: there one gather of pairs costs what one of values does.
void gather_pairs(__global const float *const values, const intv index, floatv *const low, floatv *const high) {
#if defined(gather_8_pairs)
    const float16 one = gather_8_pairs(values, index.lo), other = gather_8_pairs(values, index.hi);
    *low = (float16)(one.even, other.even), *high = (float16)(one.odd, other.odd);
#else
    *low = gather(values, index), *high = gather(values + 1, index);
#endif
}
