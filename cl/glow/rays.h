// Rays side by side, how light fades along them, and how they pass a place.
#pragma once
#include "../elementary.h"
#include "../lanes.h"
#include "../roots.h"
#include "types.h"

#define TINY 1e-30f

// Lengths along a ray are counted from one place of it: the eye, its plane, or where the ray is next to the middle of
// all that shines.
typedef struct {
    float3v toward;    // the direction, of length 1
    floatv begin, end; // the stretch that light is gathered on
    floatv length;     // of the ray
    floatv beta;       // of the decay, a length
} Rays;

// What a ray is to an element's middle.
typedef struct {
    floatv low, high; // the stretch that light is gathered on, lengths from where it is closest
    float3v way;      // from the middle to there
    floatv d2;        // its square
} Passing;

// Returns what of light reaches the eye from lengths behind the begin of rays, times the measure.
INLINE floatv fading(const GlowView *const view, const Rays *const rays, const floatv behind) {
    floatv left = splat(view->scale);
    if (view->power > 0u) {
        const floatv w = rays->length * inverse(behind + rays->beta);
        for (uint factor = 0u; factor < view->power; ++factor)
            left *= w;
    }
    if (view->absorbed > 0.0f)
        left *= power_of_two(-min(view->absorbed * behind, 100.0f));
    return left;
}
