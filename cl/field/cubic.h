// Real roots of the depressed cubic u^3 + 3 p u + 2 h = 0 (Cardano; Watanabe, Abe, Konno 2015, appendix A, corrected).
#pragma once
#include "../lanes.h"

// a^(-1/3) for a > 0: a first guess from the exponent, good to 4 %, then Newton steps, each squaring the error.
#ifndef CUBE_ROOT_STEPS
#define CUBE_ROOT_STEPS 4
#endif
floatv inverse_cube_root(const floatv a) {
    const intv guess = 0x54a2fa8c - as_intv(a) / 3;
    floatv y = as_floatv(guess);
    for (int step = 0; step < CUBE_ROOT_STEPS; ++step)
        y = y * fma(-a / 3.0f, y * y * y, splat(4.0f / 3.0f));
    return y;
}

// cos(acos(x) / 3) for x in [-1,1], as a minimax polynomial in cos(acos(x) / 2): within 2e-7.
floatv cosine_of_third(const floatv x) {
    const floatv y = sqrt(fma(x, splat(0.5f), splat(0.5f)));
    floatv r = splat(-0.002143448f);
    r = fma(r, y, splat(0.010623050f));
    r = fma(r, y, splat(-0.026538218f));
    r = fma(r, y, splat(0.051547910f));
    r = fma(r, y, splat(-0.110823040f));
    r = fma(r, y, splat(0.577333460f));
    return fma(r, y, splat(0.500000163f));
}

// The one real root where h^2 + p^3 > 0. With A^3 = |h| + sqrt(h^2 + p^3) and B = p / A the root is -+(A - B), here
// written as 2h / (A^2 + A B + B^2), in which nothing cancels.
floatv single_root(const floatv p, const floatv h, const floatv discriminant) {
    const floatv cube = fabs(h) + sqrt(max(discriminant, 0.0f));
    const floatv inverse = inverse_cube_root(max(cube, 1e-36f));
    const floatv a = cube * inverse * inverse;
    const floatv b = p * inverse;
    return -2.0f * h / max(fma(a, a, fma(b, b, p)), 1e-36f);
}

// The least and the greatest of three real roots, where h^2 + p^3 <= 0.
void outer_roots(const floatv p, const floatv h, floatv *const least, floatv *const greatest) {
    const floatv q = max(-p, 1e-24f);
    const floatv root = sqrt(q);
    const floatv cosine = clamp(h / (q * root), -1.0f, 1.0f);
    *least = -2.0f * root * cosine_of_third(cosine);
    *greatest = 2.0f * root * cosine_of_third(-cosine);
}
