// Written by energywave, MIT OR Apache-2.0.
// Light along a ray, the integral of field times decay: linear RGB before tone mapping.

// The scene's values. Before each field its offset in bytes.
struct Wave {
    /* 0 */ rays: vec4f, // |E - S|; beta |E - S|, or 0 without decay; what multiplies all light;
                         // no squared distance to a core is taken below the last
    /* 16 */ eye: vec4f, // last 1, or 0 where rays are parallel
    /* 32 */ corner: vec4f, // from the eye to the top left corner of the plane; last kappa
    /* 48 */ across: vec4f, // from there to the top right corner
    /* 64 */ down: vec4f, // and to the bottom left corner
    /* 80 */ forward: vec4f, // where parallel rays go
    /* 96 */ spheres: array<Sphere, 2>,
    /* 192 */ beams: array<Beam, 2>,
} // 352 bytes
@group(2) @binding(0) var<uniform> wave: Wave;

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

// Returns what is left of light at a place.
fn fading(x: f32) -> f32 {
    let n = nearness(x);
    return n * n;
}

// Integrals without a closed form: 16 Gauss-Legendre nodes on each side of the place p where a ray is nearest to a core,
// in v of x = p + width sinh(v), width the distance there, in which 1/q is flat and its powers are bells of width 1.
// The error is within 1e-2 of a pixel's brightest channel; on a core of 1/q^2 without a radius it is 0.2 and more.
const NODES = array<f32, 8>(
    0.095012510, 0.281603551, 0.458016778, 0.617876244,
    0.755404408, 0.865631202, 0.944575023, 0.989400935
);
const WEIGHTS = array<f32, 8>(
    0.189450610, 0.182603415, 0.169156519, 0.149595989,
    0.124628971, 0.095158512, 0.062253524, 0.027152459
);

// Where a ray is nearest, and the distance there.
struct Peak { place: f32, width: f32 }

// Returns the v of a place.
fn mapped(place: f32, peak: Peak) -> f32 {
    let x = (place - peak.place) / peak.width;
    return sign(x) * log(abs(x) + sqrt(x * x + 1.0));
}

// Returns field times decay, from the squared distance with softening, and the place on the ray.
fn faded_field(softened2: f32, x: f32, light: Light) -> f32 {
    let bare2 = max(softened2 - light.core.x, 0.0);
    let per_q = inverseSqrt(max(softened2, wave.rays.w));
    var field = per_q * select(1.0, per_q, light.color.w > 0.0) * select(1.0, per_q, light.color.w > 1.0);
    if (light.color.w > 2.0) {
        field = exp(-bare2 * light.core.w);
    }
    let window = max(1.0 - bare2 * light.core.y, 0.0);
    return wave.rays.z * fading(x) * field * window * window;
}

// The integral of decay times field over a stretch of a ray, in closed form (Abe, Watanabe 2010, eq. 8; Sakai 2006 for
// the square; Watanabe, Abe, Konno 2015, eq. 21 for the decay). The light may grow linearly over the stretch.
//
// With n = b / (x + b), b = beta |E - S|, or 1 without decay, and dv = n^2 dx, f = n q has a square that is a quadratic
// a v^2 + .. in v. Over the advance D of v, F the sum of f at both ends, and m = sqrt(a) D / F, the integral of dv / f is
// 2 artanh(m) / sqrt(a): no difference of large terms is left.
struct Stretch { from_: f32, to: f32, light_from: f32, light_to: f32 }

// Light that ends at a reach h, of a field times (1 - (d/h)^2)^2, the profiles beside 1/q and 1/q^2, and light that fades
// otherwise than by n^2: 16 nodes in x where q^2 hardly changes, else in v of x = sqrt(m) sinh(v), q^2 = x^2 + m, on each
// side of where q is least.
fn shaped_panel(q: Quadratic, light: Light, stretch: Stretch, begin: f32, end: f32, is_flat: bool) -> f32 {
    var nodes = NODES;
    var weights = WEIGHTS;
    let growth = (stretch.light_to - stretch.light_from) / (stretch.to - stretch.from_);
    let root = sqrt(q.least);
    var sum = 0.0;
    for (var k = 0; k < 16; k++) {
        let node = select(nodes[k % 8], -nodes[k % 8], k < 8);
        let at = 0.5 * (begin + end) + 0.5 * (end - begin) * node;
        var x = at;
        var ahead = q.rate * (at - q.nearest);
        var slope = 1.0;
        if (!is_flat) {
            let grown = exp(at);
            ahead = 0.5 * root * (grown - 1.0 / grown);
            x = clamp(q.nearest + ahead / q.rate, stretch.from_, stretch.to);
            slope = 0.5 * root * (grown + 1.0 / grown) / q.rate;
        }
        let lit = stretch.light_from + growth * (x - stretch.from_);
        sum += weights[k % 8] * lit * slope * faded_field(ahead * ahead + q.least, x, light);
    }
    return 0.5 * (end - begin) * sum;
}

// Returns the integral over a stretch, as far as there is light.
fn shaped_over(q: Quadratic, light: Light, whole: Stretch) -> f32 {
    let end2 = light.core.x + light.core.z;
    let half = sqrt(max(end2 - q.least, 0.0)) / max(q.rate, 1e-18);
    let from_ = max(whole.from_, q.nearest - half);
    let to = min(whole.to, q.nearest + half);
    if (to <= from_ || end2 <= q.least) {
        return 0.0;
    }
    let growth = (whole.light_to - whole.light_from) / (whole.to - whole.from_);
    let light_from = whole.light_from + growth * (from_ - whole.from_);
    let stretch = Stretch(from_, to, light_from, whole.light_from + growth * (to - whole.from_));
    let x0 = q.rate * (from_ - q.nearest);
    let x1 = q.rate * (to - q.nearest);
    let middle = 0.5 * (x0 + x1);
    let is_flat = (x1 - x0) * (x1 - x0) < 1.3 * (middle * middle + q.least);
    if (is_flat) {
        return shaped_panel(q, light, stretch, from_, to, true);
    }
    let peak = Peak(q.nearest, sqrt(q.least) / q.rate);
    let place = mapped(clamp(q.nearest, from_, to), peak);
    return shaped_panel(q, light, stretch, mapped(from_, peak), place, false)
        + shaped_panel(q, light, stretch, place, mapped(to, peak), false);
}

// Returns the integral over a stretch, for a coefficient of 1.
fn integral_over(q: Quadratic, light: Light, stretch: Stretch) -> f32 {
    if (stretch.to <= stretch.from_) {
        return 0.0;
    }
    return shaped_over(q, light, stretch);
}

fn evenly_lit(from_: f32, to: f32) -> Stretch {
    return Stretch(from_, to, 1.0, 1.0);
}

// A point of light (Watanabe, Abe, Konno 2015, eq. 2).
struct Sphere { center: vec4f, light: Light }

fn sphere_light(ray: Ray, sphere: Sphere) -> f32 {
    return integral_over(to_point(ray, sphere.center.xyz, sphere.light), sphere.light, evenly_lit(0.0, ray.end));
}

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

// Returns the light along a ray: linear RGB. The direction is of length 1, depth the length at which
// the ray is hidden, world units from its origin.
fn wave_light(origin: vec3f, direction: vec3f, depth: f32) -> vec3f {
    let ray = Ray(origin, direction, clamp(depth, 0.0, wave.rays.x));
    var light = vec3f(0.0);
    for (var i = 0; i < 2; i++) {
        light += sphere_light(ray, wave.spheres[i]) * wave.spheres[i].light.color.rgb;
    }
    for (var i = 0; i < 2; i++) {
        light += beam_light(ray, wave.beams[i]) * wave.beams[i].light.color.rgb;
    }
    return light;
}

// The picture by the scene's own camera.
#import bevy_sprite::mesh2d_vertex_output::VertexOutput

@fragment
fn fragment(mesh: VertexOutput) -> @location(0) vec4<f32> {
    let on_plane = wave.corner.xyz + mesh.uv.x * wave.across.xyz + mesh.uv.y * wave.down.xyz; // seen from the eye
    let light = wave_light(wave.eye.xyz + on_plane, normalize(on_plane), wave.rays.x);
    return vec4<f32>(1.0 - exp(-light), 1.0);
}
