//! The light that cores cast on surfaces in float64: `E(P, n) = integral of I' max(0, n.y) / (|y|^2 + radius^2)^(3/2)`
//! over all cores, by adaptive quadrature over each core's parameter, between where it crosses the horizon, which is
//! searched for, and where it is nearest. The kernels have closed forms and rules of few nodes.

use glam::DVec3;

use super::quadrature::integrate;
use crate::error::Result;
use crate::scene::{Emitter, EmitterCore, Scene};

/// Relative error of an integral.
const ERROR: f64 = 1e-9;

/// Places of a core at which its height and its distance are looked at.
const PLACES: u32 = 200;

/// Halvings of a bracket.
const HALVINGS: u32 = 60;

/// Beyond which a line is not followed, in distances: what is left is smaller than its square.
const FAR: f64 = 1e14;

/// A core as it is seen from a point.
struct Seen<'a> {
    emitter: &'a Emitter,
    point: DVec3,
    normal: DVec3,
    /// Of a line: where it is nearest, how far off it is there, and the parameters of its ends.
    nearest: f64,
    distance: f64,
    ends: [f64; 2],
}

impl<'a> Seen<'a> {
    fn new(emitter: &'a Emitter, point: DVec3, normal: DVec3) -> Self {
        let mut seen = Self {
            emitter,
            point,
            normal,
            nearest: 0.0,
            distance: 1.0,
            ends: [0.0, 1.0],
        };
        match emitter.core {
            EmitterCore::Line {
                point: begin,
                direction,
                range,
            } => {
                seen.nearest = (point - begin).dot(direction);
                let beside = begin + seen.nearest * direction - point;
                seen.distance = beside.length().hypot(emitter.radius);
                let parameter = |t: f64| {
                    ((t - seen.nearest) / seen.distance)
                        .clamp(-FAR, FAR)
                        .asinh()
                };
                seen.ends = range.map(parameter);
            }
            EmitterCore::Arc { angles, .. } => seen.ends = angles,
            EmitterCore::Point(_) | EmitterCore::Curve(_) => {}
        }
        seen
    }

    /// Returns the vector to the core, how fast that moves on, and how far it is of the core, 0 to 1.
    fn at(&self, x: f64) -> (DVec3, f64, f64) {
        let [from, to] = self.ends;
        let share = (x - from) / (to - from);
        match self.emitter.core {
            EmitterCore::Point(place) => (place - self.point, 1.0, 0.0),
            EmitterCore::Line {
                point,
                direction,
                range,
            } => {
                let t = self.nearest + self.distance * x.sinh();
                let share = (t - range[0]) / (range[1] - range[0]);
                let share = if share.is_finite() { share } else { 0.0 };
                (
                    point + t * direction - self.point,
                    self.distance * x.cosh(),
                    share,
                )
            }
            EmitterCore::Arc {
                center,
                x: right,
                y: up,
                ..
            } => {
                let place = center + x.cos() * right + x.sin() * up;
                (place - self.point, right.length(), share)
            }
            EmitterCore::Curve(piece) => {
                (piece.at(x) - self.point, piece.velocity(x).length(), share)
            }
        }
    }

    fn height(&self, x: f64) -> f64 {
        self.at(x).0.dot(self.normal)
    }

    fn distance2(&self, x: f64) -> f64 {
        self.at(x).0.length_squared()
    }

    /// Returns where the core crosses the horizon, and where it is nearest.
    fn breaks(&self) -> Vec<f64> {
        let [from, to] = self.ends;
        let at = |k: u32| from + (to - from) * f64::from(k) / f64::from(PLACES);
        let mut breaks = Vec::new();
        for k in 0..PLACES {
            let (mut a, mut b) = (at(k), at(k + 1));
            let was_above = self.height(a) > 0.0;
            if was_above != (self.height(b) > 0.0) {
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (a + b);
                    match (self.height(middle) > 0.0) == was_above {
                        true => a = middle,
                        false => b = middle,
                    }
                }
                breaks.push(0.5 * (a + b));
            }
            let [before, here, after] = [k.max(1) - 1, k, k + 1].map(|k| self.distance2(at(k)));
            if here <= before && here <= after {
                let (mut a, mut b) = (at(k.max(1) - 1), at(k + 1));
                for _ in 0..2 * HALVINGS {
                    let [first, second] = [1.0, 2.0].map(|third| a + (b - a) * third / 3.0);
                    match self.distance2(first) < self.distance2(second) {
                        true => b = second,
                        false => a = first,
                    }
                }
                breaks.push(0.5 * (a + b));
            }
        }
        breaks
    }

    /// Returns the integral of what falls on the surface, times a power of the share of the core.
    fn moment(&self, breaks: &[f64], power: i32) -> f64 {
        let [from, to] = self.ends;
        let integrand = |x: f64| {
            let (y, speed, share) = self.at(from + x);
            let distance2 = y.length_squared() + self.emitter.radius.powi(2);
            share.powi(power) * speed * y.dot(self.normal).max(0.0) / distance2.powf(1.5)
        };
        let mut breaks: Vec<f64> = breaks.iter().map(|x| x - from).collect();
        integrate(integrand, &mut breaks, to - from, ERROR).value
    }

    fn irradiance(&self) -> DVec3 {
        let [begin, middle, end] = self.emitter.light;
        if let EmitterCore::Point(_) = self.emitter.core {
            let (y, ..) = self.at(0.0);
            let distance2 = y.length_squared() + self.emitter.radius.powi(2);
            return begin * y.dot(self.normal).max(0.0) / distance2.powf(1.5);
        }
        let breaks = self.breaks();
        let even = begin * self.moment(&breaks, 0);
        if begin == middle && middle == end {
            return even;
        }
        let bend = 2.0 * (begin + end - 2.0 * middle);
        even + (end - begin - bend) * self.moment(&breaks, 1) + bend * self.moment(&breaks, 2)
    }
}

/// Returns the irradiance, linear RGB, of points of surfaces with normals of any length but zero, in float64.
///
/// # Errors
/// [`Error::Scene`](crate::Error::Scene) if the scene is not valid.
pub fn irradiance(scene: &Scene, points: &[DVec3], normals: &[DVec3]) -> Result<Vec<[f64; 3]>> {
    scene.validate()?;
    let emitters = scene.emitters();
    let at = |(point, normal): (&DVec3, &DVec3)| {
        let normal = normal.normalize();
        let of_one = |emitter| Seen::new(emitter, *point, normal).irradiance();
        emitters.iter().map(of_one).sum::<DVec3>().to_array()
    };
    Ok(points.iter().zip(normals).map(at).collect())
}
