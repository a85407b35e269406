// The integral of the field of a KIND times the decay, to a relative error: Gauss-Legendre quadrature on mapped panels
// (panel.h). Two null rules on the same nodes, the highest Legendre coefficients that they see, tell how well a panel
// is resolved; one that is not is cut in two, in all lanes. A kind without closed form includes this
// file at the end of its own header, where it has defined KIND: that makes its KIND_integral, torus_integral for
// instance.
//
// The host gives the positive nodes of the rule, the outermost first, their weights and those of the null rules as
// GAUSS_..., and as `threshold` how large the coefficients may be, of the integral.

// Cuts of a ray's panels in all, panels that may be open at once, by which factor errors may grow with every cut of the
// second half, how much worse than its nodes tell a panel with kinks may be, and the share of the first estimate
// that errors may be measured by.
#ifndef MOST_CUTS
#define MOST_CUTS 64
#endif
#define MOST_PANELS 24
#define PATIENCE 1.25f
#define DOUBT 30.0f
#define FIRST_ESTIMATE 0.25f

// Pairs of nodes whose fields are taken side by side: all for vectors, whose lanes do not hide what an operation waits
// for; one where work-items do that and registers are few.
#ifndef PAIRS_AT_ONCE
#if LANES == 1
#define PAIRS_AT_ONCE 1
#else
#define PAIRS_AT_ONCE GAUSS_PAIRS
#endif
#endif

typedef struct {
    KIND_near near;
    Panel map;
    floatv base, from, to;
    floatv doubt; // how many times worse it may be than its nodes tell
} KIND_panel;

INLINE KIND_panel KIND_open_panel(const KIND_peaks *const peaks, const Decay decay, const floatv from,
                                  const floatv to) {
    KIND_panel panel;
    Peak peak;
    panel.near = KIND_approach(peaks, from, to, &peak, &panel.base);
    panel.map = mapped_panel(decay, peak, from, to, panel.base);
    panel.from = from, panel.to = to;
    panel.doubt = select(splat(1.0f), splat(DOUBT), peak.is_flat);
    return panel;
}

INLINE PanelSum KIND_sum_panel(const KIND_peaks *const peaks, const Decay decay, KIND_panel *const panel) {
    const float node[GAUSS_PAIRS] = GAUSS_NODES;
    const float weight[GAUSS_PAIRS] = GAUSS_WEIGHTS;
    const float null_even[GAUSS_PAIRS] = GAUSS_NULL_EVEN;
    const float null_odd[GAUSS_PAIRS] = GAUSS_NULL_ODD;
    const Panel *const map = &panel->map;
    floatv sum = splat(0.0f), even = splat(0.0f), odd = splat(0.0f);
#if KIND_HAS(jumps)
    KIND_view view = KIND_view_from(peaks, panel->from, panel->to);
#endif
#if PAIRS_AT_ONCE == 1
#pragma unroll 1
#endif
    for (int begin = 0; begin < GAUSS_PAIRS; begin += PAIRS_AT_ONCE) {
        // All nodes first, then the field at all of them: chains of operations that do not wait for each other.
        floatv right_s[PAIRS_AT_ONCE], left_s[PAIRS_AT_ONCE], right_v[PAIRS_AT_ONCE], left_v[PAIRS_AT_ONCE];
#pragma unroll
        for (int k = 0; k < PAIRS_AT_ONCE; ++k) {
            const floatv grown = power_of_two(map->half_length * node[begin + k]), shrunk = coarse_inverse(grown);
            const floatv right_up = map->rising * grown, right_down = map->falling * shrunk;
            const floatv left_up = map->rising * shrunk, left_down = map->falling * grown;
            const floatv right_x = map->middle + (right_up - right_down), left_x = map->middle + (left_up - left_down);
            right_s[k] = parameter_of(map, right_x);
            left_s[k] = parameter_of(map, left_x);
            right_v[k] = right_up + right_down;
            left_v[k] = left_up + left_down;
#ifdef FADING
            right_v[k] *= fading_beside(decay, map, right_x, right_s[k]);
            left_v[k] *= fading_beside(decay, map, left_x, left_s[k]);
#endif
        }
#if KIND_HAS(look_ahead)
        KIND_look_ahead(&panel->near, left_s, right_s, PAIRS_AT_ONCE);
#endif
#if KIND_HAS(jumps)
        KIND_node_sight right_sight[PAIRS_AT_ONCE], left_sight[PAIRS_AT_ONCE];
#endif
#pragma unroll
        for (int k = 0; k < PAIRS_AT_ONCE; ++k) {
            const floatv right = right_v[k] * summand_of(KIND_near_field(&panel->near, right_s[k]));
#if KIND_HAS(jumps)
            right_sight[k] = panel->near.sight;
#endif
            const floatv left = left_v[k] * summand_of(KIND_near_field(&panel->near, left_s[k]));
#if KIND_HAS(jumps)
            left_sight[k] = panel->near.sight;
#endif
            const floatv both = right + left;
            sum = fma(both, splat(weight[begin + k]), sum);
            even = fma(both, splat(null_even[begin + k]), even);
            odd = fma(right - left, splat(null_odd[begin + k]), odd);
        }
#if KIND_HAS(jumps)
        if (KIND_has_view(peaks)) {
#pragma unroll
            for (int k = 0; k < PAIRS_AT_ONCE; ++k) {
                KIND_see(&view, &view.right, right_sight[k], right_v[k] * weight[begin + k], begin + k);
                KIND_see(&view, &view.left, left_sight[k], left_v[k] * weight[begin + k], begin + k);
            }
        }
#endif
    }
    const floatv scale = LN_2 * decay.strength * map->half_length;
    const floatv middle = panel->base + parameter_of(map, map->middle + (map->rising - map->falling));
#if KIND_HAS(jumps)
    const floatv unseen = scale * KIND_unseen(peaks, &view, sum);
#else
    const floatv unseen = splat(0.0f);
#endif
    const PanelSum result = {scale * sum, size_of_unresolved(panel->doubt * scale, even, odd),
                             clamp(middle, panel->from, panel->to), unseen};
    return result;
}

#if KIND_HAS(two_panels)
#if LANES > 1
// Opens the halves of a panel in place of it, and returns which lanes have them; others are done with it.
INLINE intv KIND_halve(const PanelSum *const sum, const floatv from, const floatv to, const intv has_panel,
                       floatv *const all_from, floatv *const all_to) {
    const floatv cut = sum->middle;
    const intv is_cut = (cut > from) & (cut < to) & has_panel;
    all_from[0] = select(from, cut, is_cut), all_to[0] = select(from, to, is_cut);
    all_from[1] = from, all_to[1] = select(from, cut, is_cut);
    return is_cut;
}
#endif

// Integrates the two panels on both sides of a cut at once, so that one works while the other waits. Returns how many
// panels are open then, in the place of the two: of vectors the halves of each that a lane has not resolved.
// `integral` gets what is done, `estimate` everything.
INLINE uint KIND_two_panels(const KIND_peaks *const peaks, const Decay decay, const float threshold,
                            floatv *const all_from, floatv *const all_to, floatv *const integral,
                            floatv *const estimate, intv *const own_cuts) {
    const floatv begin = peaks->begin, cut = all_to[1], end = peaks->end;
#if LANES == 1
    // One after the other, from one copy of the code: other work-items work while one waits.
    floatv unresolved = 0.0f;
    *estimate = 0.0f;
#pragma unroll 1
    for (int k = 0; k < 2; ++k) {
        const floatv from = k == 0 ? begin : cut, to = k == 0 ? cut : end;
        if (is_empty_panel(decay, from, to))
            continue;
        KIND_panel panel = KIND_open_panel(peaks, decay, from, to);
        const PanelSum sum = KIND_sum_panel(peaks, decay, &panel);
        *estimate += sum.integral;
        unresolved = max(unresolved, sum.unresolved);
    }
    if (is_beyond(unresolved, threshold * *estimate))
        return 2;
    *integral = *estimate;
    return 0;
#else
    const intv has_first = !is_empty_panel(decay, begin, cut), has_second = !is_empty_panel(decay, cut, end);
    const floatv first_end = select(begin + 1.0f, cut, has_first), second_begin = select(splat(0.0f), cut, has_second);
    const floatv second_end = select(splat(1.0f), end, has_second);
    KIND_panel first = KIND_open_panel(peaks, decay, begin, first_end);
    KIND_panel second = KIND_open_panel(peaks, decay, second_begin, second_end);
    const PanelSum of_first = KIND_sum_panel(peaks, decay, &first);
    const PanelSum of_second = KIND_sum_panel(peaks, decay, &second);
    const floatv first_part = select(splat(0.0f), of_first.integral, has_first);
    const floatv second_part = select(splat(0.0f), of_second.integral, has_second);
    *estimate = first_part + second_part;
    const floatv allowed = threshold * *estimate;
    const intv first_is_rough = is_beyond(of_first.unresolved, allowed) & has_first;
    const intv second_is_rough = is_beyond(of_second.unresolved, allowed) & has_second;
    intv has_halves = (intv)(0);
    uint open = 0;
    if (MOST_CUTS > 0 && any_lane(second_is_rough)) {
        has_halves = KIND_halve(&of_second, cut, end, has_second, all_from, all_to);
        open = 2;
    }
    *integral = select(second_part, splat(0.0f), has_halves);
    has_halves = (intv)(0);
    if (MOST_CUTS > 0 && any_lane(first_is_rough)) {
        has_halves = KIND_halve(&of_first, begin, cut, has_first, all_from + open, all_to + open);
        open += 2;
    }
    *integral += select(first_part, splat(0.0f), has_halves);
    *own_cuts += select((intv)(0), (intv)(1), first_is_rough) + select((intv)(0), (intv)(1), second_is_rough);
    return open;
#endif
}
#endif

#if defined(SHAPES) && KIND_HAS(peaks_along)
// Trims panels to where there is light: from both ends at once, so that one search works while the other waits.
INLINE void KIND_trim(const KIND_peaks *const peaks, const uint count, floatv *const from, floatv *const to) {
    const floatv length = 2.0f * peaks->ray->length;
    const float end2 = peaks->path.profile.end2;
    for (uint k = 0; k < count; ++k) {
        const floatv first = from[k], last = to[k];
        if (!any_lane(last > first))
            continue;
        EdgeSearch begin = edge_search_from(first, 1.0f), end = edge_search_from(last, -1.0f);
        intv is_moving = (intv)(-1);
#pragma unroll 1
        for (int step = 0; step < EDGE_STEPS && any_lane(is_moving); ++step) {
            const EdgeView at_begin = KIND_edge_view(peaks, begin.s), at_end = KIND_edge_view(peaks, end.s);
            is_moving = step_to_edge(&begin, &at_begin, length, end2, first, last) |
                        step_to_edge(&end, &at_end, length, end2, first, last);
        }
        from[k] = clamp(begin.edge, first, last);
        to[k] = max(from[k], clamp(end.edge, first, last));
    }
}
#endif

INLINE floatv KIND_integral_of(const KIND_peaks *const all_peaks, const Quadrature *const quadrature) {
    const Decay decay = quadrature->decay;
#if KIND_HAS(kinks) || defined(FADING)
    float threshold = quadrature->kinked_threshold;
#else
    float threshold = quadrature->smooth_threshold;
#endif
    KIND_peaks peaks = *all_peaks;
#if defined(FADING) && KIND_HAS(peaks_along)
    peaks.end = min(peaks.end, darkness(decay));
    peaks.begin = min(peaks.begin, peaks.end);
#endif
    floatv all_from[MOST_PANELS], all_to[MOST_PANELS], integral;
    uint open = KIND_panels(&peaks, quadrature, all_from, all_to, &integral);
#if defined(SHAPES) && KIND_HAS(peaks_along)
    const bool has_end = HAS_END(&peaks.path.profile);
    if (has_end) {
        KIND_trim(&peaks, open, all_from, all_to);
        threshold = quadrature->kinked_threshold;
    }
#else
    const bool has_end = false;
#endif
    // Of every lane: what one cannot resolve is not to spoil its neighbours.
    floatv patience = splat(threshold);
    intv own_cuts = (intv)(0);
#if KIND_HAS(more_cuts)
    const uint most_cuts = MOST_CUTS + KIND_more_cuts(&peaks);
#else
    const uint most_cuts = MOST_CUTS;
#endif
    uint nodes = 0;
    bool has_cut = false;
    floatv estimate = integral;
#if KIND_HAS(two_panels)
    if (!has_end) {
        nodes += 4 * GAUSS_PAIRS;
        open = KIND_two_panels(&peaks, decay, threshold, all_from, all_to, &integral, &estimate, &own_cuts);
    }
#endif
    const uint all = open;
#if KIND_HAS(dark_parts)
    bool is_survey = KIND_is_uneven(&peaks);
#else
    bool is_survey = false;
#endif
    while (open > 0 || is_survey) {
        if (open == 0) {
            is_survey = false, open = all;
            continue;
        }
        --open;
        const floatv from = all_from[open];
        const intv is_empty = is_empty_panel(decay, from, all_to[open]);
        if (!any_lane(!is_empty))
            continue;
        const floatv to = select(all_to[open], splat(1.0f), is_empty);
        floatv value = splat(0.0f);
        intv is_done = is_empty;
#if KIND_HAS(closed_ends)
        if (has_cut)
            is_done |= KIND_closed(&peaks, quadrature, from, to, &value);
#endif
        if (any_lane(!is_done)) {
            KIND_panel opened = KIND_open_panel(&peaks, decay, from, to);
            const PanelSum panel = KIND_sum_panel(&peaks, decay, &opened);
            nodes += 2 * GAUSS_PAIRS;
            value = select(panel.integral, value, is_done);
            if (is_survey) {
                estimate += select(value, splat(0.0f), is_empty);
                continue;
            }
            const floatv allowed = patience * max(fabs(integral + value), FIRST_ESTIMATE * fabs(estimate));
            const intv is_rough = (is_beyond(panel.unresolved, allowed) | (panel.unseen > allowed)) & !is_done &
                                  (own_cuts < (intv)((int)most_cuts));
            if (open + 2 <= MOST_PANELS && any_lane(is_rough)) {
                // What is as short as float32 can tell stays whole.
                const intv is_cut = (panel.middle > from) & (panel.middle < to) & !is_done;
#if KIND_HAS(jumps)
                const floatv cut = KIND_split(&peaks, from, to, panel.middle);
#else
                const floatv cut = panel.middle;
#endif
                // Lanes that are done with the panel, or have it whole, find both halves empty.
                integral += select(value, splat(0.0f), is_empty | is_cut);
                all_from[open] = select(from, cut, is_cut), all_to[open] = select(from, to, is_cut);
                all_from[open + 1] = from, all_to[open + 1] = select(from, cut, is_cut);
                open += 2;
                has_cut = true;
                own_cuts += select((intv)(0), (intv)(1), is_rough);
                patience = select(patience, PATIENCE * patience, is_rough & (own_cuts > (intv)((int)most_cuts / 2)));
                continue;
            }
        }
        integral += select(value, splat(0.0f), is_empty);
    }
#ifdef COUNT_NODES
    atomic_add(quadrature->counts + COUNT_NODES_TAKEN, nodes * LANES);
#endif
    return integral;
}

#if KIND_HAS(peaks_along)
PER_RAY floatv KIND_integral(const Ray *const ray, const Sources *const sources, const uint index,
                             const Quadrature *const quadrature) {
    const KIND_peaks peaks = KIND_peaks_along(ray, sources, index);
    return KIND_integral_of(&peaks, quadrature);
}
#endif
