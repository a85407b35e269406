// What changes along a path: its light, and how thick it is.
//
// Straight pieces stand for a curved core. Its own nearest point moves on evenly where that of the pieces rests on
// their corners: planes across the core through the corners of a piece tell how far along the core a spot lies, by its
// distance from both.
#pragma once
#include "rows.h"

#ifdef SERIES
// A stretch is at least so many halvings of the way to the next part.
#define MOST_HALVINGS 8

// Of a corner, as the host says.
#define SMOOTH_JOINT 2.0f

// How far light is followed beyond the ends of a piece, in pieces, where the core goes on smoothly.
#define BEYOND_PIECE 0.5f

#ifndef DOUBLED // a test spoils it
#define DOUBLED 2.0f
#endif

typedef struct {
    floatv value, radius; // what light is multiplied with; how thick the core is, doubled, where that changes
} path_light;

// Returns the tangent after a corner (row 0), or before it (row 1).
INLINE float3v path_tangent(const path_rows *const path, const intv corner, const int row) {
    __global const float *const tangents = (__global const float *)(path->corners + 4u * path->corner_count);
    const intv first = 8 * corner + 4 * row;
    const float3v v = {gather(tangents, first), gather(tangents, first + 1), gather(tangents, first + 2)};
    return v;
}

// Returns how far a spot lies behind the plane across the core at a corner.
INLINE floatv path_behind(const path_rows *const path, const intv corner, const int row, const float3v at) {
    const float3v from_corner = subtract3(at, path_gather3(path, corner, 0));
    return dot3(from_corner, path_tangent(path, corner, row));
}

// Returns the light at a spot whose nearest part is known. At a corner it is that of the piece on the spot's side.
INLINE path_light path_light_at(const path_rows *const path, const uint is_even, const path_place *const place,
                                const float3v at) {
    path_light light = {splat(1.0f), splat(0.0f)};
    if (is_even)
        return light;
    __global const float *const values = (__global const float *)path->corners + 7, *const radii = values + 4;
    __global const float *const joints = (__global const float *)(path->corners + 4u * path->corner_count) + 7;
    const intv corner = place->corner, last = (intv)((int)path->corner_count - 1);
    const intv is_before =
        !place->is_line & (path_behind(path, corner, 0, at) <= 0.0f) & (gather(joints, 8 * corner) > 0.0f);
    const intv begin = select(corner, max(corner - 1, 0), is_before), end = min(begin + 1, last);
    const floatv behind = path_behind(path, begin, 0, at), ahead = -path_behind(path, end, 1, at);
    // Parts that are all but equally near may not have taken over yet.
    const floatv least = select(splat(0.0f), splat(-BEYOND_PIECE), gather(joints, 8 * begin) == SMOOTH_JOINT);
    const floatv most = select(splat(1.0f), splat(1.0f + BEYOND_PIECE), gather(joints, 8 * end) == SMOOTH_JOINT);
    const floatv share = clamp(behind * inverse(max(behind + ahead, 1e-30f)), least, most);
    const floatv value = gather(values, 16 * begin), radius = gather(radii, 16 * begin);
    light.value = fma(share, gather(values, 16 * end) - value, value);
    light.radius = DOUBLED * fma(share, gather(radii, 16 * end) - radius, radius);
    return light;
}

// Returns whether a value is far from half way between those on both sides.
intv path_bends(const floatv from, const floatv middle, const floatv to, const float most) {
    return fabs(middle - 0.5f * (from + to)) > most * max(fabs(middle), max(fabs(from), fabs(to)));
}

// Returns up to where the light is all but linear along a ray: halves the way until it is.
INLINE floatv path_straight_to(const path_rows *const path, __global const LightPath *const source,
                               const Ray *const ray, const path_place *const place, const floatv from, floatv to) {
    if (source->is_even)
        return to;
    const path_light begin = path_light_at(path, 0u, place, path_spot_at(ray, from).at);
    path_light end = path_light_at(path, 0u, place, path_spot_at(ray, to).at);
    for (int halvings = 0; halvings < MOST_HALVINGS; ++halvings) {
        const floatv half_way = 0.5f * (from + to);
        const path_light middle = path_light_at(path, 0u, place, path_spot_at(ray, half_way).at);
        const intv bends = (path_bends(begin.value, middle.value, end.value, source->most_bend) |
                            path_bends(begin.radius, middle.radius, end.radius, source->most_bend)) &
                           (half_way > from);
        if (!any_lane(bends))
            break;
        to = select(to, half_way, bends);
        end.value = select(end.value, middle.value, bends), end.radius = select(end.radius, middle.radius, bends);
    }
    return to;
}
#endif
