// A ring of light: 1/q or 1/q^2 of (rho - R)^2 + z^2, rho the distance to the axis, z the height over the plane
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
    let first = middle - apart;
    let last = middle + apart;
    let of_first = peak_at(first, torus_distance2(torus, ray.origin + first * ray.direction), torus.light);
    let of_last = peak_at(last, torus_distance2(torus, ray.origin + last * ray.direction), torus.light);
    return torus_stretch(ray, torus, of_first, 0.0, cut) + torus_stretch(ray, torus, of_last, cut, ray.end);
}
