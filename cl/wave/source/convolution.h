// Convolution of 1/r with a straight piece of core: every point of it lights space, and all are added up. Per unit of
// length that is the integral of dl / |P - C(l)| from one end to the other,
//
//     asinh(h / rho) + asinh(b / rho) = 2 artanh(length / (r0 + r1)),
//
// rho the distance to the whole line, r0 and r1 those to the ends, h and b the way from either end to the foot of P,
// towards the other end. It is additive: pieces that meet have no joint. Where light changes evenly from one end to the
// other, its growth over the piece adds 2 (h - length / 2) (artanh(m) - m), m = length / (r0 + r1).
//
// Along a ray it is integrated by nodes; it peaks where the ray comes closest to the line between the ends, or to an
// end, in the complex plane where one of these squared distances is 0.
#pragma once
#include "../quadrature/panel.h"
#include "../quadrature/quadrature.h"
#include "../quadrature/stretch.h"
#include "names.h"
#include "quadratic.h"

// A piece seen from a ray. All lengths are doubled, also those of heights.
typedef struct {
    Quadratic to_line, to_first, to_last; // squared distances: to the line, and to its ends; all softened
    Height over_first, over_last;         // over the planes through the ends, along the line
    float length;
    float light, growth; // -D SERIES: what light is multiplied with in the middle, and how that grows with the length
} ConvolvedPiece;

#ifndef OF_GROWTH // a test spoils it
#define OF_GROWTH 2.0f
#endif

// Returns the field of a piece, from squared distances and heights.
INLINE floatv convolved(const floatv line2, const floatv first2, const floatv last2, const floatv over_first,
                        const floatv over_last, const float length, const float light, const float growth) {
    const floatv to_first = 0.5f * twice_sqrt(first2), to_last = 0.5f * twice_sqrt(last2);
    const floatv ratio = length * inverse(to_first + to_last), m2 = ratio * ratio;
    // Where the logarithm is small.
    const floatv series = 2.0f * ratio * fma(m2, artanh_series(min(m2, 0.2f)), splat(1.0f));
    const intv is_beyond_first = over_first >= 0.0f, is_before_last = over_last <= 0.0f;
    const floatv first = to_first + fabs(over_first), last = to_last + fabs(over_last);
    const floatv above = select(splat(1.0f), first, is_beyond_first) * select(splat(1.0f), last, is_before_last);
    const floatv below = select(select(first, splat(1.0f), is_beyond_first) * select(last, splat(1.0f), is_before_last),
                                line2, is_beyond_first & is_before_last);
    const floatv field = LN_2 * binary_logarithm(max(above * inverse(below), 1.0f));
    const floatv even = select(field, series, m2 < 0.2f);
#ifdef SERIES
    const floatv excess = fma(splat(0.5f), even, -ratio);
    const floatv least = ratio * m2 * artanh_series(min(m2, 0.2f));
    const floatv beyond_middle = over_first - 0.5f * length;
    return fma(splat(light), even, OF_GROWTH * growth * beyond_middle * select(excess, least, m2 < 0.2f));
#else
    return even;
#endif
}

INLINE floatv convolved_at(const ConvolvedPiece *const piece, const floatv s) {
    return convolved(quadratic_at(&piece->to_line, s), quadratic_at(&piece->to_first, s),
                     quadratic_at(&piece->to_last, s), height_at(&piece->over_first, s),
                     height_at(&piece->over_last, s), piece->length, piece->light, piece->growth);
}

#ifdef EXACT
typedef struct {
    ConvolvedPiece piece;
    floatv end; // of the ray
} convolution_peaks;

// Returns how far a panel is from where a squared distance is 0, squared.
floatv distance2_to_zero(const Quadratic *const q, const floatv from, const floatv to) {
    const floatv per_slope = inverse(max(q->slope, 1e-18f));
    const floatv beyond = min(fabs(q->nearest - clamp(q->nearest, from, to)), 1e15f);
    return fma(beyond, beyond, min(q->least * per_slope, 1e30f * q->slope) * per_slope);
}

// Where the field peaks, as seen from a panel: next to the line between the ends, or next to one of them.
typedef struct {
    floatv s; // the real part
    intv is_last, is_line;
} Nearest;

INLINE Nearest nearest_of_piece(const ConvolvedPiece *const piece, const floatv from, const floatv to) {
    const floatv to_first = distance2_to_zero(&piece->to_first, from, to);
    const floatv to_last = distance2_to_zero(&piece->to_last, from, to);
    const floatv to_line = distance2_to_zero(&piece->to_line, from, to);
    const floatv foot = clamp(piece->to_line.nearest, from, to);
    const intv is_between =
        (height_at(&piece->over_first, foot) >= 0.0f) & (height_at(&piece->over_last, foot) <= 0.0f);
    Nearest nearest;
    nearest.is_last = to_last < to_first;
    nearest.is_line = is_between & (to_line < min(to_first, to_last));
    nearest.s = select(select(piece->to_first.nearest, piece->to_last.nearest, nearest.is_last), piece->to_line.nearest,
                       nearest.is_line);
    return nearest;
}

// Cuts the ray where it comes closest to the piece: next to where a squared distance is 0.
INLINE uint convolution_panels(const convolution_peaks *const peaks, const Quadrature *const quadrature,
                               floatv *const from, floatv *const to, floatv *const integral) {
    floatv end = peaks->end;
#ifdef FADING
    end = min(end, darkness(quadrature->decay));
#endif
    const Nearest nearest = nearest_of_piece(&peaks->piece, splat(0.0f), end);
    to[0] = end;
    to[1] = from[0] = clamp(nearest.s, 0.0f, end);
    from[1] = splat(0.0f);
    *integral = splat(0.0f);
    return 2;
}

// A squared distance beside a point of the ray: (ahead + slope x)^2 + least.
typedef struct {
    floatv ahead, slope, least;
} QuadraticBeside;

QuadraticBeside quadratic_beside(const Quadratic *const q, const floatv base) {
    const QuadraticBeside beside = {along_at(q, base, splat(0.0f)), q->slope, q->least};
    return beside;
}

floatv beside_at(const QuadraticBeside *const q, const floatv x) {
    const floatv ahead = fma(q->slope, x, q->ahead);
    return fma(ahead, ahead, q->least);
}

typedef struct {
    QuadraticBeside to_line, to_first, to_last;
    Height over_first, over_last; // from the base on
    float length, light, growth;
} convolution_near;

INLINE convolution_near convolution_approach(const convolution_peaks *const peaks, const floatv from, const floatv to,
                                             Peak *const peak, floatv *const base) {
    const ConvolvedPiece *const piece = &peaks->piece;
    const Nearest nearest = nearest_of_piece(piece, from, to);
    const intv is_last = nearest.is_last, is_line = nearest.is_line;
    *base = clamp(nearest.s, from, to);
    convolution_near near;
    near.to_line = quadratic_beside(&piece->to_line, *base);
    near.to_first = quadratic_beside(&piece->to_first, *base);
    near.to_last = quadratic_beside(&piece->to_last, *base);
    near.over_first = piece->over_first, near.over_last = piece->over_last;
    near.over_first.at = height_at(&piece->over_first, *base), near.over_last.at = height_at(&piece->over_last, *base);
    near.length = piece->length, near.light = piece->light, near.growth = piece->growth;
    const floatv slope = select(select(near.to_first.slope, near.to_last.slope, is_last), near.to_line.slope, is_line);
    const floatv ahead = select(select(near.to_first.ahead, near.to_last.ahead, is_last), near.to_line.ahead, is_line);
    const floatv least = select(select(near.to_first.least, near.to_last.least, is_last), near.to_line.least, is_line);
    const floatv per_slope = inverse(max(slope, 1e-18f));
    peak->re = -ahead * per_slope;
    peak->im = 0.5f * twice_sqrt(least) * per_slope;
    peak->is_flat = (intv)(0);
    return near;
}

// Returns the field at s = base + x.
INLINE floatv convolution_near_field(const convolution_near *const near, const floatv x) {
    return convolved(beside_at(&near->to_line, x), beside_at(&near->to_first, x), beside_at(&near->to_last, x),
                     height_at(&near->over_first, x), height_at(&near->over_last, x), near->length, near->light,
                     near->growth);
}

#define convolution_has_kinks 1 // more than one peak
#define KIND convolution
#include "../quadrature/adaptive.h" // convolution_integral_of
#undef KIND

// Integrates along a ray up to a point of it.
CALL_IF_SCALAR floatv convolved_over(const ConvolvedPiece *const piece, const floatv end,
                                     const Quadrature *const quadrature) {
    const convolution_peaks peaks = {*piece, end};
    return convolution_integral_of(&peaks, quadrature);
}
#endif
