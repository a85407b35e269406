// Real roots of the depressed cubic u^3 + 3 p u + 2 h = 0 (Cardano; Watanabe, Abe, Konno 2015, appendix A, corrected).
#pragma once
#include "../../lanes.h"
#include "../../roots.h"

// a^(-1/3) for a > 0: a first guess from the exponent, good to 4 %, then Newton steps, each squaring the error.
#ifndef CUBE_ROOT_STEPS
#define CUBE_ROOT_STEPS 3
#endif
floatv inverse_cube_root(const floatv a) {
    const floatv guess = fma(to_floatv(as_intv(a)), splat(-1.0f / 3.0f), splat(1419967116.0f));
    const floatv third = a * (-1.0f / 3.0f);
    floatv y = as_floatv(to_intv_down(guess));
#pragma unroll
    for (int step = 0; step < CUBE_ROOT_STEPS; ++step)
        y = y * fma(third * y, y * y, splat(4.0f / 3.0f));
    return y;
}

// Returns cos(acos(x) / 3) for x in [-1,1], as a minimax polynomial in cos(acos(x) / 2): within 2e-7.
floatv cosine_of_third(const floatv x) {
    const floatv y = 0.5f * twice_sqrt(max(fma(x, splat(0.5f), splat(0.5f)), 1e-30f));
    floatv r = splat(-0.002143448f);
    r = fma(r, y, splat(0.010623050f));
    r = fma(r, y, splat(-0.026538218f));
    r = fma(r, y, splat(0.051547910f));
    r = fma(r, y, splat(-0.110823040f));
    r = fma(r, y, splat(0.577333460f));
    return fma(r, y, splat(0.500000163f));
}

// Returns the one real root where the discriminant h^2 + p^3 > 0: -+(A - p / A) with A^3 = |h| + sqrt(h^2 + p^3).
floatv single_root(const floatv p, const floatv h, const floatv discriminant) {
    const floatv cube = fma(twice_sqrt(max(discriminant, 1e-36f)), splat(0.5f), fabs(h));
    const floatv inverse = inverse_cube_root(cube);
    const floatv root = fma(cube * inverse, inverse, -p * inverse);
    return copysign(root, -h);
}

// Finds the least and the greatest of three real roots, where h^2 + p^3 <= 0.
void outer_roots(const floatv p, const floatv h, floatv *const least, floatv *const greatest) {
    const floatv q = max(-p, 1e-24f);
    const floatv inverse = 0.5f * twice_inverse_sqrt_(q);
    const floatv twice_root = 2.0f * q * inverse;
    const floatv cosine = clamp(h * inverse * inverse * inverse, -1.0f, 1.0f);
    *least = -twice_root * cosine_of_third(cosine);
    *greatest = twice_root * cosine_of_third(-cosine);
}
