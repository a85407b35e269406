//! An infinite line of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, HasLight, Placement, Profile, SourceKind, source, source_struct};
use crate::scene::values::{Checked, direction, read_vector, vector};

source_struct! {
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
    }
}

impl Cylinder {
    /// Makes a white line through the origin.
    #[must_use]
    pub fn new(direction: DVec3) -> Self {
        source!(Self {
            point: DVec3::ZERO,
            direction,
        })
    }
}

impl SourceKind for Cylinder {
    keys! { KEYS;
        point: VECTOR, WORLD, Value("[0, 0, 0]"), "a point of the line";
        direction: VECTOR, NONE, Required, "where the line goes, of any length but zero";
    }

    fn check(&self, brightness: &Brightness) -> Checked {
        vector("point", self.point)?;
        direction("direction", self.direction)?;
        self.shared().check(brightness, &|light| light.coefficient.abs())
    }

    fn move_core(&mut self, place: &Placement) {
        self.point = place.point(self.point);
        self.direction = place.direction(self.direction);
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
