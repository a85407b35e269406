// Circles and parts of them.
//
// As seen from a point at the distance rho from the axis and the height z, |y|^2 = al - be cos(psi), psi the angle from
// the nearest point; D0^2 = (R - rho)^2 + z^2 and D1^2 = (R + rho)^2 + z^2 are its least and greatest value. All of a
// circle has complete elliptic integrals (by the arithmetic-geometric mean); a part Gauss' rule over v, where
// tan(psi/2) = (D0/D1) tan(v/2) (Landen's transformation): then dpsi / |y|^3 = sqrt(Q) / (D0 D1)^2 dv with
// Q = D1^2 cos^2(v/2) + D0^2 sin^2(v/2).
#pragma once
#include "stretch.h"

// How a ring is seen from a point.
typedef struct {
    floatv turn;           // the angle of the nearest point
    floatv al, be;         // the squared distance is al - be cos(psi)
    floatv near2, far2;    // D0^2, D1^2
    floatv height;         // n.y of the nearest point
    floatv across, beside; // n.y is height + across (cos(psi) - 1) + beside sin(psi)
} SeenRing;

SeenRing see_ring(__global const CastLight *const ring, const float3v y, const float3v normal) {
    const float radius = ring->along.w;
    const float3v x_axis = uniform3(ring->along), y_axis = uniform3(ring->across);
    const float3v axis = cross3(x_axis, y_axis);
    const floatv z = dot3(y, axis);
    const float3v from_center = subtract3(scale3(axis, z), y);
    const floatv rho = sqrt(dot3(from_center, from_center));
    const float3v out = select3(x_axis, scale3(from_center, 1.0f / rho), rho > 1e-6f * radius);
    const floatv near2 = (radius - rho) * (radius - rho) + z * z + ring->place.w;
    SeenRing seen;
    seen.turn = angle_of(dot3(out, y_axis), dot3(out, x_axis));
    seen.al = radius * radius + rho * rho + z * z + ring->place.w;
    seen.be = 2.0f * radius * rho;
    seen.near2 = near2;
    seen.far2 = near2 + 4.0f * radius * rho;
    seen.height = FACING(normal, fma3(out, splat(radius), y));
    seen.across = radius * FACING(normal, out);
    seen.beside = radius * FACING(normal, cross3(axis, out));
    return seen;
}

// Returns what is above the horizon.
Stretches ring_above(__global const CastLight *const ring, const SeenRing *const seen) {
    Stretches above = no_stretch();
    const floatv all_from = splat(ring->from), all_to = splat(ring->to);
#ifdef WITHOUT_HORIZON
    add_stretch(&above, all_from, all_to);
#else
    const floatv level = seen->height - seen->across;
    const floatv swing = sqrt(seen->across * seen->across + seen->beside * seen->beside);
    const intv is_cut = (level > -swing) & (level < swing);
    add_stretch(&above, all_from, select(all_from, all_to, level >= swing));
    if (!any_lane(is_cut))
        return above;
    const floatv top = seen->turn + angle_of(seen->beside, seen->across);
    const floatv half_width = angle_of(sqrt(fmax((swing - level) * (swing + level), 0.0f)), -level);
    const floatv turns = floor((0.5f * (all_from + all_to) - top) / (2.0f * PI_F) + 0.5f);
    for (int k = -1; k <= 1; ++k) {
        const floatv middle = top + 2.0f * PI_F * (turns + k);
        const floatv from = fmax(all_from, middle - half_width), to = fmin(all_to, middle + half_width);
        add_stretch(&above, from, select(from, to, is_cut));
    }
#endif
    return above;
}

// Returns the integral over all of it of (n.y) / |y|^3 over the angle: J3 and Jc by K and E of k'^2 = D0^2 / D1^2.
floatv whole_ring(const SeenRing *const seen) {
    const floatv far = sqrt(seen->far2);
    floatv a = splat(1.0f), g = sqrt(seen->near2 / seen->far2);
    floatv taken = 0.5f * (1.0f - g * g);
    float power = 0.5f;
    for (int step = 0; step < 5; ++step) {
        const floatv half_difference = 0.5f * (a - g);
        const floatv mean = 0.5f * (a + g);
        g = sqrt(a * g);
        a = mean;
        power *= 2.0f;
        taken += power * half_difference * half_difference;
    }
    const floatv k = 0.5f * PI_F / a;
    const floatv e = k * (1.0f - taken);
    const floatv j3 = 4.0f * e / (seen->near2 * far);
    const floatv j1 = 4.0f * k / far;
    const floatv b = seen->be / seen->al;
    const floatv b2 = b * b;
    // From near the axis the closed form of Jc cancels, and a series serves.
    const floatv series =
        2.0f * PI_F * b * (0.75f + b2 * (0.8203125f + b2 * 0.845947266f)) / (seen->al * sqrt(seen->al));
    const floatv jc = select((seen->al * j3 - j1) / seen->be, series, b < 0.1f);
    return (seen->height - seen->across) * j3 + seen->across * jc;
}

// Returns the cosine of an angle up to a quarter of a turn, and gives its sine: Taylor's series, within 1e-7.
floatv cosine_of(const floatv x, floatv *const sine) {
    const floatv x2 = x * x;
    floatv c = fma(splat(2.08767570e-9f), x2, splat(-2.75573192e-7f));
    floatv s = fma(splat(-2.50521084e-8f), x2, splat(2.75573192e-6f));
    c = fma(c, x2, splat(2.48015873e-5f)), s = fma(s, x2, splat(-1.98412698e-4f));
    c = fma(c, x2, splat(-1.38888889e-3f)), s = fma(s, x2, splat(8.33333333e-3f));
    c = fma(c, x2, splat(4.16666667e-2f)), s = fma(s, x2, splat(-1.66666667e-1f));
    c = fma(c, x2, splat(-0.5f)), s = fma(s, x2, splat(1.0f));
    *sine = s * x;
    return fma(c, x2, splat(1.0f));
}

// Returns v/2 of an angle psi from -pi to pi.
floatv half_landen(const floatv psi, const floatv near, const floatv far) {
    floatv sine;
    const floatv cosine = cosine_of(0.5f * psi, &sine);
    return angle_of(far * sine, fmax(near * cosine, 0.0f));
}

// A part of a ring: what is needed at a node.
typedef struct {
    floatv near, far, turns;
} RingPart;

void add_ring_node(LitSum *const sum, __global const CastLight *const ring, const SeenRing *const seen,
                   const RingPart *const part, const floatv half_angle, const float weight) {
    floatv sine;
    const floatv cosine = cosine_of(half_angle, &sine);
    const floatv c = part->far * cosine, s = part->near * sine;
    const floatv q = c * c + s * s;
    const floatv inverse_root = 0.5f * twice_inverse_sqrt(q);
    const floatv turned = 2.0f * s * (seen->beside * c - seen->across * s);
    // sqrt(q) (n.y).
    const floatv value = weight * inverse_root * fma(q, seen->height, turned);
    const floatv angle = is_even(ring) ? splat(0.0f) : 2.0f * angle_of(s, c) + part->turns;
    add_lit(sum, ring, value, (angle - ring->from) * (1.0f / (ring->to - ring->from)));
}

// Adds the integral of light (n.y) / |y|^3 over angles psi that lie between two multiples of pi, angles of the ring
// less `turns`.
void add_part_of_ring(LitSum *const sum, __global const CastLight *const ring, const SeenRing *const seen,
                      const floatv from, const floatv to, const floatv turns) {
    const RingPart part = {sqrt(seen->near2), sqrt(seen->far2), turns};
    const floatv begin = half_landen(from, part.near, part.far), end = half_landen(to, part.near, part.far);
    const floatv middle = 0.5f * (begin + end), half_width = fmax(0.5f * (end - begin), 0.0f);
    // The nearer, the closer the integrand's poles are.
    const Rule rule = any_lane(part.near < 0.2f * part.far)   ? RULE_12
                      : any_lane(part.near < 0.5f * part.far) ? RULE_8
                                                              : RULE_6;
    LitSum own = no_light();
    for (uint node = rule.first; node < rule.end; ++node) {
        const floatv off = half_width * GAUSS_NODES[node];
        add_ring_node(&own, ring, seen, &part, middle - off, GAUSS_WEIGHTS[node]);
        add_ring_node(&own, ring, seen, &part, middle + off, GAUSS_WEIGHTS[node]);
    }
    const floatv scale = 2.0f * half_width / (seen->near2 * seen->far2);
    sum->even = fma(scale, own.even, sum->even);
    sum->slope = fma(scale, own.slope, sum->slope);
    sum->bend = fma(scale, own.bend, sum->bend);
}

float3v ring_irradiance(__global const CastLight *const ring, const SeenRing *const seen, const floatv from,
                        const floatv to) {
    const float radius = ring->along.w;
    const intv is_whole = to - from > (is_even(ring) ? 1.99999f * PI_F : INFINITY);
    LitSum sum = no_light();
    floatv begin = from - seen->turn;
    // What is whole is no part.
    const floatv last = select(to - seen->turn, begin, is_whole);
    for (int k = 0; k < 4 && any_lane(begin < last); ++k) {
        // Up to the next multiple of pi.
        const floatv half_turns = floor(begin / PI_F + 1e-6f) + 1.0f;
        const floatv end = fmin(last, half_turns * PI_F);
        const floatv turns = 2.0f * PI_F * floor(0.5f * half_turns);
        const floatv low = splat(-PI_F), high = splat(PI_F);
        add_part_of_ring(&sum, ring, seen, clamp(begin - turns, low, high), clamp(end - turns, low, high),
                         turns + seen->turn);
        begin = fmax(begin, end);
    }
    const floatv whole = any_lane(is_whole) ? whole_ring(seen) : splat(0.0f);
    sum.even = select(sum.even, whole, is_whole);
    return scale3(light_of(ring, sum), splat(radius));
}

#ifdef IS_HIDDEN
float3v ring_place(__global const CastLight *const ring, const float3v y, const float angle) {
    const float radius = ring->along.w;
    return fma3(uniform3(ring->across), radius * sin(angle), fma3(uniform3(ring->along), radius * cos(angle), y));
}
#endif
