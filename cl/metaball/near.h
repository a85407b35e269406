// The particles near a few rays side by side: found in the cells of a window of slabs, and kept while the rays pass
// them. Where there are more than can be kept, a window is walked in parts, anew for each pass over it; none is
// dropped.
#pragma once
#include "../roots.h"
#include "search.h"

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

#define TINY 1e-30f

// Particles near the rays of a block: a ring, and how many of them each slab has.
typedef struct {
    uint begin, count;
    uint of_slab[8];
    uint met[ROOM]; // those whose field the rays meet on a stretch, in their order
    uint met_count;
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

// Where a search goes on.
typedef struct {
    uint slab, last_slab; // the next to be opened, and the one to stop at
    uint open;            // the one that is open
    bool is_listed;       // whether its particles are, or else are in cells
    Cells cells;
    uint row;
    uint at, end; // particles of a row of cells, or of the list
} Cursor;

// Adds a particle if a ray comes within its radius; there must be room.
INLINE void add_particle(const Search *const search, const uint number, Near *const near, const uint slab) {
    __global const Particle *const particle = search->particles + number;
    const Passing it = passing(search->rays, particle);
    const float wide = particle->radius * search->surface->wider;
    if (!any_lane(it.d2 < wide * wide))
        return;
    const uint place = (near->begin + near->count) % ROOM;
    const floatv chord2 = max(particle->radius * particle->radius - it.d2, 0.0f),
                 half_chord = 0.5f * twice_sqrt(max(chord2, splat(TINY)));
    near->particle[place] = number;
    near->inverse_radius[place] = particle->inverse_radius, near->weight[place] = particle->weight;
    near->at[place] = it.at, near->d2[place] = it.d2;
    near->enter[place] = it.at - half_chord, near->leave[place] = it.at + half_chord;
    const floatv share2 = min(it.d2 * (particle->inverse_radius * particle->inverse_radius), 1.0f);
    const floatv left = IS_SMOOTH(search->surface) ? 1.0f - share2 : 1.0f - 0.5f * twice_sqrt(max(share2, splat(TINY)));
    near->most[place] = particle->weight * left * left * (IS_SMOOTH(search->surface) ? left : splat(1.0f));
    near->growth[place] = particle->growth * (IS_SMOOTH(search->surface) ? chord2 * chord2 : chord2);
    ++near->count, ++near->of_slab[slab % 8u];
}

// Adds particles of a row of cells, or of the list. Returns whether there was room.
INLINE bool add_row(const Search *const search, Cursor *const cursor, Near *const near) {
    const Listed *const listed = search->listed;
    for (; cursor->at < cursor->end; cursor->at += LANES) {
        const uint at = cursor->at;
        const Places places = cursor->is_listed ? places_listed(listed, at) : places_at(search, at);
        uint bits = lane_bits(may_be_near(search, &places) & (at + LANE_NUMBERS < cursor->end));
        for (; bits != 0u; bits &= bits - 1u) {
            const uint place = at + LOWEST_LANE(bits);
            if (near->count == ROOM) {
                cursor->at = place;
                return false;
            }
            add_particle(search, cursor->is_listed ? listed->number[place] : place, near, cursor->open);
        }
    }
    return true;
}

// Opens the next slab.
INLINE void open_slab(const Search *const search, Cursor *const cursor, Near *const near) {
    cursor->open = cursor->slab++;
    near->of_slab[cursor->open % 8u] = 0u;
    cursor->is_listed = is_listed(search, cursor->open);
    if (cursor->is_listed) {
        const uint number = cursor->open - search->listed->first;
        cursor->at = search->listed->begin[number], cursor->end = search->listed->begin[number + 1u];
        cursor->row = 1u, cursor->cells.bottom = 0u;
        return;
    }
    cursor->cells = cells_near(search->slabs + cursor->open, &search->block);
    cursor->row = cursor->cells.top;
}

// Adds particles until the search is over, or there is no room. Returns whether it is over.
INLINE bool add_particles(const Search *const search, Cursor *const cursor, Near *const near) {
    for (;;) {
        if (!add_row(search, cursor, near))
            return false;
        if (cursor->row > cursor->cells.bottom) {
            if (cursor->slab == cursor->last_slab)
                return true;
            open_slab(search, cursor, near);
            if (cursor->is_listed)
                continue;
        }
        __global const Slab *const slab = search->slabs + cursor->open;
        const uint begin = slab->first_cell + cursor->row * slab->columns;
        cursor->at = cell_begin(search->cells, begin + cursor->cells.left);
        cursor->end = search->cells[begin + cursor->cells.right];
        ++cursor->row;
    }
}

// Returns a search that has yet to begin with a slab.
Cursor cursor_at(const uint slab, const uint last_slab) {
    const Cursor cursor = {slab, last_slab, slab, false, {0u, 0u, 1u, 0u}, 1u, 0u, 0u};
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

// Returns the first slab whose particles may be near a slab's.
uint first_of_window(__global const Surface *const surface, const uint slab) {
    return slab > surface->reach ? slab - surface->reach : 0u;
}

// Moves a window on: lets go of what lies before it, and adds what is new. Where that is too much, it is walked.
void move_window(const Search *const search, Window *const window, Near *const near, const uint slab) {
    const uint reach = search->surface->reach;
    const uint first = first_of_window(search->surface, slab);
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

// Says that all particles are met.
INLINE void meet_all(Near *const near) {
    for (uint number = 0u; number < near->count; ++number)
        near->met[number] = (near->begin + number) % ROOM;
    near->met_count = near->count;
}

// Begins a pass over a window: returns whether there are particles. Each part of it is in `near` in turn.
bool first_part(const Search *const search, Window *const window, Near *const near) {
    if (window->is_kept)
        return near->count > 0u;
    forget(near);
    window->cursor = cursor_at(window->first, window->last);
    add_particles(search, &window->cursor, near);
    meet_all(near);
    return near->count > 0u;
}

bool next_part(const Search *const search, Window *const window, Near *const near) {
    if (window->is_kept)
        return false;
    forget(near);
    add_particles(search, &window->cursor, near);
    meet_all(near);
    return near->count > 0u;
}
