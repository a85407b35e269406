// Beam, a half-line from a tip M (Abe, Watanabe 2010, eq. 6, 11, 12): ahead of the plane through M, perpendicular to
// the beam, the field of its line; behind it that of the point M, or the line's own, fading (Sakai 2006, fig. 4.3); and
// a further sphere around M. Along a ray the height over the plane is linear.
#pragma once
#include "cylinder.h"
#include "sphere.h"

// Lengths are doubled, but for heights.
typedef struct {
    Quadratic to_line, to_tip;   // squared distances
    floatv height, height_slope; // over the plane
    floatv taper, taper_slope;   // the same over the end of the taper, of its length
    float line, cap, sphere;     // coefficients
    bool has_taper;
    floatv floor2;
    uint is_square;
} beam_path;

INLINE beam_path beam_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Beam *const beam = &sources->beams[index];
    const fine3v direction = fine3(beam->direction, beam->direction_rest);
    const fine3v from_tip = fine_between(ray, splat(0.0f), beam->tip, beam->tip_rest);
    beam_path path;
    path.to_line = distance2_to_line(ray, beam->point, beam->point_rest, beam->direction, beam->direction_rest);
    path.to_tip = distance2_to_point(ray, beam->tip, beam->tip_rest);
    path.height = from_finev(fine_dot3(from_tip, direction));
    path.height_slope = ray->stretch * from_finev(fine_dot3(ray->fine_toward, direction));
    path.line = beam->line, path.cap = beam->cap, path.sphere = beam->sphere;
    const fine per_taper = (fine)beam->per_taper + (fine)beam->per_taper_rest;
    path.taper = from_finev(fma(fine_dot3(from_tip, direction), (finev)(per_taper), (finev)(1.0f)));
    path.taper_slope = path.height_slope * beam->per_taper;
    path.has_taper = beam->per_taper > 0.0f;
    path.floor2 = 4.0f * ray->floor2;
    path.is_square = IS_SQUARE(beam);
    return path;
}

floatv beam_field(const beam_path *const path, const floatv s) {
    const floatv height = fma(path->height_slope, s, path->height);
    const floatv per_line = twice_inverse_sqrt(max(quadratic_at(&path->to_line, s), path->floor2));
    const floatv per_tip = twice_inverse_sqrt(max(quadratic_at(&path->to_tip, s), path->floor2));
    const floatv of_line = profiled(per_line, path->is_square), of_tip = profiled(per_tip, path->is_square);
    const floatv taper = max(fma(path->taper_slope, s, path->taper), 0.0f);
    const floatv behind = path->has_taper ? path->line * taper * of_line : path->cap * of_tip;
    return fma(splat(path->sphere), of_tip, select(path->line * of_line, behind, height < 0.0f));
}
