// The light of a ball, or of a stretch of a streak, along rays.
//
// With x = 1 - d^2/h^2, t = sqrt x and D = 1 - x the moments of (1 - r/h)^2 about the place where a ray is closest to a
// ball are h F0, h^3 F2, h^5 F4, each a smooth function of t and a share of D ln D:
//   F0 = 2 t - (4/3) t^3 - 2 D ln(1 + t) + D ln D, F2 = ... - (1/4) D^2 ln D, F4 = ... + (1/8) D^3 ln D;
// those of (1 - r^2/h^2)^3 are (32/35) t^7, (32/315) t^9, (32/1155) t^11. A decay alpha/(s + beta)^2 far from its pole,
// W away, gives alpha L^2/W^2 (M0 + 3 M2/W^2 + 5 M4/W^4). Whatever is cut, near the pole, or no ball is summed by
// panels of Gauss and Legendre that begin where the ray is closest, in y, the root of the share of the panel.
#pragma once
#include "rays.h"

// A panel ends where the decay's argument has grown to so many times itself, or has shrunk to that part.
#define MOST_GROWTH 3.0f

// Beyond this share of the way to the decay's pole moments do not tell enough: they leave 5e-6 there.
#ifdef MOMENTS_EVERYWHERE
#define MOMENTS_END 1e9f // spoiled
#else
#define MOMENTS_END 0.2f
#endif

#define NODES 10u
__constant float NODE[NODES] = {1.702173135e-04f, 4.551973752e-03f, 2.569455622e-02f, 8.026019485e-02f,
                                1.811037227e-01f, 3.299780617e-01f, 5.136555890e-01f, 7.051041245e-01f,
                                8.696153404e-01f, 9.740767458e-01f};
__constant float WEIGHT[NODES] = {8.698434107e-04f, 1.008323095e-02f, 3.511849577e-02f, 7.628388168e-02f,
                                  1.257641256e-01f, 1.697600992e-01f, 1.929828376e-01f, 1.839678667e-01f,
                                  1.393681182e-01f, 6.580150090e-02f};

// A piece of an element along a ray: at lengths u from a place on the ray the way from the core is from + step u, and
// the radius h + slope u.
typedef struct {
    float3v from, step;
    floatv h, slope;
    floatv behind; // the place's length behind the projection plane
    bool is_smooth;
} Piece;

// How a squared distance grows from where it is least: least2 + 2 tilt u + steepness u^2.
typedef struct {
    floatv least2, tilt, steepness;
} Distances;

INLINE floatv root(const floatv x) {
    return 0.5f * x * twice_inverse_sqrt_(max(x, splat(TINY)));
}

// Sums a panel from `u` on, of this length, which may be negative.
INLINE floatv panel(const GlowView *const view, const Rays *const rays, const Piece *const piece,
                    const Distances *const distances, const floatv u, const floatv length) {
    floatv sum = splat(0.0f);
    const bool fades = view->power > 0u || view->absorbed > 0.0f;
    for (uint node = 0u; node < NODES; ++node) {
        const floatv at = fma(length, splat(NODE[node]), u);
        // All terms are positive, as the ray leaves the core both ways from where it is closest.
        const floatv r2 = fma(fma(distances->steepness, at, 2.0f * distances->tilt), at, distances->least2);
        const floatv h = fma(piece->slope, at, piece->h);
        const floatv per_h = inverse(max(h, splat(TINY)));
        floatv light;
        if (piece->is_smooth) {
            const floatv r = root(r2);
            const floatv share = max((h - r) * (h + r) * per_h * per_h, splat(0.0f));
            light = share * share * share;
        } else {
            const floatv share = max((h - root(r2)) * per_h, splat(0.0f));
            light = share * share;
        }
        if (fades)
            light *= fading(view, rays, max(piece->behind + at, 0.0f));
        sum = fma(light, splat(WEIGHT[node]), sum);
    }
    return sum * fabs(length) * (fades ? 1.0f : view->scale);
}

// Sums from `from` to `to` by as many panels as the decay asks for.
INLINE floatv panels(const GlowView *const view, const Rays *const rays, const Piece *const piece,
                     const Distances *const distances, const floatv from, const floatv to) {
    floatv sum = splat(0.0f), at = from;
    intv goes_on = to != from;
    while (any_lane(goes_on)) {
        floatv next = to;
        if (view->power > 0u) {
            const floatv argument = max(piece->behind + at + rays->beta, rays->beta);
            next = min(next, fma(argument, splat(MOST_GROWTH - 1.0f), at));
            next = select(next, max(to, fma(argument, splat(1.0f / MOST_GROWTH - 1.0f), at)), to < at);
        }
        if (view->absorbed > 0.0f) {
            const float most = 3.0f / view->absorbed;
            next = clamp(next, at - most, at + most);
        }
        const floatv part = panel(view, rays, piece, distances, at, next - at);
        sum += select(splat(0.0f), part, goes_on);
        goes_on &= (next != to) & (next != at);
        at = next;
    }
    return sum;
}

// Sums a piece over [low, high], lengths from its place.
INLINE floatv piece_light(const GlowView *const view, const Rays *const rays, Piece *const piece, floatv low,
                          floatv high) {
    // From where the ray is closest on: lengths are small there.
    const floatv steepness = dot3(piece->step, piece->step);
    const floatv closest = clamp(-dot3(piece->from, piece->step) / max(steepness, splat(TINY)), low, max(low, high));
    piece->from = fma3(piece->step, closest, piece->from);
    piece->h = fma(piece->slope, closest, piece->h);
    piece->behind += closest;
    low -= closest, high -= closest;
    const Distances distances = {dot3(piece->from, piece->from), dot3(piece->from, piece->step), steepness};
    // Where the distance is the radius: a u^2 + 2 b u + c = 0.
    const floatv a = fma(-piece->slope, piece->slope, steepness);
    const floatv b = fma(-piece->h, piece->slope, distances.tilt);
    const floatv c = fma(-piece->h, piece->h, distances.least2);
    const floatv inside = fma(b, b, -a * c);
    intv meets = (low < high) & (inside > 0.0f);
    if (!any_lane(meets))
        return splat(0.0f);
    const floatv square = sqrt(max(inside, 0.0f));
    const floatv q = -(b + copysign(square, b));
    const floatv one = q / select(a, copysign(splat(TINY), a), fabs(a) < TINY);
    const floatv other = c / select(q, copysign(splat(TINY), q), fabs(q) < TINY);
    const floatv first = min(one, other), last = max(one, other);
    // Along a cone that opens faster than the ray leaves its axis, the ray stays inside.
    const intv is_open = a < 0.0f;
    const intv opens = piece->slope > 0.0f;
    low = max(low, select(first, select(splat(-INFINITY), last, opens), is_open));
    high = min(high, select(last, select(first, splat(INFINITY), opens), is_open));
    meets &= low < high;
    if (!any_lane(meets))
        return splat(0.0f);
    low = select(splat(0.0f), low, meets), high = select(splat(0.0f), high, meets);
    const floatv from = clamp(splat(0.0f), low, high);
    return panels(view, rays, piece, &distances, from, high) + panels(view, rays, piece, &distances, from, low);
}

// Minimax polynomials in t of what is smooth of F0/t, F2/t and F4/t, the lowest power first: within 3e-8, 1e-6 and
// 5e-5.
__constant float OF_F0[8] = {-3.002489891e-06f, 1.000104485e+00f,  -1.255754341e-03f, -4.925518022e-01f,
                             2.413101417e-01f,  -1.128021289e-01f, 3.830246926e-02f,  -6.437768702e-03f};
__constant float OF_F2[6] = {-6.547561012e-05f, -2.486476567e-01f, -9.433025751e-03f,
                             4.061955820e-01f,  -5.575475766e-02f, -2.562899517e-02f};
__constant float OF_F4[5] = {2.525937431e-03f, 8.588014377e-02f, 1.993991679e-01f, -7.684398139e-01f, 4.996312911e-01f};

// Returns a polynomial of so many factors.
#define POLYNOMIAL(result, factors, count)                                                                             \
    floatv result = splat(factors[count - 1]);                                                                         \
    _Pragma("unroll") for (int power = count - 2; power >= 0; --power) result = fma(result, t, splat(factors[power]))

// The moments of a ball about the place where the ray is closest, in radii.
typedef struct {
    floatv zeroth, second, fourth;
} Moments;

// Returns them from t, and from D = d^2/h^2, 1 where the ray passes by: without a branch, so that the moments of
// several balls are under way at once.
INLINE Moments moments(const floatv t, const floatv d, const bool is_smooth, const bool fades) {
    Moments result = {splat(0.0f), splat(0.0f), splat(0.0f)};
    if (is_smooth) {
        const floatv x = t * t, t7 = x * x * x * t;
        result.zeroth = (32.0f / 35.0f) * t7;
        result.second = (32.0f / 315.0f) * t7 * x;
        result.fourth = (32.0f / 1155.0f) * t7 * x * x;
        return result;
    }
    const floatv d_logarithm = d * (LN_2 * binary_logarithm(max(d, splat(TINY))));
    POLYNOMIAL(zeroth, OF_F0, 8);
    result.zeroth = max(fma(zeroth, t, d_logarithm), splat(0.0f));
    if (fades) {
        const floatv more = d * d_logarithm;
        POLYNOMIAL(second, OF_F2, 6);
        POLYNOMIAL(fourth, OF_F4, 5);
        result.second = fma(second, t, -0.25f * more);
        result.fourth = fma(fourth, t, 0.125f * d * more);
    }
    return result;
}

// Returns the integral over a whole chord: the moments' sum, with the decay if there is one, `to_pole` from its pole.
INLINE floatv chord_light(const GlowView *const view, const Rays *const rays, __global const Element *const element,
                          const floatv d2, const floatv to_pole, const bool has_decay) {
    const float radius = element->radius, inverse_radius = element->inverse_radius;
    const bool is_smooth = (element->form & IS_SMOOTH) != 0u;
    const floatv chord2 = max(radius * radius - d2, splat(0.0f));
    const floatv t = min(root(chord2) * inverse_radius, splat(1.0f));
    const floatv d = min(d2 * (inverse_radius * inverse_radius), splat(1.0f));
    const Moments sum = moments(t, d, is_smooth, has_decay);
    const float measure = radius * view->scale;
    if (!has_decay)
        return sum.zeroth * measure;
    const floatv share = inverse(to_pole), step = radius * share, step2 = step * step;
    const floatv more = fma(step2, 5.0f * sum.fourth, 3.0f * sum.second);
    const floatv w = rays->length * share;
    return fma(step2, more, sum.zeroth) * measure * w * w;
}

// Returns the light of a ball of emission 1 whose chords all lie on the rays, far from the decay's pole.
INLINE floatv clear_ball_light(const GlowView *const view, const Rays *const rays, const Passing *const it,
                               __global const Element *const element) {
    return chord_light(view, rays, element, it->d2, rays->beta - it->low, view->power == 2u);
}

// Returns the light of a ball of emission 1.
INLINE floatv ball_light(const GlowView *const view, const Rays *const rays, const Passing *const it,
                         __global const Element *const element) {
    const float h = element->radius;
    const floatv chord2 = fma(splat(h), splat(h), -it->d2);
    const floatv half_chord = root(max(chord2, splat(0.0f)));
    const floatv low = it->low, high = it->high;
    const intv meets = (chord2 > 0.0f) & (half_chord > low) & (-half_chord < high) & (low < high);
    if (!any_lane(meets))
        return splat(0.0f);
    const bool is_smooth = (element->form & IS_SMOOTH) != 0u;
    const bool has_decay = view->power == 2u && !(view->absorbed > 0.0f);
    const bool is_plain = has_decay || (view->power == 0u && !(view->absorbed > 0.0f));
#ifdef NEVER_CUT
    const intv is_cut = (intv)(0); // spoiled
#else
    const intv is_cut = (-half_chord < low) | (half_chord > high);
#endif
    const floatv to_pole = rays->beta - low;
    const intv is_near = has_decay ? h > MOMENTS_END * to_pole : (intv)(0);
    const intv by_panels = meets & (is_plain ? is_cut | is_near : (intv)(-1));
    floatv light = splat(0.0f);
    if (any_lane(meets & ~by_panels)) {
        light = chord_light(view, rays, element, it->d2, to_pole, has_decay);
        light = select(splat(0.0f), light, meets & ~by_panels);
    }
    if (any_lane(by_panels)) {
        Piece piece = {it->way, rays->toward, splat(h), splat(0.0f), -low, is_smooth};
        const floatv part = piece_light(view, rays, &piece, low, select(low, high, by_panels));
        light += select(splat(0.0f), part, by_panels);
    }
    return light;
}

// Returns the light of a stretch of a streak of emission 1: of its sides, and of the caps that it has.
INLINE floatv stretch_light(const GlowView *const view, const Rays *const rays, const Passing *const it,
                            __global const Element *const element) {
    const float4 half_axis = (float4)(element->axis_x, element->axis_y, element->axis_z, 0.0f);
    const float half_length = length(half_axis);
    const float4 axis = half_axis / half_length;
    const float3v toward = rays->toward;
    const bool is_smooth = (element->form & IS_SMOOTH) != 0u;
    const float3v axes = uniform3(axis);
    const floatv along = dot3(it->way, axes), cosine = dot3(toward, axes);
    const floatv slant = select(cosine, copysign(splat(1e-12f), cosine), fabs(cosine) < 1e-12f);
    const floatv low = it->low, high = it->high, behind = -low;
    // Where the ray passes the planes of the ends.
    const floatv at_begin = (-half_length - along) / slant, at_end = (half_length - along) / slant;
    const float slope = element->growth / half_length;
    Piece sides = {fma3(axes, -along, it->way),
                   fma3(axes, -cosine, toward),
                   fma(along, splat(slope), splat(element->radius)),
                   cosine * slope,
                   behind,
                   is_smooth};
    floatv light = piece_light(view, rays, &sides, max(low, min(at_begin, at_end)), min(high, max(at_begin, at_end)));
    const intv is_forward = slant > 0.0f;
    if (element->form & HAS_FIRST_CAP) {
        Piece cap = {fma3(axes, splat(half_length), it->way),
                     toward,
                     splat(element->radius - element->growth),
                     splat(0.0f),
                     behind,
                     is_smooth};
        light += piece_light(view, rays, &cap, select(max(low, at_begin), low, is_forward),
                             select(high, min(high, at_begin), is_forward));
    }
    if (element->form & HAS_LAST_CAP) {
        Piece cap = {fma3(axes, splat(-half_length), it->way),
                     toward,
                     splat(element->radius + element->growth),
                     splat(0.0f),
                     behind,
                     is_smooth};
        light += piece_light(view, rays, &cap, select(low, max(low, at_end), is_forward),
                             select(min(high, at_end), high, is_forward));
    }
    return light;
}
