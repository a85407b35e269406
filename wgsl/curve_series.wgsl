// Returns the local intensity, a quadratic B-spline over t, in pieces c0 + c1 x + c2 x^2, x from 0 to 1 (Watanabe, Abe,
// Konno 2015, eq. 14-16).
fn curve_intensity(curve: Curve, t: f32) -> f32 {
    let count = curve.velocity.w;
    if (count < 1.0) {
        return 1.0;
    }
    let piece = clamp(floor((t + 0.5) * count), 0.0, count - 1.0);
    let x = (t + 0.5) * count - piece;
    let c = wave.series[i32(curve.middle.w + piece)];
    return (c.z * x + c.y) * x + c.x;
}

// Returns the field of the nearest point, times the intensity there.
fn curve_field(curve: Curve, ray: Ray, x: f32) -> f32 {
    let point = ray.origin + x * ray.direction;
    let t = curve_nearest(curve, point);
    let beside = curve_at(curve, t) - point;
    return curve_intensity(curve, t) * faded_field(dot(beside, beside) + curve.light.core.x, x, curve.light);
}
