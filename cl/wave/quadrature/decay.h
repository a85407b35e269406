// Decay zeta(s) = alpha / (s + beta)^2 (Watanabe, Abe, Konno 2015, eq. 21), taken out of integrals by a change of
// variable: with v = -beta / (s + beta) the integral of psi(s) zeta(s) ds is alpha / beta times that of psi dv. Without
// decay v = s.
#pragma once
#include "../../lanes.h"
#include "../../roots.h"
#include "../types.h"

typedef struct {
    float strength; // alpha / beta; 1 without decay
    float beta;     // 0 without decay
    float per_beta; // 1 / beta; 0 without decay
} Decay;

Decay decay_of(const Integrand *const integrand) {
    const Decay decay = {integrand->decay_strength, integrand->decay_beta, integrand->decay_per_beta};
    return decay;
}

// Returns beta / (s + beta), which is -v; 1 without decay.
floatv nearness(const Decay decay, const floatv s) {
    return decay.beta > 0.0f ? decay.beta * inverse(s + decay.beta) : splat(1.0f);
}

// Returns zeta(s) itself.
floatv decay_at(const Decay decay, const floatv s) {
    const floatv near = nearness(decay, s);
    return decay.beta > 0.0f ? decay.strength * decay.per_beta * near * near : splat(1.0f);
}

// Returns v(to) - v(from), from their nearness.
floatv advance(const Decay decay, const floatv from, const floatv near_from, const floatv to, const floatv near_to) {
    return decay.beta > 0.0f ? (to - from) * near_from * near_to * decay.per_beta : to - from;
}
