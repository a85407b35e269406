// The integral of the field named by FIELD times the decay, to a relative error: Gauss-Legendre quadrature on mapped
// panels (panel.h). Two null rules on the same nodes, the highest Legendre coefficients that they see, tell how well a
// panel is resolved; one that is not is cut in two, in all lanes. Included once for every field that has no closed
// form.
//
// The host gives the positive nodes of the rule, the outermost first, their weights and those of the null rules as
// GAUSS_..., and as `threshold` how large the coefficients may be, of the integral.

// Panels that may be open at once, cuts of a ray's panels in all, and the length in s below which a panel is left to
// the next one.
#ifndef MOST_CUTS
#define MOST_CUTS 64
#endif
#define MOST_PANELS 24
#define SHORTEST_PANEL 1e-7f
#define BEYOND_NODES 0.03f
#define LN_2 0.693147181f

typedef struct {
    JOIN(FIELD, _near) near;
    Panel map;
    floatv base, from, to;
} JOIN(panel_of_, FIELD);

INLINE JOIN(panel_of_, FIELD)
    JOIN(open_, FIELD)(const JOIN(FIELD, _peaks) *const peaks, const Decay decay, const floatv from, const floatv to) {
    JOIN(panel_of_, FIELD) panel;
    Peak peak;
    panel.near = JOIN(FIELD, _approach)(peaks, from, to, &peak, &panel.base);
    panel.map = mapped_panel(decay, peak, from, to, panel.base);
    panel.from = from, panel.to = to;
    return panel;
}

INLINE PanelSum JOIN(sum_, FIELD)(const JOIN(FIELD, _peaks) *const peaks, const Decay decay,
                                  JOIN(panel_of_, FIELD) *const panel) {
    const float node[GAUSS_PAIRS] = GAUSS_NODES;
    const float weight[GAUSS_PAIRS] = GAUSS_WEIGHTS;
    const float null_even[GAUSS_PAIRS] = GAUSS_NULL_EVEN;
    const float null_odd[GAUSS_PAIRS] = GAUSS_NULL_ODD;
    const Panel *const map = &panel->map;
    // All nodes first, then the field at all of them: chains of operations that do not wait for each other.
    floatv right_s[GAUSS_PAIRS], left_s[GAUSS_PAIRS], right_v[GAUSS_PAIRS], left_v[GAUSS_PAIRS];
#pragma unroll
    for (int k = 0; k < GAUSS_PAIRS; ++k) {
        const floatv grown = power_of_two(map->half_length * node[k]), shrunk = coarse_inverse(grown);
        const floatv right_up = map->rising * grown, right_down = map->falling * shrunk;
        const floatv left_up = map->rising * shrunk, left_down = map->falling * grown;
        right_s[k] = parameter_of(map, map->middle + (right_up - right_down));
        left_s[k] = parameter_of(map, map->middle + (left_up - left_down));
        right_v[k] = right_up + right_down;
        left_v[k] = left_up + left_down;
    }
    JOIN(FIELD, _look_ahead)(&panel->near, left_s, right_s, GAUSS_PAIRS);
    floatv sum = splat(0.0f), even = splat(0.0f), odd = splat(0.0f);
#pragma unroll
    for (int k = 0; k < GAUSS_PAIRS; ++k) {
        const floatv right = right_v[k] * JOIN(FIELD, _near_field)(&panel->near, right_s[k]);
        const floatv left = left_v[k] * JOIN(FIELD, _near_field)(&panel->near, left_s[k]);
        const floatv both = right + left;
        sum = fma(both, splat(weight[k]), sum);
        even = fma(both, splat(null_even[k]), even);
        odd = fma(right - left, splat(null_odd[k]), odd);
    }
    const floatv scale = LN_2 * decay.strength * map->half_length;
    const floatv middle = panel->base + parameter_of(map, map->middle + (map->rising - map->falling));
    const PanelSum result = {
        scale * sum, scale * scale * fma(even, even, odd * odd), clamp(middle, panel->from, panel->to),
        JOIN(FIELD, _is_broken)(peaks, panel->from, panel->to, panel->base + left_s[0], panel->base + right_s[0])};
    return result;
}

#ifdef FIRST_TWO
// The two panels on both sides of a cut at once: what one waits for, the other fills. Whether both are resolved.
INLINE bool JOIN(first_two_, FIELD)(const JOIN(FIELD, _peaks) *const peaks, const Decay decay, const float threshold,
                                    const floatv cut, floatv *const integral) {
    const intv has_first = cut >= SHORTEST_PANEL, has_second = cut <= 1.0f - SHORTEST_PANEL;
    const floatv first_end = max(cut, SHORTEST_PANEL), second_begin = min(cut, 1.0f - SHORTEST_PANEL);
    JOIN(panel_of_, FIELD) first = JOIN(open_, FIELD)(peaks, decay, splat(0.0f), first_end);
    JOIN(panel_of_, FIELD) second = JOIN(open_, FIELD)(peaks, decay, second_begin, splat(1.0f));
    const PanelSum of_first = JOIN(sum_, FIELD)(peaks, decay, &first);
    const PanelSum of_second = JOIN(sum_, FIELD)(peaks, decay, &second);
    *integral = select(splat(0.0f), of_first.integral, has_first) + select(splat(0.0f), of_second.integral, has_second);
    const floatv allowed = threshold * *integral;
    return !any_lane(max(of_first.unresolved2, of_second.unresolved2) > allowed * allowed);
}
#endif

INLINE floatv JOIN(exact_, FIELD)(const Ray *const ray, const Sources *const sources, const uint index,
                                  const Quadrature *const quadrature) {
    const Decay decay = quadrature->decay;
    const float threshold = quadrature->JOIN(FIELD, _threshold);
    const JOIN(FIELD, _peaks) peaks = JOIN(FIELD, _peaks_along)(ray, sources, index);
    floatv all_from[MOST_PANELS], all_to[MOST_PANELS], integral;
    uint open = JOIN(FIELD, _panels)(&peaks, decay, all_from, all_to, &integral);
    uint cuts = 0, nodes = 0;
#ifdef FIRST_TWO
    nodes += 4 * GAUSS_PAIRS;
    if (JOIN(first_two_, FIELD)(&peaks, decay, threshold, all_to[1], &integral))
        open = 0;
    else
        integral = splat(0.0f);
#endif
    while (open > 0) {
        --open;
        const floatv from = all_from[open], to = all_to[open];
        const intv is_empty = to - from < SHORTEST_PANEL;
        if (!any_lane(!is_empty))
            continue;
        const floatv end = max(to, from + SHORTEST_PANEL);
        floatv value = splat(0.0f);
        intv is_done = is_empty;
        if (cuts > 0)
            is_done |= JOIN(FIELD, _closed)(&peaks, decay, from, end, &value);
        if (any_lane(!is_done)) {
            JOIN(panel_of_, FIELD) opened = JOIN(open_, FIELD)(&peaks, decay, from, end);
            const PanelSum panel = JOIN(sum_, FIELD)(&peaks, decay, &opened);
            nodes += 2 * GAUSS_PAIRS;
            value = select(panel.integral, value, is_done);
            const floatv allowed = threshold * (integral + value);
            const intv is_unseen = panel.is_broken & (BEYOND_NODES * value > allowed);
            const intv is_rough = (panel.unresolved2 > allowed * allowed) | is_unseen;
            if (cuts < MOST_CUTS && open + 2 <= MOST_PANELS && any_lane(is_rough & !is_done)) {
                const floatv cut = JOIN(FIELD, _split)(&peaks, from, end, panel.middle);
                all_from[open] = cut, all_to[open] = to;
                all_from[open + 1] = from, all_to[open + 1] = min(cut, to);
                open += 2;
                ++cuts;
                continue;
            }
        }
        integral += select(value, splat(0.0f), is_empty);
    }
#ifdef COUNT_NODES
    return splat((float)nodes);
#endif
    return integral;
}
