// Decay zeta(s) = alpha / (s + beta)^2 (Watanabe, Abe, Konno 2015, eq. 21), taken out of integrals by a change of
// variable: with v = -beta / (s + beta) the integral of psi(s) zeta(s) ds is alpha / beta times that of psi dv. Without
// decay v = s.
//
// With -D FADING=m, m the power of a decay alpha / (s + beta)^m or 0 for none, light fades in another way, and space
// may absorb it: v stays that of the square, and what it does not take out of integrals is a factor at each node.
#pragma once
#include "../../elementary.h"
#include "../../lanes.h"
#include "../../roots.h"
#include "../types.h"

typedef struct {
    float strength; // alpha / beta, with a power m alpha beta^(1 - m); 1 without decay
    float beta;     // 0 without decay
    float per_beta; // 1 / beta; 0 without decay
#ifdef FADING
    floatv lost; // what absorption takes along the ray as far as s = 1, a binary logarithm
#endif
} Decay;

Decay decay_of(const Integrand *const integrand, const floatv ray_length) {
    const Decay decay = {integrand->decay_strength, integrand->decay_beta, integrand->decay_per_beta,
#ifdef FADING
                         integrand->absorption * ray_length
#endif
    };
    return decay;
}

// Returns beta / (s + beta), which is -v; 1 without decay.
floatv nearness(const Decay decay, const floatv s) {
    return decay.beta > 0.0f ? decay.beta * inverse(s + decay.beta) : splat(1.0f);
}

#ifdef FADING
// Light of which less is left than this, as a binary logarithm, is none: float32 holds little more.
#define MOST_LOST 100.0f

// Returns the parameter s from which on all is dark.
floatv darkness(const Decay decay) {
    return MOST_LOST * inverse(max(decay.lost, 1e-30f));
}

// Returns what absorption leaves of the light at the parameter s.
floatv left_at(const Decay decay, const floatv s) {
    const floatv lost = decay.lost * s;
    return select(power_of_two(-min(lost, MOST_LOST)), splat(0.0f), lost > MOST_LOST);
}

// Returns all of the fading at the parameter s.
floatv decay_at(const Decay decay, const floatv s) {
    const floatv left = left_at(decay, s);
#if FADING == 0
    return left;
#else
    const floatv near = nearness(decay, s);
    floatv zeta = decay.strength * decay.per_beta * near;
    for (int power = 1; power < FADING; ++power)
        zeta *= near;
    return zeta * left;
#endif
}
#else
// Returns zeta(s) itself.
floatv decay_at(const Decay decay, const floatv s) {
    const floatv near = nearness(decay, s);
    return decay.beta > 0.0f ? decay.strength * decay.per_beta * near * near : splat(1.0f);
}
#endif

// Returns v(to) - v(from), from their nearness.
floatv advance(const Decay decay, const floatv from, const floatv near_from, const floatv to, const floatv near_to) {
    return decay.beta > 0.0f ? (to - from) * near_from * near_to * decay.per_beta : to - from;
}
