//! A finite line of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, HasLight, Light, Placement, Profile, SourceKind, emissions_along, source, source_struct};
use crate::scene::chain::{Along, LitChain, Piece, Run};
use crate::scene::values::{Checked, Fault, finite, read_pair, read_vector, vector};

source_struct! {
    /// A finite line of light: `1/d`, or by its [`Profile`] `1/d^2`, d the distance to the nearest point between its
    /// ends. Ends that coincide make a point.
    #[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
    #[serde(deny_unknown_fields)]
    pub struct Segment along {
        /// One end.
        #[serde(deserialize_with = "read_vector")]
        pub from: DVec3,
        /// The other end.
        #[serde(deserialize_with = "read_vector")]
        pub to: DVec3,
        /// Over which lengths the light rises from 0 at either end, world units; 0: it does not, and the end glows as a
        /// point does.
        #[serde(default, skip_serializing_if = "is_even", deserialize_with = "read_pair")]
        pub taper_lengths: [f64; 2],
    }
}

fn is_even(lengths: &[f64; 2]) -> bool {
    *lengths == [0.0; 2]
}

impl Segment {
    /// Makes a white line between two points.
    #[must_use]
    pub fn new(from: DVec3, to: DVec3) -> Self {
        source!(Self along {
            from,
            to,
            taper_lengths: [0.0; 2],
        })
    }

    fn along(&self) -> Along<'_> {
        let length = self.from.distance(self.to);
        let share = |over: f64| if over > 0.0 { over / length } else { 0.0 };
        Along {
            tapers: self.taper_lengths.map(share),
            ..self.along_keys()
        }
    }

    fn whole(&self) -> Run {
        Run::whole(vec![Piece::straight(self.from, self.to)])
    }
}

impl SourceKind for Segment {
    keys! { KEYS;
        from: VECTOR, WORLD, Required, "one end";
        to: VECTOR, WORLD, Required, "the other end; ends that coincide make a point";
        taper_lengths: PAIR, WORLD, Value("[0, 0]"), "over which lengths the light rises from 0 at either end";
    }

    #[cfg(feature = "files")]
    const ALONG: &[crate::scene::keys::Key] = super::shared::ALONG_KEYS;

    fn check(&self, brightness: &Brightness) -> Checked {
        vector("from", self.from)?;
        vector("to", self.to)?;
        for length in self.taper_lengths {
            finite("taper_lengths", length)?;
            if length < 0.0 {
                let message = format!("light rises over 0 or more from either end; found {length}");
                return Err(Fault::new("taper_lengths", message));
            }
        }
        let (along, shared) = (self.along(), self.shared().adding_up());
        along.check(&shared, self.radius)?;
        along.check_arc(|| self.whole())?;
        let strongest = |light: &Light| along.strongest() * light.coefficient.abs();
        shared.check(brightness, &strongest)
    }

    fn for_each_emission(&self, add: &mut dyn FnMut(DVec3)) {
        emissions_along(&self.along().lights(&self.shared()), add);
    }

    fn move_core(&mut self, place: &Placement) {
        self.from = place.point(self.from);
        self.to = place.point(self.to);
        self.taper_lengths = self.taper_lengths.map(|length| place.scale * length);
        self.scale_along(place.scale);
    }

    fn core(&self) -> Core {
        match self.arc {
            Some(_) => Core::Chain(self.along().chain(self.whole(), None).rough_corners()),
            None => Core::between(self.from, self.to),
        }
    }

    fn uneven(&self) -> Option<&'static str> {
        self.along().uneven()
    }

    fn as_chains(&self) -> Option<Vec<LitChain>> {
        let along = self.along();
        (!along.is_even()).then(|| along.lit(self.whole(), None, &self.shared()))
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
