//! The reference against closed forms: points and lines whose light decays by every power, and points whose light is
//! absorbed.

use energywave::scene::{Cylinder, Profile, Sphere};
use glam::DVec3;

use crate::common;
use crate::fading::{absorbing, by_reference, decay, faded, rays};

/// The integral of `u^-power / r^order` from `beta` to `1 + beta` past a point, in closed form: the squared distance is
/// `a u^2 + 2 b u + c`.
fn past_a_point(order: u32, power: u32, beta: f64, (a, b, c): (f64, f64, f64)) -> f64 {
    let d = (a * c - b * b).sqrt();
    let primitive = |u: f64| {
        let square = a * u * u + 2.0 * b * u + c;
        let r = square.sqrt();
        let s1 = -((c + b * u) / (u * d)).asinh() / c.sqrt();
        let angle = ((a * u + b) / d).atan() / d;
        let growth = (u * u / square).ln();
        match (order, power) {
            (1, 0) => ((a * u + b) / d).asinh() / a.sqrt(),
            (1, 1) => s1,
            (1, 2) => -r / (c * u) - b / c * s1,
            (1, _) => {
                let first = -r / (2.0 * c * u * u) + 3.0 * b * r / (2.0 * c * c * u);
                first + (3.0 * b * b - c * a) / (2.0 * c * c) * s1
            }
            (_, 0) => angle,
            (_, 1) => growth / (2.0 * c) - b / c * angle,
            (_, 2) => {
                -1.0 / (c * u) - b / (c * c) * growth + (2.0 * b * b - a * c) / (c * c) * angle
            }
            _ => {
                let first = -1.0 / (2.0 * c * u * u) + 2.0 * b / (c * c * u);
                let third = (3.0 * a * c * b - 4.0 * b.powi(3)) / c.powi(3);
                first + (4.0 * b * b - a * c) / (2.0 * c.powi(3)) * growth + third * angle
            }
        }
    };
    primitive(1.0 + beta) - primitive(beta)
}

/// The exponential integral E1 of a complex number that is not large, as real and imaginary part.
fn exponential_integral((x, y): (f64, f64)) -> (f64, f64) {
    const EULER: f64 = 0.577_215_664_901_532_9;
    let mut sum = (-EULER - 0.5 * (x * x + y * y).ln(), -y.atan2(x));
    let mut term = (1.0, 0.0); // (-z)^k / k!
    for k in 1..100 {
        let k = f64::from(k);
        term = (
            (-term.0 * x + term.1 * y) / k,
            (-term.0 * y - term.1 * x) / k,
        );
        sum = (sum.0 - term.0 / k, sum.1 - term.1 / k);
    }
    sum
}

#[test]
fn the_reference_meets_closed_forms_of_points_and_lines() {
    let direction = DVec3::new(0.8, 0.6, 0.0);
    for (profile, order) in [(Profile::Inverse, 1), (Profile::InverseSquare, 2)] {
        let mut point = common::empty_scene(8, 8);
        point.spheres.push(Sphere {
            profile,
            ..Sphere::default()
        });
        let mut line = common::empty_scene(8, 8);
        line.cylinders.push(Cylinder {
            profile,
            ..Cylinder::new(direction)
        });
        for power in 0..4 {
            for beta in [0.05, 0.5, 2.0] {
                let fading = (decay(power, beta), None);
                for (scene, is_line) in [(&point, false), (&line, true)] {
                    let found = by_reference(&faded(scene, fading));
                    for (ray, found) in rays().iter().zip(found) {
                        let seen = |v: DVec3| if is_line { v.cross(direction) } else { v };
                        let (start, span) = (seen(ray.origin), seen(ray.span));
                        let a = span.length_squared();
                        let b = start.dot(span) - a * beta;
                        let c = start.length_squared() - beta * (2.0 * start.dot(span) - a * beta);
                        let expected = 0.3 * past_a_point(order, power, beta, (a, b, c));
                        let error = (found / expected - 1.0).abs();
                        assert!(
                            error < 1e-7,
                            "{profile:?}, power {power}, {beta}, {ray:?}: {error:e}"
                        );
                    }
                }
            }
        }
        if order == 1 {
            continue;
        }
        for kappa in [0.1, 1.0] {
            let found = by_reference(&faded(&point, (None, absorbing(kappa))));
            for (ray, found) in rays().iter().zip(found) {
                let length = ray.span.length();
                let begin = ray.origin.dot(ray.span) / length;
                let d = (ray.origin.length_squared() - begin * begin).sqrt();
                let (cosine, sine) = ((kappa * d).cos(), (kappa * d).sin());
                let primitive = |x: f64| {
                    let (re, im) = exponential_integral((kappa * x, -kappa * d));
                    -(cosine * im - sine * re) / d
                };
                let whole = primitive(begin + length) - primitive(begin);
                let expected = (kappa * begin).exp() * whole / length;
                let error = (found / expected - 1.0).abs();
                assert!(error < 1e-7, "{kappa} {ray:?}: {found} {expected}");
            }
        }
    }
}
