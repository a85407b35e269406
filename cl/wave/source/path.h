// Path, a chain of straight pieces (the host cuts curves into them): the field of its nearest point, so that joints are
// no brighter than what lies beside them. How the nearest part of it changes along a ray is in path/next.h. A curve
// is there in several levels, the first with the most pieces: rays that pass it farther away need fewer.
#pragma once
#include "../../view.h"
#include "../footprint/closest.h"
#include "../quadrature/quadrature.h"
#include "../quadrature/stretch.h"
#include "../tiles/clearance.h"
#ifdef CONVOLUTION
#include "convolution.h"
#endif
#include "profile.h"
#include "quadratic.h"
#include "sources.h"

// Its rows: two for every level, with its numbers of corners and groups, the corners of a group, and its first row; and
// the squared distance from which on it serves, and how far it is off. At the first row, a ball for every group of
// pieces (centre, radius); then four rows for every corner: where it is, with the length of the piece that begins there
// (0 at the last corner of pieces that follow each other); what float32 leaves of that, with what light is multiplied
// with there; the unit direction of the piece, with how thick the core is at the corner, where that changes along it;
// and what float32 leaves of that. Where light changes along the core follow, for every corner, the core's own
// tangents: that after it, and that before it, with 0 where no piece ends, 2 where one goes on smoothly into the next,
// else 1.
typedef struct LightPath {
    float4 emission;
    uint row; // its first
    uint level_count;
    uint is_even;    // 1: light and thickness are the same all along it, and there are no tangents
    float most_bend; // by how much they may be off a straight line in the middle of a stretch, of themselves
    Falloff falloff;
} LightPath;
CHECK_SIZE(LightPath, SIZEOF_LIGHTPATH);

#define path_is_quick 0

// These use the struct.
#include "path/light.h"
#include "path/nearest.h"
#include "path/next.h"

typedef struct {
    const Ray *ray;
    __global const LightPath *source;
    __global const float4 *all_rows;
    path_rows rows; // of the first level
    Profile profile;
} path_path;

INLINE path_path path_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const LightPath *const source = &sources->path_list[index];
    const path_path path = {ray, source, sources->rows, path_level(source, sources->rows, 0u),
                            profile_of(ray, &source->falloff)};
    return path;
}

// Returns the level with the fewest pieces that serves rays as close as these.
INLINE path_rows path_level_for(const path_path *const path) {
    const uint last = path->source->level_count - 1u;
    if (last == 0u)
        return path->rows;
    const path_rows roughest = path_level(path->source, path->all_rows, last);
    const path_approach nearest = path_closest_approach(&roughest, path->ray);
    const floatv distance = 0.5f * twice_sqrt(max(nearest.distance2, 1e-36f)) - roughest.off;
    const floatv softened2 = fma(max(distance, 0.0f), max(distance, 0.0f), 0.25f * path->profile.softening2);
    uint level = last;
    path_rows rows = roughest;
    while (level > 0u && any_lane(softened2 < rows.from2))
        rows = path_level(path->source, path->all_rows, --level);
    return rows;
}

#ifdef CONVOLUTION
#define PATH_IS_CONVOLVED(path) ((path)->source->falloff.profile == 5u)

// Returns a piece whose points are added up; one that has no length adds nothing.
INLINE ConvolvedPiece path_piece(const path_path *const path, const path_rows *const rows, const uint k) {
    __global const float4 *const corner = rows->corners + 4u * k, *const next = corner + 4;
    const fine3v direction = fine3(corner[2], corner[3]);
    // What is added up is softened, and has no other floor.
    const floatv softening2 = path->profile.softening2 + path->profile.floor2;
    ConvolvedPiece piece;
    piece.to_line = distance2_to_line(path->ray, corner[0], corner[1], corner[2], corner[3], softening2);
    piece.to_first = distance2_to_point(path->ray, corner[0], corner[1], softening2);
    piece.to_last = distance2_to_point(path->ray, next[0], next[1], softening2);
    piece.over_first = height_over(path->ray, corner[0], corner[1], direction);
    piece.over_last = height_over(path->ray, next[0], next[1], direction);
    piece.over_first.at *= 2.0f, piece.over_first.slope *= 2.0f;
    piece.over_last.at *= 2.0f, piece.over_last.slope *= 2.0f;
    piece.length = 2.0f * corner[0].w;
    piece.light = 0.5f * (corner[1].w + next[1].w);
    piece.growth = (next[1].w - corner[1].w) / piece.length;
    return piece;
}

#define FOR_EACH_PIECE(k, rows)                                                                                        \
    for (uint k = 0; k + 1u < (rows)->corner_count; ++k)                                                               \
        if ((rows)->corners[4u * k].w > 0.0f)
#endif

floatv path_field(const path_path *const path, const floatv s) {
#ifdef CONVOLUTION
    if (PATH_IS_CONVOLVED(path)) {
        floatv field = splat(0.0f);
        FOR_EACH_PIECE(k, &path->rows) {
            const ConvolvedPiece piece = path_piece(path, &path->rows, k);
            field += convolved_at(&piece, s);
        }
        return field;
    }
#endif
    const path_spot spot = path_spot_at(path->ray, s);
    const path_groups groups = path_all_groups(&path->rows);
    const path_place nearest = path_nearest(&path->rows, &groups, &spot);
    const floatv bare2 = 4.0f * nearest.distance2, softened2 = bare2 + path->profile.softening2;
#ifdef SERIES
    const path_light light = path_light_at(&path->rows, path->source->is_even, &nearest, spot.at);
    return light.value * field_of_core(&path->profile, bare2, fma(light.radius, light.radius, softened2));
#else
    return field_of_core(&path->profile, bare2, softened2);
#endif
}

// Returns the squared distance to a part of the path, all along the ray.
INLINE Quadratic path_distance2(const path_path *const path, const path_rows *const rows, const path_place *const place,
                                const path_view *const view) {
    const fine3v corner = path_join(view->corner, view->corner_rest);
    const floatv softening2 = path->profile.softening2;
    Quadratic distance2 = distance2_to_points(path->ray, view->corner, corner, softening2);
    if (any_lane(place->is_line)) {
        const fine3v along = path_join(view->along, path_gather3(rows, place->corner, 3));
        const Quadratic to_line = distance2_to_lines(path->ray, view->corner, corner, view->along, along, softening2);
        distance2 = select_quadratic(distance2, to_line, place->is_line);
    }
    return distance2;
}

// Goes along the ray from one nearest part of the path to the next, each with a closed form.
PER_RAY_IF_WIDE floatv path_integral(const Ray *const ray, const Sources *const sources, const uint index,
                                     const Quadrature *const quadrature) {
    const path_path path = path_along(ray, sources, index);
    const path_rows level = path_level_for(&path), *const rows = &level;
#if defined(CONVOLUTION) && defined(EXACT)
    if (PATH_IS_CONVOLVED(&path)) {
        floatv sum = splat(0.0f);
        FOR_EACH_PIECE(k, rows) {
            const ConvolvedPiece piece = path_piece(&path, rows, k);
            sum += convolved_over(&piece, ray->end, quadrature);
        }
        return sum;
    }
#endif
    floatv s = splat(0.0f), end = ray->end;
    path_groups groups = path_all_groups(rows);
#ifdef SHAPES
    if (HAS_END(&path.profile))
        path_keep_lit(&groups, rows, ray, 0.5f * sqrt(path.profile.end2), &s, &end);
#endif
    if (!any_lane(s < end))
        return splat(0.0f);
    path_spot spot = path_spot_at(ray, s);
    const path_spot last_spot = path_spot_at(ray, end);
    path_place place = path_nearest(rows, &groups, &spot);
    const path_place last = path_nearest(rows, &groups, &last_spot);
    path_keep_near(&groups, rows, ray, &spot, &place, &last, end - s);
    floatv integral = splat(0.0f);
    for (uint left = MOST_PATH_STEPS(rows); left != 0 && any_lane(s < end); --left) {
        const floatv beyond = end - s;
        const path_view view = path_view_of(rows, ray, &spot, &place);
        const floatv most = path_far_step(&view.distance2, beyond);
        const path_place next = path_next(rows, &groups, ray, &spot, &place, &view, most);
        const floatv ahead = min(s + max(next.x, path_least_step(s)), end);
        floatv to = select(ahead, end, (next.x >= beyond) | (intv)(left == 1u ? -1 : 0));
#ifdef SERIES
        const floatv whole = to;
        if (left > 1u)
            to = path_straight_to(rows, path.source, ray, &place, s, whole);
#endif
        Quadratic distance2 = path_distance2(&path, rows, &place, &view);
        Stretch stretch = evenly_lit(s, to);
        const path_spot next_spot = path_spot_at(ray, to);
#ifdef SERIES
        const path_light from_light = path_light_at(rows, path.source->is_even, &place, spot.at);
        const path_light to_light = path_light_at(rows, path.source->is_even, &place, next_spot.at);
        stretch.light_from = from_light.value, stretch.light_to = to_light.value;
        const floatv widening = (to_light.radius - from_light.radius) * inverse(max(to - s, 1e-30f));
        if (any_lane(from_light.radius + to_light.radius > 0.0f))
            distance2 = widened(distance2, fma(widening, distance2.nearest - s, from_light.radius), widening);
#endif
        integral += integral_over(stretch, &distance2, &path.profile, quadrature);
#ifdef SERIES
        place = select_place(place, next, to >= whole);
#else
        place = next;
#endif
        s = to, spot = next_spot;
    }
    return integral;
}

// Returns the clearance of the nearest of all pieces.
Clearance path_clearance(const Ray *const ray, const Sources *const sources, const uint index, const float pixel_step) {
    const path_path path = path_along(ray, sources, index);
    const path_rows roughest = path_level(path.source, sources->rows, path.source->level_count - 1u);
    const path_approach nearest = path_closest_approach(&roughest, ray);
    const floatv distance = max(0.5f * twice_sqrt(max(nearest.distance2, 1e-36f)) - roughest.off, 0.0f);
    return clear_by(ray, pixel_step, nearest.s, fma(4.0f * distance, distance, path.profile.softening2), &path.profile);
}

#ifdef FOOTPRINT
Closest path_closest(const Ray *const ray, const Sources *const sources, const uint index) {
    const path_path path = path_along(ray, sources, index);
    const path_rows *const rows = &path.rows;
    const floatv s = path_closest_approach(rows, ray).s;
    const path_spot spot = path_spot_at(ray, s);
    const path_groups groups = path_all_groups(rows);
    const path_place place = path_nearest(rows, &groups, &spot);
    const float3v from_corner = add3(subtract3(spot.at, path_gather3(rows, place.corner, 0)),
                                     subtract3(spot.rest, path_gather3(rows, place.corner, 1)));
    const float3v direction = path_gather3(rows, place.corner, 2);
    const float3v from_core =
        fma3(direction, select(splat(0.0f), -dot3(from_corner, direction), place.is_line), from_corner);
    // At a corner the core is level with the ray; not at its ends.
    const intv last = (intv)((int)rows->corner_count - 1);
    const intv is_end = (place.corner == 0) | (place.corner == last);
    const float3v level = select3(cross3(from_core, ray->span), uniform3((float4)(0.0f)), is_end);
    Closest closest = {s, scale3(from_core, splat(-1.0f)), select3(level, direction, place.is_line), splat(0.0f),
                       splat(1.0f)};
#ifdef SERIES
    const path_light light = path_light_at(rows, path.source->is_even, &place, spot.at);
    closest.thickness2 = 0.25f * light.radius * light.radius;
    closest.light = light.value;
#endif
    return closest;
}
#endif
