// Which elements come near the rays of a unit, a square of blocks, and of each of its blocks: LANES elements are looked
// at side by side. What is left out gives the rays nothing, so sums have the same bits however much is left out.
#pragma once
#include "pixels.h"

// Blocks across and down in a unit. Scalar devices have rays enough to keep them busy one by one.
#if LANES == 1
#define UNIT 1u
#else
#define UNIT 4u
#endif
#define UNIT_COLUMNS (UNIT * BLOCK_COLUMNS)
#define UNIT_ROWS (UNIT * BLOCK_ROWS)

// Elements of a unit that are looked at together, a multiple of all lane widths.
#if LANES == 1
#define ROOM 1u
#else
#define ROOM 256u
#endif

// Elements near a unit.
typedef struct {
    uint count;
    uint number[ROOM];
    float x[ROOM], y[ROOM], z[ROOM];
    float radius[ROOM];
} Candidates;

// Returns what of vectors is across the middle ray.
INLINE float3v across(const Cone *const cone, const float3v v) {
    const float3v toward = uniform3(cone->toward);
    return fma3(toward, -dot3(v, toward), v);
}

INLINE float3v from_middle(const Cone *const cone, const float3v place) {
    const float3v from = {place.x - cone->x, place.y - cone->y, place.z};
    return across(cone, from);
}

// Says whether rays may come within radii of places that are so far from the middle ray: by as much more as the others
// have spread where they meet what is there, at most so deep.
INLINE intv is_within(const GlowView *const view, const Cone *const cone, const float3v core, const floatv deepest,
                      floatv radius) {
#ifdef NARROW
    radius *= 0.7f; // spoiled
#endif
    const floatv farthest = view->is_parallel ? splat(1.0f) : deepest + radius;
    const floatv most = fma(farthest, splat(cone->spread), 1.001f * radius);
    return dot3(core, core) <= most * most;
}

// Says whether any ray may come within balls.
INLINE intv is_ball_near(const GlowView *const view, const Cone *const cone, const float3v place, const floatv radius) {
    return is_within(view, cone, from_middle(cone, place), fabs(place.z), radius);
}

// The same of stretches.
INLINE intv is_stretch_near(const GlowView *const view, const Cone *const cone, const float3v place, const float3v axis,
                            const floatv growth, const floatv radius) {
    const float3v core = from_middle(cone, place), beside = across(cone, axis);
    const floatv along = -dot3(core, beside) / max(dot3(beside, beside), splat(TINY));
    return is_within(view, cone, fma3(beside, clamp(along, -1.0f, 1.0f), core), fabs(place.z) + fabs(axis.z),
                     radius + fabs(growth));
}

// Returns a value of elements, the so manieth in their struct.
INLINE floatv value_of(__global const Element *const elements, const intv number, const uint place) {
    const uint stride = sizeof(Element) / sizeof(float);
    return gather((__global const float *)elements + place, number * (int)stride);
}

// Puts elements of a list near the rays of a cone into the candidates, of which there is room for LANES at least.
INLINE void add_candidates(const GlowView *const view, const Cone *const cone, __global const Element *const elements,
                           __global const uint *const numbers, const uint at, const uint end, Candidates *const found) {
    const intv place = min((int)at + as_intv((uintv)LANE_NUMBERS), (intv)((int)end - 1));
    const intv number = as_intv(gather((__global const float *)numbers, place));
    const float3v middle = {value_of(elements, number, 0u), value_of(elements, number, 1u),
                            value_of(elements, number, 2u)};
    const floatv radius = value_of(elements, number, 3u);
    const intv is_stretch = (as_intv(value_of(elements, number, 7u)) & (int)IS_STRETCH) != 0;
    intv near = is_ball_near(view, cone, middle, radius);
    if (any_lane(is_stretch)) {
        const float3v axis = {value_of(elements, number, 8u), value_of(elements, number, 9u),
                              value_of(elements, number, 10u)};
        const floatv growth = value_of(elements, number, 11u);
        near = select(near, is_stretch_near(view, cone, middle, axis, growth, radius), is_stretch);
    }
    uint bits = lane_bits(near & (LANE_NUMBERS < (uintv)(end - at)));
    if (bits == 0u)
        return;
    int list[LANES];
    float x[LANES], y[LANES], z[LANES], wide[LANES];
    STORE_LANES(number, list);
    // How near stretches are is looked at one by one.
    const floatv reach = select(radius, splat(INFINITY), is_stretch);
    scatter(middle.x, x), scatter(middle.y, y), scatter(middle.z, z), scatter(reach, wide);
    uint count = found->count;
    for (; bits != 0u; bits &= bits - 1u) {
        const uint lane = LOWEST_LANE(bits);
        found->number[count] = (uint)list[lane];
        found->x[count] = x[lane], found->y[count] = y[lane], found->z[count] = z[lane];
        found->radius[count] = wide[lane];
        ++count;
    }
    found->count = count;
}

// Fills the lanes beside the last candidate: they are looked at with it, and never taken.
INLINE void fill_last_lanes(Candidates *const found) {
    for (uint k = found->count; k % LANES != 0u; ++k)
        found->x[k] = found->y[k] = found->z[k] = found->radius[k] = 0.0f;
}

// Lists the candidates near the rays of a block. Returns how many those are.
INLINE uint near_block(const GlowView *const view, const Cone *const cone, const Candidates *const candidates,
                       ushort *const list) {
    uint count = 0u;
    for (uint begin = 0u; begin < candidates->count; begin += LANES) {
        const float3v place = {LOAD_LANES(candidates->x + begin), LOAD_LANES(candidates->y + begin),
                               LOAD_LANES(candidates->z + begin)};
        const intv near = is_ball_near(view, cone, place, LOAD_LANES(candidates->radius + begin));
        uint bits = lane_bits(near & (begin + LANE_NUMBERS < (uintv)(candidates->count)));
        for (; bits != 0u; bits &= bits - 1u)
            list[count++] = (ushort)(begin + LOWEST_LANE(bits));
    }
    return count;
}
