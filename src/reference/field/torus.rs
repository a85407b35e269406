//! A circle.

use glam::{DVec2, DVec3};

use super::{Field, Parts, Sample, Source, even};
use crate::scene::{Ray, Torus, Light};

/// The circle of a ring; the axis is a unit vector.
#[derive(Debug, Clone)]
struct Circle {
    center: DVec3,
    axis: DVec3,
    radius: f64,
}

impl Parts for Torus {
    fn add_parts(&self, light: Light, add: &mut dyn FnMut(Source)) {
        add(Source::new(
            Circle {
                center: self.center,
                axis: self.axis.normalize(),
                radius: self.major_radius,
            },
            light,
        ));
    }
}

impl Field for Circle {
    fn sample(&self, point: DVec3) -> Sample {
        let from_center = point - self.center;
        let height = from_center.dot(self.axis);
        let from_axis = from_center.cross(self.axis).length();
        even(DVec2::new(from_axis - self.radius, height).length_squared())
    }

    /// Adds where the ray is closest to the ring, and the kink beside its axis. Every least distance lies where the ray
    /// passes alongside the ring's bounding ball: beyond, all of the ring falls behind.
    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        const CELLS: usize = 64;
        let distance2 = |s: f64| self.sample(ray.at(s)).distance2;
        let middle = ray.nearest_to(self.center);
        let reach = 1.001 * self.radius / ray.span.length();
        let at = |i: usize| middle + reach * (2.0 * i as f64 / CELLS as f64 - 1.0);
        let values: Vec<f64> = (0..=CELLS).map(|i| distance2(at(i))).collect();
        for i in 1..CELLS {
            if values[i] <= values[i - 1] && values[i] <= values[i + 1] {
                breaks.push(least(&distance2, at(i - 1), at(i + 1)));
            }
        }
        let across = ray.span.cross(self.axis);
        if across.length_squared() > 0.0 {
            let to_axis = (self.center - ray.origin).cross(self.axis);
            breaks.push(to_axis.dot(across) / across.length_squared());
        }
    }
}

/// Finds where a function with one minimum in [from, to] is least, by golden-section search.
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
