// A finite line of light: the field of its nearest point. The planes through its ends cut a ray into three stretches:
// past one end, past the line, past the other end.
struct Segment { first: vec4f, last: vec4f, direction: vec4f, light: Light }

fn segment_light(ray: Ray, segment: Segment) -> f32 {
    let slope = dot(ray.direction, segment.direction.xyz);
    let at_first = zero_along(dot(ray.origin - segment.first.xyz, segment.direction.xyz), slope, ray.end);
    let at_last = zero_along(dot(ray.origin - segment.last.xyz, segment.direction.xyz), slope, ray.end);
    let is_falling = slope <= -1e-30;
    let enters = min(at_first, at_last);
    let leaves = max(at_first, at_last);
    let near = to_point(ray, select(segment.first.xyz, segment.last.xyz, is_falling), segment.light);
    let far = to_point(ray, select(segment.last.xyz, segment.first.xyz, is_falling), segment.light);
    let line = to_line(ray, segment.first.xyz, segment.direction.xyz, segment.light);
    return integral_over(near, segment.light, evenly_lit(0.0, enters))
        + integral_over(line, segment.light, evenly_lit(enters, leaves))
        + integral_over(far, segment.light, evenly_lit(leaves, ray.end));
}
