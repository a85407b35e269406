//! An infinite line.

use glam::DVec3;

use super::{Field, Parts, Sample, Source, even, nearest_to_line};
use crate::scene::{Cylinder, Ray, Light};

/// A line through a point; the direction is a unit vector.
#[derive(Debug, Clone)]
struct Line {
    point: DVec3,
    direction: DVec3,
}

impl Parts for Cylinder {
    fn add_parts(&self, light: Light, add: &mut dyn FnMut(Source)) {
        add(Source::new(
            Line {
                point: self.point,
                direction: self.direction.normalize(),
            },
            light,
        ));
    }
}

impl Field for Line {
    fn sample(&self, point: DVec3) -> Sample {
        let from_point = point - self.point;
        even(from_point.cross(self.direction).length_squared())
    }

    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        breaks.push(nearest_to_line(ray, self.point, self.direction));
    }
}
