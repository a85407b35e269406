//! A finite line of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, Falloff, Light, Profile, SourceKind, one, white};
use crate::scene::values::{Checked, read_vector, vector};

/// A finite line of light: `1/d`, or by its [`Profile`] `1/d^2`, d the distance to the nearest point between its ends.
/// Ends that coincide make a point.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// One end.
    #[serde(deserialize_with = "read_vector")]
    pub from: DVec3,
    /// The other end.
    #[serde(deserialize_with = "read_vector")]
    pub to: DVec3,
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

impl Segment {
    /// Makes a white line between two points.
    #[must_use]
    pub fn new(from: DVec3, to: DVec3) -> Self {
        Self {
            from,
            to,
            coefficient: one(),
            color: white(),
            profile: Profile::default(),
            radius: 0.0,
            reach: None,
            peak: None,
        }
    }
}

impl SourceKind for Segment {
    fn check(&self, brightness: &Brightness) -> Checked {
        vector("from", self.from)?;
        vector("to", self.to)?;
        brightness.check_added_light(self.light(), self.peak)
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
        Core::between(self.from, self.to)
    }

    fn specimen(place: DVec3, profile: Profile) -> Self {
        let reach = DVec3::new(0.9, 0.4, -0.5);
        Self {
            color: DVec3::new(1.0, 0.8, 0.3),
            profile,
            ..Self::new(place - reach, place + reach)
        }
    }
}
