// Returns how far there is light from a place towards another: chords of the squared distance over the squared length
// come close to where light ends.
fn KIND_lit(ray: Ray, source: TYPE, place: f32, towards: f32) -> f32 {
    if (source.light.core.z >= ENDLESS) {
        return towards;
    }
    let least2 = KIND_distance2(source, ray.origin + place * ray.direction);
    let left2 = source.light.core.z - least2;
    var way = towards - place;
    if (left2 <= 0.0 || way == 0.0) {
        return place;
    }
    for (var step = 0; step < 5; step++) {
        let rise = KIND_distance2(source, ray.origin + (place + way) * ray.direction) - least2;
        let further = abs(way) * sqrt(left2 / max(rise, 1e-12 * left2));
        way = sign(towards - place) * min(further, abs(towards - place));
    }
    return place + way;
}

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
        sum += weights[k % 8] * KIND_field(source, ray, x) * 0.5 * (grown + 1.0 / grown);
    }
    return half * peak.width * sum;
}

// Returns the integral over a stretch with one peak, or with its foot, as far as there is light.
fn KIND_stretch(ray: Ray, source: TYPE, peak: Peak, from_: f32, to: f32) -> f32 {
    if (peak.width * peak.width >= source.light.core.x + source.light.core.z) {
        return 0.0;
    }
    let place = clamp(peak.place, from_, to);
    return KIND_side(ray, source, peak, KIND_lit(ray, source, place, from_), place)
        + KIND_side(ray, source, peak, place, KIND_lit(ray, source, place, to));
}
