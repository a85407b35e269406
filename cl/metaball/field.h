// The summed field of particles along rays, its slope, and the bound of its growth.
//
// With u the length from where a ray is closest to a particle, d the distance there, r^2 = u^2 + d^2:
// P = (1 - r/h)^2 (Mishima, Tanaka, Sagawa 2008), whose second derivative along the ray is
// (2/h^2)(1 - d^2 h / r^3) <= 2 k, k = (1 - d^2/h^2)/h^2; of (1 - r^2/h^2)^3 it is at most 2 k with
// k = 3 (1 - d^2/h^2)^2 / h^2. Slopes jump down only, at r = 0. So with K the sum of k over the particles whose field
// meets the stretch from s to s + x, f(s + x) <= f(s) + f'(s) x + K x^2.
#pragma once
#include "near.h"

typedef struct {
    floatv field, slope, growth;
} Sums;

// Where passes are counted.
#ifdef COUNT_NODES
#define COUNT(counter, more) (counter) += (more)
#else
#define COUNT(counter, more)
#endif

// Returns 1 / sqrt(x), x >= 0.
floatv inverse_root(const floatv x) {
    return 0.5f * twice_inverse_sqrt_(max(x, splat(TINY)));
}

// Adds a particle's field at lengths s, and its bound up to `end`.
INLINE void add_field(Sums *const sums, const Near *const near, const uint place, const floatv s, const floatv end,
                      const bool is_smooth) {
    const floatv u = s - near->at[place];
    const floatv r2 = fma(u, u, near->d2[place]);
    const float inverse_radius = near->inverse_radius[place], weight = near->weight[place];
    if (is_smooth) {
        const float inverse2 = inverse_radius * inverse_radius;
        const floatv left = max(fma(r2, splat(-inverse2), splat(1.0f)), splat(0.0f));
        const floatv left2 = weight * left * left;
        sums->field = fma(left2, left, sums->field);
        sums->slope = fma(left2 * u, splat(-6.0f * inverse2), sums->slope);
    } else {
        const floatv twice_inverse_r = twice_inverse_sqrt_(max(r2, splat(TINY)));
        const floatv left = max(fma(r2 * twice_inverse_r, splat(-0.5f * inverse_radius), splat(1.0f)), splat(0.0f));
        const floatv weighted = weight * left;
        sums->field = fma(weighted, left, sums->field);
        sums->slope = fma(weighted * u, twice_inverse_r * -inverse_radius, sums->slope);
    }
    const intv meets = (near->leave[place] > s) & (near->enter[place] < end);
    sums->growth += select(splat(0.0f), near->growth[place], meets);
}

// Lists those of the kept particles whose field any ray meets between two lengths: only they are summed there. Returns
// what the field cannot exceed on each ray: the most of all that it meets.
INLINE floatv begin_stretch(const Search *const search, Window *const window, Near *const near, const floatv s,
                            const floatv end) {
    floatv most = splat(0.0f);
    for (bool has_part = first_part(search, window, near); has_part; has_part = next_part(search, window, near)) {
        uint met = 0u;
        for (uint number = 0u; number < near->count; ++number) {
            const uint place = (near->begin + number) % ROOM;
            const intv meets = (near->leave[place] > s) & (near->enter[place] < end);
            most += select(splat(0.0f), near->most[place], meets);
            near->met[met] = place;
            met += any_lane(meets);
        }
        near->met_count = met;
    }
    return most;
}

// Sums the particles of a window at lengths s, and bounds up to `end`.
INLINE Sums field_along(const Search *const search, Window *const window, Near *const near, const floatv s,
                        const floatv end) {
    Sums sums = {splat(0.0f), splat(0.0f), splat(0.0f)};
    const bool is_smooth = IS_SMOOTH(search->surface);
    COUNT(near->passes, 1u);
    for (bool has_part = first_part(search, window, near); has_part; has_part = next_part(search, window, near))
        for (uint number = 0u; number < near->met_count; ++number) {
            const uint place = near->met[number];
            COUNT(near->pairs, 1u);
            add_field(&sums, near, place, s, end, is_smooth);
        }
    return sums;
}

// The field and its gradient, along the axes of the picture.
typedef struct {
    floatv field;
    float3v gradient;
} Gradient;

INLINE Gradient gradient_at(const Search *const search, Window *const window, Near *const near, const floatv s) {
    Gradient sum = {splat(0.0f), {splat(0.0f), splat(0.0f), splat(0.0f)}};
    const Rays *const rays = search->rays;
    const floatv z = 1.0f / rays->per_z;
    const bool is_smooth = IS_SMOOTH(search->surface);
    for (bool has_part = first_part(search, window, near); has_part; has_part = next_part(search, window, near))
        for (uint number = 0u; number < near->met_count; ++number) {
            const uint place = near->met[number];
            __global const Particle *const particle = search->particles + near->particle[place];
            const Passing it = passing(rays, particle);
            const floatv u = s - it.at, r2 = fma(u, u, it.d2);
            const float inverse_radius = particle->inverse_radius;
            floatv toward; // what the way from the particle is multiplied with
            if (is_smooth) {
                const float inverse2 = inverse_radius * inverse_radius;
                const floatv left = max(fma(r2, splat(-inverse2), splat(1.0f)), splat(0.0f));
                sum.field = fma(particle->weight * left * left, left, sum.field);
                toward = -6.0f * particle->weight * inverse2 * left * left;
            } else {
                const floatv inverse_r = inverse_root(r2);
                const floatv left = max(fma(r2 * inverse_r, splat(-inverse_radius), splat(1.0f)), splat(0.0f));
                sum.field = fma(particle->weight * left, left, sum.field);
                toward = -2.0f * particle->weight * inverse_radius * left * inverse_r;
            }
            // From the particle to the ray where that is closest, and on along it.
            const floatv on = u - it.along;
            sum.gradient.x = fma(toward, fma(on, rays->x, it.x), sum.gradient.x);
            sum.gradient.y = fma(toward, fma(on, rays->y, it.y), sum.gradient.y);
            sum.gradient.z = fma(toward, on * z, sum.gradient.z);
        }
    return sum;
}
