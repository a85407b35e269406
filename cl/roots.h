// Square roots and quotients. x86 processors estimate 1/sqrt(x) and 1/x to 12 bits or more in one instruction, which
// clang offers in OpenCL C too; one Newton step brings that to float32's precision. It makes a torus 1.7 times as fast,
// a sphere 2.1 times, a curve 5 % faster. Elsewhere, and with -D PORTABLE_ROOTS, OpenCL's own functions serve.
#pragma once
#include "lanes.h"

#if !defined(PORTABLE_ROOTS) && defined(__has_builtin)
#if LANES == 16 && defined(__AVX512F__)
#if __has_builtin(__builtin_ia32_rsqrt14ps512_mask) && __has_builtin(__builtin_ia32_rcp14ps512_mask)
#define estimate_inverse_sqrt(x) __builtin_ia32_rsqrt14ps512_mask(x, splat(0.0f), (ushort)0xffff)
#define estimate_inverse(x) __builtin_ia32_rcp14ps512_mask(x, splat(0.0f), (ushort)0xffff)
#endif
#elif LANES == 8 && defined(__AVX__)
#if __has_builtin(__builtin_ia32_rsqrtps256) && __has_builtin(__builtin_ia32_rcpps256)
#define estimate_inverse_sqrt(x) __builtin_ia32_rsqrtps256(x)
#define estimate_inverse(x) __builtin_ia32_rcpps256(x)
#endif
#elif LANES == 4 && defined(__SSE__)
#if __has_builtin(__builtin_ia32_rsqrtps) && __has_builtin(__builtin_ia32_rcpps)
#define estimate_inverse_sqrt(x) __builtin_ia32_rsqrtps(x)
#define estimate_inverse(x) __builtin_ia32_rcpps(x)
#endif
#endif
#endif

// 2 / sqrt(x) and 2 sqrt(x) - offset for normal x > 0. Twice, because the Newton step y (3 - x y^2) gives that: with
// all lengths doubled beforehand it saves a multiplication a root.
#ifdef estimate_inverse_sqrt
floatv twice_inverse_sqrt_(const floatv x) {
    const floatv y = estimate_inverse_sqrt(x);
    return y * fma(-x * y, y, splat(3.0f));
}

floatv twice_sqrt_less(const floatv x, const floatv offset) {
    const floatv y = estimate_inverse_sqrt(x);
    const floatv xy = x * y;
    return fma(xy, fma(-xy, y, splat(3.0f)), -offset);
}

floatv inverse(const floatv x) {
    const floatv y = estimate_inverse(x);
    return y * fma(-x, y, splat(2.0f));
}
#else
floatv twice_inverse_sqrt_(const floatv x) {
    return 2.0f * rsqrt(x);
}

floatv twice_sqrt_less(const floatv x, const floatv offset) {
    return fma(sqrt(x), splat(2.0f), -offset);
}

floatv inverse(const floatv x) {
    return 1.0f / x;
}
#endif

floatv twice_sqrt(const floatv x) {
    return twice_sqrt_less(x, splat(0.0f));
}

// The same within 2^-14, where a tolerance of a thousandth leaves room for that (-D COARSE) and estimates are that
// good.
#if defined(COARSE) && defined(estimate_inverse) && LANES == 16
#define coarse_inverse(x) estimate_inverse(x)
#define coarse_twice_inverse_sqrt(x) (2.0f * estimate_inverse_sqrt(x))
#else
#define coarse_inverse(x) inverse(x)
#define coarse_twice_inverse_sqrt(x) twice_inverse_sqrt_(x)
#endif

// A build option may put another form of the field in its place.
#ifdef twice_inverse_sqrt
#undef coarse_twice_inverse_sqrt
#define coarse_twice_inverse_sqrt(x) twice_inverse_sqrt(x)
#else
#define twice_inverse_sqrt(x) twice_inverse_sqrt_(x)
#endif
