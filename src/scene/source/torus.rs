//! A ring of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, HasLight, Placement, Profile, SourceKind, plus_z, source, source_struct};
use crate::scene::values::{Checked, direction, positive, read_vector, vector};

source_struct! {
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
    }
}

impl Torus {
    /// Makes a white ring around the origin, in the plane z = 0.
    #[must_use]
    pub fn new(major_radius: f64) -> Self {
        source!(Self {
            center: DVec3::ZERO,
            axis: plus_z(),
            major_radius,
        })
    }
}

impl SourceKind for Torus {
    fn check(&self, brightness: &Brightness) -> Checked {
        vector("center", self.center)?;
        direction("axis", self.axis)?;
        positive("major_radius", self.major_radius)?;
        self.shared().check(brightness, &|light| light.coefficient.abs())
    }

    fn move_core(&mut self, place: &Placement) {
        self.center = place.point(self.center);
        self.axis = place.direction(self.axis);
        self.major_radius *= place.scale;
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
