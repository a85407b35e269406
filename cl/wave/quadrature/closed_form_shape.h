// The integral of a shape (profile.h) over a stretch of a ray whose squared distance is a quadratic, in closed form,
// for light that does not fade: 1, 2 and 3 powers of 1 / q with a window or without, and a Gaussian.
//
// With x = slope s + offset, q^2 = x^2 + m and E the squared distance at which light ends, softened, the window is
// (E - q^2)^2 over the fourth power of the reach: what is to be known are the integrals J_k of q^k over x. Where they
// would cancel, which is where q^2 hardly changes, six Gauss-Legendre nodes serve.
#pragma once
#include "closed_form.h"

#if defined(SHAPES) && defined(EXACT) && !defined(FADING) && !defined(SQUARED)
#ifndef CUBIC_PART // a test spoils it
#define CUBIC_PART (1.0f / 3.0f)
#endif

// A stretch from x0 to x1, as far as it is lit. Lengths are doubled.
typedef struct {
    floatv x0, x1, length; // length = x1 - x0
    floatv least;          // m
    floatv left2;          // squared distance that m lacks to where light ends
} ShapePart;

// Returns the integral of 1 / q^2 times a window over x.
INLINE floatv windowed_square_over(const Profile *const profile, const ShapePart *const part) {
    const floatv x0 = part->x0, x1 = part->x1, m = part->least, end = m + part->left2;
    const floatv q0q1 = 0.25f * twice_sqrt(fma(x0, x0, m)) * twice_sqrt(fma(x1, x1, m));
    const floatv g = fma(x0, x1, m), per_root = 0.5f * twice_inverse_sqrt_(m);
    // The peak sees the part under an angle. Half of it, or half of what it lacks to pi, has the tangent t.
    const floatv t = min(m * per_root * part->length * inverse(q0q1 + fabs(g)), 1.0f);
    const floatv angle = 2.0f * t * arctangent_ratio(t * t);
    const floatv seen = select(angle, M_PI_F - angle, g < 0.0f);
    const floatv squares = fma(x1, x1, fma(x0, x1, x0 * x0));
    const floatv rest = fma(squares, splat(CUBIC_PART), fma(splat(-2.0f), end, m));
    return profile->per_reach2 * profile->per_reach2 * fma(end * end * per_root, seen, rest * part->length);
}

// Returns the integrals of q to the powers -3, -1, 1 and 3 over x.
INLINE void odd_powers_over(const ShapePart *const part, floatv powers[4]) {
    const floatv x0 = part->x0, x1 = part->x1, m = part->least, per_m = inverse(m);
    const floatv q0 = 0.5f * twice_sqrt(fma(x0, x0, m)), q1 = 0.5f * twice_sqrt(fma(x1, x1, m));
    const floatv size0 = q0 + fabs(x0), size1 = q1 + fabs(x1);
    // x1 / q1 - x0 / q0 cancels where both are on one side.
    const floatv across = x1 * q0, back = x0 * q1, per_q0q1 = inverse(q0 * q1);
    const floatv beside = part->length * (x1 + x0) * inverse(max(fabs(across + back), 1e-30f));
    powers[0] = per_q0q1 * select((across - back) * per_m, fabs(beside), x0 * x1 > 0.0f);
    const floatv ratio =
        select(size1, m * inverse(size1), x1 < 0.0f) * select(inverse(size0), size0 * per_m, x0 < 0.0f);
    powers[1] = LN_2 * binary_logarithm(ratio);
    powers[2] = 0.5f * fma(x1, q1, fma(-x0, q0, m * powers[1]));
    powers[3] = 0.25f * fma(x1 * q1 * q1, q1, fma(-x0 * q0 * q0, q0, 3.0f * m * powers[2]));
}

// Returns the integral of 1 / q to an odd power, times a window, over x.
INLINE floatv odd_over(const Profile *const profile, const ShapePart *const part) {
    floatv powers[4];
    odd_powers_over(part, powers);
    const bool is_cubed = profile->number == 2u;
    if (profile->per_reach2 == 0.0f)
        return powers[0]; // 1 / q has other forms
    const floatv end = part->least + part->left2;
    const floatv a = is_cubed ? powers[0] : powers[1], b = is_cubed ? powers[1] : powers[2],
                 c = is_cubed ? powers[2] : powers[3];
    return profile->per_reach2 * profile->per_reach2 * fma(end, fma(end, a, -2.0f * b), c);
}

// Returns erf(x).
floatv error_function(const floatv x) {
    return x * error_function_ratio(max(fabs(x), 1e-6f));
}

// Returns the mean of the field over a part in which q^2 hardly changes.
INLINE floatv short_mean(const Profile *const profile, const ShapePart *const part) {
    const float node[3] = {0.932469514f, 0.661209386f, 0.238619186f},
                weight[3] = {0.171324492f, 0.360761573f, 0.467913935f};
    const floatv middle = 0.5f * (part->x0 + part->x1), half_length = 0.5f * part->length;
    floatv sum = splat(0.0f);
#pragma unroll
    for (int k = 0; k < 6; ++k) {
        const floatv x = fma(half_length, splat(k < 3 ? node[k % 3] : -node[k % 3]), middle);
        const floatv q2 = fma(x, x, part->least), left2 = max(fma(-x, x, part->left2), 0.0f);
        sum = fma(shaped(profile, q2, left2, twice_inverse_sqrt(q2)), splat(0.5f * weight[k % 3]), sum);
    }
    return sum;
}

// Integrates over a stretch that has such a form in all lanes; returns whether it has.
INLINE bool closed_shape_over(const Stretch *const stretch, const Quadratic *const distance2,
                              const Profile *const profile, const floatv left2, floatv *const integral) {
    const bool is_gaussian = profile->number == 3u, is_windowed = profile->per_reach2 > 0.0f;
    if (profile->number > 3u || (is_gaussian && is_windowed))
        return false;
    const floatv x_from = along_at(distance2, stretch->from, stretch->from_rest);
    const floatv x_to = along_at(distance2, stretch->to, stretch->to_rest);
    const floatv span = stretch->to - stretch->from;
    const floatv reach = HAS_END(profile) ? 0.5f * twice_sqrt(max(left2, 1e-30f)) : splat(1e18f);
    const intv is_whole = (x_from >= -reach) & (x_to <= reach);
    const floatv per_slope = inverse(max(distance2->slope, 1e-18f));
    ShapePart part;
    part.x0 = max(x_from, -reach), part.x1 = min(x_to, reach);
    part.length = select(part.x1 - part.x0, distance2->slope * span, is_whole);
    part.least = distance2->least, part.left2 = left2;
    const intv is_lit = (left2 > 0.0f) & (part.length > 0.0f);
    *integral = splat(0.0f);
    if (!any_lane(is_lit))
        return true;
    if (any_lane(is_lit & ((distance2->least < profile->floor2) | (stretch->light_from != stretch->light_to))))
        return false;
#ifdef WIDENS
    if (any_lane(is_lit & (distance2->bare_slope != distance2->slope)))
        return false;
#endif
    const floatv way = select(part.length * per_slope, span, is_whole);
    const floatv middle = 0.5f * (part.x0 + part.x1), half2 = 0.25f * part.length * part.length;
    const intv is_short =
        is_gaussian ? half2 * profile->per_width2 < 0.25f : half2 < 0.33f * fma(middle, middle, part.least);
    floatv mean = splat(0.0f);
    if (any_lane(is_lit & is_short))
        mean = short_mean(profile, &part);
    if (any_lane(is_lit & !is_short)) {
        const floatv per_length = inverse(max(part.length, 1e-18f));
        floatv over_x;
        if (is_gaussian) {
            const float per_width = sqrt(profile->per_width2);
            const floatv from = per_width * part.x0, to = per_width * part.x1;
            if (any_lane(is_lit & !is_short & (min(fabs(from), fabs(to)) > 1.0f) & (from * to > 0.0f)))
                return false;
            const floatv bare2 = max(part.least - profile->softening2, 0.0f);
            over_x = 0.886226925f / per_width * fading(bare2 * profile->per_width2) *
                     (error_function(to) - error_function(from));
        } else if (profile->number == 1u) {
            over_x = 4.0f * windowed_square_over(profile, &part);
        } else {
            over_x = (profile->number == 2u ? 8.0f : 2.0f) * odd_over(profile, &part);
        }
        mean = select(per_length * over_x, mean, is_short);
    }
    *integral = select(splat(0.0f), way * mean * stretch->light_from, is_lit);
    return true;
}
#endif
