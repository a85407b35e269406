// Returns the integral between two places on one side of a peak.
fn KIND_side(ray: Ray, source: TYPE, peak: Peak, from_: f32, to: f32) -> f32 {
    if (to <= from_) {
        return 0.0;
    }
    var nodes = NODES;
    var weights = WEIGHTS;
    let begin = mapped(from_, peak);
    let half = 0.5 * (mapped(to, peak) - begin);
    var sum = 0.0;
    for (var k = 0; k < 16; k++) {
        let node = select(nodes[k % 8], -nodes[k % 8], k < 8);
        let grown = exp(begin + half * (node + 1.0));
        let x = clamp(peak.place + 0.5 * peak.width * (grown - 1.0 / grown), from_, to);
        let field = faded_field(KIND_distance2(source, ray.origin + x * ray.direction), x, source.light);
        sum += weights[k % 8] * field * 0.5 * (grown + 1.0 / grown);
    }
    return half * peak.width * sum;
}

// Returns the integral over a stretch with one peak, or with its foot.
fn KIND_stretch(ray: Ray, source: TYPE, peak: Peak, from_: f32, to: f32) -> f32 {
    let place = clamp(peak.place, from_, to);
    return KIND_side(ray, source, peak, from_, place) + KIND_side(ray, source, peak, place, to);
}
