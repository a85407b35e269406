// The integral of zeta(s) / sqrt((slope s + offset)^2 + least) over a stretch of a ray, in closed form: a point or a
// straight line of light (Abe, Watanabe 2010, eq. 8; with decay the same after the change of variable in decay.h). The
// light may grow or fall linearly over the stretch.
//
// With n = beta / (s + beta), or 1, and f = n times the distance, f^2 is a quadratic a v^2 + .. in v, and n times the
// light is linear in v. Let D be the advance of v and F the sum of f at both ends. Then sqrt(a) / 2 times the integral
// of dv / f is artanh(m), m = sqrt(a) D / F, the potential of a line seen from a point, and with a linear factor what
// follows from it with 1/a taken out by hand: no difference of large terms is left, neither for far nor for near ends,
// nor where a is 0.
#pragma once
#include "../../elementary.h"
#include "../source/profile.h"
#include "../source/quadratic.h"
#include "decay.h"

// A part of a ray, and the light at its ends; linear in s between.
typedef struct {
    floatv from, to;
    floatv light_from, light_to;
    floatv from_rest, to_rest; // what float32 leaves of the ends
} Stretch;

// A parameter s with more digits than float32 has.
typedef struct {
    floatv s, rest;
} Cut;

Cut cut_at(const floatv s) {
    const Cut cut = {s, splat(0.0f)};
    return cut;
}

Cut select_cut(const Cut a, const Cut b, const intv is_b) {
    const Cut cut = {select(a.s, b.s, is_b), select(a.rest, b.rest, is_b)};
    return cut;
}

Stretch between(const Cut from, const Cut to) {
    const Stretch stretch = {from.s, to.s, splat(1.0f), splat(1.0f), from.rest, to.rest};
    return stretch;
}

Stretch evenly_lit(const floatv from, const floatv to) {
    return between(cut_at(from), cut_at(to));
}

// What a stretch comes to in v: index 0 its beginning, 1 its end.
typedef struct {
    floatv advance; // of v
    floatv n0, n1;
    floatv l0, l1;  // n times the light
    floatv f0, f1;  // n times the distance
    floatv f0f1, g; // and what has (f0 f1)^2 - g^2 = least (rate advance)^2
    floatv rate;
    floatv a; // of f^2 = a v^2 + ..
} Ends;

// Returns a stretch's ends in v; x0 and x1 are slope s + offset there.
INLINE Ends ends_of(const Quadratic *const distance2, const Decay decay, const Stretch stretch, const floatv x0,
                    const floatv x1) {
    const floatv least = distance2->least;
    Ends ends;
    ends.n0 = nearness(decay, stretch.from), ends.n1 = nearness(decay, stretch.to);
    ends.l0 = ends.n0 * stretch.light_from, ends.l1 = ends.n1 * stretch.light_to;
    ends.advance = advance(decay, stretch.from, ends.n0, stretch.to, ends.n1);
    ends.f0 = 0.5f * ends.n0 * twice_sqrt(fma(x0, x0, least));
    ends.f1 = 0.5f * ends.n1 * twice_sqrt(fma(x1, x1, least));
    ends.f0f1 = ends.f0 * ends.f1;
    ends.g = ends.n0 * ends.n1 * fma(x0, x1, least);
    const floatv x_pole = along_at(distance2, splat(-decay.beta), splat(0.0f));
    ends.rate = decay.beta > 0.0f ? decay.beta * distance2->slope : distance2->slope;
    ends.a = decay.beta > 0.0f ? fma(x_pole, x_pole, least) : ends.rate * ends.rate;
    return ends;
}

// Returns (artanh(m) / m - 1) / m^2 for m^2 up to 0.2.
floatv artanh_series(const floatv m2) {
    floatv series = splat(1.0f / 21.0f);
    for (int odd = 19; odd > 1; odd -= 2)
        series = fma(series, m2, splat(1.0f / odd));
    return series;
}

#ifndef HALF_LN_2 // a test spoils it
#define HALF_LN_2 0.346573590f
#endif

// Returns the integral of the light times n / f over v.
INLINE floatv inverse_over(const Ends *const ends, const floatv least) {
    const floatv sum = ends->f0 + ends->f1;
    const floatv per_sum = inverse(max(sum, 1e-30f));
    const floatv ratio = ends->advance * per_sum;
    const floatv m2 = ends->a * ratio * ratio;

    // artanh(m) is half the logarithm of (F + sqrt(a) D)^2 / (F^2 - a D^2), where F^2 - a D^2 = 2 (f0 f1 + g).
    const intv is_between = ends->g < 0.0f;
    const floatv per_root = 0.5f * twice_inverse_sqrt_(max(ends->a, 1e-30f));
    const floatv whole = fma(ends->a * per_root, ends->advance, sum);
    const floatv turn = ends->rate * ends->advance;
    const floatv above = whole * whole * select(splat(1.0f), ends->f0f1 - ends->g, is_between);
    const floatv below = 2.0f * select(ends->f0f1 + ends->g, least * turn * turn, is_between);
    const floatv artanh = HALF_LN_2 * binary_logarithm(above * inverse(max(below, 1e-36f)));
    const floatv per_m = per_root * inverse(max(ratio, 1e-30f));
    floatv excess = fma(artanh, per_m, splat(-1.0f)) * per_m * per_m;
    const intv is_small = m2 < 0.2f;
    if (any_lane(is_small))
        excess = select(excess, artanh_series(m2), is_small);
    const floatv mean = 0.5f * (ends->l0 + ends->l1);
    const floatv bent = fma(m2, mean, -0.5f * (ends->l1 - ends->l0) * (ends->f1 - ends->f0) * per_sum);
    return 2.0f * ratio * fma(bent, excess, mean);
}
