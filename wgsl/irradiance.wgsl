// The light that cores cast on surfaces, E = integral of I' max(0, n.y) / (|y|^2 + radius^2)^(3/2) over a core, y from the
// place to the core, n the normal. Nothing is hidden but what is below the horizon.
//
// With y.T = p at the parameter 0 of a line along T, h = y - p T, u = t + p and R = sqrt(h^2 + radius^2 + u^2), the
// integral over u of (n.h + u n.T) / R^3 is n.h [u/R] / (h^2 + radius^2) - n.T [1/R].
struct PointLight {
    place: vec4f, // last the squared radius
    light: vec4f, // intensity
}

struct LineLight {
    place: vec4f, // of the parameter 0; last the squared radius
    along: vec4f,
    range: vec4f, // parameters of the ends
    light: vec4f, // intensity of a unit of length
}

// Returns the irradiance by a point of intensity 1.
fn point_irradiance(y: vec3f, normal: vec3f, radius2: f32) -> f32 {
    let per_distance = inverseSqrt(dot(y, y) + radius2);
    return max(dot(normal, y), 0.0) * per_distance * per_distance * per_distance;
}

// Returns the irradiance by a part of a line of intensity 1 a length, y to its parameter 0.
fn line_irradiance(y: vec3f, normal: vec3f, along: vec3f, range: vec2f, radius2: f32) -> f32 {
    let rise = dot(normal, along);
    let horizon = -dot(normal, y) / select(rise, 1e-20, abs(rise) < 1e-20);
    let begin = select(range.x, max(range.x, horizon), rise >= 1e-20);
    let end = select(range.y, min(range.y, horizon), rise <= -1e-20);
    if (end <= begin) {
        return 0.0;
    }
    let p = dot(y, along);
    let beside = y - p * along;
    let h2 = dot(beside, beside) + radius2;
    let u0 = begin + p;
    let u1 = end + p;
    let r0 = sqrt(u0 * u0 + h2);
    let r1 = sqrt(u1 * u1 + h2);
    // Differences of numbers of one sign, without cancelling.
    var sines = (u1 / r1 - u0 / r0) / h2;
    if ((u0 > 0.0) == (u1 > 0.0)) {
        sines = (u1 - u0) / r0 * (u1 + u0) / (r1 * (u1 * r0 + u0 * r1));
    }
    let inverses = (u0 - u1) / r0 * (u1 + u0) / (r1 * (r0 + r1));
    return max(dot(normal, beside) * sines - rise * inverses, 0.0);
}
