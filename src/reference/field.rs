//! Scalar fields in float64: distance to the core, and where along a ray it is least.

use glam::{DVec2, DVec3};

use super::curve::CurveField;
use crate::ray::Ray;
use crate::scene::{Cylinder, Sphere, Torus};

/// One sample of a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Squared distance to the core, world units squared.
    pub distance2: f64,
    /// Local intensity of the core at its nearest point; 1 without a series.
    pub intensity: f64,
}

/// A source's field.
#[derive(Debug, Clone)]
pub enum Field {
    /// 1/r around a point.
    Sphere(Sphere),
    /// 1/r around an infinite line; the direction is a unit vector.
    Cylinder(Cylinder),
    /// 1/r around a circle; the axis is a unit vector.
    Torus(Torus),
    /// 1/r around a quadratic curve, times a local intensity.
    Curve(CurveField),
}

impl Field {
    /// The field at a point, without softening.
    pub fn sample(&self, point: DVec3) -> Sample {
        let distance2 = match self {
            Self::Sphere(sphere) => point.distance_squared(sphere.center),
            Self::Cylinder(cylinder) => {
                let from_point = point - cylinder.point;
                from_point.cross(cylinder.direction).length_squared()
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
            intensity: 1.0,
        }
    }

    /// Appends the parameters s, inside `[0,1]` or not, at which the field peaks or may not be smooth along the ray.
    pub fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        match self {
            Self::Sphere(sphere) => breaks.push(ray.nearest_to(sphere.center)),
            Self::Cylinder(cylinder) => {
                let across = |v: DVec3| v.cross(cylinder.direction);
                let span = across(ray.span);
                breaks.push(across(cylinder.point - ray.origin).dot(span) / span.length_squared());
            }
            Self::Torus(torus) => torus_breaks(torus, ray, breaks),
            Self::Curve(curve) => curve.breaks(ray, breaks),
        }
    }
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
