// Beam, a half-line from a tip M (Abe, Watanabe 2010, eq. 6, 11, 12): ahead of the plane through M, perpendicular to
// the beam, the field of its line; behind it that of the point M, or the line's own, fading (Sakai 2006, fig. 4.3); and
// a further sphere around M. Along a ray the height over the plane is linear.
//
// The planes through its tip and through the end of its taper cut the ray into stretches, each with a closed form (Abe,
// Watanabe 2010, eq. 10-12).
#pragma once
#include "../../view.h"
#include "../footprint/closest.h"
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
    uint padding_0, padding_1, padding_2;
    Falloff falloff;
} Beam;
CHECK_SIZE(Beam, SIZEOF_BEAM);

#define beam_is_quick 1

#define beam_has_parts 1 // ahead of its tip, and behind

// Lengths are doubled, but for heights.
typedef struct {
    Quadratic to_line, to_tip; // squared distances
    Height height;             // over the plane
    floatv taper, taper_slope; // the same over the end of the taper, of its length
    float line, cap, sphere;   // coefficients
    bool has_taper;
    Profile profile;
} beam_path;

PER_RAY_IF_WIDE beam_path beam_along(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Beam *const beam = &sources->beam_list[index];
    const fine3v direction = fine3(beam->direction, beam->direction_rest);
    beam_path path;
    path.profile = profile_of(ray, &beam->falloff);
    const floatv softening2 = path.profile.softening2;
    path.to_line =
        distance2_to_line(ray, beam->point, beam->point_rest, beam->direction, beam->direction_rest, softening2);
    path.to_tip = distance2_to_point(ray, beam->tip, beam->tip_rest, softening2);
    path.height = height_over(ray, beam->tip, beam->tip_rest, direction);
    path.line = beam->line, path.cap = beam->cap, path.sphere = beam->sphere;
    const finev per_taper = uniform_fine(beam->per_taper, beam->per_taper_rest);
    const fine3v from_tip = fine_between(ray, splat(0.0f), beam->tip, beam->tip_rest);
    path.taper = from_finev(fine_fma(fine_dot3(from_tip, direction), per_taper, uniform_fine(1.0f, 0.0f)));
    path.taper_slope = path.height.slope * beam->per_taper;
    path.has_taper = beam->per_taper > 0.0f;
    return path;
}

floatv beam_field(const beam_path *const path, const floatv s) {
    const floatv height = height_at(&path->height, s);
    const floatv of_line = field_at(&path->profile, quadratic_at(&path->to_line, s));
    const floatv of_tip = field_at(&path->profile, quadratic_at(&path->to_tip, s));
    const floatv taper = max(fma(path->taper_slope, s, path->taper), 0.0f);
    const floatv behind = path->has_taper ? path->line * taper * of_line : path->cap * of_tip;
    return fma(splat(path->sphere), of_tip, select(path->line * of_line, behind, height < 0.0f));
}

// Returns the integral, with the coefficients in it.
PER_RAY_IF_WIDE floatv beam_integral(const Ray *const ray, const Sources *const sources, const uint index,
                                     const Quadrature *const quadrature) {
    const beam_path path = beam_along(ray, sources, index);
    const Cut begin = cut_at(splat(0.0f)), end = cut_at(ray->end);
    const intv is_rising = path.height.slope > -1e-30f;
    Cut tip = climbs_through(&path.height, ray->end);
    __global const Beam *const beam = &sources->beam_list[index];
    const intv is_close = path.to_tip.least < FLOORS_OFF * FLOORS_OFF * path.profile.floor2;
    refine_cut(&tip, ray, &path.height, beam->tip, beam->tip_rest, fine3(beam->direction, beam->direction_rest),
               is_close);
    const Stretch ahead = between(select_cut(begin, tip, is_rising), select_cut(tip, end, is_rising));
    const Stretch behind = between(select_cut(tip, begin, is_rising), select_cut(end, tip, is_rising));

    floatv light = path.line * integral_over(ahead, &path.to_line, &path.profile, quadrature);
    if (path.has_taper) {
        const Cut taper = cut_at(zero_along(path.taper, path.taper_slope, ray->end));
        const intv is_later = taper.s > tip.s;
        Stretch fading = between(select_cut(taper, tip, is_later), select_cut(tip, taper, is_later));
        fading.light_from = clamp(fma(path.taper_slope, fading.from, path.taper), 0.0f, 1.0f);
        fading.light_to = clamp(fma(path.taper_slope, fading.to, path.taper), 0.0f, 1.0f);
        light += path.line * integral_over(fading, &path.to_line, &path.profile, quadrature);
    } else {
        light += path.cap * integral_over(behind, &path.to_tip, &path.profile, quadrature);
    }
    if (path.sphere != 0.0f) {
        const Stretch all = between(begin, end);
        light += path.sphere * integral_over(all, &path.to_tip, &path.profile, quadrature);
    }
    return light;
}

// Returns the clearance of the line ahead of the tip, or of the tip. Lengths are doubled.
Clearance beam_clearance(const Ray *const ray, const Sources *const sources, const uint index, const float pixel_step) {
    const beam_path path = beam_along(ray, sources, index);
    const floatv s = clamp(path.to_line.nearest, 0.0f, ray->end);
    const floatv ahead = path.has_taper ? fma(path.taper_slope, s, path.taper) : height_at(&path.height, s);
    const Clearance of_line = quadratic_clearance(ray, &path.to_line, &path.profile, pixel_step);
    const Clearance of_tip = quadratic_clearance(ray, &path.to_tip, &path.profile, pixel_step);
    Clearance clearance = select_clearance(of_tip, nearer_of(of_line, of_tip), ahead >= 0.0f);
    // What fades goes on behind the tip.
    clearance.to_light = path.has_taper ? min(of_line.to_light, of_tip.to_light) : clearance.to_light;
    // Where line and cap differ, light has a kink where the plane through the tip passes the beginning or the end of
    // rays.
    const floatv jump = splat(!path.has_taper && path.line != path.cap ? 1.0f : 0.0f);
    clearance.seen[1] = select(splat(0.0f), jump, path.height.at < 0.0f);
    clearance.seen[2] = select(splat(0.0f), jump, height_at(&path.height, ray->end) < 0.0f);
    return clearance;
}

#ifdef FOOTPRINT
Closest beam_closest(const Ray *const ray, const Sources *const sources, const uint index) {
    __global const Beam *const beam = &sources->beam_list[index];
    const beam_path path = beam_along(ray, sources, index);
    const floatv s = path.to_line.nearest;
    const floatv ahead = path.has_taper ? fma(path.taper_slope, s, path.taper) : height_at(&path.height, s);
    const Closest to_line = closest_to_line(ray, fine3(beam->point, beam->point_rest), uniform3(beam->direction), s);
    const Closest to_tip = closest_to_point(ray, fine3(beam->tip, beam->tip_rest), path.to_tip.nearest);
    Closest closest = select_closest(to_tip, to_line, ahead >= 0.0f);
    closest.along = to_line.along;
    closest.is_end = ahead < 0.0f;
    closest.light = splat(path.has_taper || path.sphere != 0.0f ? 0.0f : path.line);
    return closest;
}
#endif
