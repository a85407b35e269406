// Light that ends at a reach h, of a field times (1 - (d/h)^2)^2, and the profiles beside 1/q and 1/q^2.
//
// Light that does not fade has a closed form for 1/q^2: with q^2 = x^2 + m, and E the q^2 at which it ends, the window is
// (E - q^2)^2 / h^4, and what is to be known are the integrals of q^-2, 1 and q^2. They cancel where q^2 hardly changes.
// There, and for all the rest, 16 nodes serve in x, or in v of x = sqrt(m) sinh(v) on each side of where q is least.
fn shaped_panel(q: Quadratic, light: Light, stretch: Stretch, begin: f32, end: f32, is_flat: bool) -> f32 {
    var nodes = NODES;
    var weights = WEIGHTS;
    let growth = (stretch.light_to - stretch.light_from) / (stretch.to - stretch.from_);
    let root = sqrt(q.least);
    var sum = 0.0;
    for (var k = 0; k < 16; k++) {
        let node = select(nodes[k % 8], -nodes[k % 8], k < 8);
        let at = 0.5 * (begin + end) + 0.5 * (end - begin) * node;
        var x = at;
        var ahead = q.rate * (at - q.nearest);
        var slope = 1.0;
        if (!is_flat) {
            let grown = exp(at);
            ahead = 0.5 * root * (grown - 1.0 / grown);
            x = clamp(q.nearest + ahead / q.rate, stretch.from_, stretch.to);
            slope = 0.5 * root * (grown + 1.0 / grown) / q.rate;
        }
        let lit = stretch.light_from + growth * (x - stretch.from_);
        sum += weights[k % 8] * lit * slope * faded_field(ahead * ahead + q.least, x, light);
    }
    return 0.5 * (end - begin) * sum;
}

// Returns the integral over a stretch, as far as there is light.
fn shaped_over(q: Quadratic, light: Light, whole: Stretch) -> f32 {
    let end2 = light.core.x + light.core.z;
    let half = sqrt(max(end2 - q.least, 0.0)) / max(q.rate, 1e-18);
    let from_ = max(whole.from_, q.nearest - half);
    let to = min(whole.to, q.nearest + half);
    if (to <= from_ || end2 <= q.least) {
        return 0.0;
    }
    let growth = (whole.light_to - whole.light_from) / (whole.to - whole.from_);
    let light_from = whole.light_from + growth * (from_ - whole.from_);
    let stretch = Stretch(from_, to, light_from, whole.light_from + growth * (to - whole.from_));
    let x0 = q.rate * (from_ - q.nearest);
    let x1 = q.rate * (to - q.nearest);
    let middle = 0.5 * (x0 + x1);
    let is_flat = (x1 - x0) * (x1 - x0) < 1.3 * (middle * middle + q.least);
    if (is_flat) {
        return shaped_panel(q, light, stretch, from_, to, true);
    }
    if (light.color.w == 1.0 && wave.rays.y == 0.0 && growth == 0.0) {
        let rest = (x0 * x0 + x0 * x1 + x1 * x1) / 3.0 + q.least - 2.0 * end2;
        let whole_field = end2 * end2 * inverse_square_over(ends_of(q, stretch), q) + light_from * rest * (to - from_);
        return wave.rays.z * light.core.y * light.core.y * whole_field;
    }
    let peak = Peak(q.nearest, sqrt(q.least) / q.rate);
    let place = mapped(clamp(q.nearest, from_, to), peak);
    return shaped_panel(q, light, stretch, mapped(from_, peak), place, false)
        + shaped_panel(q, light, stretch, place, mapped(to, peak), false);
}

// Returns the integral over a stretch, for a coefficient of 1.
fn integral_over(q: Quadratic, light: Light, stretch: Stretch) -> f32 {
    if (stretch.to <= stretch.from_) {
        return 0.0;
    }
    if (light.color.w > 1.0 || light.core.y > 0.0) {
        return shaped_over(q, light, stretch);
    }
    let ends = ends_of(q, stretch);
    if (light.color.w > 0.0) {
        return wave.rays.z * inverse_square_over(ends, q);
    }
    return wave.rays.z * inverse_over(ends, q);
}

fn evenly_lit(from_: f32, to: f32) -> Stretch {
    return Stretch(from_, to, 1.0, 1.0);
}
