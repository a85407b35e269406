//! Scalar fields in float64: distance to the core, and where along a ray it is least. A module for each kind of source.

use glam::DVec3;

use crate::scene::kinds::for_each_kind;
use crate::scene::{Falloff, HasLight, Light, Ray, Scene, SourceKind};

mod added;

macro_rules! field_modules {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        $(mod $kind;)*

        /// Lists the lights of a scene, the parts of each; those of what is drawn as chains part by part.
        pub fn lights(scene: &Scene) -> Vec<Vec<Source>> {
            let mut lights = Vec::with_capacity(scene.light_count());
            $(for source in &scene.$list {
                match source.as_chains() {
                    Some(chains) => {
                        let add = &mut |part| lights.push(vec![part]);
                        chains.iter().for_each(|chain| path::add_chain(chain, add));
                    }
                    None => lights.extend(source.lights().map(|light| {
                        let mut parts = Vec::new();
                        source.add_parts(light, &mut |part| parts.push(part));
                        parts
                    })),
                }
            })*
            lights
        }

        /// Lists every source of a scene, light by light and part by part.
        pub fn sources(scene: &Scene) -> Vec<Source> {
            lights(scene).into_iter().flatten().collect()
        }
    };
}
for_each_kind!(field_modules);

pub use curve::{CurveField, b_spline};

/// One sample of a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Squared distance to the core, world units squared.
    pub distance2: f64,
    /// Local intensity of the core at its nearest point; 1 without a series.
    pub intensity: f64,
}

/// What a field falls off from.
pub trait Field: std::fmt::Debug + Send + Sync {
    /// Samples the field at a point, without softening.
    fn sample(&self, point: DVec3) -> Sample;

    /// Returns the light at a point, from what is added to squared distances, and what none is taken below.
    fn light(&self, point: DVec3, falloff: &Falloff, softening2: f64, floor2: f64) -> f64 {
        let Sample {
            distance2,
            intensity,
        } = self.sample(point);
        intensity * falloff.field(distance2, (distance2 + softening2).max(floor2))
    }

    /// Appends the parameters s, inside `[0,1]` or not, at which the field peaks or may not be smooth along the ray.
    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>);
}

/// A part of a source: `emission` times the integral of its field.
#[derive(Debug)]
pub struct Source {
    /// What the field falls off from.
    pub field: Box<dyn Field>,
    /// How it falls off.
    pub falloff: Falloff,
    /// Colour times coefficient, linear RGB.
    pub emission: DVec3,
}

impl Source {
    /// Makes a part with all of a light.
    fn new(field: impl Field + 'static, light: Light) -> Self {
        Self {
            field: Box::new(field),
            falloff: light.falloff,
            emission: light.emission(),
        }
    }
}

/// What the reference asks of every kind of source.
trait Parts {
    /// Calls `add` with each part of the source that glows with one of its lights; with none of a kind that is always
    /// drawn as a chain.
    fn add_parts(&self, _: Light, _: &mut dyn FnMut(Source)) {}
}

/// Makes the sample of a core that is equally bright everywhere.
fn even(distance2: f64) -> Sample {
    Sample {
        distance2,
        intensity: 1.0,
    }
}

/// Returns the parameter s at which a ray is nearest to a line; not a number if they are parallel.
fn nearest_to_line(ray: &Ray, point: DVec3, direction: DVec3) -> f64 {
    let across = |v: DVec3| v.cross(direction);
    let span = across(ray.span);
    across(point - ray.origin).dot(span) / span.length_squared()
}

/// Returns the parameter s at which a ray crosses a plane (2010, eq. 10); not finite if they are parallel.
fn crossing(ray: &Ray, point: DVec3, normal: DVec3) -> f64 {
    (point - ray.origin).dot(normal) / ray.span.dot(normal)
}
