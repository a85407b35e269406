// Radiance of a ray: the sum of emission times integral over the sources (Watanabe, Abe, Konno 2015, eq. 18, 20). The
// host chooses the method, with -D EXACT the integrals themselves, else the Simpson sums of the paper, and the kinds of
// source that a scene has: what it has not costs it neither compiling nor registers.
#pragma once
#include "field/beam.h"
#include "field/curve.h"
#include "field/cylinder.h"
#include "field/sphere.h"
#include "field/torus.h"
#include "integrate/panel.h"
#include "integrate/quadrature.h"
#include "integrate/stretch.h"
#include "peaks/curve_panels.h"
#include "peaks/torus.h"

// A kernel that takes integrals in several places may have them as calls: -D PER_RAY=
#ifndef PER_RAY
#define PER_RAY INLINE
#endif

#ifdef SPHERES
#define FIELD sphere
#ifdef EXACT
#include "integrate/closed.h"
#else
#include "integrate/simpson.h"
#endif
#undef FIELD
#endif

#ifdef CYLINDERS
#define FIELD cylinder
#ifdef EXACT
#include "integrate/closed.h"
#else
#include "integrate/simpson.h"
#endif
#undef FIELD
#endif

#ifdef BEAMS
#define FIELD beam
#ifdef EXACT
#include "integrate/beam.h"
#else
#include "integrate/simpson.h"
#endif
#undef FIELD
#endif

#ifdef TORI
#define FIELD torus
#define FIRST_TWO
#ifdef EXACT
#include "integrate/exact.h"
#else
#include "integrate/simpson.h"
#endif
#undef FIRST_TWO
#undef FIELD
#endif

#ifdef CURVES
#define FIELD curve
#ifdef EXACT
#include "integrate/exact.h"
#else
#include "integrate/simpson.h"
#endif
#undef FIELD
#endif

#ifdef EXACT
#define METHOD exact_
#else
#define METHOD simpson_
#endif

// Adds the light of the sources of one kind that a launch names.
#define ADD_LIGHT(kind)                                                                                                \
    for (uint i = launch->kind##_begin; i < launch->kind##_end; ++i) {                                                 \
        const floatv integral = JOIN(METHOD, kind)(ray, sources, i, quadrature);                                       \
        radiance = fma3(uniform3(kind##_emission(sources, i)), integral, radiance);                                    \
    }

// Linear RGB of the sources that a launch names, a ray in every lane.
INLINE float3v radiance_along(const Ray *const ray, const Sources *const sources, const Quadrature *const quadrature,
                              const Launch *const launch) {
    float3v radiance = uniform3((float4)(0.0f));
#ifdef SPHERES
    ADD_LIGHT(sphere)
#endif
#ifdef CYLINDERS
    ADD_LIGHT(cylinder)
#endif
#ifdef BEAMS
    ADD_LIGHT(beam)
#endif
#ifdef TORI
    ADD_LIGHT(torus)
#endif
#ifdef CURVES
    ADD_LIGHT(curve)
#endif
    return radiance;
}
