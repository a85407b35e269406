//! A half-line, in up to three parts: its line, what glows behind the tip, and a sphere around the tip.

use glam::DVec3;

use super::sphere::Point;
use super::{Field, Parts, Sample, Source, crossing, nearest_to_line};
use crate::scene::{Beam, Ray, Light};

/// The line of a beam: dark behind the tip, or fading there over the length of a taper; the direction is a unit vector.
#[derive(Debug, Clone)]
struct HalfLine {
    tip: DVec3,
    direction: DVec3,
    taper_length: Option<f64>,
}

/// The tip of a beam, dark ahead of it; the direction is a unit vector.
#[derive(Debug, Clone)]
struct Cap {
    tip: DVec3,
    direction: DVec3,
}

impl Parts for Beam {
    fn add_parts(&self, light: Light, add: &mut dyn FnMut(Source)) {
        let (tip, direction) = (self.tip, self.direction.normalize());
        let taper_length = self.taper_length();
        let line = HalfLine {
            tip,
            direction,
            taper_length,
        };
        let parts: [(Box<dyn Field>, f64); 3] = [
            (Box::new(line), light.coefficient),
            (Box::new(Cap { tip, direction }), self.cap(&light)),
            (Box::new(Point(tip)), self.sphere_coefficient),
        ];
        let lit = parts
            .into_iter()
            .filter(|(_, coefficient)| *coefficient != 0.0);
        for (field, coefficient) in lit {
            add(Source {
                field,
                falloff: light.falloff,
                emission: light.color * coefficient,
            });
        }
    }
}

/// Returns how far ahead of the plane through a beam's tip a point lies; 0 where only rounding tells it from the plane.
fn ahead_of(tip: DVec3, direction: DVec3, point: DVec3) -> f64 {
    let from_tip = point - tip;
    let ahead = from_tip.dot(direction);
    let rounding = 4e-15 * (from_tip.abs() + tip.abs()).element_sum();
    if ahead.abs() < rounding { 0.0 } else { ahead }
}

impl Field for HalfLine {
    fn sample(&self, point: DVec3) -> Sample {
        let from_tip = point - self.tip;
        let ahead = ahead_of(self.tip, self.direction, point);
        Sample {
            distance2: from_tip.cross(self.direction).length_squared(),
            intensity: match self.taper_length {
                _ if ahead >= 0.0 => 1.0,
                Some(length) => (1.0 + ahead / length).max(0.0),
                None => 0.0,
            },
        }
    }

    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        breaks.push(nearest_to_line(ray, self.tip, self.direction));
        for behind in [Some(0.0), self.taper_length].into_iter().flatten() {
            let point = self.tip - self.direction * behind;
            breaks.push(crossing(ray, point, self.direction));
        }
    }
}

impl Field for Cap {
    fn sample(&self, point: DVec3) -> Sample {
        let from_tip = point - self.tip;
        Sample {
            distance2: from_tip.length_squared(),
            intensity: f64::from(ahead_of(self.tip, self.direction, point) < 0.0),
        }
    }

    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        breaks.push(ray.nearest_to(self.tip));
        breaks.push(crossing(ray, self.tip, self.direction));
    }
}
