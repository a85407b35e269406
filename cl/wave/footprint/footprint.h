// The mean of a source's light over a pixel's square, or over a part of it. Next to a core light is all but that of a
// straight core, or of a point, whose mean is known (mean.h), and of what else there is, which is smooth: the pixel is
// what a ray gets that does not pass too close, and by how much the mean differs from what such a core gives that ray.
// Light of 1/q without an end falls off so slowly that its surroundings count as much: a second ray tells them apart.
// Elsewhere the ray through the centre gets the mean.
//
// Where a core bends or ends within the pixel, or another part of it shines as brightly, the mean is in doubt, and the
// pixel is cut (seen.h).
#pragma once
#include "../../view.h"
#include "../quadrature/decay.h"
#include "../source/quadratic.h"
#include "../tiles/clearance.h"
#include "closest.h"
#include "mean.h"

// So many pixels from a core, the ray through the centre gets the mean.
#define FOOTPRINT_END 6.0f
#define FOOTPRINT_END_OF_INVERSE 1.5f
#define FOOTPRINT_END_OF_GAUSSIAN 5.0f // standard deviations
// So thick a core, in pixels, does not vary over one.
#define FOOTPRINT_THICK 3.0f
#define FOOTPRINT_THICK_OF_GAUSSIAN 13.0f
// Where light ends closer than this, it curves all the way; where farther than that, its rim is faint.
#define CLOSE_REACH 24.0f
#define FAR_REACH 96.0f
#define RIM 0.25f
// So far from a core its bends and ends are seen; farther off an end is a point.
#define CLOSE 3.0f
// A pixel is cut in halves or quarters a side if its light may be off by so much of itself; of by how much a bend
// changes its mean, a part stays.
#ifndef HALVED_FROM // a test spoils it
#define HALVED_FROM 3e-3f
#endif
#define QUARTERED_FROM (4.0f * HALVED_FROM)
#define BEND_DOUBT 0.5f
// From so much of that on the cuts count, at first little.
#ifndef PASSES_FROM // a test cuts at once
#define PASSES_FROM 0.75f
#endif
// So little of the way to a line lies along it by rounding: a ray that meets a core is led away from it, not along it.
#ifndef ALONG_ROUNDED // a test spoils it
#define ALONG_ROUNDED 1e-2f
#endif
#define TRUST_IN_RIM 0.75f
// No ray passes a core closer than this, nor the rim; by so much farther off does the second ray.
#define LEAST_PASS 0.4f
#define RIM_PASS 0.5f
#define SECOND_PASS 0.5f
// More than so many times what a ray gets is no mean of smooth light: a place has seen another part of the core.
#define MOST_SMOOTH 2.0f

// A square of the image, in pixels: a ray's pixel, or a part of it.
typedef struct {
    float right, below; // from the pixel's centre
    float side;
} Square;

// A core, seen from a square's centre, in sides of the square: how far it is across; and how far its end is along, or
// where a bend leads it.
typedef struct {
    floatv across, along;
    floatv right, below;             // by how much `across` grows with every side to the right, and below
    floatv along_right, along_below; // and `along`
    intv is_point;
    float3v across_axis, along_axis;
    floatv per_length; // sides a unit of length there
} CoreSeen;

// Where a core is seen next to a square, and how its light falls off.
typedef struct {
    CoreSeen core;
    Across light;
    floatv distance;  // of the core
    floatv per_speed; // how long a ray takes for a unit of length across the core, as a parameter s
    intv is_near;     // so near that a ray is not enough
    intv is_close;    // so near that a core's bends and ends count
} Surroundings;

// Rays, by pixels to the right and below of the pixel's centre; and what the mean is by the first one's integral: so
// much more, of what a straight core gives it. If there are two rays that is by how much their integrals differ.
#define FOOTPRINT_RAYS 2
typedef struct {
    uint count;
    floatv right[FOOTPRINT_RAYS], below[FOOTPRINT_RAYS];
    floatv straight; // without the core's own light, which closest.h has
    floatv growth;
    floatv trust; // in what a straight core gives; the greater, the fainter the light
} Footprint;

INLINE float3v unit_along(const float3v v) {
    return scale3(v, 0.5f * twice_inverse_sqrt_(max(dot3(v, v), 1e-36f)));
}

INLINE CoreSeen core_seen(const View *const view, const Square *const square, const Ray *const ray,
                          const Closest *const closest) {
    // Where a side to the right, and below, moves the point of the ray that is closest.
    const floatv scale = square->side * fma(ray->stretch, closest->s, splat(1.0f));
    const float3v right = scale3(uniform3(view->column_step), scale), below = scale3(uniform3(view->row_step), scale);
    const float3v across_line = cross3(closest->along, ray->span), beside = closest->beside;
    const intv is_far = dot3(beside, beside) > CLOSE * CLOSE * dot3(right, right);
    CoreSeen core;
    core.is_point = (dot3(across_line, across_line) <= 0.0f) | (closest->is_end & is_far);
    const float3v toward = select3(across_line, beside, core.is_point);
    const float3v axis = select3(toward, right, dot3(toward, toward) < 1e-36f);
    core.across_axis = unit_along(axis);
    core.along_axis = unit_along(cross3(core.across_axis, ray->span));
    const floatv a = dot3(core.across_axis, right), b = dot3(core.across_axis, below);
    core.per_length = 0.5f * twice_inverse_sqrt_(max(fma(a, a, b * b), 1e-36f));
    core.right = a * core.per_length, core.below = b * core.per_length;
    const floatv turn = fma(core.right, dot3(core.along_axis, below), -core.below * dot3(core.along_axis, right));
    core.along_right = -copysign(core.below, turn * core.below),
    core.along_below = copysign(core.right, turn * core.right);
    core.across = dot3(core.across_axis, beside) * core.per_length;
    const floatv along = dot3(core.along_axis, beside) * core.per_length;
    core.along = select(select(along, splat(0.0f), fabs(along) < ALONG_ROUNDED), along, core.is_point);
    return core;
}

// Returns where a core, or the end of its light, is so near that a ray is not enough.
INLINE intv is_near_core(const Across *const light, const floatv distance) {
    const float end = IS_INVERSE(light->profile) ? FOOTPRINT_END_OF_INVERSE : FOOTPRINT_END;
    const intv is_near = (distance < end) & (light->thickness < FOOTPRINT_THICK);
#ifdef SHAPES
    if (IS_GAUSSIAN(light)) {
        const floatv seen = max(FOOTPRINT_END_OF_GAUSSIAN * light->thickness, FOOTPRINT_END);
        return (distance < seen) & (light->thickness < FOOTPRINT_THICK_OF_GAUSSIAN);
    }
    if (light->has_end) {
        const floatv reach = root_of(inverse(light->per_reach2));
        const intv is_rim = (reach < FAR_REACH) & (distance > reach - FOOTPRINT_END);
        return (is_near | is_rim | (reach < CLOSE_REACH)) & (distance < reach + SEEN_BEYOND);
    }
#endif
    return is_near;
}

INLINE Surroundings surroundings_of(const View *const view, const Square *const square, const Ray *const ray,
                                    const Closest *const closest, __global const Falloff *const falloff) {
    Surroundings around;
    const uint profile = falloff->profile;
    around.core = core_seen(view, square, ray, closest);
    const CoreSeen *const core = &around.core;
    const floatv softening2 = ray->softening2 + closest->thickness2 + falloff->radius2;
    const floatv thickness2 = IS_BARE(profile) ? splat(falloff->radius2) : softening2;
    const floatv thickness = max(root_of(thickness2) * core->per_length, LEAST_THICKNESS);
    around.light.profile = profile;
    around.light.thickness = profile == 4u ? SMEARED_THICKNESS * thickness : thickness;
    around.light.has_end = profile <= 2u && falloff->reach2 > 0.0f;
    around.light.per_reach2 = splat(0.0f);
    if (around.light.has_end)
        around.light.per_reach2 = inverse(falloff->reach2 * core->per_length * core->per_length);
    around.distance = root_of(fma(core->across, core->across, core->along * core->along));
    // Where a ray runs along a core, the core may be far ahead.
    const floatv apart = length3(closest->beside) * core->per_length;
    const intv is_met = (closest->s > 0.0f) & (closest->s < ray->end), is_known = profile != CONVOLVED ? -1 : 0;
    around.is_near = is_known & is_met & is_near_core(&around.light, apart);
    around.is_close = around.is_near & (core->is_point | (apart < CLOSE));
    const float3v across_line = cross3(unit_along(closest->along), ray->span);
    around.per_speed = inverse(length3(select3(across_line, ray->span, core->is_point)));
    return around;
}

// Returns the mean over a square of the light of a core that has its closest point there, as a place in it sees it.
INLINE MeanLight mean_at_place(const Surroundings *const around, const Closest *const closest) {
    const CoreSeen *const core = &around->core;
    const floatv across = dot3(core->across_axis, closest->beside) * core->per_length;
    const floatv along = dot3(core->along_axis, closest->beside) * core->per_length;
    return mean_across(&around->light, across, along, core->right, core->below);
}

// Puts a ray at a distance from the core, on the side of the square's centre.
INLINE void put_ray(Footprint *const footprint, const uint k, const Square *const square,
                    const Surroundings *const around, const floatv distance) {
    const CoreSeen *const core = &around->core;
    const floatv share = 1.0f - distance * inverse(max(around->distance, 1e-6f));
    const floatv across = select(core->across * share, -distance, around->distance < 1e-6f),
                 along = core->along * share;
    const floatv right = fma(across, core->right, along * core->along_right);
    const floatv below = fma(across, core->below, along * core->along_below);
    footprint->right[k] = square->right + square->side * select(splat(0.0f), right, around->is_near);
    footprint->below[k] = square->below + square->side * select(splat(0.0f), below, around->is_near);
}

// Returns the whole light of a straight core, without its own, in the units of across.h.
INLINE floatv light_of_straight(const Surroundings *const around) {
    const Across *const light = &around->light;
    const floatv per_length = around->core.per_length,
                 window = fma(light->thickness * light->thickness, light->per_reach2, splat(1.0f));
    switch (light->profile) {
    case 1:
        return PI * per_length * window * window * around->per_speed;
    case 2:
        return 2.0f * per_length * per_length * window * window * around->per_speed;
    case 3:
        return ROOT_OF_2_PI * light->thickness * inverse(per_length) * around->per_speed;
    default:
        return 2.0f * window * window * around->per_speed;
    }
}

// Returns the ray through the centre of a square.
INLINE Footprint center_of(const Square *const square) {
    const floatv right = splat(square->right), below = splat(square->below);
    const Footprint footprint = {1, {right, right}, {below, below}, splat(0.0f), splat(0.0f), splat(0.0f)};
    return footprint;
}

// Takes the mean over a square of the light next to it.
INLINE Footprint footprint_of(const Square *const square, const Surroundings *const around, const MeanLight seen) {
    Footprint footprint = center_of(square);
    const CoreSeen *const core = &around->core;
    const Across *const light = &around->light;
    const floatv b = light->thickness, distance = around->distance;
    floatv mean = seen.core;
    const intv is_rough = core->is_point & (distance < SMOOTH_FROM) & (b < SMOOTH_FROM) & around->is_near;
    if (any_lane(is_rough)) {
        const floatv right = core->right * core->across, below = core->below * core->across;
        mean = select(mean, mean_beside_point(light, right, below), is_rough);
    }
    mean -= seen.lost;
    floatv pass = IS_GAUSSIAN(light) ? min(distance, 5.0f * b) : max(distance, LEAST_PASS - min(b, LEAST_PASS));
#ifdef SHAPES
    const floatv reach = root_of(inverse(light->per_reach2));
    if (light->has_end)
        pass = min(pass, max(reach - RIM_PASS, 0.5f * reach));
#endif
    const floatv at_pass = core_across(light, pass * pass) - lost_across(light, pass * pass);
    floatv ratio = mean * inverse(at_pass);
    ratio = select(ratio, min(ratio, MOST_SMOOTH), distance > SMOOTH_FROM);
#ifdef SHAPES
    if (light->has_end) {
        const floatv at_rim = mean_at_rim(reach - distance, core->right, core->below, reach - pass);
        ratio = select(ratio, at_rim, distance > reach - RIM);
        footprint.trust = select(splat(0.0f), splat(TRUST_IN_RIM), distance > 0.5f * reach);
        footprint.trust = select(footprint.trust, splat(1.0f), (distance > FOOTPRINT_END) & (reach > CLOSE_REACH));
    }
#endif
    footprint.straight = light_of_straight(around);
    put_ray(&footprint, 0, square, around, pass);
    if (IS_INVERSE(light->profile) && !light->has_end) {
        const floatv second = pass + SECOND_PASS, fall = at_pass - core_across(light, second * second);
        put_ray(&footprint, 1, square, around, second);
        footprint.count = 2;
        footprint.growth = select(splat(0.0f), (mean - at_pass) * inverse(fall), around->is_near);
        footprint.straight *= fall;
    } else {
        footprint.growth = select(splat(0.0f), ratio - 1.0f, around->is_near);
        footprint.straight *= at_pass;
    }
    return footprint;
}

// The light of a square, and by how much it may be off, of itself.
typedef struct {
    floatv light, doubt;
} SquareLight;

// What surroundings tell of the mean is taken for a part of the light only where that is less than so much of it.
#define MOST_GROWTH 0.5f

// Makes the light of a square from its rays' integrals.
INLINE SquareLight light_of_square(const Footprint *const footprint, const floatv *const integrals,
                                   const floatv core_light, const floatv bend) {
    const floatv growth = footprint->growth, known = core_light * footprint->straight;
    floatv of_core = integrals[0];
    if (footprint->count == 2)
        of_core -= integrals[1];
    const floatv other = fabs(of_core - known) * inverse(max(fabs(of_core), 1e-30f));
    const floatv doubt = select((1.0f - footprint->trust) * other * fabs(growth), splat(0.0f), core_light == 0.0f);
    const intv is_part = (fabs(known) < fabs(of_core)) & (known * of_core > 0.0f) & (fabs(growth) < MOST_GROWTH);
    if (footprint->count == 1)
        of_core = select(of_core, known, is_part);
    const SquareLight seen = {fma(of_core, growth, integrals[0]), fma(splat(BEND_DOUBT), bend, doubt)};
    return seen;
}

// Returns one of the squares that a pixel is cut into, so many a side; 1 is the pixel.
INLINE Square part_of_pixel(const uint number, const uint cuts) {
    const float side = 1.0f / (float)cuts;
    const Square part = {fma((float)(number % cuts) + 0.5f, side, -0.5f),
                         fma((float)(number / cuts) + 0.5f, side, -0.5f), side};
    return part;
}

// Returns how much of a pixel's light is that of its cuts, which do from such a doubt on: one way of seeing a pixel
// passes into the other, so that it does not pop where its doubt grows.
INLINE floatv share_of_cuts(const floatv doubt, const float from) {
    return clamp((doubt - PASSES_FROM * from) * (1.0f / ((1.0f - PASSES_FROM) * from)), 0.0f, 1.0f);
}
