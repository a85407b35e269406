// The first place along rays where the summed field reaches the threshold T.
//
// From f < T the root of f + f' x + K x^2 = T (field.h) is never beyond that place, and next to it the step is
// Newton's: with g = T - f and q = sqrt(f'^2 + 4 K g) it is 2 g / (q + f') where the field grows, else (q - f') / (2
// K).
#pragma once
#include "field.h"

// How close to the threshold a field is on the surface: what float32 leaves of sums, and what it leaves of a length s,
// times the slope. A fixed value is less than a step of s can bring far from the eye.
#define FIELD_ERROR 5e-6f
#define LENGTH_ERROR 2.4e-7f

// Where rays are, and what they have found. Lanes are masks.
typedef struct {
    floatv s;       // how far they have come
    floatv limit;   // where something else ends them
    intv is_open;   // whether they go on
    intv is_hit;    // whether the surface is at s
    floatv on;      // exactly: the step that is left to it
    intv is_strict; // whether the surface is only where the field is seen to be at the threshold
    floatv want;    // method sampling: where the next sample may lie,
    uintv taken;    // and how many were taken
    float3v normal; // of the surface, along the axes of the picture
} March;

// Goes on to the end of a slab, or to the surface. Returns which lanes found it.
INLINE intv march_exactly(const Search *const search, Window *const window, Near *const near, March *const march,
                          const floatv slab_end) {
    const floatv end = min(slab_end, march->limit);
    const float threshold = search->surface->threshold;
    const floatv none = splat(0.0f);
    intv found = (intv)(0);
    intv goes_on = march->is_open & (march->s < end);
    const floatv most = begin_stretch(search, window, near, march->s, end);
#ifndef STEP_BEYOND
    const intv is_empty = most < threshold * (1.0f - FIELD_ERROR);
    march->s = select(march->s, end, goes_on & is_empty);
    goes_on &= ~is_empty;
#endif
    while (any_lane(goes_on)) {
        const Sums sums = field_along(search, window, near, march->s, end);
        const floatv missing = threshold - sums.field;
        const floatv error =
            fma(fabs(sums.slope), LENGTH_ERROR * (march->s + search->surface->radius), splat(FIELD_ERROR * threshold));
        const floatv growth = max(sums.growth, splat(TINY)), left = max(missing, none);
        const intv grows = sums.slope > 0.0f;
        // Where Newton's step misses the threshold by no more than that, it is taken when the surface is settled.
        const intv is_close = grows & ~march->is_strict & (growth * left * left <= error * sums.slope * sums.slope);
        const intv is_there = goes_on & ((missing <= error) | is_close);
        march->on = select(march->on, select(none, left * inverse(max(sums.slope, splat(TINY))), is_close), is_there);
        found |= is_there;
        goes_on &= ~is_there;
        const floatv root = 0.5f * twice_sqrt(max(fma(sums.slope, sums.slope, 4.0f * growth * left), splat(TINY)));
        const floatv above = select(root - sums.slope, 2.0f * left, grows);
        const floatv below = select(2.0f * growth, root + sums.slope, grows);
        const floatv step = max(above * inverse(max(below, splat(TINY))), LENGTH_ERROR * march->s);
#ifdef STEP_BEYOND
        // Spoiled: behind the end are particles that the bound does not know. Nor is an empty stretch passed at once.
        const floatv next = select(march->s + step, end, sums.growth <= 0.0f);
#else
        const floatv next = select(min(march->s + step, end), end, sums.growth <= 0.0f);
#endif
        march->s = select(march->s, next, goes_on);
        goes_on &= march->s < end;
    }
    return found;
}

#ifdef SAMPLING
#if LANES == 1
#define as_uintv as_uint
#else
#define as_uintv JOIN(as_uint, LANES)
#endif

// Samples that are taken one after the other before a gap is looked for (2008).
#define AT_ONCE 4u

// Returns the first place from `want` on that lies in the front half of a particle's cube (2008, eq. 1-4): a square of
// side 2 h across the ray, h deep.
INLINE floatv next_region(const Search *const search, Window *const window, Near *const near, const floatv want) {
    const Rays *const rays = search->rays;
    floatv next = splat(INFINITY);
    for (bool has_part = first_part(search, window, near); has_part; has_part = next_part(search, window, near))
        for (uint number = 0u; number < near->count; ++number) {
            __global const Particle *const particle = search->particles + near->particle[(near->begin + number) % ROOM];
            const Passing it = passing(rays, particle);
            const float radius = particle->radius;
            const floatv right = fma(-it.along, rays->x, it.x), down = fma(-it.along, rays->y, it.y);
            const intv is_in = (it.at >= want) & (fabs(right) <= radius) & (fabs(down) <= radius);
            next = select(next, min(next, max(it.at - radius, want)), is_in);
        }
    return next;
}

// Interpolates the place of the threshold between a sample within and the interval before it (2008, eq. 5).
INLINE floatv refined(const Search *const search, Window *const window, Near *const near, const floatv within) {
    const float threshold = search->surface->threshold;
    floatv low = max(within - search->surface->interval, splat(0.0f)), high = within, place = within;
    floatv at_low = field_along(search, window, near, low, low).field;
    floatv at_high = field_along(search, window, near, high, high).field;
    for (uint count = 0u; count < search->surface->refinements; ++count) {
        const floatv share = (threshold - at_low) / max(at_high - at_low, splat(TINY));
        place = select(place, fma(high - low, clamp(share, 0.0f, 1.0f), low), at_low < threshold);
        const floatv field = field_along(search, window, near, place, place).field;
        const intv is_within = field >= threshold;
        high = select(high, place, is_within), at_high = select(at_high, field, is_within);
        low = select(place, low, is_within), at_low = select(field, at_low, is_within);
    }
    return place;
}

// Goes on to the end of a slab, or to the surface, by samples. Returns which lanes found it.
INLINE intv march_by_samples(const Search *const search, Window *const window, Near *const near, March *const march,
                             const floatv slab_end) {
    __global const Surface *const surface = search->surface;
    const floatv end = min(slab_end, march->limit);
    intv found = (intv)(0);
    intv goes_on = march->is_open & (march->want < end);
    meet_all(near);
    while (any_lane(goes_on)) {
        const floatv region = next_region(search, window, near, march->want);
        const floatv place = select(march->want, region, march->taken % AT_ONCE == 0u);
        goes_on &= place < end;
        if (!any_lane(goes_on))
            break;
        const floatv field = field_along(search, window, near, place, place).field;
        const intv is_there = goes_on & (field >= surface->threshold);
        march->s = select(march->s, place, goes_on);
        march->want = select(march->want, place + surface->interval, goes_on);
        march->taken += as_uintv(goes_on & 1);
        found |= is_there;
        march->is_open &= ~goes_on | (march->taken < surface->samples) | is_there;
        goes_on &= ~is_there & march->is_open & (march->want < end);
    }
    if (any_lane(found))
        march->s = select(march->s, refined(search, window, near, march->s), found);
    return found;
}
#endif

INLINE intv march_on(const Search *const search, Window *const window, Near *const near, March *const march,
                     const floatv slab_end) {
#ifdef SAMPLING
    if (search->surface->samples > 0u)
        return march_by_samples(search, window, near, march, slab_end);
#endif
    return march_exactly(search, window, near, march, slab_end);
}

// Puts what was found onto the surface by Newton's steps, and takes its normal. Returns which lanes have to look for it
// further: the field that a step comes to may not be at the threshold.
INLINE intv settle(const Search *const search, Window *const window, Near *const near, March *const march,
                   const intv found) {
    const bool is_exact = search->surface->samples == 0u;
    const float threshold = search->surface->threshold;
    const floatv s = is_exact ? march->s + march->on : march->s;
    const Gradient there = gradient_at(search, window, near, s);
    const float3v direction = {search->rays->x, search->rays->y, 1.0f / search->rays->per_z};
    const floatv slope = dot3(there.gradient, direction);
    const floatv missing = threshold - there.field;
    const floatv error = fma(fabs(slope), LENGTH_ERROR * (s + search->surface->radius), splat(FIELD_ERROR * threshold));
    const intv is_beside = is_exact ? found & (march->on > 0.0f) & (missing > error) : (intv)(0);
    const intv is_settled = found & ~is_beside;
    march->is_strict |= is_beside;
    const floatv step = missing * inverse(max(slope, splat(TINY)));
    // Not where the eye is within the surface, nor where the ray just touches it.
    const float most = 1e-3f * search->surface->radius;
    const intv is_small = is_exact ? is_settled & (slope > 0.0f) & (fabs(step) < most) : (intv)(0);
    march->s = select(march->s, max(select(s, s + step, is_small), splat(0.0f)), is_settled);
    const floatv outward = -inverse_root(dot3(there.gradient, there.gradient));
    march->normal = select3(march->normal, scale3(there.gradient, outward), is_settled);
    march->is_hit |= is_settled;
    march->is_open &= ~is_settled;
    return is_beside;
}
