// Returns the integral over a stretch, for a coefficient of 1.
fn integral_over(q: Quadratic, light: Light, stretch: Stretch) -> f32 {
    if (stretch.to <= stretch.from_) {
        return 0.0;
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
