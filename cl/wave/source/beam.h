// Beam, a half-line from a tip M (Abe, Watanabe 2010, eq. 6, 11, 12): ahead of the plane through M, perpendicular to
// the beam, the field of its line; behind it that of the point M, or the line's own, fading (Sakai 2006, fig. 4.3); and
// a further sphere around M. Along a ray the height over the plane is linear.
//
// The planes through its tip and through the end of its taper cut the ray into stretches, each with a closed form (Abe,
// Watanabe 2010, eq. 10-12).
#pragma once
#include "../../view.h"
#include "../quadrature/quadrature.h"
#include "../quadrature/stretch.h"
#include "../tiles/clearance.h"
#include "profile.h"
#include "quadratic.h"
#include "sources.h"

typedef struct Beam {
    float4 tip, tip_rest;
    float4 point, point_rest;         // the point of the line nearest to the eye
    float4 direction, direction_rest; // unit
    float4 emission;                  // colour alone, times |E - S| where light is measured by length
    float line, cap, sphere;         // coefficients: of the line ahead of the tip, of the point behind it, of the point
                                     // everywhere
    float per_taper, per_taper_rest; // 1 over the length of the taper behind the tip; 0 without
    uint is_square;
    uint padding_0, padding_1;
} Beam;
CHECK_SIZE(Beam, SIZEOF_BEAM);

#define beam_has_parts 1 // ahead of its tip, and behind

// Lengths are doubled, but for heights.
typedef struct {
    Quadratic to_line, to_tip; // squared distances
    Height height;             // over the plane
    floatv taper, taper_slope; // the same over the end of the taper, of its length
    float line, cap, sphere;   // coefficients
    bool has_taper;
    floatv floor2;
    uint is_square;
} beam_path;

PER_RAY_IF_WIDE beam_path beam_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Beam *const beam = &sources->beam_list[index];
    const fine3v direction = fine3(beam->direction, beam->direction_rest);
    beam_path path;
    path.to_line = distance2_to_line(ray, beam->point, beam->point_rest, beam->direction, beam->direction_rest);
    path.to_tip = distance2_to_point(ray, beam->tip, beam->tip_rest);
    path.height = height_over(ray, beam->tip, beam->tip_rest, direction);
    path.line = beam->line, path.cap = beam->cap, path.sphere = beam->sphere;
    const finev per_taper = uniform_fine(beam->per_taper, beam->per_taper_rest);
    const fine3v from_tip = fine_between(ray, splat(0.0f), beam->tip, beam->tip_rest);
    path.taper = from_finev(fine_fma(fine_dot3(from_tip, direction), per_taper, uniform_fine(1.0f, 0.0f)));
    path.taper_slope = path.height.slope * beam->per_taper;
    path.has_taper = beam->per_taper > 0.0f;
    path.floor2 = 4.0f * ray->floor2;
    path.is_square = IS_SQUARE(beam);
    return path;
}

floatv beam_field(const beam_path *const path, const floatv s) {
    const floatv height = height_at(&path->height, s);
    const floatv per_line = twice_inverse_sqrt(max(quadratic_at(&path->to_line, s), path->floor2));
    const floatv per_tip = twice_inverse_sqrt(max(quadratic_at(&path->to_tip, s), path->floor2));
    const floatv of_line = profiled(per_line, IS_SQUARE(path)), of_tip = profiled(per_tip, IS_SQUARE(path));
    const floatv taper = max(fma(path->taper_slope, s, path->taper), 0.0f);
    const floatv behind = path->has_taper ? path->line * taper * of_line : path->cap * of_tip;
    return fma(splat(path->sphere), of_tip, select(path->line * of_line, behind, height < 0.0f));
}

// Returns the integral, with the coefficients in it.
PER_RAY_IF_WIDE floatv beam_integral(const Ray *const ray, const Sources *const sources, const uint index,
                                     const Quadrature *const quadrature) {
    const beam_path path = beam_along(ray, sources, index);
    const Decay decay = quadrature->decay;
    const Cut begin = cut_at(splat(0.0f)), end = cut_at(ray->end);
    const intv is_rising = path.height.slope > -1e-30f;
    Cut tip = climbs_through(&path.height, ray->end);
    __global const Beam *const beam = &sources->beam_list[index];
    const intv is_close = path.to_tip.least < FLOORS_OFF * FLOORS_OFF * path.floor2;
    refine_cut(&tip, ray, &path.height, beam->tip, beam->tip_rest, fine3(beam->direction, beam->direction_rest),
               is_close);
    const Stretch ahead = between(select_cut(begin, tip, is_rising), select_cut(tip, end, is_rising));
    const Stretch behind = between(select_cut(tip, begin, is_rising), select_cut(end, tip, is_rising));

    floatv light = path.line * integral_over(ahead, &path.to_line, path.floor2, decay, IS_SQUARE(&path));
    if (path.has_taper) {
        const Cut taper = cut_at(zero_along(path.taper, path.taper_slope, ray->end));
        const intv is_later = taper.s > tip.s;
        Stretch fading = between(select_cut(taper, tip, is_later), select_cut(tip, taper, is_later));
        fading.light_from = clamp(fma(path.taper_slope, fading.from, path.taper), 0.0f, 1.0f);
        fading.light_to = clamp(fma(path.taper_slope, fading.to, path.taper), 0.0f, 1.0f);
        light += path.line * integral_over(fading, &path.to_line, path.floor2, decay, IS_SQUARE(&path));
    } else {
        light += path.cap * integral_over(behind, &path.to_tip, path.floor2, decay, IS_SQUARE(&path));
    }
    if (path.sphere != 0.0f) {
        const Stretch all = between(begin, end);
        light += path.sphere * integral_over(all, &path.to_tip, path.floor2, decay, IS_SQUARE(&path));
    }
    return light;
}

// Returns the clearance of the line ahead of the tip, or of the tip. Lengths are doubled.
Clearance beam_clearance(const Ray *const ray, const Sources *const sources, const uint index, const float pixel_step) {
    const beam_path path = beam_along(ray, sources, index);
    const floatv s = clamp(path.to_line.nearest, 0.0f, ray->end);
    const floatv ahead = path.has_taper ? fma(path.taper_slope, s, path.taper) : height_at(&path.height, s);
    const Clearance of_line = quadratic_clearance(ray, &path.to_line, pixel_step);
    const Clearance of_tip = quadratic_clearance(ray, &path.to_tip, pixel_step);
    Clearance clearance = clear_by(select(of_tip.distance2, min(of_line.distance2, of_tip.distance2), ahead >= 0.0f));
    // Where line and cap differ, light has a kink where the plane through the tip passes the beginning or the end of
    // rays.
    const floatv jump = splat(!path.has_taper && path.line != path.cap ? 1.0f : 0.0f);
    clearance.seen[1] = select(splat(0.0f), jump, path.height.at < 0.0f);
    clearance.seen[2] = select(splat(0.0f), jump, height_at(&path.height, ray->end) < 0.0f);
    return clearance;
}
