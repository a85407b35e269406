// What rays look for particles in: the cells of slabs, of which a unit, a square of blocks of rays, lists once what is
// near any of its rays. Its blocks look through that list; where it is full, through the cells. What is left out is
// near no ray, and the order is that of the cells, so sums have the same bits however much is listed.
#pragma once
#include "../block.h"
#include "../lanes.h"
#include "cells.h"

// Particles that a unit lists, a multiple of all lane widths, and slabs. Scalar devices have rays enough to keep them
// busy one by one.
#if LANES == 1
#define LISTED 1u
#define LISTED_SLABS 0u
#else
#define LISTED 1024u
#define LISTED_SLABS 256u
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

// The particles near a unit, of slabs that follow each other.
typedef struct {
    uint first, last; // slabs, the last not included
    bool is_full;
    uint begin[LISTED_SLABS + 1u]; // of each slab's
    uint number[LISTED];
    float x[LISTED + LANES], y[LISTED + LANES], z[LISTED + LANES]; // lanes are read beyond the last
    float radius[LISTED + LANES];
} Listed;

// A rectangle of rays, and what it looks for particles in; of a block there is a ray in every lane.
typedef struct Search {
    const Sight *sight;
    __global const Surface *surface;
    __global const Slab *slabs;
    __global const uint *cells;
    __global const Particle *particles;
    __global const float *planes; // x, y, z and radius of all particles, each `plane` numbers
    uint plane;
    const Rays *rays;
    const struct Search *unit; // that of a unit of blocks
    Listed *listed;            // what is near that
    Block block;
    float middle_x, middle_y, spread; // slope, or offset, of the block's middle, and how far its rays are from that
    float longest;                    // the greatest length of a ray for 1 along the axis of view
} Search;

// Makes it that of a rectangle of rays.
void set_rectangle(Search *const search, const uint column, const uint row, const uint columns, const uint rows) {
    const Sight *const sight = search->sight;
    search->block = block_of(sight, column, row, columns, rows);
    const Block *const block = &search->block;
    const float middle_column = 0.5f * (block->left + block->right), middle_row = 0.5f * (block->top + block->bottom);
    search->middle_x = fma(middle_column, sight->step_x, fma(middle_row, sight->skew_x, sight->first_x));
    search->middle_y = fma(middle_row, sight->step_y, sight->first_y);
    const float down = block->bottom - block->top, below = down * sight->step_y;
    const float across = fma(block->right - block->left, sight->step_x, down * fabs(sight->skew_x));
    search->spread = 0.501f * sqrt(fma(across, across, below * below));
    search->longest = sqrt(1.0f + block->steepest2);
}

// Places and radii of particles, one in every lane.
typedef struct {
    floatv x, y, z, radius;
} Places;

INLINE Places places_at(const Search *const search, const uint at) {
    __global const float *const first = search->planes + at;
    const uint plane = search->plane;
    const Places places = {load_lanes(first), load_lanes(first + plane), load_lanes(first + 2u * plane),
                           load_lanes(first + 3u * plane)};
    return places;
}

INLINE Places places_listed(const Listed *const listed, const uint at) {
    const Places places = {LOAD_LANES(listed->x + at), LOAD_LANES(listed->y + at), LOAD_LANES(listed->z + at),
                           LOAD_LANES(listed->radius + at)};
    return places;
}

// Says of particles whether any of the rays may come within their radius: seen in the plane across the axis of view
// that a particle lies in, where rays are closest to it at a slant.
INLINE intv may_be_near(const Search *const search, const Places *const places) {
    const floatv depth = search->sight->is_parallel ? splat(1.0f) : places->z;
    const floatv x = fma(splat(search->middle_x), depth, -places->x);
    const floatv y = fma(splat(search->middle_y), depth, -places->y);
    const floatv most = fma(places->radius, splat(search->longest), search->spread * fabs(depth));
    return fma(x, x, y * y) <= most * most;
}

void begin_list(Listed *const listed, const uint slab) {
    listed->first = listed->last = slab;
    listed->begin[0] = 0u;
    listed->is_full = LISTED_SLABS == 0u;
}

#if LANES > 1
// Lists the particles of the next slab near a unit, if there is room.
INLINE void list_slab(const Search *const unit, Listed *const listed) {
    const uint number = listed->last - listed->first;
    __global const Slab *const slab = unit->slabs + listed->last;
    const Cells cells = cells_near(slab, &unit->block);
    uint count = listed->begin[number];
    for (uint row = cells.top; row <= cells.bottom; ++row) {
        const uint begin = slab->first_cell + row * slab->columns;
        const uint end = unit->cells[begin + cells.right];
        for (uint at = cell_begin(unit->cells, begin + cells.left); at < end; at += LANES) {
            if (count + LANES > LISTED) {
                listed->is_full = true;
                return;
            }
            const Places places = places_at(unit, at);
            uint bits = lane_bits(may_be_near(unit, &places) & (at + LANE_NUMBERS < end));
            if (bits == 0u)
                continue;
            float x[LANES], y[LANES], z[LANES], radius[LANES];
            scatter(places.x, x), scatter(places.y, y), scatter(places.z, z), scatter(places.radius, radius);
            for (; bits != 0u; bits &= bits - 1u) {
                const uint lane = LOWEST_LANE(bits);
                listed->number[count] = at + lane;
                listed->x[count] = x[lane], listed->y[count] = y[lane], listed->z[count] = z[lane];
                listed->radius[count] = radius[lane];
                ++count;
            }
        }
    }
    // Lanes beside the last are looked at with it, and never taken.
    scatter(splat(0.0f), listed->x + count), scatter(splat(0.0f), listed->y + count);
    scatter(splat(0.0f), listed->z + count), scatter(splat(0.0f), listed->radius + count);
    ++listed->last;
    listed->begin[number + 1u] = count;
    listed->is_full = number + 1u == LISTED_SLABS;
}
#endif

// Says whether a slab is listed, once it was if there is room.
INLINE bool is_listed(const Search *const search, const uint slab) {
    Listed *const listed = search->listed;
#if LANES > 1
    while (listed->last <= slab && !listed->is_full)
        list_slab(search->unit, listed);
#endif
    return slab >= listed->first && slab < listed->last;
}
