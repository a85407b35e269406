// Returns the field of a curve that is as bright everywhere.
fn curve_field(curve: Curve, ray: Ray, x: f32) -> f32 {
    return faded_field(curve_distance2(curve, ray.origin + x * ray.direction) + curve.light.core.x, x, curve.light);
}
