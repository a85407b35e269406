// Which part of a path is nearest: at a spot of a ray, and all along it.
#pragma once
#include "rows.h"

// Looks whether a part of a group is nearer to a spot than what was found.
INLINE void path_nearer(path_place *const nearest, const path_rows *const path, const path_spot *const spot,
                        const uint group) {
    const uint first = group * path->group_size, end = min(first + path->group_size, path->corner_count);
    for (uint k = first; k < end; ++k) {
        __global const float4 *const corner = path->corners + 4u * k;
        const float3v from_corner = path_from(spot, corner[0], corner[1]);
        const float3v direction = uniform3(corner[2]);
        const floatv along = dot3(from_corner, direction);
        const float3v across = fma3(direction, -along, from_corner);
        const intv is_line = (along > 0.0f) & (along < corner[0].w);
        const floatv to_line2 = dot3(across, across), to_corner2 = dot3(from_corner, from_corner);
        const path_place place = {(intv)((int)k), is_line, select(to_corner2, to_line2, is_line), splat(0.0f)};
        *nearest = select_place(*nearest, place, place.distance2 < nearest->distance2);
    }
}

// Finds the nearest part at a spot: looks into the nearest group, then into those that are not ruled out.
INLINE path_place path_nearest(const path_rows *const path, const path_groups *const groups,
                               const path_spot *const spot) {
    path_place nearest = {(intv)(0), (intv)(0), splat(1e36f), splat(0.0f)};
    float least = 1e36f;
    uint likely = 0;
    FOR_EACH_GROUP(group, groups) {
        const float3v from_ball = subtract3(spot->at, uniform3(path->balls[group]));
        const float distance2 = first_lane(dot3(from_ball, from_ball));
        likely = distance2 < least ? group : likely;
        least = min(least, distance2);
    }
    path_nearer(&nearest, path, spot, likely);
    FOR_EACH_GROUP(group, groups) {
        const float4 ball = path->balls[group];
        const floatv to_ball = length3(subtract3(spot->at, uniform3(ball))) * 0.9999f - ball.w;
        if (group != likely && any_lane((to_ball < 0.0f) | (to_ball * to_ball < nearest.distance2)))
            path_nearer(&nearest, path, spot, group);
    }
    return nearest;
}

// Where a ray comes closest to a path.
typedef struct {
    floatv s, distance2;
} path_approach;

INLINE path_approach nearer_approach(const path_approach a, const path_approach b) {
    const intv is_b = b.distance2 < a.distance2;
    const path_approach nearer = {select(a.s, b.s, is_b), select(a.distance2, b.distance2, is_b)};
    return nearer;
}

// Returns where a ray comes closest to a point, seen from which it begins.
INLINE path_approach approach_to_point(const Ray *const ray, const float3v origin, const floatv per_length2) {
    path_approach approach;
    approach.s = clamp(-dot3(origin, ray->span) * per_length2, 0.0f, ray->end);
    const float3v closest = fma3(ray->span, approach.s, origin);
    approach.distance2 = dot3(closest, closest);
    return approach;
}

// Finds where a ray comes closest to any piece. Where it is level with the line of one, it does so at an end too.
INLINE path_approach path_closest_approach(const path_rows *const path, const Ray *const ray) {
    const floatv per_length2 = inverse(ray->length * ray->length);
    path_approach nearest = {splat(0.0f), splat(1e36f)};
    for (uint group = 0; group < path->group_count; ++group) {
        const float4 ball = path->balls[group];
        const path_approach to_center = approach_to_point(ray, subtract3(ray->origin, uniform3(ball)), per_length2);
        const floatv least = 0.4999f * twice_sqrt(max(to_center.distance2, 1e-36f)) - ball.w;
        if (!any_lane((least < 0.0f) | (least * least < nearest.distance2)))
            continue;
        const uint first = group * path->group_size, end = min(first + path->group_size, path->corner_count);
        for (uint k = first; k < end; ++k) {
            __global const float4 *const corner = path->corners + 4u * k;
            const float3v origin = subtract3(ray->origin, uniform3(corner[0]));
            nearest = nearer_approach(nearest, approach_to_point(ray, origin, per_length2));
            const float3v along = uniform3(corner[2]);
            const float3v start = cross3(origin, along), span = cross3(ray->span, along);
            path_approach to_line;
            to_line.s = clamp(-dot3(start, span) * inverse(max(dot3(span, span), 1e-30f)), 0.0f, ray->end);
            const float3v closest = fma3(span, to_line.s, start);
            to_line.distance2 = dot3(closest, closest);
            const floatv height = dot3(fma3(ray->span, to_line.s, origin), along);
            to_line.distance2 = select(splat(1e36f), to_line.distance2, (height > 0.0f) & (height < corner[0].w));
            nearest = nearer_approach(nearest, to_line);
        }
    }
    return nearest;
}
