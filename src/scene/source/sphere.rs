//! A point of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, HasLight, Placement, Profile, SourceKind, source, source_struct};
use crate::scene::values::{Checked, read_vector, vector};

source_struct! {
    /// A point of light: `1/d`, or by its [`Profile`] `1/d^2`, d the distance to the point M (2015, eq. 2).
    #[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
    #[serde(deny_unknown_fields)]
    pub struct Sphere {
        /// The point, M.
        #[serde(default, deserialize_with = "read_vector")]
        pub center: DVec3,
    }
}

impl Default for Sphere {
    fn default() -> Self {
        source!(Self {
            center: DVec3::ZERO,
        })
    }
}

impl SourceKind for Sphere {
    keys! { KEYS;
        center: VECTOR, WORLD, Value("[0, 0, 0]"), "the point";
    }

    fn check(&self, brightness: &Brightness) -> Checked {
        vector("center", self.center)?;
        self.shared().check(brightness, &|light| light.coefficient.abs())
    }

    fn move_core(&mut self, place: &Placement) {
        self.center = place.point(self.center);
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
