// An infinite line of light (Watanabe, Abe, Konno 2015, eq. 3).
struct Cylinder { point: vec4f, direction: vec4f, light: Light }

fn cylinder_light(ray: Ray, cylinder: Cylinder) -> f32 {
    let q = to_line(ray, cylinder.point.xyz, cylinder.direction.xyz, cylinder.light);
    return integral_over(q, cylinder.light, evenly_lit(0.0, ray.end));
}
