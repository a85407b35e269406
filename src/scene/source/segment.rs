//! A finite line of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, HasLight, Light, Placement, Profile, SourceKind, source, source_struct};
use crate::scene::values::{Checked, read_vector, vector};

source_struct! {
    /// A finite line of light: `1/d`, or by its [`Profile`] `1/d^2`, d the distance to the nearest point between its
    /// ends. Ends that coincide make a point.
    #[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
    #[serde(deny_unknown_fields)]
    pub struct Segment {
        /// One end.
        #[serde(deserialize_with = "read_vector")]
        pub from: DVec3,
        /// The other end.
        #[serde(deserialize_with = "read_vector")]
        pub to: DVec3,
    }
}

impl Segment {
    /// Makes a white line between two points.
    #[must_use]
    pub fn new(from: DVec3, to: DVec3) -> Self {
        source!(Self {
            from,
            to,
        })
    }
}

impl SourceKind for Segment {
    fn check(&self, brightness: &Brightness) -> Checked {
        vector("from", self.from)?;
        vector("to", self.to)?;
        let strongest = |light: &Light| light.coefficient.abs();
        self.shared().adding_up().check(brightness, &strongest)
    }

    fn move_core(&mut self, place: &Placement) {
        self.from = place.point(self.from);
        self.to = place.point(self.to);
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
