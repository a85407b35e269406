//! A ring of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, Falloff, Light, Profile, SourceKind, one, plus_z, white};
use crate::scene::values::{Checked, direction, positive, read_vector, vector};

/// A ring of light: `1/d`, or by its [`Profile`] `1/d^2`, d the distance to the nearest point of the major circle
/// (2015, eq. 7).
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Torus {
    /// Middle of the ring.
    #[serde(default, deserialize_with = "read_vector")]
    pub center: DVec3,
    /// Normal of the ring's plane, of any length but zero.
    #[serde(default = "plus_z", deserialize_with = "read_vector")]
    pub axis: DVec3,
    /// Radius of the circle, positive.
    pub major_radius: f64,
    /// The paper's energy coefficient.
    #[serde(default = "one")]
    pub coefficient: f64,
    /// Linear RGB.
    #[serde(default = "white", deserialize_with = "read_vector")]
    pub color: DVec3,
    /// How the field falls off.
    #[serde(default)]
    pub profile: Profile,
    /// How thick the core is: `d^2 + radius^2` stands for `d^2`; world units, 0 for none.
    #[serde(default)]
    pub radius: f64,
    /// The distance at which the light ends, smoothly; world units, more than the radius. `None`: nowhere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reach: Option<f64>,
    /// Takes the coefficient's place: the light of a ray straight across the core, measured by length, without decay.
    /// It needs a radius, and where the light of the profile has no end, a reach.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak: Option<f64>,
}

impl Torus {
    /// Makes a white ring around the origin, in the plane z = 0.
    #[must_use]
    pub fn new(major_radius: f64) -> Self {
        Self {
            center: DVec3::ZERO,
            axis: plus_z(),
            major_radius,
            coefficient: one(),
            color: white(),
            profile: Profile::default(),
            radius: 0.0,
            reach: None,
            peak: None,
        }
    }
}

impl SourceKind for Torus {
    fn check(&self, brightness: &Brightness) -> Checked {
        vector("center", self.center)?;
        direction("axis", self.axis)?;
        positive("major_radius", self.major_radius)?;
        brightness.check_light(self.light(), self.peak, 1.0)
    }

    fn light(&self) -> Light {
        let falloff = Falloff {
            profile: self.profile,
            radius: self.radius,
            reach: self.reach,
        };
        Light {
            coefficient: falloff.coefficient(self.coefficient, self.peak),
            color: self.color,
            falloff,
        }
    }

    fn core(&self) -> Core {
        Core::Circle {
            center: self.center,
            axis: self.axis.normalize(),
            radius: self.major_radius,
        }
    }

    fn specimen(place: DVec3, profile: Profile) -> Self {
        Self {
            center: place,
            axis: DVec3::new(0.1, 0.4, 1.0),
            color: DVec3::new(0.3, 0.6, 1.0),
            profile,
            ..Self::new(1.1)
        }
    }
}
