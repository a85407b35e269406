// A half-line of light from a tip (Abe, Watanabe 2010, eq. 6, 10-12): ahead of the plane through the tip its line, behind
// it a cap, the tip's own field, or the line's, fading over a taper (Sakai 2006, fig. 4.3); and a sphere everywhere.
struct Beam {
    tip: vec4f,
    direction: vec4f,
    parts: vec4f, // coefficients of line, cap and sphere; 1 over the length of the taper, or 0
    light: Light,
}

fn beam_light(ray: Ray, beam: Beam) -> f32 {
    let line = to_line(ray, beam.tip.xyz, beam.direction.xyz, beam.light);
    let tip = to_point(ray, beam.tip.xyz, beam.light);
    let height = dot(ray.origin - beam.tip.xyz, beam.direction.xyz);
    let slope = dot(ray.direction, beam.direction.xyz);
    let is_rising = slope > -1e-30;
    let cut = zero_along(height, slope, ray.end);
    let ahead = evenly_lit(select(0.0, cut, is_rising), select(cut, ray.end, is_rising));
    var light = beam.parts.x * integral_over(line, beam.light, ahead);
    if (beam.parts.w > 0.0) {
        let fade = height * beam.parts.w + 1.0; // 1 at the tip, 0 at the end of the taper
        let growth = slope * beam.parts.w;
        let end = zero_along(fade, growth, ray.end);
        let from_ = min(cut, end);
        let to = max(cut, end);
        let lit = clamp(vec2f(growth * from_ + fade, growth * to + fade), vec2f(0.0), vec2f(1.0));
        light += beam.parts.x * integral_over(line, beam.light, Stretch(from_, to, lit.x, lit.y));
    } else {
        let behind = evenly_lit(select(cut, 0.0, is_rising), select(ray.end, cut, is_rising));
        light += beam.parts.y * integral_over(tip, beam.light, behind);
    }
    return light + beam.parts.z * integral_over(tip, beam.light, evenly_lit(0.0, ray.end));
}
