// The integral of decay times field over a stretch of a ray, in closed form (Abe, Watanabe 2010, eq. 8; Sakai 2006 for
// the square; Watanabe, Abe, Konno 2015, eq. 21 for the decay). The light may grow linearly over the stretch.
//
// With n = b / (x + b), b = beta |E - S|, or 1 without decay, and dv = n^2 dx, f = n q has a square that is a quadratic
// a v^2 + .. in v. Over the advance D of v, F the sum of f at both ends, and m = sqrt(a) D / F, the integral of dv / f is
// 2 artanh(m) / sqrt(a): no difference of large terms is left.
struct Stretch { from_: f32, to: f32, light_from: f32, light_to: f32 }

struct Ends {
    advance: f32, // of v
    n0: f32, n1: f32,
    l0: f32, l1: f32, // n times the light
    f0: f32, f1: f32, // n times the distance
    g: f32,           // has (f0 f1)^2 - g^2 = least (rate advance)^2
    a: f32,           // of f^2 = a v^2 + ..
}

fn ends_of(q: Quadratic, stretch: Stretch) -> Ends {
    let x0 = q.rate * (stretch.from_ - q.nearest);
    let x1 = q.rate * (stretch.to - q.nearest);
    var ends: Ends;
    ends.n0 = nearness(stretch.from_);
    ends.n1 = nearness(stretch.to);
    ends.advance = (stretch.to - stretch.from_) * ends.n0 * ends.n1;
    ends.l0 = ends.n0 * stretch.light_from;
    ends.l1 = ends.n1 * stretch.light_to;
    ends.f0 = ends.n0 * sqrt(x0 * x0 + q.least);
    ends.f1 = ends.n1 * sqrt(x1 * x1 + q.least);
    ends.g = ends.n0 * ends.n1 * (x0 * x1 + q.least);
    ends.a = q.rate * q.rate;
    if (wave.rays.y > 0.0) {
        let pole = q.rate * (wave.rays.y + q.nearest);
        ends.a = (pole * pole + q.least) / (wave.rays.y * wave.rays.y);
    }
    return ends;
}

// Returns the integral of the light times n / f over v.
fn inverse_over(ends: Ends, q: Quadratic) -> f32 {
    let sum = ends.f0 + ends.f1;
    let ratio = ends.advance / max(sum, 1e-30);
    let m2 = ends.a * ratio * ratio;
    // (artanh(m) / m - 1) / m^2: a series where m is small, else half the logarithm of (F + sqrt(a) D)^2 / (F^2 - a D^2),
    // where F^2 - a D^2 = 2 (f0 f1 + g).
    var excess = 1.0 / 21.0;
    for (var odd = 19; odd > 1; odd -= 2) {
        excess = excess * m2 + 1.0 / f32(odd);
    }
    if (m2 >= 0.2) {
        let whole = sum + sqrt(ends.a) * ends.advance;
        let turn = q.rate * ends.advance;
        var parts = vec2f(whole * whole, 2.0 * (ends.f0 * ends.f1 + ends.g));
        if (ends.g < 0.0) {
            parts = vec2f(whole * whole * (ends.f0 * ends.f1 - ends.g), 2.0 * q.least * turn * turn);
        }
        let artanh = 0.5 * log(parts.x / max(parts.y, 1e-36));
        let per_m = inverseSqrt(m2);
        excess = (artanh * per_m - 1.0) * per_m * per_m;
    }
    let mean = 0.5 * (ends.l0 + ends.l1);
    let bent = m2 * mean - 0.5 * (ends.l1 - ends.l0) * (ends.f1 - ends.f0) / max(sum, 1e-30);
    return 2.0 * ratio * (bent * excess + mean);
}

// Returns the integral of the light times n^2 / f^2 over v: by four Gauss-Legendre nodes where f hardly changes, else an
// angle, a logarithm and what is left of the stretch.
fn inverse_square_over(ends: Ends, q: Quadratic) -> f32 {
    let d = ends.advance;
    let rise = (ends.f1 - ends.f0) * (ends.f1 + ends.f0);
    let bulge = 0.25 * ends.a * d * d;
    let middle2 = 0.5 * (ends.f0 * ends.f0 + ends.f1 * ends.f1) - bulge;
    let mean_l = 0.5 * (ends.l0 + ends.l1);
    let mean_n = 0.5 * (ends.n0 + ends.n1);
    if (bulge <= 0.1 * middle2) {
        var sum = 0.0;
        for (var k = 0; k < 4; k++) {
            let is_outer = k == 0 || k == 3;
            let x = select(0.339981044, 0.861136312, is_outer) * select(1.0, -1.0, k < 2);
            let weight = select(0.652145155, 0.347854845, is_outer);
            let light = (mean_l + 0.5 * (ends.l1 - ends.l0) * x) * (mean_n + 0.5 * (ends.n1 - ends.n0) * x);
            sum += weight * light / ((bulge * x + 0.5 * rise) * x + middle2);
        }
        return 0.5 * d * sum;
    }
    let root = sqrt(q.least) * q.rate;
    let per_sum = 1.0 / max(ends.f0 * ends.f1 + abs(ends.g), 1e-36);
    var angle = 2.0 * atan(min(root * d * per_sum, 1.0));
    angle = select(angle, 3.14159265 - angle, ends.g < 0.0) / max(root, 1e-30);
    let growth = log(ends.f1 / max(ends.f0, 1e-18));
    let per_a = 1.0 / max(ends.a, 1e-30);
    let per_d = 1.0 / max(d, 1e-30);
    let to_peak = -0.5 * rise * per_a * per_d * per_d; // from the middle, of the stretch
    let slope_l = ends.l1 - ends.l0;
    let slope_n = ends.n1 - ends.n0;
    let peak_l = slope_l * to_peak + mean_l;
    let peak_n = slope_n * to_peak + mean_n;
    let curvature = slope_l * slope_n * per_d * per_d * per_a;
    let slope = (peak_l * slope_n + peak_n * slope_l) * per_d * per_a;
    let at_peak = peak_l * peak_n - curvature * per_a * root * root;
    return at_peak * angle + slope * growth + curvature * d;
}
