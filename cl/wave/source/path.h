// Path, a chain of straight pieces (the host cuts curves into them): the field of its nearest point, so that joints are
// no brighter than what lies beside them. How the nearest part of it changes along a ray is in path/next.h. A curve
// is there in several levels, the first with the most pieces: rays that pass it farther away need fewer.
#pragma once
#include "../../view.h"
#include "../quadrature/quadrature.h"
#include "../quadrature/stretch.h"
#include "../tiles/clearance.h"
#include "profile.h"
#include "quadratic.h"
#include "sources.h"

// Its rows: two for every level, with its numbers of corners and groups, the corners of a group, and its first row; and
// the squared distance from which on it serves, and how far it is off. At the first row, a ball for every group of
// pieces (centre, radius); then four rows for every corner: where it is, with the length of the piece that begins there
// (0 at the last corner); what float32 leaves of that, with what light is multiplied with there; the unit direction of
// the piece; and what float32 leaves of that.
typedef struct LightPath {
    float4 emission;
    uint row; // its first
    uint level_count;
    uint padding_0, padding_1;
    Falloff falloff;
} LightPath;
CHECK_SIZE(LightPath, SIZEOF_LIGHTPATH);

#define path_is_quick 0

// These use the struct.
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

floatv path_field(const path_path *const path, const floatv s) {
    const path_spot spot = path_spot_at(path->ray, s);
    const path_groups groups = path_all_groups(&path->rows);
    const path_place nearest = path_nearest(&path->rows, &groups, &spot);
    const floatv field = field_at(&path->profile, fma(splat(4.0f), nearest.distance2, path->profile.softening2));
#ifdef SERIES
    const path_view view = path_view_of(&path->rows, path->ray, &spot, &nearest);
    return field * path_light(&view, splat(0.0f));
#else
    return field;
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
        const floatv to = select(s + next.x, end, (next.x >= beyond) | (intv)(left == 1u ? -1 : 0));
        const Quadratic distance2 = path_distance2(&path, rows, &place, &view);
        Stretch stretch = evenly_lit(s, to);
#ifdef SERIES
        stretch.light_from = path_light(&view, splat(0.0f)), stretch.light_to = path_light(&view, to - s);
#endif
        integral += integral_over(stretch, &distance2, &path.profile, quadrature);
        s = to, place = next;
        spot = path_spot_at(ray, s);
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
