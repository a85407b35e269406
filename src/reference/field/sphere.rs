//! A point.

use glam::DVec3;

use super::{Field, Parts, Sample, Source, even};
use crate::scene::{Ray, Sphere, Light};

/// A point.
#[derive(Debug, Clone)]
pub(super) struct Point(pub DVec3);

impl Parts for Sphere {
    fn add_parts(&self, light: Light, add: &mut dyn FnMut(Source)) {
        add(Source::new(
            Point(self.center),
            light,
        ));
    }
}

impl Field for Point {
    fn sample(&self, point: DVec3) -> Sample {
        even(point.distance_squared(self.0))
    }

    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        breaks.push(ray.nearest_to(self.0));
    }
}
