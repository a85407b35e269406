//! A point of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, Falloff, Light, Profile, SourceKind, one, white};
use crate::scene::values::{Checked, read_vector, vector};

/// A point of light: `1/d`, or by its [`Profile`] `1/d^2`, d the distance to the point M (2015, eq. 2).
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Sphere {
    /// The point, M.
    #[serde(deserialize_with = "read_vector")]
    pub center: DVec3,
    /// The paper's energy coefficient.
    pub coefficient: f64,
    /// Linear RGB.
    #[serde(deserialize_with = "read_vector")]
    pub color: DVec3,
    /// How the field falls off.
    pub profile: Profile,
    /// How thick the core is: `d^2 + radius^2` stands for `d^2`; world units, 0 for none.
    pub radius: f64,
    /// The distance at which the light ends, smoothly; world units, more than the radius. `None`: nowhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reach: Option<f64>,
    /// Takes the coefficient's place: the light of a ray straight across the core, measured by length, without decay.
    /// It needs a radius, and where the light of the profile has no end, a reach.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak: Option<f64>,
}

impl Default for Sphere {
    fn default() -> Self {
        Self {
            center: DVec3::ZERO,
            coefficient: one(),
            color: white(),
            profile: Profile::default(),
            radius: 0.0,
            reach: None,
            peak: None,
        }
    }
}

impl SourceKind for Sphere {
    fn check(&self, brightness: &Brightness) -> Checked {
        vector("center", self.center)?;
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
        Core::point(self.center)
    }

    fn specimen(place: DVec3, profile: Profile) -> Self {
        Self {
            center: place,
            color: DVec3::new(1.0, 0.5, 0.2),
            profile,
            ..Self::default()
        }
    }
}
