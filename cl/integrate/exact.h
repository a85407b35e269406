// The integral of the field named by FIELD times the decay, to a relative error: Gauss-Legendre quadrature on mapped
// panels (panel.h). Two null rules on the same nodes, the highest Legendre coefficients that they see, tell how well a
// panel is resolved; one that is not is halved, in all lanes. Included once for every field that has no closed form.
//
// The host gives the positive nodes of the rule, their weights and those of the null rules as GAUSS_..., and as
// `threshold` how large the coefficients may be, of the integral.

// Panels that may be open at once, halvings of a ray's panels in all, and the length in s below which a panel is left
// to the next one.
#ifndef MOST_ENDS
#define MOST_ENDS 24
#define MOST_HALVINGS 64
#define SHORTEST_PANEL 1e-6f
#endif

INLINE floatv JOIN(panel_of_, FIELD)(const JOIN(FIELD, _peaks) *const peaks, const Decay decay, const floatv from,
                                     const floatv to, floatv *const unresolved2, floatv *const middle) {
    const float node[GAUSS_PAIRS] = GAUSS_NODES;
    const float weight[GAUSS_PAIRS] = GAUSS_WEIGHTS;
    const float null_even[GAUSS_PAIRS] = GAUSS_NULL_EVEN;
    const float null_odd[GAUSS_PAIRS] = GAUSS_NULL_ODD;
    Peak peak;
    floatv base;
    const JOIN(FIELD, _near) near = JOIN(FIELD, _approach)(peaks, from, to, &peak, &base);
    const Panel panel = mapped_panel(decay, peak, from, to, base);
    floatv sum = splat(0.0f), even = splat(0.0f), odd = splat(0.0f);
    for (int k = 0; k < GAUSS_PAIRS; ++k) {
        const floatv grown = exponential(panel.half_length * node[k]), shrunk = inverse(grown);
        const floatv right_up = panel.rising * grown, right_down = panel.falling * shrunk;
        const floatv left_up = panel.rising * shrunk, left_down = panel.falling * grown;
        const floatv right_s = parameter_of(&panel, panel.middle + (right_up - right_down));
        const floatv left_s = parameter_of(&panel, panel.middle + (left_up - left_down));
        const floatv right = (right_up + right_down) * JOIN(FIELD, _near_field)(&near, right_s);
        const floatv left = (left_up + left_down) * JOIN(FIELD, _near_field)(&near, left_s);
        const floatv both = right + left;
        sum = fma(both, splat(weight[k]), sum);
        even = fma(both, splat(null_even[k]), even);
        odd = fma(right - left, splat(null_odd[k]), odd);
    }
    const floatv scale = decay.strength * panel.half_length;
    *unresolved2 = scale * scale * fma(even, even, odd * odd);
    *middle = clamp(base + parameter_of(&panel, panel.middle + (panel.rising - panel.falling)), from, to);
    return scale * sum;
}

INLINE floatv JOIN(exact_, FIELD)(const Ray *const ray, const Sources *const sources, const uint index,
                                  const Quadrature *const quadrature) {
    const Decay decay = quadrature->decay;
    const JOIN(FIELD, _peaks) peaks = JOIN(FIELD, _peaks_along)(ray, sources, index);
    floatv ends[MOST_ENDS];
    uint open = JOIN(FIELD, _cuts)(&peaks, ends);
    uint halvings = MOST_HALVINGS;
    floatv integral = splat(0.0f), from = splat(0.0f);
    uint nodes = 0;
    while (open > 0) {
        const floatv to = ends[open - 1];
        const intv is_empty = to - from < SHORTEST_PANEL;
        if (!any_lane(!is_empty)) {
            --open;
            continue;
        }
        const floatv end = max(to, from + SHORTEST_PANEL);
        floatv closed, unresolved2 = splat(0.0f), middle = from;
        const intv is_closed = JOIN(FIELD, _closed)(&peaks, decay, from, end, &closed);
        floatv value = closed;
        if (any_lane(!(is_closed | is_empty))) {
            const floatv open_value = JOIN(panel_of_, FIELD)(&peaks, decay, from, end, &unresolved2, &middle);
            value = select(open_value, closed, is_closed);
            nodes += 2 * GAUSS_PAIRS;
        }
        value = select(value, splat(0.0f), is_empty);
        const floatv allowed = quadrature->threshold * (integral + value);
        const intv is_rough = (unresolved2 > allowed * allowed) & !(is_closed | is_empty);
        if (halvings > 0 && open < MOST_ENDS && any_lane(is_rough)) {
            ends[open] = middle;
            ++open;
            --halvings;
        } else {
            integral += value;
            from = select(to, from, is_empty);
            --open;
        }
    }
#ifdef COUNT_NODES
    return splat((float)nodes);
#endif
    return integral;
}
