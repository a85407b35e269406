//! The sources of light: each a scalar field that falls off from a core, times a coefficient and a colour.

use std::borrow::Cow;

use glam::DVec3;

use super::chain::{LightAlong, LitChain};
use super::emitter::{AddEmitter, add_even};
use super::group::Placement;
use super::kinds::for_each_kind;
use super::values::{Checked, Fault, finite, vector};
use super::{Measure, Reduction};

mod core;
mod falloff;
mod layer;
mod shared;

pub(super) use core::{Core, ball_around};
pub use falloff::{Falloff, Profile};
#[cfg(feature = "files")]
pub(super) use layer::LAYER_KEYS;
pub use layer::Layer;
use layer::read_layers;
#[cfg(feature = "files")]
pub(super) use shared::SHARED_KEYS;
pub(crate) use shared::{CoreLight, HasLight, Shared};
use shared::{source, source_struct};

macro_rules! declare_kinds {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        $(mod $kind;)*
        $(pub use $kind::*;)*
    };
}
for_each_kind!(declare_kinds);

/// What makes a source's core glow: a source has one light, or one a layer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Light {
    pub coefficient: f64,
    pub color: DVec3,
    pub falloff: Falloff,
}

impl Light {
    /// Returns colour times coefficient, linear RGB.
    pub(crate) fn emission(&self) -> DVec3 {
        self.color * self.coefficient
    }
}

/// What every kind of source says of itself.
pub(crate) trait SourceKind: HasLight {
    /// What is read of its own keys.
    #[cfg(feature = "files")]
    const KEYS: &[super::keys::Key];

    /// What is read besides of a core along which light may change.
    #[cfg(feature = "files")]
    const ALONG: &[super::keys::Key] = &[];

    /// Checks its values; `brightness` tells which light float32 can hold.
    fn check(&self, brightness: &Brightness) -> Checked;

    /// Calls `add` with the emission of each of its parts, where some may be of another sign.
    fn for_each_emission(&self, add: &mut dyn FnMut(DVec3)) {
        self.lights().for_each(|light| add(light.emission()));
    }

    /// Moves its own points, directions and lengths to where a group puts them; what all kinds have is scaled for it.
    fn move_core(&mut self, place: &Placement);

    /// Returns it as a group puts it.
    fn placed(&self, place: &Placement) -> Self
    where
        Self: Clone,
    {
        let mut placed = self.clone();
        placed.move_core(place);
        placed.scale(place.scale);
        placed
    }

    /// Returns where its core is, of a source whose values are right.
    fn core(&self) -> Core;

    /// Calls `add` with the parts of its core that cast light on surfaces, and what they emit.
    fn for_each_emitter(&self, add: AddEmitter<'_>)
    where
        Self: Sized,
    {
        add_even(self, add);
    }

    /// Returns the chains that it is drawn as where light changes along its core, whose lights add; `None`: it is drawn
    /// as it is.
    fn as_chains(&self) -> Option<Vec<LitChain>> {
        None
    }

    /// Makes a source of this kind at about `place`, for the self-test of kernels.
    fn specimen(place: DVec3, profile: Profile) -> Self;

    /// Returns the key with which it has more than one light, or one that is not the same all along its core; layers
    /// aside.
    fn uneven(&self) -> Option<&'static str> {
        None
    }

    /// Makes a specimen even ([`SourceKind::uneven`]), where it is not.
    #[must_use]
    fn evened(self) -> Self
    where
        Self: Sized,
    {
        self
    }

    /// Gives a specimen a series over its core, where its kind has such.
    #[must_use]
    fn with_series(self) -> Self
    where
        Self: Sized,
    {
        self
    }
}

/// No product on the way to a pixel may exceed this: sums of up to 1e8 such lights are still finite in float32.
pub(crate) const BRIGHTEST: f64 = 1e30;

/// A bound of the integral of 1/r over a core of any length, seen from anywhere: lengths reach up to 1e9, and floors of
/// distances begin at 1e-15.
const MOST_ADDED_UP: f64 = 120.0;

/// What decay and measure can make of a field on a ray through a core, and how close the ray comes to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Brightness {
    /// The greatest value of decay times measure.
    pub most: f64,
    /// World units.
    pub least_distance: f64,
    pub measure: Measure,
    pub reduction: Reduction,
}

impl Brightness {
    /// Returns the greatest value that decay times field times measure can take, of squared fields where those are
    /// integrated.
    pub(crate) fn of(&self, falloff: Falloff) -> f64 {
        let distance = self.least_distance.hypot(falloff.radius);
        let field = match falloff.profile {
            Profile::Inverse => 1.0 / distance,
            Profile::InverseSquare => distance.powi(-2),
            Profile::InverseCube => distance.powi(-3),
            Profile::Gaussian => 1.0,
            Profile::Smeared => 1.0 / falloff.radius,
            Profile::Convolution => MOST_ADDED_UP,
        };
        self.most * self.reduction.summand(field)
    }

    /// Checks the light that the keys of a source, or of one of its layers, make; `strongest` gives the greatest
    /// coefficient that it has anywhere.
    fn check_light(&self, shared: &Shared<'_>, strongest: &dyn Fn(&Light) -> f64) -> Checked {
        vector("color", shared.color)?;
        let falloff = shared.falloff();
        if falloff.profile == Profile::Convolution {
            if !shared.adds_up {
                let message = "adds up the light of a [[segment]], [[path]] or [[torus]]; other cores have none";
                return Err(Fault::new("profile", message));
            }
            falloff.check_convolution(shared.peak)?;
        }
        falloff.check()?;
        match shared.peak {
            Some(peak) => falloff.check_peak(peak, self.measure)?,
            None => finite("coefficient", shared.coefficient)?,
        }
        let strongest = strongest(&shared.light());
        let brightest = self.of(falloff) * strongest * shared.color.abs().max_element();
        if brightest > BRIGHTEST {
            return Err(Fault::new(
                if shared.peak.is_some() {
                    "peak"
                } else {
                    "coefficient"
                },
                match self.reduction {
                    Reduction::Sum => format!(
                        "next to the core the light comes to {brightest:.0e}, more than float32 holds"
                    ),
                    Reduction::Rms => format!(
                        "next to the core its square comes to {brightest:.0e}, more than float32 holds: give a radius"
                    ),
                },
            ));
        }
        Ok(())
    }
}

/// Calls `add` with the emission of all lights of a source along its core.
fn emissions_along(lights: &[LightAlong], add: &mut dyn FnMut(DVec3)) {
    for LightAlong { light, values, .. } in lights {
        match values.is_empty() {
            true => add(light.emission()),
            false => values
                .iter()
                .for_each(|(_, value)| add(*value * light.emission())),
        }
    }
}

/// Returns the name of an item of a list in a file, such as `intensity[3]`.
pub(super) fn item(list: &str, index: usize) -> Cow<'static, str> {
    format!("{list}[{index}]").into()
}

fn plus_z() -> DVec3 {
    DVec3::Z
}

fn one() -> f64 {
    1.0
}

pub(super) fn white() -> DVec3 {
    DVec3::ONE
}
