// Powers of two, logarithms and arctangents in float32: OpenCL's own are exact to the last digit, and slower than a
// whole panel of nodes may be on a CPU.
#pragma once
#include "lanes.h"

#define LN_2 0.693147181f

// Returns 2^x for |x| below 120: a power of two times a minimax polynomial of the rest; within 2e-7.
floatv power_of_two(const floatv x) {
    const floatv shifted = x + 12582912.0f; // 1.5 2^23: what follows the point is rounded away
    const floatv f = x - (shifted - 12582912.0f);
    const floatv f2 = f * f;
    const floatv low = fma(splat(6.931469671e-1f), f, splat(1.0f));
    const floatv mid = fma(splat(5.550713275e-2f), f, splat(2.402211972e-1f));
    const floatv high = fma(splat(1.327647203e-3f), f, splat(9.675541480e-3f));
    const floatv r = fma(fma(high, f2, mid), f2, low);
    return as_floatv(as_intv(r) + (as_intv(shifted) << 23));
}

// Returns the binary logarithm of a normal x > 0: exponent, and a minimax polynomial of the mantissa in [sqrt(1/2),
// sqrt(2)]; within 2e-7 of max(1, |log x|).
floatv binary_logarithm(const floatv x) {
    const intv bits = as_intv(x) - 0x3f3504f3;
    const floatv m = as_floatv((bits & 0x007fffff) + 0x3f3504f3) - 1.0f;
    const floatv m2 = m * m;
    const floatv a = fma(splat(-7.213571490e-1f), m, splat(1.442694772e+0f));
    const floatv b = fma(splat(-3.600872143e-1f), m, splat(4.809394451e-1f));
    const floatv c = fma(splat(-2.500690532e-1f), m, splat(2.867074486e-1f));
    const floatv d = fma(splat(-1.457445055e-1f), m, splat(2.368904340e-1f));
    const floatv r = fma(fma(fma(d, m2, c), m2, b), m2, a);
    return fma(r, m, to_floatv(bits >> 23));
}

// Returns atan(x) / x for x^2 up to 1: a minimax polynomial, within 1e-7.
floatv arctangent_ratio(const floatv x2) {
    floatv r = splat(2.766283480e-3f);
    r = fma(r, x2, splat(-1.573124904e-2f));
    r = fma(r, x2, splat(4.213762345e-2f));
    r = fma(r, x2, splat(-7.456854814e-2f));
    r = fma(r, x2, splat(1.061837063e-1f));
    r = fma(r, x2, splat(-1.419779779e-1f));
    r = fma(r, x2, splat(1.999187203e-1f));
    r = fma(r, x2, splat(-3.333303671e-1f));
    return fma(r, x2, splat(9.999999818e-1f));
}

// Returns the angle of a place (x, y), from -pi to pi; within 3e-7. Of (0, 0) it is 0.
floatv angle_of(const floatv y, const floatv x) {
    const floatv across = fabs(x), up = fabs(y);
    const floatv ratio = fmin(across, up) / fmax(fmax(across, up), splat(1e-30f));
    const floatv low = ratio * arctangent_ratio(ratio * ratio);
    const floatv quarter = select(low, 1.57079633f - low, up > across);
    return copysign(select(quarter, 3.14159265f - quarter, x < 0.0f), y);
}

// Returns asinh(x) for |x| below 1e18, within 3e-7 of max(1, |asinh x|).
floatv inverse_hyperbolic_sine(const floatv x) {
    const floatv size = fabs(x);
    return copysign(LN_2 * binary_logarithm(size + sqrt(fma(size, size, splat(1.0f)))), x);
}
