// Exponential and logarithm in float32: OpenCL's own are exact to the last digit, and slower than a whole panel of
// nodes allows on a CPU.
#pragma once
#include "lanes.h"

// e^x for |x| below 80: 2^n times a polynomial of the rest; within 2e-7.
floatv exponential(const floatv x) {
    const floatv shifted = fma(x, splat(1.44269504f), splat(12582912.0f)); // 1.5 2^23: what follows the point is lost
    const floatv n = shifted - 12582912.0f;
    const floatv f = fma(n, splat(-1.42860677e-6f), fma(n, splat(-0.693145752f), x)); // ln 2 in two parts
    floatv r = splat(1.3978917e-3f);
    r = fma(r, f, splat(8.3752662e-3f));
    r = fma(r, f, splat(4.1665524e-2f));
    r = fma(r, f, splat(1.6666508e-1f));
    r = fma(r, f, splat(5.0000000e-1f));
    r = fma(r, f, splat(1.0f));
    r = fma(r, f, splat(1.0f));
    return as_floatv(as_intv(r) + (as_intv(shifted) << 23));
}

// ln x for normal x > 0: exponent and mantissa in [sqrt(1/2), sqrt(2)]; within 2e-7 of max(1, |ln x|).
floatv logarithm(const floatv x) {
    const intv bits = as_intv(x) - 0x3f3504f3;
    const floatv n = to_floatv(bits >> 23);
    const floatv m = as_floatv((bits & 0x007fffff) + 0x3f3504f3) - 1.0f;
    // Degree 8 in threes, for short chains of dependent operations.
    const floatv m2 = m * m, m3 = m2 * m;
    const floatv a = fma(fma(splat(2.0000714765e-1f), m, splat(-2.4999993993e-1f)), m, splat(3.3333331174e-1f));
    const floatv b = fma(fma(splat(-1.2420140846e-1f), m, splat(1.4249322787e-1f)), m, splat(-1.6668057665e-1f));
    const floatv c = fma(fma(splat(7.0376836292e-2f), m, splat(-1.1514610310e-1f)), m, splat(1.1676998740e-1f));
    const floatv r = fma(fma(c, m3, b), m3, a);
    return fma(n, splat(0.693147181f), fma(m2, fma(r, m, splat(-0.5f)), m));
}
