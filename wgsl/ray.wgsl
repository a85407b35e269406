// What all kinds of source share: rays, and squared distances along them. All lengths are world units.
//
// Along a ray, at the length x from its origin, the squared distance to a point or to a straight line is a quadratic,
// kept as (rate (x - nearest))^2 + least, in which nothing cancels near the least (Abe, Watanabe 2010, eq. 8).
struct Ray { origin: vec3f, direction: vec3f, end: f32 }

struct Light {
    color: vec4f, // linear RGB times coefficient and measure; last 0 for 1/q, 1 for 1/q^2, 2 for 1/q^3, 3 for a Gaussian
    core: vec4f,  // the squared radius, and softening, of q^2 = d^2 + radius^2; 1 over the squared reach, or 0; the squared
                  // distance where light ends; 1 over twice the squared width of a Gaussian
}

struct Quadratic { rate: f32, nearest: f32, least: f32 }

// Returns the squared distance to a point.
fn to_point(ray: Ray, point: vec3f, light: Light) -> Quadratic {
    let start = ray.origin - point;
    let rough = -dot(start, ray.direction);
    let beside = start + rough * ray.direction;
    let rest = -dot(beside, ray.direction);
    let closest = beside + rest * ray.direction;
    return Quadratic(1.0, rough + rest, max(dot(closest, closest) + light.core.x, wave.rays.w));
}

// Returns the squared distance to a line: |(P - M) x D|^2, a cross product, where the difference of squares of 2015,
// eq. 3 would cancel.
fn to_line(ray: Ray, point: vec3f, direction: vec3f, light: Light) -> Quadratic {
    let start = cross(ray.origin - point, direction);
    let span = cross(ray.direction, direction);
    let rate2 = dot(span, span);
    let per_rate2 = 1.0 / max(rate2, 1e-12);
    let rough = -dot(start, span) * per_rate2;
    let beside = cross(ray.origin - point + rough * ray.direction, direction);
    let rest = -dot(beside, span) * per_rate2;
    let closest = beside + rest * span;
    return Quadratic(sqrt(rate2), rough + rest, max(dot(closest, closest) + light.core.x, wave.rays.w));
}

// Returns where a value that is linear along a ray is 0; a ray where it never is stays on its side.
fn zero_along(at: f32, slope: f32, end: f32) -> f32 {
    return clamp(-at / select(slope, 1e-30, abs(slope) < 1e-30), 0.0, end);
}

// Returns n, whose powers are decays.
fn nearness(x: f32) -> f32 {
    return select(1.0, wave.rays.y / (x + wave.rays.y), wave.rays.y > 0.0);
}
