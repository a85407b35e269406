//! The quadratic curve in float64: nearest point by bracketed Newton steps on the monotone stretches of the cubic
//! (2015, eq. 11, 12, corrected), local intensity by de Boor's recursion (eq. 14-17). Neither is the kernels' method.

use glam::DVec3;

use super::{Field, Parts, Sample, Source};
use crate::scene::{Curve, Ray, Light};

/// `C(t) = C2 t^2 + C1 t + C0`, t in `[0,1]`, with its intensity series.
#[derive(Debug, Clone)]
pub struct CurveField {
    c0: DVec3,
    c1: DVec3,
    c2: DVec3,
    intensity: Option<Vec<f64>>,
}

impl CurveField {
    /// Takes the polynomial form of a Bezier curve (eq. 10).
    pub fn new(curve: &Curve) -> Self {
        let [b0, b1, b2] = curve.control_points;
        Self {
            c0: b0,
            c1: 2.0 * (b1 - b0),
            c2: b0 - 2.0 * b1 + b2,
            intensity: curve.intensity.clone(),
        }
    }

    /// Returns the point C(t).
    pub fn at(&self, t: f64) -> DVec3 {
        (self.c2 * t + self.c1) * t + self.c0
    }

    /// Finds the parameter of the nearest point, the least one where several are equally near, and its squared
    /// distance.
    pub fn nearest(&self, point: DVec3) -> (f64, f64) {
        // A folded curve runs twice through the same points: rounding must not choose between them.
        let tie = 1e-12 * (self.c1.length() + self.c2.length()).powi(2);
        let mut least = self.c0.distance_squared(point);
        let mut nearest = (0.0, least);
        self.for_each_stationary(point, &mut |t, distance2| {
            least = least.min(distance2);
            if distance2 < nearest.1 - tie {
                nearest = (t, distance2);
            }
        });
        (nearest.0, least)
    }

    /// Calls `offer` with both ends and every parameter between at which the distance from a point is stationary, and
    /// its square there.
    pub fn for_each_stationary(&self, point: DVec3, offer: &mut impl FnMut(f64, f64)) {
        let mut at = |t: f64| offer(t, self.at(t).distance_squared(point));
        at(0.0);
        stationary(self.c2, self.c1, self.c0 - point, &mut at);
        at(1.0);
    }

    /// Finds where along the ray the nearest point jumps, also closely beside each break, where no node of a quadrature
    /// would see it.
    fn jumps(&self, ray: &Ray, breaks: &[f64]) -> Vec<f64> {
        const SHARES: [f64; 13] = [
            1e-8,
            1e-6,
            1e-4,
            1e-2,
            0.1,
            0.3,
            0.5,
            0.7,
            0.9,
            1.0 - 1e-2,
            1.0 - 1e-4,
            1.0 - 1e-6,
            1.0 - 1e-8,
        ];
        let mut ends: Vec<f64> = breaks.iter().map(|s| s.clamp(0.0, 1.0)).collect();
        ends.extend([0.0, 1.0]);
        ends.sort_by(f64::total_cmp);
        let pieces = ends.windows(2).filter(|pair| pair[1] > pair[0]);
        let samples: Vec<f64> = pieces
            .flat_map(|pair| SHARES.map(|share| pair[0] + share * (pair[1] - pair[0])))
            .collect();
        let nearest = |s: f64| self.nearest(ray.at(s)).0;
        let mut jumps = Vec::new();
        let mut before = nearest(0.0);
        for pair in samples.windows(2) {
            let (mut from, mut to) = (pair[0], pair[1]);
            let (mut t_from, mut t_to) = (before, nearest(to));
            before = t_to;
            // A smooth change halves with the stretch it happens on; a jump stays.
            for _ in 0..50 {
                if (t_to - t_from).abs() < 1e-3 {
                    break;
                }
                let middle = 0.5 * (from + to);
                let t = nearest(middle);
                if (t - t_from).abs() < (t - t_to).abs() {
                    (from, t_from) = (middle, t);
                } else {
                    (to, t_to) = (middle, t);
                }
            }
            if (t_to - t_from).abs() >= 1e-3 {
                jumps.push(0.5 * (from + to));
            }
        }
        jumps
    }
}

impl Parts for Curve {
    fn add_parts(&self, light: Light, add: &mut dyn FnMut(Source)) {
        add(Source::new(
            CurveField::new(self),
            light,
        ));
    }
}

impl Field for CurveField {
    fn sample(&self, point: DVec3) -> Sample {
        let (t, distance2) = self.nearest(point);
        let intensity = self
            .intensity
            .as_ref()
            .map_or(1.0, |series| b_spline(series, t));
        Sample {
            distance2,
            intensity,
        }
    }

    /// Adds where the ray passes closest to the curve and to its ends (seen along the ray the curve is a plane
    /// parabola), and where it enters the reach of the ends: the planes through them, perpendicular to the curve.
    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        let direction = ray.span.normalize();
        let flat = |v: DVec3| v - direction * v.dot(direction);
        let mut offer = |t: f64| breaks.push(ray.nearest_to(self.at(t)));
        stationary(
            flat(self.c2),
            flat(self.c1),
            flat(self.c0 - ray.origin),
            &mut offer,
        );
        offer(0.0);
        offer(1.0);
        // The planes through the ends, and through the knots of the intensity: what is lit may lie between two of them.
        let pieces = self.intensity.as_ref().map_or(1, |series| series.len() - 2);
        for t in (0..=pieces).map(|knot| knot as f64 / pieces as f64) {
            let tangent = 2.0 * t * self.c2 + self.c1;
            breaks.push((self.at(t) - ray.origin).dot(tangent) / ray.span.dot(tangent));
        }
        breaks.retain(|s| s.is_finite());
        let jumps = self.jumps(ray, breaks);
        breaks.extend(jumps);
    }
}

/// Calls `offer` with every t in (0,1) where the squared length of `c2 t^2 + c1 t + c0` is stationary, in rising order:
/// the roots of `2|c2|^2 t^3 + 3 c1.c2 t^2 + (|c1|^2 + 2 c2.c0) t + c1.c0` (half the derivative).
fn stationary(c2: DVec3, c1: DVec3, c0: DVec3, offer: &mut impl FnMut(f64)) {
    let a = 2.0 * c2.length_squared();
    let b = 3.0 * c1.dot(c2);
    let c = c1.length_squared() + 2.0 * c2.dot(c0);
    let d = c1.dot(c0);
    let cubic = |t: f64| ((a * t + b) * t + c) * t + d;
    let slope = |t: f64| (3.0 * a * t + 2.0 * b) * t + c;
    let [first, second] = turning_points(a, b, c);
    let ends = [0.0, first, second, 1.0];
    for pair in ends.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        if from < to && (cubic(from) <= 0.0) != (cubic(to) <= 0.0) {
            offer(bracketed_root(&cubic, &slope, from, to));
        }
    }
}

/// Returns the roots of the cubic's derivative `3 a t^2 + 2 b t + c`, ordered and clamped to `[0,1]`; 0 and 0 if there
/// are none.
fn turning_points(a: f64, b: f64, c: f64) -> [f64; 2] {
    let discriminant = b * b - 3.0 * a * c;
    if discriminant <= 0.0 {
        return [0.0, 0.0];
    }
    let q = -(b + b.signum() * discriminant.sqrt());
    let (first, second) = (q / (3.0 * a), c / q);
    let clamp = |t: f64| if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
    [clamp(first.min(second)), clamp(first.max(second))]
}

/// Finds the root of a function that changes its sign once in [from, to]: Newton steps, halving where they leave the
/// bracket.
fn bracketed_root(
    function: &impl Fn(f64) -> f64,
    slope: &impl Fn(f64) -> f64,
    mut from: f64,
    mut to: f64,
) -> f64 {
    let rising = function(from) <= 0.0;
    let mut t = 0.5 * (from + to);
    for _ in 0..100 {
        let value = function(t);
        if (value <= 0.0) == rising {
            from = t;
        } else {
            to = t;
        }
        let newton = t - value / slope(t);
        let next = if newton > from && newton < to {
            newton
        } else {
            0.5 * (from + to)
        };
        if (next - t).abs() <= f64::EPSILON * t.abs() {
            return next;
        }
        t = next;
    }
    t
}

/// Evaluates the clamped uniform quadratic B-spline `S(t)` with weights `series` at t in `[0,1]`, by de Boor's
/// recursion.
pub fn b_spline(series: &[f64], t: f64) -> f64 {
    const DEGREE: usize = 2;
    let spans = series.len() - DEGREE;
    let knot = |i: usize| i.saturating_sub(DEGREE).min(spans) as f64 / spans as f64;
    let span = ((t * spans as f64) as usize).min(spans - 1);
    let mut points = [series[span], series[span + 1], series[span + 2]];
    for level in 1..=DEGREE {
        for j in (level..=DEGREE).rev() {
            let left = knot(span + j);
            let right = knot(span + j + DEGREE + 1 - level);
            let weight = (t - left) / (right - left);
            points[j] = (1.0 - weight) * points[j - 1] + weight * points[j];
        }
    }
    points[DEGREE]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: [[f64; 3]; 3]) -> CurveField {
        CurveField::new(&Curve::new(points.map(DVec3::from)))
    }

    #[test]
    fn the_nearest_point_beats_a_dense_scan_also_on_degenerate_curves() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut point = || DVec3::from([0; 3].map(|_| 4.0 * random.f64() - 2.0));
        let shapes = [
            [[-1.2, -0.2, 0.1], [-0.6, 1.1, -0.3], [0.0, 0.0, 0.1]],
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]],
            [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
            [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]],
            [[0.5, 0.5, 0.5], [0.5, 0.5, 0.5], [0.5, 0.5, 0.5]],
        ];
        for shape in shapes.map(curve) {
            for _ in 0..200 {
                let p = point();
                let scan = (0..=2000)
                    .map(|i| shape.at(f64::from(i) / 2000.0).distance_squared(p))
                    .fold(f64::INFINITY, f64::min);
                let (t, found) = shape.nearest(p);
                assert!(
                    found <= scan * (1.0 + 1e-12),
                    "{shape:?} {p}: {found} {scan}"
                );
                assert!(found >= scan - 1e-2, "{shape:?} {p}: {found} {scan}");
                assert!((0.0..=1.0).contains(&t));
            }
        }
    }

    #[test]
    fn the_b_spline_sums_to_one_interpolates_its_ends_and_matches_a_bezier() {
        let series = [1.0, 0.6, 0.2, 0.4, 0.8, 0.6, 1.0];
        assert_eq!(b_spline(&series, 0.0), 1.0);
        assert!((b_spline(&series, 1.0) - 1.0).abs() < 1e-15);
        // At a knot a quadratic B-spline is the mean of two weights.
        assert!((b_spline(&series, 0.2) - 0.4).abs() < 1e-15);
        for i in 0..=10 {
            let t = f64::from(i) / 10.0;
            assert!((b_spline(&[1.0; 5], t) - 1.0).abs() < 1e-15);
            let bezier = 2.0 * (1.0 - t) * (1.0 - t) + 2.0 * 5.0 * t * (1.0 - t) + 3.0 * t * t;
            assert!((b_spline(&[2.0, 5.0, 3.0], t) - bezier).abs() < 1e-14);
        }
    }
}
