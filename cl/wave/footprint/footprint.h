// The mean of a source's light over a pixel's square. Next to a core light is all but proportional to that of a
// straight core, or of a point, whose mean is known (mean.h): the pixel is what a ray gets that does not pass too
// close, times the mean over what such a core gives that ray. Light of 1/q falls off so slowly that what its
// surroundings add counts as much: a second ray tells that apart. Elsewhere the ray through the centre gets the mean.
#pragma once
#include "../../view.h"
#include "../source/quadratic.h"
#include "closest.h"
#include "mean.h"
#include "reach.h"

// So many pixels from a core, the ray through the centre gets the mean.
#define FOOTPRINT_END 6.0f
#define FOOTPRINT_END_OF_INVERSE 1.5f
// Where light ends closer than this, it curves all the way.
#define CLOSE_REACH 24.0f
// So thick a core, in pixels, does not vary over one.
#define FOOTPRINT_THICK 3.0f
// No ray passes a core closer than this; by so much farther off does the second ray.
#define LEAST_PASS 0.4f
#define SECOND_PASS 0.5f

// Rays beside the one through the centre, by pixels to the right and below, and what the integral of each counts.
#define FOOTPRINT_RAYS 2
typedef struct {
    uint count;
    bool is_center; // alone
    floatv right[FOOTPRINT_RAYS], below[FOOTPRINT_RAYS], weight[FOOTPRINT_RAYS];
} Footprint;

// A core, seen in pixels from a ray: how far it is, of either sign, and by how much that distance grows with every
// pixel to the right, and below.
typedef struct {
    floatv offset;
    floatv right, below;
    intv is_point;
    floatv per_length; // pixels a unit of length across the core
} CoreSeen;

INLINE CoreSeen core_seen(const View *const view, const Ray *const ray, const Closest *const closest) {
    // Where a pixel to the right, and below, moves the point of the ray that is closest.
    const floatv scale = fma(ray->stretch, closest->s, splat(1.0f));
    const float3v right = scale3(uniform3(view->column_step), scale), below = scale3(uniform3(view->row_step), scale);
    const float3v across_line = cross3(closest->along, ray->span);
    CoreSeen seen;
    seen.is_point = dot3(across_line, across_line) <= 0.0f;
    const float3v across = select3(across_line, closest->beside, seen.is_point);
    const floatv across2 = dot3(across, across);
    const floatv per_across = 0.5f * twice_inverse_sqrt_(max(across2, 1e-36f));
    const float3v unit = select3(scale3(across, per_across), scale3(right, inverse(length3(right))), across2 < 1e-36f);
    const floatv a = dot3(unit, right), b = dot3(unit, below);
    seen.per_length = 0.5f * twice_inverse_sqrt_(max(fma(a, a, b * b), 1e-36f));
    seen.right = a * seen.per_length, seen.below = b * seen.per_length;
    seen.offset = dot3(unit, closest->beside) * seen.per_length;
    return seen;
}

// Puts a ray at a distance from the core, on the side of the pixel's centre, where `is_there`.
INLINE void put_ray(Footprint *const footprint, const uint k, const CoreSeen *const seen, const floatv distance,
                    const intv is_there) {
    const floatv steps = seen->offset - copysign(distance, seen->offset);
    footprint->right[k] = select(footprint->right[k], steps * seen->right, is_there);
    footprint->below[k] = select(footprint->below[k], steps * seen->below, is_there);
}

// Takes the mean of what lies next to a core.
INLINE void take_core(Footprint *const footprint, const CoreSeen *const seen, const Across *const light,
                      const intv is_near) {
    const floatv distance = fabs(seen->offset), thickness = light->thickness;
    floatv mean = mean_beside_line(light, distance, seen->right, seen->below);
    if (any_lane(is_near & seen->is_point)) {
        const floatv of_point = mean_beside_point(light, seen->right * seen->offset, seen->below * seen->offset);
        mean = select(mean, of_point, seen->is_point);
    }
    const floatv pass =
        IS_GAUSSIAN(light) ? min(distance, 5.0f * thickness) : max(distance, LEAST_PASS - min(thickness, LEAST_PASS));
    floatv at_pass = light_across(light, pass);
#ifdef SHAPES
    if (light->has_end) {
        const Taken taken = taken_at_reach(light, distance, seen->is_point);
        mean -= taken.here + taken.of_mean;
        at_pass -= taken_at_reach(light, pass, seen->is_point).here;
    }
#endif
    put_ray(footprint, 0, seen, pass, is_near);
    floatv weight = mean * inverse(at_pass);
    if (IS_INVERSE(light->profile)) {
        const floatv second = pass + SECOND_PASS;
        const floatv share = (mean - at_pass) * inverse(at_pass - light_across(light, second));
        put_ray(footprint, 1, seen, second, is_near);
        footprint->count = 2;
        footprint->weight[1] = select(splat(0.0f), -share, is_near);
        weight = 1.0f + share;
    }
    footprint->weight[0] = select(footprint->weight[0], weight, is_near);
}

INLINE Footprint footprint_of(const View *const view, const Ray *const ray, const Closest *const closest,
                              __global const Falloff *const falloff) {
    Footprint footprint = {1, true, {splat(0.0f), splat(0.0f)}, {splat(0.0f), splat(0.0f)}, {splat(1.0f), splat(0.0f)}};
    const uint profile = falloff->profile;
    if (profile == CONVOLVED)
        return footprint;
    const CoreSeen seen = core_seen(view, ray, closest);
    const floatv softening2 = ray->softening2 + closest->thickness2 + falloff->radius2;
    const floatv thickness2 = IS_BARE(profile) ? splat(falloff->radius2) : softening2;
    const floatv thickness = max(0.5f * twice_sqrt(max(thickness2, 1e-36f)) * seen.per_length, LEAST_THICKNESS);
    const intv is_met = (closest->s > 0.0f) & (closest->s < ray->end);
    // Not the offset: where a ray runs along a core, the core may be far ahead.
    const floatv apart2 = dot3(closest->beside, closest->beside) * seen.per_length * seen.per_length;
    const float end = IS_INVERSE(profile) ? FOOTPRINT_END_OF_INVERSE : FOOTPRINT_END;
    Across light = {profile, profile == 4u ? SMEARED_THICKNESS * thickness : thickness, false, splat(0.0f)};
    floatv end2 = splat(end * end);
#ifdef SHAPES
    light.has_end = (profile == 1u || profile == 2u) && falloff->reach2 > 0.0f;
    if (light.has_end) {
        const floatv reach2 = falloff->reach2 * seen.per_length * seen.per_length;
        light.per_reach2 = inverse(reach2);
        end2 = select(end2, REACH_SHARE * REACH_SHARE * reach2, reach2 < CLOSE_REACH * CLOSE_REACH);
    }
#endif
    const intv is_near = is_met & (apart2 < end2) & (thickness < FOOTPRINT_THICK);
    if (any_lane(is_near)) {
        take_core(&footprint, &seen, &light, is_near);
        footprint.is_center = false;
    }
    return footprint;
}
