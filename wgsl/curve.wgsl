// A quadratic curve of light, M + V t + A t^2 for t from -1/2 to 1/2: a field of the nearest point (Watanabe, Abe, Konno
// 2015, eq. 8-13).
struct Curve {
    middle: vec4f,   // last the first row of its series
    velocity: vec4f, // last how many rows that has
    second: vec4f,
    light: Light,
}

// Returns both t where |w + V t + A t^2|^2 may be least. Half its slope is a cubic that rises left of its turning points,
// and curves down there, and rises right of them, and curves up: Newton's steps from the ends never overshoot.
fn minima(w: vec3f, v: vec3f, a: vec3f) -> vec2f {
    let c3 = 2.0 * dot(a, a);
    let c2 = 3.0 * dot(a, v);
    let c1 = dot(v, v) + 2.0 * dot(w, a);
    let c0 = dot(w, v);
    let spread = c2 * c2 - 3.0 * c3 * c1;
    let h = -(c2 + select(-1.0, 1.0, c2 >= 0.0) * sqrt(max(spread, 0.0)));
    let turn = h / max(3.0 * c3, 1e-30);
    let other = select(turn, c1 / select(h, 1e-30, h == 0.0), spread > 0.0);
    let left = clamp(min(turn, other), -0.5, 0.5);
    let right = clamp(max(turn, other), -0.5, 0.5);
    var t = vec2f(-0.5, 0.5);
    for (var step = 0; step < 10; step++) {
        let cubic = ((c3 * t + c2) * t + c1) * t + c0;
        let slope = max((3.0 * c3 * t + 2.0 * c2) * t + c1, vec2f(1e-30));
        t -= vec2f(min(cubic.x, 0.0), max(cubic.y, 0.0)) / slope;
        t = vec2f(clamp(t.x, -0.5, left), clamp(t.y, right, 0.5));
    }
    // Where it does not come to rise there is but the other one.
    let at_left = ((c3 * left + c2) * left + c1) * left + c0;
    let at_right = ((c3 * right + c2) * right + c1) * right + c0;
    return select(select(t, t.yy, at_left < 0.0), t.xx, at_left >= 0.0 && at_right > 0.0);
}

fn curve_at(curve: Curve, t: f32) -> vec3f {
    return curve.middle.xyz + t * (curve.velocity.xyz + t * curve.second.xyz);
}

// Returns the t of the point of a curve that is nearest.
fn curve_nearest(curve: Curve, point: vec3f) -> f32 {
    let t = minima(curve.middle.xyz - point, curve.velocity.xyz, curve.second.xyz);
    let first = curve_at(curve, t.x) - point;
    let last = curve_at(curve, t.y) - point;
    return select(t.y, t.x, dot(first, first) < dot(last, last));
}

fn curve_distance2(curve: Curve, point: vec3f) -> f32 {
    let beside = curve_at(curve, curve_nearest(curve, point)) - point;
    return dot(beside, beside);
}

fn across(v: vec3f, direction: vec3f) -> vec3f {
    return v - dot(v, direction) * direction;
}

// A ray passes a curve where the curve as the ray sees it is nearest, at most twice. Between both passes it is cut where
// the nearest point jumps from one to the other, found by halving.
fn curve_light(ray: Ray, curve: Curve) -> f32 {
    let d = ray.direction;
    let t = minima(across(curve.middle.xyz - ray.origin, d), across(curve.velocity.xyz, d), across(curve.second.xyz, d));
    let of_first = curve_at(curve, t.x) - ray.origin;
    let of_last = curve_at(curve, t.y) - ray.origin;
    let is_turned = dot(of_last - of_first, d) < 0.0;
    let passes = select(t, t.yx, is_turned);
    let near = select(of_first, of_last, is_turned);
    let far = select(of_last, of_first, is_turned);
    var from_ = clamp(dot(near, d), 0.0, ray.end);
    var to = clamp(dot(far, d), 0.0, ray.end);
    for (var step = 0; step < 12; step++) {
        let middle = 0.5 * (from_ + to);
        let seen = curve_nearest(curve, ray.origin + middle * d);
        if (abs(seen - passes.x) < abs(seen - passes.y)) {
            from_ = middle;
        } else {
            to = middle;
        }
    }
    let first = peak_at(dot(near, d), dot(across(near, d), across(near, d)), curve.light);
    let last = peak_at(dot(far, d), dot(across(far, d), across(far, d)), curve.light);
    return curve_stretch(ray, curve, first, 0.0, from_) + curve_stretch(ray, curve, last, from_, ray.end);
}
