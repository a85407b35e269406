// What is summed of a field along a ray, and what a pixel has of the integral: both themselves, or with -D ROOT the
// root of an integral of squares. Where the square is a field that has a closed form, such as 1/q^2 for 1/q, the host
// gives that field; elsewhere (-D SQUARED) every sample is squared.
#pragma once
#include "../../roots.h"

INLINE floatv summand_of(const floatv field) {
#ifdef SQUARED
    return field * field;
#else
    return field;
#endif
}

// Integrals of squares below this are 0.
#define LEAST_SQUARES 1e-37f

INLINE floatv reduced(const floatv integral) {
#ifdef ROOT
    return select(splat(0.0f), 0.5f * twice_sqrt(max(integral, LEAST_SQUARES)), integral > LEAST_SQUARES);
#else
    return integral;
#endif
}
