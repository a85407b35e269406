// A ring of light: a field of (rho - R)^2 + z^2, rho the distance to the axis, z the height over the plane
// (Watanabe, Abe, Konno 2015, eq. 7).
struct Torus {
    center: vec4f, // last the radius R
    axis: vec4f,
    light: Light,
}

fn torus_distance2(torus: Torus, point: vec3f) -> f32 {
    let beside = point - torus.center.xyz;
    let z = dot(beside, torus.axis.xyz);
    let from_ring = length(beside - z * torus.axis.xyz) - torus.center.w;
    return from_ring * from_ring + z * z;
}

fn torus_field(torus: Torus, ray: Ray, x: f32) -> f32 {
    return faded_field(torus_distance2(torus, ray.origin + x * ray.direction) + torus.light.core.x, x, torus.light);
}

// Comes closer to where the ray is nearest to the ring on one side of the cut, by Newton's steps: half the slope of the
// squared distance is P.D - R rho'.
fn torus_pass(torus: Torus, ray: Ray, rough: f32, from_: f32, to: f32) -> f32 {
    let rise = dot(ray.direction, torus.axis.xyz);
    var x = clamp(rough, from_, to);
    for (var step = 0; step < 4; step++) {
        let p = ray.origin + x * ray.direction - torus.center.xyz;
        let z = dot(p, torus.axis.xyz);
        let per_rho = 1.0 / max(length(p - z * torus.axis.xyz), 1e-6 * torus.center.w);
        let growth = (dot(p, ray.direction) - z * rise) * per_rho;
        let bend = 1.0 - torus.center.w * (1.0 - rise * rise - growth * growth) * per_rho;
        x = clamp(x - (dot(p, ray.direction) - torus.center.w * growth) / max(bend, 0.1), from_, to);
    }
    return x;
}

// In complex x the squared distance is (rho - R + i z)(rho - R - i z), 0 where |P|^2 = R^2 + 2 i R z: the two roots of that
// quadratic are both passes at the ring. Where the ray is nearest to the axis rho has a kink: there it is cut.
fn torus_light(ray: Ray, torus: Torus) -> f32 {
    let radius = torus.center.w;
    let start = ray.origin - torus.center.xyz;
    let middle = -dot(start, ray.direction);
    let beside = start + middle * ray.direction;
    let slope = dot(ray.direction, torus.axis.xyz);
    let z = dot(beside, torus.axis.xyz);
    let square = vec2f(radius * radius * (1.0 - slope * slope) - dot(beside, beside), 2.0 * radius * z);
    let size = length(square);
    let root = sqrt(0.5 * vec2f(size + abs(square.x), max(size - abs(square.x), 0.0)));
    let apart = select(root.y, root.x, square.x > 0.0);
    let span = cross(ray.direction, torus.axis.xyz);
    let cut = clamp(-dot(cross(start, torus.axis.xyz), span) / max(dot(span, span), 1e-12), 0.0, ray.end);
    let first = torus_pass(torus, ray, middle - apart, 0.0, cut);
    let last = torus_pass(torus, ray, middle + apart, cut, ray.end);
    let of_first = peak_at(first, torus_distance2(torus, ray.origin + first * ray.direction), torus.light);
    let of_last = peak_at(last, torus_distance2(torus, ray.origin + last * ray.direction), torus.light);
    return torus_stretch(ray, torus, of_first, 0.0, cut) + torus_stretch(ray, torus, of_last, cut, ray.end);
}
