// The light of a point along rays in closed form: the integral of zeta / d or zeta / d^2 (Abe, Watanabe 2010, eq. 8;
// Sakai 2006; with decay after the change of variable of cl/wave/quadrature/decay.h, whose closed forms these are for
// a whole ray). x is the way from the foot of the perpendicular, from the beginning of a ray to its end; `least` the
// squared distance of its line.
#pragma once
#include "../elementary.h"
#include "../roots.h"
#include "types.h"

#define SMALL 1e-30f

// Rays from the eye, in lanes: slopes, and what follows from them.
typedef struct {
    floatv u, v;
    floatv stretch, per_stretch; // the length of (u, v, 1), and its inverse
    floatv begin;                // from the eye to where a ray begins
} Rays;

INLINE Rays rays_through(const CrowdView *const view, const floatv u, const floatv v) {
    Rays rays;
    rays.u = u, rays.v = v;
    const floatv length2 = fma(u, u, fma(v, v, splat(1.0f)));
    rays.per_stretch = 0.5f * twice_inverse_sqrt_(length2);
    rays.stretch = length2 * rays.per_stretch;
    rays.begin = view->near_plane * rays.stretch;
    return rays;
}

// Where rays end: what decay leaves of the light there, how far v goes to there, and the length of the way.
typedef struct {
    floatv nearness, advance, per_advance, length;
} End;

// Returns the end of whole rays.
INLINE End whole_ray(const CrowdView *const view) {
    End end;
    end.nearness = splat(view->nearness), end.advance = splat(view->advance);
    end.per_advance = splat(1.0f / view->advance), end.length = splat(view->ray_length);
    return end;
}

#ifdef WITH_ENDS
// Returns the end at a share of rays.
INLINE End end_at(const CrowdView *const view, const floatv share) {
    End end;
    const floatv least = max(share, 1e-6f);
    end.length = view->ray_length * least;
    end.nearness = splat(1.0f), end.advance = least;
    if (view->pole > 0.0f) {
        const floatv per_way = inverse(end.length + view->pole);
        end.nearness = view->pole * per_way, end.advance = end.length * per_way;
    }
    end.per_advance = inverse(end.advance);
    return end;
}
#endif

INLINE floatv root(const floatv x) {
    return 0.5f * twice_sqrt(max(x, SMALL));
}

// Returns (artanh(m) / m - 1) / m^2 for m^2 up to 0.2.
INLINE floatv near_artanh(const floatv m2) {
    floatv series = splat(1.0f / 13.0f);
    series = fma(series, m2, splat(1.0f / 11.0f));
    series = fma(series, m2, splat(1.0f / 9.0f));
    series = fma(series, m2, splat(1.0f / 7.0f));
    series = fma(series, m2, splat(1.0f / 5.0f));
    return fma(series, m2, splat(1.0f / 3.0f));
}

// How a ray comes to a point: the way from the foot of the perpendicular to where it begins, the squared distance of
// its line, the distance where it begins; after the change of variable, the factor of the square, and how far the point
// is beside the line. All ends of a ray share it.
typedef struct {
    floatv begin, least, f0, per_f0;
    floatv a, per_root_a;
    floatv beside, per_beside;
} Approach;

INLINE Approach approach_of(const CrowdView *const view, const floatv begin, const floatv beside2) {
    Approach it;
    it.begin = begin, it.least = max(beside2, view->floor2);
    it.f0 = root(fma(begin, begin, it.least));
    it.per_f0 = inverse(max(it.f0, 1e-18f));
    const floatv from_pole = begin - view->pole;
    it.a = view->pole > 0.0f ? fma(from_pole, from_pole, it.least) : splat(view->ray_length * view->ray_length);
    it.per_root_a = 0.5f * twice_inverse_sqrt_(max(it.a, SMALL));
    it.beside = root(it.least) * (view->pole > 0.0f ? view->pole : view->ray_length);
    it.per_beside = inverse(max(it.beside, SMALL));
    return it;
}

INLINE floatv inverse_light(const Approach *const it, const End *const at) {
    const floatv n1 = at->nearness, turn = n1 * at->length, end = it->begin + at->length;
    const floatv f1 = n1 * root(fma(end, end, it->least)), f0f1 = it->f0 * f1;
    const floatv g = n1 * fma(it->begin, end, it->least);
    const floatv sum = it->f0 + f1, per_sum = inverse(max(sum, SMALL));
    const floatv ratio = at->advance * per_sum;
    const floatv m2 = it->a * ratio * ratio;
    const intv is_between = g < 0.0f;
    const floatv whole = fma(it->a * it->per_root_a, at->advance, sum);
    const floatv above = whole * whole * select(splat(1.0f), f0f1 - g, is_between);
    const floatv below = 2.0f * select(f0f1 + g, it->least * (turn * turn), is_between);
    const floatv artanh = 0.5f * LN_2 * binary_logarithm(above * inverse(max(below, 1e-36f)));
    const floatv per_m = it->per_root_a * inverse(max(ratio, SMALL));
    floatv excess = fma(artanh, per_m, splat(-1.0f)) * per_m * per_m;
    const intv is_small = m2 < 0.1f;
    if (any_lane(is_small))
        excess = select(excess, near_artanh(m2), is_small);
    const floatv mean = 0.5f * (1.0f + n1);
    const floatv bent = fma(m2, mean, -0.5f * (n1 - 1.0f) * (f1 - it->f0) * per_sum);
    return 2.0f * ratio * fma(bent, excess, mean);
}

INLINE floatv square_light(const CrowdView *const view, const Approach *const it, const End *const at) {
    const floatv n1 = at->nearness, d = at->advance, end = it->begin + at->length;
    const floatv f1 = n1 * root(fma(end, end, it->least)), f0f1 = it->f0 * f1;
    const floatv g = n1 * fma(it->begin, end, it->least);
    const floatv rise = (f1 - it->f0) * (f1 + it->f0);
    const floatv bulge = 0.25f * d * d * it->a;
    const floatv middle2 = fma(splat(0.5f), fma(it->f0, it->f0, f1 * f1), -bulge);
    const floatv mean_n = 0.5f * (1.0f + n1);
    const intv is_short = bulge <= 0.1f * middle2;
    floatv light = splat(0.0f);
    if (any_lane(is_short)) {
        const float node[2] = {0.861136312f, 0.339981044f}, weight[2] = {0.347854845f, 0.652145155f};
        for (int k = 0; k < 4; ++k) {
            const float x = k < 2 ? node[k & 1] : -node[k & 1];
            const floatv f2 = fma(fma(bulge, splat(x), 0.5f * rise), splat(x), middle2);
            const floatv n = fma(0.5f * (n1 - 1.0f), splat(x), mean_n);
            light = fma(inverse(f2), 0.5f * weight[k & 1] * d * n * n, light);
        }
    }
    if (!any_lane(!is_short))
        return light;
    const floatv per_sum = inverse(max(f0f1 + fabs(g), 1e-36f));
    const floatv t = min(it->beside * d * per_sum, 1.0f);
    const floatv beyond = 2.0f * d * per_sum * arctangent_ratio(t * t);
    const floatv angle = select(beyond, fma(splat(M_PI_F), it->per_beside, -beyond), g < 0.0f);
    floatv whole = angle;
    if (view->pole > 0.0f) { // nearness falls by as much as v grows
        const floatv per_a = it->per_root_a * it->per_root_a, bend = per_a * it->beside;
        const floatv growth = LN_2 * binary_logarithm(f1 * it->per_f0);
        const floatv peak_n = fma(0.5f * rise, per_a * at->per_advance, mean_n);
        const floatv at_peak = fma(-bend, bend, peak_n * peak_n);
        whole = fma(at_peak, angle, per_a * fma(-2.0f * peak_n, growth, d));
    }
    return select(whole, light, is_short);
}

// Returns the light along rays that come to a point so, up to an end.
INLINE floatv light_to(const CrowdView *const view, const Approach *const approach, const End *const end) {
    return view->scale * (view->is_square ? square_light(view, approach, end) : inverse_light(approach, end));
}

// Returns the square of (u, v, 1) x (u', v', 1), of which a and b are u - u' and v - v'.
INLINE floatv cross2(const floatv a, const floatv b, const float u, const float v) {
    const floatv c = fma(a, splat(v), -b * u);
    return fma(a, a, fma(b, b, c * c));
}

// How rays pass a point: the squared distance of their lines, and the way to the foot of the perpendicular.
typedef struct {
    floatv least, along;
} Passing;

// Returns that of a point at the slopes u, v and z along the axis of view; `soft4`: the fourth power of an angle by
// which the angle between ray and point is softened, times the fourth power of the distance.
INLINE Passing passing(const Rays *const rays, const float u, const float v, const float z, const floatv beside2,
                       const float soft4) {
    Passing it;
    it.least = z * z * beside2 * rays->per_stretch * rays->per_stretch;
    if (soft4 > 0.0f)
        it.least = root(fma(it.least, it.least, splat(soft4)));
    it.along = z * fma(rays->u, splat(u), fma(rays->v, splat(v), splat(1.0f))) * rays->per_stretch;
    return it;
}

// Returns what a peak is multiplied with at an angle, from the square of its sine: -ln of that, or 1 over the sine.
INLINE floatv core_of(const CrowdView *const view, const floatv sine2) {
    const floatv least = max(sine2, 1e-24f);
    return view->is_square ? 0.5f * twice_inverse_sqrt_(least) : -LN_2 * binary_logarithm(least);
}
