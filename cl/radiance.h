// Radiance of a ray: the sum of emission times integral over the sources (Watanabe, Abe, Konno 2015, eq. 18, 20). The
// host chooses the method: with -D EXACT the integrals themselves, else the Simpson sums of the paper.
#pragma once
#include "field/curve.h"
#include "field/cylinder.h"
#include "field/sphere.h"
#include "field/torus.h"
#include "integrate/quadrature.h"

#ifdef EXACT
#define METHOD exact_
#include "integrate/closed_form.h"
#include "peaks/curve.h"
#include "peaks/torus.h"
#define FIELD sphere
#include "integrate/closed.h"
#undef FIELD
#define FIELD cylinder
#include "integrate/closed.h"
#undef FIELD
#define FIELD torus
#include "integrate/exact.h"
#undef FIELD
#define FIELD curve
#include "integrate/exact.h"
#undef FIELD
#else
#define METHOD simpson_
#define FIELD sphere
#include "integrate/simpson.h"
#undef FIELD
#define FIELD cylinder
#include "integrate/simpson.h"
#undef FIELD
#define FIELD torus
#include "integrate/simpson.h"
#undef FIELD
#define FIELD curve
#include "integrate/simpson.h"
#undef FIELD
#endif

// Linear RGB of the sources that a launch names, a ray in every lane.
INLINE float3v radiance_along(const Ray *const ray, const Sources *const sources, const Quadrature *const quadrature,
                              const Launch *const launch) {
    float3v radiance = uniform3((float4)(0.0f));
    for (uint i = launch->sphere_begin; i < launch->sphere_end; ++i) {
        const floatv integral = JOIN(METHOD, sphere)(ray, sources, i, quadrature);
        radiance = fma3(uniform3(sources->spheres[i].emission), integral, radiance);
    }
    for (uint i = launch->cylinder_begin; i < launch->cylinder_end; ++i) {
        const floatv integral = JOIN(METHOD, cylinder)(ray, sources, i, quadrature);
        radiance = fma3(uniform3(sources->cylinders[i].emission), integral, radiance);
    }
    for (uint i = launch->torus_begin; i < launch->torus_end; ++i) {
        const floatv integral = JOIN(METHOD, torus)(ray, sources, i, quadrature);
        radiance = fma3(uniform3(sources->tori[i].emission), integral, radiance);
    }
    for (uint i = launch->curve_begin; i < launch->curve_end; ++i) {
        const floatv integral = JOIN(METHOD, curve)(ray, sources, i, quadrature);
        radiance = fma3(uniform3(sources->curves[i].emission), integral, radiance);
    }
    return radiance;
}
