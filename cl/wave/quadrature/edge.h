// The search for where light begins on a ray, and where it ends: where the squared distance to a core is that of the
// source's reach. What is beyond would be nodes for nothing, and a kink between those that are left.
#pragma once
#include "../../lanes.h"
#include "../../roots.h"

// Steps at most, how fast a ray must come closer to the light, of its length, to take one, and which share of the panel
// the last one goes: the next would go about its square.
#ifndef EDGE_STEPS
#define EDGE_STEPS 8
#endif
#ifndef LAST_EDGE_STEP
#ifdef COARSE
#define LAST_EDGE_STEP 1e-3f
#else
#define LAST_EDGE_STEP 1e-4f
#endif
#endif
#define LEAST_CLOSING 0.02f

// Along the ray, or, with `turn` -1, against it.
typedef struct {
    floatv turn;
    floatv s, safe, edge;
} EdgeSearch;

// The squared distance to a core somewhere on a ray, without softening, its slope there, and half of its curvature, or
// more.
typedef struct {
    floatv distance2, slope, half_curvature;
} EdgeView;

INLINE EdgeSearch edge_search_from(const floatv s, const float turn) {
    const EdgeSearch search = {splat(turn), s, s, s};
    return search;
}

// Takes a step to where the squared distance, as a parabola, is that of the edge, or Newton's where it never is. One
// that goes where the ray draws away from the core may have passed over what is lit: in its place comes a step as long
// as the distance to the light. Returns which lanes are still moving.
INLINE intv step_to_edge(EdgeSearch *const search, const EdgeView *const view, const floatv length, const float end2,
                         const floatv from, const floatv to) {
    const floatv s = search->s, turn = search->turn, distance2 = max(view->distance2, 1e-30f);
    const float end = sqrt(end2);
    const floatv distance = 0.5f * twice_sqrt(distance2), left2 = distance2 - end2;
    const floatv closing = -0.5f * turn * view->slope;
    const intv is_closing = closing > LEAST_CLOSING * length * distance;
    const intv is_there = is_closing | (s == search->safe);
    const floatv bend = fma(-view->half_curvature, left2, closing * closing);
    const floatv root = 0.5f * twice_sqrt(max(bend, 1e-36f));
    floatv ahead = (distance - end) * distance * inverse(max(closing, 1e-30f));
    ahead = select(ahead, left2 * inverse(max(closing + root, 1e-30f)), bend > 0.0f);
    const floatv short_step = fma(turn * max(distance - end, 0.0f), inverse(length), s);
    const floatv there = fma(turn, ahead, s);
    search->edge = select(search->edge, select(there, s, left2 > 0.0f), is_there);
    search->safe = clamp(select(search->safe, short_step, is_there), from, to);
    search->s = clamp(select(search->safe, there, is_closing), from, to);
    return fabs(search->s - s) > LAST_EDGE_STEP * (to - from);
}
