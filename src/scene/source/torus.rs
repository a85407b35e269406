//! A ring of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, HasLight, Placement, Profile, SourceKind, emissions_along, plus_z, source, source_struct};
use crate::scene::chain::{LitChain, Piece, Run};
use crate::scene::emitter::{AddEmitter, EmitterCore, add_even};
use crate::scene::values::{
    Checked, Fault, direction, finite, positive, read_some_pair, read_some_vector, read_vector, vector,
};

source_struct! {
    /// A ring of light: `1/d`, or by its [`Profile`] `1/d^2`, d the distance to the nearest point of the major circle
    /// (2015, eq. 7).
    #[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
    #[serde(deny_unknown_fields)]
    pub struct Torus along {
        /// Middle of the ring.
        #[serde(default, deserialize_with = "read_vector")]
        pub center: DVec3,
        /// Normal of the ring's plane, of any length but zero.
        #[serde(default = "plus_z", deserialize_with = "read_vector")]
        pub axis: DVec3,
        /// Radius of the circle, positive.
        pub major_radius: f64,
        /// The part of the ring that there is, from one angle to another, degrees, by at most a full turn; series go
        /// from the first to the second. `None`: all of it, from 0 to 360.
        #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "read_some_pair")]
        pub sweep: Option<[f64; 2]>,
        /// Where the angle 0 is: as seen from the centre, what of this is at right angles to the axis. Angles grow
        /// counterclockwise where the axis points at the viewer. `None`: x of the world, or y where the axis is x.
        #[serde(
            default,
            skip_serializing_if = "Option::is_none",
            deserialize_with = "read_some_vector"
        )]
        pub start: Option<DVec3>,
    }
}

impl Torus {
    /// Makes a white ring around the origin, in the plane z = 0.
    #[must_use]
    pub fn new(major_radius: f64) -> Self {
        source!(Self along {
            center: DVec3::ZERO,
            axis: plus_z(),
            major_radius,
            sweep: None,
            start: None,
        })
    }

    /// Returns the direction of the angle 0, of length 1.
    fn start(&self) -> DVec3 {
        let axis = self.axis.normalize();
        let across = |v: DVec3| v - v.dot(axis) * axis;
        let of_world = match across(DVec3::X).length() > LEAST_ACROSS {
            true => DVec3::X,
            false => DVec3::Y,
        };
        across(self.start.unwrap_or(of_world)).normalize()
    }

    /// Returns its whole core, of which dashes may be left.
    fn whole(&self) -> Run {
        let x = self.major_radius * self.start();
        let y = self.axis.normalize().cross(x);
        Run::whole(Piece::circle(self.center, x, y, self.angles()))
    }

    /// Returns from where to where it goes, radians.
    fn angles(&self) -> [f64; 2] {
        self.sweep.unwrap_or([0.0, 360.0]).map(f64::to_radians)
    }

    fn is_even(&self) -> bool {
        self.sweep.is_none() && self.along_keys().is_even()
    }

    fn check_angles(&self) -> Checked {
        if let Some(start) = self.start {
            direction("start", start)?;
            let across = start.normalize().cross(self.axis.normalize()).length();
            if across < LEAST_ACROSS {
                let message = "lies along the axis: give a direction across it";
                return Err(Fault::new("start", message));
            }
        }
        let Some([from, to]) = self.sweep else {
            return Ok(());
        };
        finite("sweep", from)?;
        finite("sweep", to)?;
        match to - from {
            sweep if sweep > 0.0 && sweep <= 360.0 => Ok(()),
            sweep => Err(Fault::new(
                "sweep",
                format!("goes from one angle to a greater one, by at most 360 degrees; found {sweep}"),
            )),
        }
    }
}

/// The sine of the least angle between the axis of a ring and where its angles begin.
const LEAST_ACROSS: f64 = 1e-3;

impl SourceKind for Torus {
    keys! { KEYS;
        center: VECTOR, WORLD, Value("[0, 0, 0]"), "the middle of the ring";
        axis: VECTOR, NONE, Value("[0, 0, 1]"), "the normal of its plane, of any length but zero";
        major_radius: POSITIVE, WORLD, Required, "the radius of the circle";
        sweep: PAIR, DEGREES, Otherwise("all of it"),
            "the part of the ring that there is, from one angle to a greater one";
        start: VECTOR, NONE, Otherwise("x, or y about x"), "the direction of the angle 0, as seen from the centre";
    }

    #[cfg(feature = "files")]
    const ALONG: &[crate::scene::keys::Key] = super::shared::ALONG_KEYS;

    fn check(&self, brightness: &Brightness) -> Checked {
        vector("center", self.center)?;
        direction("axis", self.axis)?;
        positive("major_radius", self.major_radius)?;
        self.check_angles()?;
        let (along, shared) = (self.along_keys(), self.shared().adding_up());
        along.check(&shared, self.radius)?;
        along.check_arc(|| self.whole())?;
        shared.check(brightness, &|light| along.strongest() * light.coefficient.abs())
    }

    fn for_each_emission(&self, add: &mut dyn FnMut(DVec3)) {
        emissions_along(&self.along_keys().lights(&self.shared()), add);
    }

    fn move_core(&mut self, place: &Placement) {
        if !self.is_even() {
            self.start = Some(place.direction(self.start()));
        }
        self.center = place.point(self.center);
        self.axis = place.direction(self.axis);
        self.major_radius *= place.scale;
        self.scale_along(place.scale);
    }

    fn core(&self) -> Core {
        if self.sweep.is_some() || self.arc.is_some() {
            let chain = self.along_keys().chain(self.whole(), None);
            return Core::Chain(chain.rough_corners());
        }
        Core::Circle {
            center: self.center,
            axis: self.axis.normalize(),
            radius: self.major_radius,
        }
    }

    fn uneven(&self) -> Option<&'static str> {
        self.along_keys().uneven()
    }

    fn as_chains(&self) -> Option<Vec<LitChain>> {
        let is_ring = self.is_even() && !self.shared().adds_any_up();
        (!is_ring).then(|| self.along_keys().lit(self.whole(), None, &self.shared()))
    }

    fn for_each_emitter(&self, add: AddEmitter<'_>) {
        let chains = match self.arc {
            None => self.as_chains(),
            Some(_) => None, // displaced cores are no parts of circles
        };
        let Some(chains) = chains else {
            return add_even(self, add);
        };
        let x = self.major_radius * self.start();
        let y = self.axis.normalize().cross(x);
        let [begin, end] = self.angles();
        for lit in chains {
            for run in &lit.chain.runs {
                for pair in lit.knots(run, &[]).windows(2) {
                    let [from, to] = [pair[0], pair[1]];
                    let arc = EmitterCore::Arc {
                        center: self.center,
                        x,
                        y,
                        angles: [from, to].map(|own| begin + (end - begin) * run.share(own)),
                    };
                    add(arc, lit.light_over(run, [from, 0.5 * (from + to), to]));
                }
            }
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
