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
    float2 nearest;       // cosine and sine of the angle of the nearest point
    float al, be;         // the squared distance is al - be cos(psi)
    float near2, far2;    // D0^2, D1^2
    float height;         // n.y of the nearest point
    float across, beside; // n.y is height + across (cos(psi) - 1) + beside sin(psi)
} SeenRing;

SeenRing see_ring(__global const CastLight *const ring, const float3 y, const float3 normal) {
    const float radius = ring->along.w;
    const float3 axis = cross(ring->along.xyz, ring->across.xyz);
    const float3 from_center = -y - dot(-y, axis) * axis;
    const float rho = length(from_center);
    const float z = dot(y, axis);
    const float3 out = rho > 1e-6f * radius ? from_center / rho : ring->along.xyz;
    const float3 nearest = y + radius * out;
    const float short2 = (radius - rho) * (radius - rho) + z * z + ring->place.w;
    const SeenRing seen = {(float2)(dot(out, ring->along.xyz), dot(out, ring->across.xyz)),
                           radius * radius + rho * rho + z * z + ring->place.w,
                           2.0f * radius * rho,
                           short2,
                           short2 + 4.0f * radius * rho,
                           FACING(normal, nearest),
                           radius * FACING(normal, out),
                           radius * FACING(normal, cross(axis, out))};
    return seen;
}

// Returns the angle of the nearest point.
float turn_of(const SeenRing *const seen) {
    return atan2(seen->nearest.y, seen->nearest.x);
}

// Returns what is above the horizon.
Stretches ring_above(__global const CastLight *const ring, const SeenRing *const seen) {
    Stretches above = {{0.0f, 0.0f}, {0.0f, 0.0f}, 0};
    const float level = seen->height - seen->across;
    const float swing = sqrt(seen->across * seen->across + seen->beside * seen->beside);
#ifndef WITHOUT_HORIZON
    if (level <= -swing)
        return above;
    if (level < swing) {
        const float top = turn_of(seen) + atan2(seen->beside, seen->across);
        const float half_width = acos(-level / swing);
        const float turns = floor((0.5f * (ring->from + ring->to) - top) / (2.0f * PI_F) + 0.5f);
        for (int k = -1; k <= 1; ++k) {
            const float middle = top + 2.0f * PI_F * (turns + k);
            add_stretch(&above, fmax(ring->from, middle - half_width), fmin(ring->to, middle + half_width));
        }
        return above;
    }
#endif
    add_stretch(&above, ring->from, ring->to);
    return above;
}

// Returns the integral over all of it of (n.y) / |y|^3 over the angle: J3 and Jc by K and E of k'^2 = D0^2 / D1^2.
float whole_ring(const SeenRing *const seen) {
    const float far = sqrt(seen->far2);
    float a = 1.0f, g = sqrt(seen->near2 / seen->far2);
    float power = 0.5f, taken = 0.5f * (1.0f - g * g);
    for (int step = 0; step < 5; ++step) {
        const float half_difference = 0.5f * (a - g);
        const float mean = 0.5f * (a + g);
        g = sqrt(a * g);
        a = mean;
        power *= 2.0f;
        taken += power * half_difference * half_difference;
    }
    const float k = 0.5f * PI_F / a;
    const float e = k * (1.0f - taken);
    const float j3 = 4.0f * e / (seen->near2 * far);
    const float j1 = 4.0f * k / far;
    const float b = seen->be / seen->al;
    const float b2 = b * b;
    // From near the axis the closed form of Jc cancels, and a series serves.
    const float series =
        2.0f * PI_F * b * (0.75f + b2 * (0.8203125f + b2 * 0.845947266f)) / (seen->al * sqrt(seen->al));
    const float jc = b < 0.1f ? series : (seen->al * j3 - j1) / seen->be;
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

// Returns the integral of light (n.y) / |y|^3 over angles psi that lie between two multiples of pi, angles of the ring
// less `turns`.
float3 part_of_ring(__global const CastLight *const ring, const SeenRing *const seen, const float from, const float to,
                    const float turns) {
    const float near = sqrt(seen->near2), far = sqrt(seen->far2);
    // Halves of angles.
    const float begin = atan2(far * sin(0.5f * from), near * cos(0.5f * from));
    const float end = atan2(far * sin(0.5f * to), near * cos(0.5f * to));
    const float middle = 0.5f * (begin + end), half_width = 0.5f * (end - begin);
    const int is_same = is_even(ring);
    float3 sum = (float3)(0.0f);
    for (uint first = 0; first < GAUSS_COUNT; first += LANES) {
        floatv sine;
        const floatv cosine = cosine_of(fma(splat(half_width), LOAD_LANES(GAUSS_NODES + first), splat(middle)), &sine);
        const floatv c = far * cosine, s = near * sine;
        const floatv q = c * c + s * s;
        const floatv height = seen->height + 2.0f * s / q * (seen->beside * c - seen->across * s);
        const floatv weight = LOAD_LANES(GAUSS_WEIGHTS + first) * sqrt(q) * height;
        if (is_same) {
            sum += sum_lanes(weight) * ring->light.xyz;
            continue;
        }
        const floatv angle = 2.0f * atan2(s, c) + turns;
        sum += lit_sum(ring, weight, (angle - ring->from) * (1.0f / (ring->to - ring->from)));
    }
    return 2.0f * half_width / (seen->near2 * seen->far2) * sum;
}

float3 ring_irradiance(__global const CastLight *const ring, const SeenRing *const seen, const float from,
                       const float to) {
    const float radius = ring->along.w;
    if (to - from > 1.99999f * PI_F && is_even(ring))
        return radius * whole_ring(seen) * ring->light.xyz;
    float3 sum = (float3)(0.0f);
    const float turn = turn_of(seen);
    float begin = from - turn;
    const float last = to - turn;
    for (int k = 0; k < 4 && begin < last; ++k) {
        // Up to the next multiple of pi.
        const float half_turns = floor(begin / PI_F + 1e-6f) + 1.0f;
        const float end = fmin(last, half_turns * PI_F);
        const float turns = 2.0f * PI_F * floor(0.5f * half_turns);
        sum +=
            part_of_ring(ring, seen, clamp(begin - turns, -PI_F, PI_F), clamp(end - turns, -PI_F, PI_F), turns + turn);
        begin = end;
    }
    return radius * sum;
}

float3 ring_place(__global const CastLight *const ring, const float3 y, const float angle) {
    return y + ring->along.w * (cos(angle) * ring->along.xyz + sin(angle) * ring->across.xyz);
}
