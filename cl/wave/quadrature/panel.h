// A panel of a ray, mapped so that its integrand is smooth: v takes the decay away (decay.h), v = v0 + w sinh u the
// peak. v0 + i w is where the squared distance to the core, continued to complex s, becomes 0: past this point of the
// core the field is like 1 / sqrt((v - v0)^2 + w^2), and constant in u. The map decides how many nodes are needed, not
// what they add up to.
#pragma once
#include "../../elementary.h"
#include "../../view.h"
#include "decay.h"
#include "edge.h"

// The advance of v up to which a panel is empty, as a share of the advance from the beginning of the ray.
#define SHORTEST_PANEL 1e-13f

// A complex zero of the squared distance along the ray, as a parameter s.
typedef struct {
    floatv re, im; // im > 0
    intv is_flat;  // whether the floor of distances cuts the peak off, with a kink on both sides
} Peak;

// Seen from the point `base` of the panel, so that nodes next to a core keep their digits.
typedef struct {
    floatv base;
    floatv bend, stretch;   // s - base = x / (stretch - bend x), x the advance of v
    floatv middle;          // of the peak: v0 less v(base)
    floatv rising, falling; // w/2 e^u and w/2 e^-u in the panel's middle
    floatv half_length;     // half the panel's length in u / ln 2
#ifdef FADING
    floatv near_base, near_end; // nearness at the base and at the end
#endif
} Panel;

// What the nodes of a panel make of it.
typedef struct {
    floatv integral;
    floatv unresolved; // the size of what the rule cannot tell from noise, of the same kind; squared but with -D FADING
    floatv middle;     // where to cut the panel in two, as a parameter s
    floatv unseen;     // what may lie between its nodes, of the same kind
} PanelSum;

// Returns the size of what is not resolved. What absorption has left is too faint to be squared.
floatv size_of_unresolved(const floatv scale, const floatv even, const floatv odd) {
#ifdef FADING
    return scale * (fabs(even) + fabs(odd));
#else
    return scale * scale * fma(even, even, odd * odd);
#endif
}

intv is_beyond(const floatv unresolved, const floatv allowed) {
#ifdef FADING
    return unresolved > fabs(allowed);
#else
    return unresolved > allowed * allowed;
#endif
}

// Returns whether so little of v passes, beside what has passed before, that it adds nothing.
intv is_empty_panel(const Decay decay, const floatv from, const floatv to) {
    const floatv near_to = nearness(decay, to);
    const floatv all = advance(decay, splat(0.0f), splat(1.0f), to, near_to);
    return advance(decay, from, nearness(decay, from), to, near_to) <= SHORTEST_PANEL * all;
}

// Returns the squared distance at which a ray passes a core, raised where that is below the floor. A ray that passes a
// core at a distance h below the floor f sees the field cut off at f. Where core and ray are straight its integral is
// that of a field without floor past the core at the distance (c + f) e^(-c/f), c^2 = f^2 - h^2. For the inverse square
// the integral is 2 c / f^2 + 4 / h atan(h / (c + f)) instead of pi over the distance.
INLINE floatv floored(const floatv least, const floatv floor2, const uint is_square) {
    const intv is_below = least < floor2;
    if (!any_lane(is_below))
        return least;
    const floatv t = min(least * inverse(floor2), 1.0f);
    const floatv c = 0.5f * twice_sqrt(max(1.0f - t, 1e-30f)), sum = 1.0f + c, per_sum = inverse(sum);
    floatv raised;
    if (is_square) {
        const floatv field = 2.0f * c + 4.0f * per_sum * arctangent_ratio((1.0f - c) * per_sum);
        raised = M_PI_F * M_PI_F * inverse(field * field);
    } else {
        raised = sum * sum * power_of_two(-2.0f / LN_2 * c);
    }
    return select(least, raised * floor2, is_below);
}

// Returns the one of two peaks that is closer to the panel in the complex plane.
Peak nearer_peak(const Peak a, const Peak b, const floatv from, const floatv to) {
    const floatv to_a = a.re - clamp(a.re, from, to), to_b = b.re - clamp(b.re, from, to);
    const intv is_b = fma(to_b, to_b, b.im * b.im) < fma(to_a, to_a, a.im * a.im);
    const Peak nearer = {select(a.re, b.re, is_b), select(a.im, b.im, is_b), a.is_flat | b.is_flat};
    return nearer;
}

// Returns e^asinh(x).
floatv exp_asinh(const floatv x) {
    const floatv sum = fma(twice_sqrt(fma(x, x, splat(1.0f))), splat(0.5f), fabs(x));
    return select(sum, inverse(sum), x < 0.0f);
}

// Maps the panel between from and to, with base between them. The peak is seen from the base, so that it keeps its
// digits next to a core.
INLINE Panel mapped_panel(const Decay decay, const Peak peak, const floatv from, const floatv to, const floatv base) {
    Panel panel;
    panel.base = base;
    const floatv near_base = nearness(decay, base);
    const floatv begin = advance(decay, base, near_base, from, nearness(decay, from));
    const floatv end = advance(decay, base, near_base, to, nearness(decay, to));
    floatv width = peak.im;
    panel.middle = peak.re;
    panel.stretch = splat(1.0f), panel.bend = splat(0.0f);
    if (decay.beta > 0.0f) {
        panel.bend = near_base * decay.per_beta;
        panel.stretch = near_base * panel.bend;
        const floatv from_pole = base + peak.re + decay.beta;
        const floatv per_size = inverse(fma(from_pole, from_pole, peak.im * peak.im));
        panel.middle = near_base * fma(peak.im, peak.im, from_pole * panel.middle) * per_size;
        width = decay.beta * peak.im * per_size;
    }
    // A peak farther away than the panel is long needs no map; a mild one keeps the panel's length in u away from 0.
    const floatv length = end - begin;
    panel.middle = clamp(panel.middle, begin - length, end + length);
    width = clamp(width, 1e-8f * length, length);
    const floatv per_width = inverse(width);
    // e^u at the end, e^-u at the beginning: both are large where the peak lies between.
    const floatv at_end = exp_asinh((end - panel.middle) * per_width);
    const floatv at_begin = exp_asinh((panel.middle - begin) * per_width);
    const floatv growth = at_end * at_begin;
    const floatv quarter_width = 0.25f * width * twice_inverse_sqrt_(growth);
    panel.half_length = 0.5f * binary_logarithm(growth);
    panel.rising = quarter_width * at_end;
    panel.falling = quarter_width * at_begin;
#ifdef FADING
    panel.near_base = near_base, panel.near_end = nearness(decay, to);
#endif
    return panel;
}

// Returns s - base of the point that lies `x` ahead of the base in v.
floatv parameter_of(const Panel *const panel, const floatv x) {
    floatv below = fma(-panel->bend, x, panel->stretch);
#ifdef FADING
    below = max(below, panel->bend * panel->near_end); // what rounding would take beyond the end
#endif
    return x * coarse_inverse(below);
}

#ifdef FADING
// Returns what v does not take away of the fading, `x` ahead of the base in v, which is the parameter base + `s`.
floatv fading_beside(const Decay decay, const Panel *const panel, const floatv x, const floatv s) {
    const floatv left = left_at(decay, panel->base + s);
#if FADING == 1
    return left * inverse(max(panel->near_base - x, panel->near_end));
#elif FADING == 3
    return left * max(panel->near_base - x, panel->near_end);
#else
    return left;
#endif
}
#endif
