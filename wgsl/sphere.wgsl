// A point of light (Watanabe, Abe, Konno 2015, eq. 2).
struct Sphere { center: vec4f, light: Light }

fn sphere_light(ray: Ray, sphere: Sphere) -> f32 {
    return integral_over(to_point(ray, sphere.center.xyz, sphere.light), sphere.light, evenly_lit(0.0, ray.end));
}
