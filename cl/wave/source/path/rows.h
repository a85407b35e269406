// The rows of a path: its levels, their groups of pieces, and spots of rays and parts of paths, seen from each other.
#pragma once

// A level of a path.
typedef struct {
    __global const float4 *balls, *corners;
    uint corner_count, group_count, group_size;
    float from2; // the squared distance from which on it serves
    float off;   // how far it is off the path at most
} path_rows;

INLINE path_rows path_level(__global const LightPath *const source, __global const float4 *const rows,
                            const uint level) {
    const float4 sizes = rows[source->row + 2u * level], distances = rows[source->row + 2u * level + 1u];
    const uint corner_count = as_uint(sizes.x), group_count = as_uint(sizes.y), group_size = as_uint(sizes.z);
    __global const float4 *const balls = rows + as_uint(sizes.w);
    const path_rows path = {balls,      balls + group_count, corner_count, group_count,
                            group_size, distances.x,         distances.y};
    return path;
}

// A point of a ray, with its last digits.
typedef struct {
    float3v at, rest;
} path_spot;

INLINE path_spot path_spot_at(const Ray *const ray, const floatv s) {
    const finev way = fine_multiply(to_finev(s), to_finev(ray->stretch));
    const fine3v fine = fine_fma3(ray->fine_toward, way, ray->fine_origin);
    path_spot spot;
    spot.at = from_fine3(fine);
    const fine3v value = {to_finev(spot.at.x), to_finev(spot.at.y), to_finev(spot.at.z)};
    spot.rest = from_fine3(fine_subtract3(fine, value));
    return spot;
}

// The part of a path that is nearest: a corner, or the line from it to the next one.
typedef struct {
    intv corner, is_line;
    floatv distance2;
    floatv x; // where it begins to be nearest
} path_place;

INLINE path_place select_place(const path_place a, const path_place b, const intv is_b) {
    const path_place place = {select(a.corner, b.corner, is_b), select(a.is_line, b.is_line, is_b),
                              select(a.distance2, b.distance2, is_b), select(a.x, b.x, is_b)};
    return place;
}

// Returns a spot, seen from a point.
INLINE float3v path_from(const path_spot *const spot, const float4 point, const float4 rest) {
    return add3(subtract3(spot->at, uniform3(point)), subtract3(spot->rest, uniform3(rest)));
}

// Returns a vector of each lane's corner.
INLINE float3v path_gather3(const path_rows *const path, const intv corner, const int row) {
    __global const float *const values = (__global const float *)path->corners;
    const intv first = 16 * corner + 4 * row;
    const float3v v = {gather(values, first), gather(values, first + 1), gather(values, first + 2)};
    return v;
}

INLINE fine3v path_join(const float3v value, const float3v rest) {
    const fine3v v = {join_fine(value.x, rest.x), join_fine(value.y, rest.y), join_fine(value.z, rest.z)};
    return v;
}

// A bit for every group of pieces that counts.
#define PATH_WORDS 8
typedef struct {
    uint words[PATH_WORDS];
} path_groups;

INLINE path_groups path_all_groups(const path_rows *const path) {
    path_groups groups;
    for (uint word = 0; word < PATH_WORDS; ++word) {
        const uint left = path->group_count - min(path->group_count, 32u * word);
        groups.words[word] = left < 32u ? (1u << left) - 1u : ~0u;
    }
    return groups;
}

// Goes through the groups that count.
#define FOR_EACH_GROUP(group, groups)                                                                                  \
    for (uint word = 0; word < PATH_WORDS; ++word)                                                                     \
        for (uint left = (groups)->words[word], group; left != 0; left &= left - 1u)                                   \
            if (group = 32u * word + 31u - clz(left & -left), true)
