// Radiance of a ray: the sum of emission times integral over the sources (Watanabe, Abe, Konno 2015, eq. 18, 20), or
// emission times the root of an integral of squares. The
// host chooses the method (with -D EXACT the integrals themselves, else the paper's Simpson sums) and the kinds of
// source that a scene has; other kinds cost neither compile time nor registers.
#pragma once
#include "../view.h"
#include "kinds.h"
#include "quadrature/quadrature.h"
#include "source/names.h"
#include "source/sources.h"
#ifdef FOOTPRINT
#include "footprint/footprint.h"
#include "footprint/seen.h" // sphere_seen and so on
#endif

#ifdef EXACT
#define METHOD _integral
#else
#define METHOD _simpson
#include "quadrature/simpson.h" // sphere_simpson and so on
#endif

// What a pixel has of a source: the mean over its square, or what the ray through its centre gets.
#ifdef FOOTPRINT
#define LIGHT_OF(kind, view, ray, sources, i, quadrature) kind##_seen(view, ray, sources, i, quadrature)
#else
#define LIGHT_OF(kind, view, ray, sources, i, quadrature) reduced(JOIN(kind, METHOD)(ray, sources, i, quadrature))
#endif

// sphere_emission and so on.
#define EMISSION_OF(kind, Type, number)                                                                                \
    float4 kind##_emission(const Sources *const sources, const uint index) {                                           \
        return sources->kind##_list[index].emission;                                                                   \
    }
KINDS(EMISSION_OF)

// Adds the light of the sources of one kind that a launch names.
#define ADD_LIGHT(kind, Type, number)                                                                                  \
    for (uint i = launch->begin[number]; i < launch->end[number]; ++i) {                                               \
        const floatv light = LIGHT_OF(kind, view, ray, sources, i, quadrature);                                        \
        radiance = fma3(uniform3(kind##_emission(sources, i)), light, radiance);                                       \
    }

// Returns the linear RGB before, and of the sources that a launch names, a ray in every lane. Each light is added to
// all before it, so that the bits of the sum do not depend on where launches part it.
INLINE float3v radiance_along(const View *const view, const Ray *const ray, const Sources *const sources,
                              const Quadrature *const quadrature, const Launch *const launch, const float3v before) {
    float3v radiance = before;
    KINDS(ADD_LIGHT)
    return radiance;
}
