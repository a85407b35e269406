//! Scalar fields in float64: distance to the core, and where along a ray it is least.

use glam::{DVec2, DVec3};

use super::curve::CurveField;
use crate::ray::Ray;
use crate::scene::{Beam, Cylinder, Sphere, Torus};

/// One sample of a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Squared distance to the core, world units squared.
    pub distance2: f64,
    /// Local intensity of the core at its nearest point; 1 without a series.
    pub intensity: f64,
}

/// What a field falls off from.
#[derive(Debug, Clone)]
pub enum Field {
    /// A point.
    Sphere(Sphere),
    /// An infinite line; the direction is a unit vector.
    Cylinder(Cylinder),
    /// The line of a beam: dark behind the tip, or fading there; the direction is a unit vector.
    BeamLine(Beam),
    /// The tip of a beam, dark ahead of it; the direction is a unit vector.
    BeamCap(Beam),
    /// A circle; the axis is a unit vector.
    Torus(Torus),
    /// A quadratic curve with its local intensity.
    Curve(CurveField),
}

impl Field {
    /// The field at a point, without softening.
    pub fn sample(&self, point: DVec3) -> Sample {
        let mut intensity = 1.0;
        let distance2 = match self {
            Self::Sphere(sphere) => point.distance_squared(sphere.center),
            Self::Cylinder(cylinder) => {
                let from_point = point - cylinder.point;
                from_point.cross(cylinder.direction).length_squared()
            }
            Self::BeamLine(beam) => {
                let from_tip = point - beam.tip;
                let ahead = from_tip.dot(beam.direction);
                intensity = match beam.taper_length {
                    _ if ahead >= 0.0 => 1.0,
                    Some(length) => (1.0 + ahead / length).max(0.0),
                    None => 0.0,
                };
                from_tip.cross(beam.direction).length_squared()
            }
            Self::BeamCap(beam) => {
                let from_tip = point - beam.tip;
                intensity = f64::from(from_tip.dot(beam.direction) < 0.0);
                from_tip.length_squared()
            }
            Self::Torus(torus) => {
                let from_center = point - torus.center;
                let height = from_center.dot(torus.axis);
                let from_axis = from_center.cross(torus.axis).length();
                DVec2::new(from_axis - torus.major_radius, height).length_squared()
            }
            Self::Curve(curve) => return curve.sample(point),
        };
        Sample {
            distance2,
            intensity,
        }
    }

    /// Appends the parameters s, inside `[0,1]` or not, at which the field peaks or may not be smooth along the ray.
    pub fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        match self {
            Self::Sphere(sphere) => breaks.push(ray.nearest_to(sphere.center)),
            Self::Cylinder(cylinder) => {
                breaks.push(nearest_to_line(ray, cylinder.point, cylinder.direction));
            }
            Self::BeamLine(beam) => {
                breaks.push(nearest_to_line(ray, beam.tip, beam.direction));
                for behind in [Some(0.0), beam.taper_length].into_iter().flatten() {
                    breaks.push(crossing(
                        ray,
                        beam.tip - beam.direction * behind,
                        beam.direction,
                    ));
                }
            }
            Self::BeamCap(beam) => {
                breaks.push(ray.nearest_to(beam.tip));
                breaks.push(crossing(ray, beam.tip, beam.direction));
            }
            Self::Torus(torus) => torus_breaks(torus, ray, breaks),
            Self::Curve(curve) => curve.breaks(ray, breaks),
        }
    }
}

/// The parameter s at which a ray is nearest to a line; not a number if they are parallel.
fn nearest_to_line(ray: &Ray, point: DVec3, direction: DVec3) -> f64 {
    let across = |v: DVec3| v.cross(direction);
    let span = across(ray.span);
    across(point - ray.origin).dot(span) / span.length_squared()
}

/// The parameter s at which a ray crosses a plane (2010, eq. 10); not finite if they are parallel.
fn crossing(ray: &Ray, point: DVec3, normal: DVec3) -> f64 {
    (point - ray.origin).dot(normal) / ray.span.dot(normal)
}

/// Least distances to the ring, and the kink beside its axis. Every least distance lies where the ray passes alongside
/// the ring's bounding ball: beyond, all of the ring falls behind.
fn torus_breaks(torus: &Torus, ray: &Ray, breaks: &mut Vec<f64>) {
    const CELLS: usize = 64;
    let field = Field::Torus(torus.clone());
    let distance2 = |s: f64| field.sample(ray.at(s)).distance2;
    let middle = ray.nearest_to(torus.center);
    let reach = 1.001 * torus.major_radius / ray.span.length();
    let at = |i: usize| middle + reach * (2.0 * i as f64 / CELLS as f64 - 1.0);
    let values: Vec<f64> = (0..=CELLS).map(|i| distance2(at(i))).collect();
    for i in 1..CELLS {
        if values[i] <= values[i - 1] && values[i] <= values[i + 1] {
            breaks.push(least(&distance2, at(i - 1), at(i + 1)));
        }
    }
    let across = ray.span.cross(torus.axis);
    if across.length_squared() > 0.0 {
        let to_axis = (torus.center - ray.origin).cross(torus.axis);
        breaks.push(to_axis.dot(across) / across.length_squared());
    }
}

/// Golden-section search for the least value of a function with one minimum in [from, to].
fn least(function: &impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let mut left = to - GOLDEN * (to - from);
    let mut right = from + GOLDEN * (to - from);
    let (mut at_left, mut at_right) = (function(left), function(right));
    for _ in 0..40 {
        if at_left < at_right {
            to = right;
            (right, at_right) = (left, at_left);
            left = to - GOLDEN * (to - from);
            at_left = function(left);
        } else {
            from = left;
            (left, at_left) = (right, at_right);
            right = from + GOLDEN * (to - from);
            at_right = function(right);
        }
    }
    0.5 * (from + to)
}
