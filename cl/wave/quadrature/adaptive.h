// The integral of the field of a KIND times the decay, to a relative error: Gauss-Legendre quadrature on mapped panels
// (panel.h). Two null rules on the same nodes, the highest Legendre coefficients that they see, tell how well a panel
// is resolved; one that is not is cut in two. A kind without closed form includes this file at the end of its own
// header, where it has defined KIND: that makes its KIND_integral, torus_integral for instance.
//
// The host gives the positive nodes of the rule, the outermost first, their weights and those of the null rules as
// GAUSS_..., and as `threshold` how large the coefficients may be, of the integral.

// Cuts of a ray's panels in all, by which factor errors may grow with every cut of the second half, how much worse than
// its nodes tell a panel with kinks may be, and the share of the first estimate that errors may be measured by.
#ifndef MOST_CUTS
#define MOST_CUTS 64
#endif
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
INLINE intv KIND_halve(OpenPanels *const open, const PanelSum *const sum, const floatv from, const floatv to,
                       const intv is_rough) {
    const floatv cut = sum->middle;
    const intv is_cut = (cut > from) & (cut < to) & is_rough;
    open_panel(open, cut, to, is_cut);
    open_panel(open, from, cut, is_cut);
    return is_cut;
}
#endif

// Integrates two panels, the later one being number 0, at once, so that one works while the other waits. Opens them
// again, of vectors the halves of each that a lane has not resolved, and returns what is done; `estimate` is
// everything.
INLINE floatv KIND_two_panels(const KIND_peaks *const peaks, const Decay decay, const float threshold,
                              const floatv *const from, const floatv *const to, OpenPanels *const open,
                              floatv *const estimate, intv *const own_cuts, uint *const nodes) {
#if LANES == 1
    // One after the other, from one copy of the code: other work-items work while one waits.
    floatv unresolved = 0.0f;
    *estimate = 0.0f;
#pragma unroll 1
    for (int k = 1; k >= 0; --k) {
        if (is_empty_panel(decay, from[k], to[k]))
            continue;
        KIND_panel panel = KIND_open_panel(peaks, decay, from[k], to[k]);
        const PanelSum sum = KIND_sum_panel(peaks, decay, &panel);
        *nodes += 2 * GAUSS_PAIRS;
        *estimate += sum.integral;
        unresolved = max(unresolved, sum.unresolved);
    }
    if (!is_beyond(unresolved, threshold * *estimate))
        return *estimate;
    for (int k = 0; k < 2; ++k)
        open_panel(open, from[k], to[k], !is_empty_panel(decay, from[k], to[k]));
    return 0.0f;
#else
    const intv has_first = !is_empty_panel(decay, from[1], to[1]), has_second = !is_empty_panel(decay, from[0], to[0]);
    if (!any_lane(has_first) || !any_lane(has_second)) { // there is but one
        open_panel(open, from[0], to[0], has_second);
        open_panel(open, from[1], to[1], has_first);
        return splat(0.0f);
    }
    *nodes += 4 * GAUSS_PAIRS;
    const floatv first_end = select(from[1] + 1.0f, to[1], has_first);
    const floatv second_begin = select(splat(0.0f), from[0], has_second);
    const floatv second_end = select(splat(1.0f), to[0], has_second);
    KIND_panel first = KIND_open_panel(peaks, decay, from[1], first_end);
    KIND_panel second = KIND_open_panel(peaks, decay, second_begin, second_end);
    const PanelSum of_first = KIND_sum_panel(peaks, decay, &first);
    const PanelSum of_second = KIND_sum_panel(peaks, decay, &second);
    const floatv first_part = select(splat(0.0f), of_first.integral, has_first);
    const floatv second_part = select(splat(0.0f), of_second.integral, has_second);
    *estimate = first_part + second_part;
    const floatv allowed = threshold * *estimate;
    const intv may_cut = (intv)(MOST_CUTS > 0 ? -1 : 0);
    const intv first_is_rough = is_beyond(of_first.unresolved, allowed) & has_first & may_cut;
    const intv second_is_rough = is_beyond(of_second.unresolved, allowed) & has_second & may_cut;
    const intv second_is_cut = KIND_halve(open, &of_second, from[0], to[0], second_is_rough);
    const intv first_is_cut = KIND_halve(open, &of_first, from[1], to[1], first_is_rough);
    *own_cuts -= first_is_rough + second_is_rough; // true is -1
    return select(second_part, splat(0.0f), second_is_cut) + select(first_part, splat(0.0f), first_is_cut);
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

#if KIND_HAS(dark_parts)
// Returns what the panels add up to by their nodes as they are.
INLINE floatv KIND_survey(const KIND_peaks *const peaks, const Decay decay, const uint count, const floatv *const from,
                          const floatv *const to, uint *const nodes) {
    floatv sum = splat(0.0f);
    for (uint k = count; k > 0; --k) {
        const intv is_empty = is_empty_panel(decay, from[k - 1], to[k - 1]);
        if (!any_lane(!is_empty))
            continue;
        KIND_panel opened = KIND_open_panel(peaks, decay, from[k - 1], select(to[k - 1], splat(1.0f), is_empty));
        const PanelSum panel = KIND_sum_panel(peaks, decay, &opened);
        *nodes += 2 * GAUSS_PAIRS;
        sum += select(panel.integral, splat(0.0f), is_empty);
    }
    return sum;
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
    floatv first_from[FIRST_PANELS], first_to[FIRST_PANELS], integral;
    const uint count = KIND_panels(&peaks, quadrature, first_from, first_to, &integral);
#if defined(SHAPES) && KIND_HAS(peaks_along)
    if (HAS_END(&peaks.path.profile)) {
        KIND_trim(&peaks, count, first_from, first_to);
        threshold = quadrature->kinked_threshold;
    }
#endif
    // Of every lane: what one cannot resolve is not to spoil its neighbours.
    floatv patience = splat(threshold), estimate = integral;
    intv own_cuts = (intv)(0);
#if KIND_HAS(more_cuts)
    const intv most_cuts = (intv)((int)(MOST_CUTS + KIND_more_cuts(&peaks)));
#else
    const intv most_cuts = (intv)(MOST_CUTS);
#endif
    OpenPanels open;
    open_none(&open);
    uint nodes = 0;
#if KIND_HAS(two_panels)
    integral += KIND_two_panels(&peaks, decay, threshold, first_from, first_to, &open, &estimate, &own_cuts, &nodes);
#else
    for (uint k = 0; k < count; ++k)
        open_panel(&open, first_from[k], first_to[k], !is_empty_panel(decay, first_from[k], first_to[k]));
#endif
#if KIND_HAS(dark_parts)
    if (KIND_is_uneven(&peaks))
        estimate += KIND_survey(&peaks, decay, count, first_from, first_to, &nodes);
#endif
    floatv from = splat(0.0f), to = splat(1.0f);
    intv is_open = next_panel(&open, (intv)(-1), &from, &to);
    while (any_lane(is_open)) {
        const intv is_empty = !is_open | is_empty_panel(decay, from, to);
        floatv value = splat(0.0f), cut = from;
        intv is_done = is_empty;
#if KIND_HAS(closed_ends)
        const intv may_be_closed = (own_cuts > 0) & !is_empty;
        if (any_lane(may_be_closed))
            is_done |= may_be_closed & KIND_closed(&peaks, quadrature, from, to, &value);
        value = select(splat(0.0f), value, is_done);
#endif
        intv is_cut = (intv)(0);
        if (any_lane(!is_done)) {
            KIND_panel opened = KIND_open_panel(&peaks, decay, from, select(to, splat(1.0f), is_empty));
            const PanelSum panel = KIND_sum_panel(&peaks, decay, &opened);
            nodes += 2 * GAUSS_PAIRS;
            value = select(panel.integral, value, is_done);
            const floatv allowed = patience * max(fabs(integral + value), FIRST_ESTIMATE * fabs(estimate));
            const intv is_rough = (is_beyond(panel.unresolved, allowed) | (panel.unseen > allowed)) & !is_done &
                                  (own_cuts < most_cuts) & (open.count + 2 <= MOST_PANELS);
            if (any_lane(is_rough)) {
                // What is as short as float32 can tell stays whole.
                is_cut = (panel.middle > from) & (panel.middle < to) & is_rough;
#if KIND_HAS(jumps)
                cut = KIND_split(&peaks, from, to, panel.middle);
#else
                cut = panel.middle;
#endif
                own_cuts += select((intv)(0), (intv)(1), is_rough);
                patience = select(patience, PATIENCE * patience, is_rough & (own_cuts > most_cuts / 2));
            }
        }
        integral += select(value, splat(0.0f), is_empty | is_cut);
        open_panel(&open, cut, to, is_cut);
        to = select(to, cut, is_cut);
        is_open = is_cut | next_panel(&open, !is_cut, &from, &to);
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
