//! An infinite line of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, Falloff, Light, Profile, SourceKind, one, white};
use crate::scene::values::{Checked, direction, read_vector, vector};

/// An infinite line of light: `1/d`, or by its [`Profile`] `1/d^2`, d the distance to the line (2015, eq. 3).
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// A point of the line.
    #[serde(default, deserialize_with = "read_vector")]
    pub point: DVec3,
    /// Direction of the line, of any length but zero.
    #[serde(deserialize_with = "read_vector")]
    pub direction: DVec3,
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

impl Cylinder {
    /// Makes a white line through the origin.
    #[must_use]
    pub fn new(direction: DVec3) -> Self {
        Self {
            point: DVec3::ZERO,
            direction,
            coefficient: one(),
            color: white(),
            profile: Profile::default(),
            radius: 0.0,
            reach: None,
            peak: None,
        }
    }
}

impl SourceKind for Cylinder {
    fn check(&self, brightness: &Brightness) -> Checked {
        vector("point", self.point)?;
        direction("direction", self.direction)?;
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
        Core::Line {
            point: self.point,
            direction: self.direction.normalize(),
            begins: false,
        }
    }

    fn specimen(place: DVec3, profile: Profile) -> Self {
        Self {
            point: 2.0 * place,
            color: DVec3::new(0.2, 1.0, 0.4),
            profile,
            ..Self::new(DVec3::new(1.0, 0.3, 0.4))
        }
    }
}
