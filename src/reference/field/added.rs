//! Cores all of whose points add their light: the integral of 1/r over their length.

use glam::DVec3;

use super::path::{Nearest, Part};
use super::{Field, Sample};
use crate::reference::quadrature::integrate;
use crate::scene::{Falloff, Ray};

/// Returns the integral of 1/r over a line; `softening2`, and with it the floor, lies at right angles to all else.
pub fn sum_over_line(from: DVec3, span: DVec3, point: DVec3, softening2: f64) -> f64 {
    let length = span.length();
    if length == 0.0 {
        return 0.0;
    }
    let direction = span / length;
    let from_begin = point - from;
    let (ahead, beside) = (from_begin.dot(direction), from_begin.cross(direction));
    let distance = (beside.length_squared() + softening2).sqrt();
    let (begin, end) = (-ahead / distance, (length - ahead) / distance);
    if begin * end > 0.0 && begin.abs().min(end.abs()) > 0.1 {
        // Both on one side: their difference would cancel.
        let (near, far) = (begin.abs().min(end.abs()), begin.abs().max(end.abs()));
        let growth = (far - near) * (1.0 + (far + near) / (far.hypot(1.0) + near.hypot(1.0)));
        return (growth / (near + near.hypot(1.0))).ln_1p();
    }
    end.asinh() - begin.asinh()
}

/// Relative error of a sum over a piece.
const SUM_ERROR: f64 = 1e-9;

/// A core of many pieces whose points all add their light.
#[derive(Debug, Clone)]
pub struct Added(pub Nearest);

impl Added {
    /// Returns the light of a piece.
    fn sum_over(&self, index: usize, point: DVec3, softening2: f64) -> f64 {
        let Part { piece, .. } = &self.0.parts[index];
        if piece.is_straight() && self.0.is_even(index) {
            return sum_over_line(
                piece.at(0.0),
                piece.at(1.0) - piece.at(0.0),
                point,
                softening2,
            );
        }
        let light = |t: f64| {
            let distance2 = piece.at(t).distance_squared(point) + softening2;
            self.0.lit(index, t).0 * piece.velocity(t).length() / distance2.sqrt()
        };
        let mut breaks = self.0.knots(index);
        self.0
            .for_each_stationary(index, point, &mut |t| breaks.push(t));
        integrate(light, &mut breaks, 1.0, SUM_ERROR).value
    }
}

impl Field for Added {
    fn sample(&self, point: DVec3) -> Sample {
        self.0.sample(point)
    }

    fn light(&self, point: DVec3, _: &Falloff, softening2: f64, floor2: f64) -> f64 {
        let sum = |index| self.sum_over(index, point, softening2 + floor2);
        (0..self.0.parts.len()).map(sum).sum()
    }

    /// Adds where the ray passes each piece, and the planes through its ends.
    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        self.0.passes(ray, &mut |s, _| breaks.push(s));
    }
}
