//! A finite line: the distance to its nearest point, or the light of all its points added up.

use glam::DVec3;

use super::added::sum_over_line;
use super::{Field, Parts, Sample, Source, crossing, even, nearest_to_line};
use crate::scene::{Falloff, Light, Profile, Ray, Segment};

/// The points from one end to the other; the span is their difference.
#[derive(Debug, Clone)]
struct FiniteLine {
    from: DVec3,
    span: DVec3,
}

impl Parts for Segment {
    fn add_parts(&self, light: Light, add: &mut dyn FnMut(Source)) {
        let line = FiniteLine {
            from: self.from,
            span: self.to - self.from,
        };
        add(match light.falloff.profile {
            Profile::Convolution => Source::new(AddedLine(line), light),
            _ => Source::new(line, light),
        });
    }
}

impl Field for FiniteLine {
    fn sample(&self, point: DVec3) -> Sample {
        let from_begin = point - self.from;
        let share = from_begin.dot(self.span) / self.span.length_squared();
        // Not a number where both ends coincide: then it is nearest at both.
        let nearest = match share {
            share if share >= 1.0 => self.span,
            share if share > 0.0 => {
                let across = from_begin.cross(self.span).length_squared();
                return even(across / self.span.length_squared());
            }
            _ => DVec3::ZERO,
        };
        even(from_begin.distance_squared(nearest))
    }

    /// Adds where the ray passes the ends and the line between them, and the planes in which the nearest point leaves
    /// an end.
    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        let to = self.from + self.span;
        breaks.extend([ray.nearest_to(self.from), ray.nearest_to(to)]);
        if let Some(direction) = self.span.try_normalize() {
            breaks.push(nearest_to_line(ray, self.from, direction));
            breaks.push(crossing(ray, self.from, direction));
            breaks.push(crossing(ray, to, direction));
        }
    }
}

/// A line whose points all add their light.
#[derive(Debug, Clone)]
struct AddedLine(FiniteLine);

impl Field for AddedLine {
    fn sample(&self, point: DVec3) -> Sample {
        self.0.sample(point)
    }

    fn light(&self, point: DVec3, _: &Falloff, softening2: f64, floor2: f64) -> f64 {
        sum_over_line(self.0.from, self.0.span, point, softening2 + floor2)
    }

    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        self.0.breaks(ray, breaks);
    }
}
