// Light that ends at a reach h, of a field times (1 - (d/h)^2)^2, the profiles beside 1/q and 1/q^2, and light that fades
// otherwise than by n^2: 16 nodes in x where q^2 hardly changes, else in v of x = sqrt(m) sinh(v), q^2 = x^2 + m, on each
// side of where q is least.
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

// Returns the integral by twice as many nodes, for light that also fades.
fn shaped_halves(q: Quadratic, light: Light, stretch: Stretch, begin: f32, end: f32, is_flat: bool) -> f32 {
    let middle = 0.5 * (begin + end);
    return shaped_panel(q, light, stretch, begin, middle, is_flat)
        + shaped_panel(q, light, stretch, middle, end, is_flat);
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
    let peak = Peak(q.nearest, sqrt(q.least) / q.rate);
    let place = mapped(clamp(q.nearest, from_, to), peak);
    return shaped_panel(q, light, stretch, mapped(from_, peak), place, false)
        + shaped_panel(q, light, stretch, place, mapped(to, peak), false);
}
