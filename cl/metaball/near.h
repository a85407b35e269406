// The particles near a few rays side by side: found in the cells of a window of slabs, and kept while the rays pass
// them. Where there are more than can be kept, a window is walked in parts, anew for each pass over it; none is
// dropped.
#pragma once
#include "../block.h"
#include "../lanes.h"
#include "../roots.h"
#include "cells.h"

// Which kernels the surfaces have: known when the program is built, unless they have both.
#if defined(CONES) && defined(SMOOTH)
#define IS_SMOOTH(surface) ((surface)->is_smooth)
#elif defined(SMOOTH)
#define IS_SMOOTH(surface) true
#else
#define IS_SMOOTH(surface) false
#endif

// Particles that are kept, a power of two.
#if LANES == 1
#define ROOM 16u
#else
#define ROOM 128u
#endif

// Rays that leave the eye, or its plane: x = offset + slope z.
typedef struct {
    floatv offset_x, offset_y;
    floatv slope_x, slope_y;
    floatv x, y;  // what of a length along the ray goes to the right, and down
    floatv per_z; // the length along a ray in which it goes 1 along the axis of view
} Rays;

Rays rays_at(const Sight *const sight, const uintv column, const uintv row) {
    const floatv begin_x = fma(to_floatv(row), splat(sight->skew_x), splat(sight->first_x));
    const floatv x = fma(to_floatv(column), splat(sight->step_x), begin_x);
    const floatv y = fma(to_floatv(row), splat(sight->step_y), splat(sight->first_y));
    Rays rays;
    if (sight->is_parallel) {
        rays.offset_x = x, rays.offset_y = y;
        rays.slope_x = rays.slope_y = rays.x = rays.y = splat(0.0f);
        rays.per_z = splat(1.0f);
        return rays;
    }
    rays.offset_x = rays.offset_y = splat(0.0f);
    rays.slope_x = x, rays.slope_y = y;
    rays.per_z = sqrt(fma(x, x, fma(y, y, splat(1.0f))));
    rays.x = x / rays.per_z, rays.y = y / rays.per_z;
    return rays;
}

// What a ray is to a particle.
typedef struct {
    floatv at;    // where it is closest, a length along the ray
    floatv d2;    // the squared distance there
    floatv x, y;  // from the particle to the ray, in the plane across the axis of view that the particle lies in
    floatv along; // what of that goes along the ray
} Passing;

// Returns how rays pass a particle. Their points at the particle's depth are close to it, so nothing cancels: of
// |p|^2 - (p D)^2 float32 keeps little.
Passing passing(const Rays *const rays, __global const Particle *const particle) {
    Passing passing;
    const float x = particle->x, y = particle->y, z = particle->z;
    passing.x = fma(rays->slope_x, splat(z), rays->offset_x - x);
    passing.y = fma(rays->slope_y, splat(z), rays->offset_y - y);
    passing.along = fma(passing.x, rays->x, passing.y * rays->y);
    passing.at = fma(splat(z), rays->per_z, -passing.along);
    passing.d2 = fma(passing.x, passing.x, fma(passing.y, passing.y, -passing.along * passing.along));
#ifdef SQUARED_DISTANCE
    // Spoiled.
    const floatv px = x - rays->offset_x, py = y - rays->offset_y, toward = 1.0f / rays->per_z;
    const floatv to = px * rays->x + py * rays->y + z * toward;
    passing.d2 = px * px + py * py + z * z - to * to;
#endif
    passing.d2 = max(passing.d2, splat(0.0f));
    return passing;
}

// Particles near the rays of a block: a ring, and how many of them each slab has.
typedef struct {
    uint begin, count;
    uint of_slab[8];
    uint particle[ROOM];
    float inverse_radius[ROOM], weight[ROOM];
    floatv at[ROOM], d2[ROOM];       // see Passing
    floatv enter[ROOM], leave[ROOM]; // where the rays come into its field, and leave it
    floatv growth[ROOM];             // the bound of its field's growth
    floatv most[ROOM];               // the most of its field on the rays
#ifdef COUNT_NODES
    uint passes, pairs; // over windows, and of rays and particles in them, LANES at a time
#endif
} Near;

// A block of rays, one in every lane, and what it looks for particles in.
typedef struct {
    const Sight *sight;
    __global const Surface *surface;
    __global const Slab *slabs;
    __global const uint *cells;
    __global const Particle *particles;
    __global const float *planes; // x, y, z and radius of all particles, each `plane` numbers
    uint plane;
    const Rays *rays;
    Block block;
    float middle_x, middle_y, spread; // slope, or offset, of the block's middle, and how far its rays are from that
    float longest;                    // the greatest length of a ray for 1 along the axis of view
} Search;

// Where a search goes on.
typedef struct {
    uint slab, last_slab; // the next to be opened, and the one to stop at
    uint open;            // the one that is open
    Cells cells;
    uint row;
    uint at, end; // particles of a row of cells
} Cursor;

// Says of particles, one in every lane, whether any ray of the block may come within their radius: seen in the plane
// across the axis of view that a particle lies in, where rays are closest to it at a slant.
INLINE intv may_be_near(const Search *const search, const uint at, const uint end) {
    __global const float *const first = search->planes + at;
    const floatv z = load_lanes(first + 2u * search->plane), radius = load_lanes(first + 3u * search->plane);
    const floatv depth = search->sight->is_parallel ? splat(1.0f) : z;
    const floatv x = fma(splat(search->middle_x), depth, -load_lanes(first));
    const floatv y = fma(splat(search->middle_y), depth, -load_lanes(first + search->plane));
    const floatv most = fma(radius, splat(search->longest), search->spread * fabs(depth));
    return (fma(x, x, y * y) <= most * most) & (at + LANE_NUMBERS < end);
}

// Adds a particle if a ray comes within its radius; there must be room.
INLINE void add_particle(const Search *const search, const uint number, Near *const near, const uint slab) {
    __global const Particle *const particle = search->particles + number;
    const Passing it = passing(search->rays, particle);
    const float wide = particle->radius * search->surface->wider;
    if (!any_lane(it.d2 < wide * wide))
        return;
    const uint place = (near->begin + near->count) % ROOM;
    const floatv chord2 = max(particle->radius * particle->radius - it.d2, 0.0f), half_chord = sqrt(chord2);
    near->particle[place] = number;
    near->inverse_radius[place] = particle->inverse_radius, near->weight[place] = particle->weight;
    near->at[place] = it.at, near->d2[place] = it.d2;
    near->enter[place] = it.at - half_chord, near->leave[place] = it.at + half_chord;
    const floatv share2 = min(it.d2 * (particle->inverse_radius * particle->inverse_radius), 1.0f);
    const floatv left = IS_SMOOTH(search->surface) ? 1.0f - share2 : 1.0f - sqrt(share2);
    near->most[place] = particle->weight * left * left * (IS_SMOOTH(search->surface) ? left : splat(1.0f));
    near->growth[place] = particle->growth * (IS_SMOOTH(search->surface) ? chord2 * chord2 : chord2);
    ++near->count, ++near->of_slab[slab % 8u];
}

// Adds particles of a row of cells. Returns whether there was room.
INLINE bool add_row(const Search *const search, Cursor *const cursor, Near *const near) {
    for (; cursor->at < cursor->end; cursor->at += LANES) {
        const intv is_near = may_be_near(search, cursor->at, cursor->end);
        if (!any_lane(is_near))
            continue;
        int flags[LANES];
#if LANES == 1
        flags[0] = is_near;
#else
        JOIN(vstore, LANES)(is_near, 0, flags);
#endif
        for (uint lane = 0u; lane < LANES; ++lane) {
            if (!flags[lane])
                continue;
            if (near->count == ROOM) {
                cursor->at += lane;
                return false;
            }
            add_particle(search, cursor->at + lane, near, cursor->open);
        }
    }
    return true;
}

// Adds particles until the search is over, or there is no room. Returns whether it is over.
INLINE bool add_particles(const Search *const search, Cursor *const cursor, Near *const near) {
    for (;;) {
        if (!add_row(search, cursor, near))
            return false;
        __global const Slab *slab = search->slabs + cursor->open;
        if (cursor->row > cursor->cells.bottom) {
            if (cursor->slab == cursor->last_slab)
                return true;
            cursor->open = cursor->slab++;
            slab = search->slabs + cursor->open;
            near->of_slab[cursor->open % 8u] = 0u;
            cursor->cells = cells_near(slab, &search->block);
            cursor->row = cursor->cells.top;
        }
        const uint begin = slab->first_cell + cursor->row * slab->columns;
        cursor->at = cell_begin(search->cells, begin + cursor->cells.left);
        cursor->end = search->cells[begin + cursor->cells.right];
        ++cursor->row;
    }
}

// Returns a search that has yet to begin with a slab.
Cursor cursor_at(const uint slab, const uint last_slab) {
    const Cursor cursor = {slab, last_slab, slab, {0u, 0u, 1u, 0u}, 1u, 0u, 0u};
    return cursor;
}

void forget(Near *const near) {
    near->begin = near->count = 0u;
    for (uint slab = 0u; slab < 8u; ++slab)
        near->of_slab[slab] = 0u;
}

// The window of slabs that a stretch of the rays passes.
typedef struct {
    uint first, last; // slabs, the last not included
    uint kept_to;     // slabs before this one have been added
    bool is_kept;     // whether all its particles are
    Cursor cursor;    // of a walk in parts
} Window;

// Moves a window on: lets go of what lies before it, and adds what is new. Where that is too much, it is walked.
void move_window(const Search *const search, Window *const window, Near *const near, const uint slab) {
    const uint reach = search->surface->reach;
    const uint first = slab > reach ? slab - reach : 0u;
    const uint last = min(slab + reach + 1u, search->surface->slab_count);
    if (!window->is_kept || window->kept_to < first) {
        forget(near);
        window->kept_to = first;
    } else {
        for (uint gone = window->first; gone < first; ++gone) {
            near->begin += near->of_slab[gone % 8u];
            near->count -= near->of_slab[gone % 8u];
        }
    }
    window->first = first, window->last = last;
    Cursor cursor = cursor_at(window->kept_to, last);
    window->is_kept = add_particles(search, &cursor, near);
    window->kept_to = last;
}

// Begins a pass over a window: returns whether there are particles. Each part of it is in `near` in turn.
bool first_part(const Search *const search, Window *const window, Near *const near) {
    if (window->is_kept)
        return near->count > 0u;
    forget(near);
    window->cursor = cursor_at(window->first, window->last);
    add_particles(search, &window->cursor, near);
    return near->count > 0u;
}

bool next_part(const Search *const search, Window *const window, Near *const near) {
    if (window->is_kept)
        return false;
    forget(near);
    add_particles(search, &window->cursor, near);
    return near->count > 0u;
}
