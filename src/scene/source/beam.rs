//! A half-line of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{
    Brightness, Core, Falloff, HasLight, Light, Placement, Profile, Shared, SourceKind, emissions_along, source,
    source_struct,
};
use crate::scene::chain::{LitChain, Piece, Run};
use crate::scene::emitter::{AddEmitter, EmitterCore, add_even, emission};
use crate::scene::values::{Fault, Checked, direction, finite, named, positive, read_vector, vector};

source_struct! {
    /// A half-line of light (Abe, Watanabe 2010, eq. 6, 11, 12); `1/d^2` for `1/d` by its [`Profile`]. Ahead of the
    /// plane through its tip M, perpendicular to its direction, `1/d` with d the distance to the line; behind it what
    /// its [`BeamEnd`] says.
    #[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
    #[serde(try_from = "BeamTable", into = "BeamTable")]
    pub struct Beam along {
        /// The point at which it begins, M.
        pub tip: DVec3,
        /// Where it goes, of any length but zero.
        pub direction: DVec3,
        /// What glows behind the tip.
        pub end: BeamEnd,
        /// The coefficient of a further sphere around M, everywhere (2010, eq. 12: a).
        pub sphere_coefficient: f64,
        /// Over which length from the tip series and dashes go, world units; beyond it the last values hold.
        pub series_length: Option<f64>,
    }
}

/// What glows behind the tip of a beam. In files `cap_coefficient` or `taper_length`, or neither for a cap as bright as
/// the line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BeamEnd {
    /// `1/d` with d the distance to the tip, of this coefficient; `None`: the line's, without a jump between them
    /// (2010, eq. 11).
    Cap(Option<f64>),
    /// The line's own field, falling linearly to 0 over this length behind the tip, world units (Sakai 2006, fig. 4.3).
    Taper(f64),
}

/// Beyond the end of every ray, world units.
const BEYOND_ALL: f64 = 4e9;

impl Beam {
    /// Makes a white beam from the origin.
    #[must_use]
    pub fn new(direction: DVec3) -> Self {
        source!(Self along {
            tip: DVec3::ZERO,
            direction,
            end: BeamEnd::Cap(None),
            sphere_coefficient: 0.0,
            series_length: None,
        })
    }

    fn check_series(&self) -> Checked {
        let along = self.along_keys();
        along.check(&self.shared(), self.radius)?;
        if along.arc.is_some() {
            let message = "displaces cores that end, and a beam does not: draw a [[segment]]";
            return Err(Fault::new("arc", message));
        }
        let is_even = along.is_even();
        match self.series_length {
            Some(length) => positive("series_length", length)?,
            None if is_even => return Ok(()),
            None => {
                let message = "required with intensity, colors, radii or dashes: how far from the tip they go";
                return Err(Fault::new("series_length", message));
            }
        }
        match self.uneven_end() {
            Some(key) if !is_even => {
                let message = "does not go with intensity, colors, radii or dashes: such a beam ends as a point does";
                Err(Fault::new(key, message))
            }
            _ => Ok(()),
        }
    }

    /// Returns the key by which it does not end as a point of its own light does, if there is one.
    fn uneven_end(&self) -> Option<&'static str> {
        match self.end {
            BeamEnd::Taper(_) => Some("taper_length"),
            BeamEnd::Cap(Some(_)) => Some("cap_coefficient"),
            BeamEnd::Cap(None) => (self.sphere_coefficient != 0.0).then_some("sphere_coefficient"),
        }
    }

    /// Returns the coefficient of the sphere behind the tip, for one of its lights; 0 where there is a taper instead.
    pub(crate) fn cap(&self, light: &Light) -> f64 {
        match self.end {
            BeamEnd::Cap(coefficient) => coefficient.unwrap_or(light.coefficient),
            BeamEnd::Taper(_) => 0.0,
        }
    }

    /// Returns the length of the taper behind the tip, if there is one.
    pub(crate) fn taper_length(&self) -> Option<f64> {
        match self.end {
            BeamEnd::Cap(_) => None,
            BeamEnd::Taper(length) => Some(length),
        }
    }
}

impl SourceKind for Beam {
    keys! { KEYS;
        tip: VECTOR, WORLD, Value("[0, 0, 0]"), "the point at which it begins";
        direction: VECTOR, NONE, Required, "where it goes, of any length but zero";
        cap_coefficient: ANY, NONE, Otherwise("that of the line"),
            "the coefficient of the point's field behind the tip";
        sphere_coefficient: ANY, NONE, Value("0"), "the coefficient of a further sphere around the tip, everywhere";
        taper_length: POSITIVE, WORLD, Otherwise("a cap"),
            "behind the tip the line's own field fades to 0 over this length";
        series_length: POSITIVE, WORLD, Otherwise("none"), "over which length from the tip series go";
    }

    #[cfg(feature = "files")]
    const ALONG: &[crate::scene::keys::Key] = super::shared::ALONG_KEYS;

    fn check(&self, brightness: &Brightness) -> Checked {
        vector("tip", self.tip)?;
        direction("direction", self.direction)?;
        match self.end {
            BeamEnd::Taper(length) => positive("taper_length", length)?,
            BeamEnd::Cap(Some(cap)) => finite("cap_coefficient", cap)?,
            BeamEnd::Cap(None) => {}
        }
        finite("sphere_coefficient", self.sphere_coefficient)?;
        self.check_series()?;
        self.shared().check(brightness, &|light| {
            let line = light.coefficient.abs().max(self.cap(light).abs());
            self.along_keys().strongest() * line + self.sphere_coefficient.abs()
        })
    }

    fn for_each_emission(&self, add: &mut dyn FnMut(DVec3)) {
        if !self.along_keys().is_even() {
            emissions_along(&self.along_keys().lights(&self.shared()), add);
            return;
        }
        for light in self.lights() {
            for coefficient in [light.coefficient, self.cap(&light), self.sphere_coefficient] {
                add(coefficient * light.color);
            }
        }
    }

    fn move_core(&mut self, place: &Placement) {
        self.tip = place.point(self.tip);
        self.direction = place.direction(self.direction);
        self.series_length = self.series_length.map(|length| place.scale * length);
        self.scale_along(place.scale);
        if let BeamEnd::Taper(length) = &mut self.end {
            *length *= place.scale;
        }
    }

    fn core(&self) -> Core {
        let direction = self.direction.normalize();
        Core::Line {
            point: self.tip - direction * self.taper_length().unwrap_or(0.0),
            direction,
            begins: true,
        }
    }

    fn uneven(&self) -> Option<&'static str> {
        self.uneven_end().or(self.along_keys().uneven())
    }

    fn as_chains(&self) -> Option<Vec<LitChain>> {
        let along = self.along_keys();
        let length = self.series_length?;
        if along.is_even() {
            return None;
        }
        let direction = self.direction.normalize();
        let last = self.tip + length * direction;
        let mut arms = along.lit(Run::whole(vec![Piece::straight(self.tip, last)]), None, &self.shared());
        arms.first_mut()?.chain.runs.push(Run {
            pieces: vec![Piece::straight(last, last + BEYOND_ALL * direction)],
            shares: [1.0, 1.0],
            fade: [1.0, 1.0],
        });
        Some(arms)
    }

    /// The cap is how the end of the line glows, and emits nothing of its own.
    fn for_each_emitter(&self, add: AddEmitter<'_>) {
        if self.as_chains().is_some() {
            return add_even(self, add);
        }
        let line = |range| EmitterCore::Line {
            point: self.tip,
            direction: self.direction.normalize(),
            range,
        };
        let light = emission(self.lights(), Falloff::cast_by_line);
        add(line([0.0, f64::INFINITY]), [light; 3]);
        if let BeamEnd::Taper(length) = self.end {
            add(line([-length, 0.0]), [DVec3::ZERO, 0.5 * light, light]);
        }
        let spheres = self.lights().map(|light| Light {
            coefficient: self.sphere_coefficient,
            ..light
        });
        add(EmitterCore::Point(self.tip), [emission(spheres, Falloff::cast_by_point); 3]);
    }

    fn evened(self) -> Self {
        Self {
            end: BeamEnd::Cap(None),
            ..self
        }
    }

    fn specimen(place: DVec3, profile: Profile) -> Self {
        Self {
            tip: -place,
            end: BeamEnd::Cap(Some(0.7)),
            color: DVec3::new(0.5, 0.2, 1.0),
            profile,
            ..Self::new(DVec3::new(-1.0, 0.2, 0.6))
        }
    }
}

source_struct! {
    /// A beam as a file describes it.
    #[derive(Deserialize, Serialize)]
    #[serde(deny_unknown_fields)]
    struct BeamTable along {
        #[serde(default, deserialize_with = "read_vector")]
        tip: DVec3,
        #[serde(deserialize_with = "read_vector")]
        direction: DVec3,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        cap_coefficient: Option<f64>,
        #[serde(default)]
        sphere_coefficient: f64,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        taper_length: Option<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        series_length: Option<f64>,
    }
}

/// Returns what is said by the keys that all kinds have, where radii may stand for the radius.
fn own_keys(radius: f64, shared: Shared<'_>) -> Shared<'_> {
    Shared { radius, ..shared }
}

impl TryFrom<BeamTable> for Beam {
    type Error = String;

    fn try_from(table: BeamTable) -> Result<Self, String> {
        let end = match (table.cap_coefficient, table.taper_length) {
            (Some(_), Some(_)) => {
                return Err(named(
                    "cap_coefficient",
                    "behind its tip a beam has a cap or a taper: leave out cap_coefficient or taper_length",
                ));
            }
            (None, Some(length)) => BeamEnd::Taper(length),
            (cap, None) => BeamEnd::Cap(cap),
        };
        Ok(source!(Self {
            tip: table.tip,
            direction: table.direction,
            end,
            sphere_coefficient: table.sphere_coefficient,
            series_length: table.series_length,
            intensity: table.intensity.clone(),
            colors: table.colors.clone(),
            radii: table.radii.clone(),
            arc: table.arc,
            dashes: table.dashes,
        } like own_keys(table.radius, table.shared())))
    }
}

impl From<Beam> for BeamTable {
    fn from(beam: Beam) -> Self {
        source!(Self {
            tip: beam.tip,
            direction: beam.direction,
            cap_coefficient: match beam.end {
                BeamEnd::Cap(coefficient) => coefficient,
                BeamEnd::Taper(_) => None,
            },
            sphere_coefficient: beam.sphere_coefficient,
            taper_length: beam.taper_length(),
            series_length: beam.series_length,
            intensity: beam.intensity.clone(),
            colors: beam.colors.clone(),
            radii: beam.radii.clone(),
            arc: beam.arc,
            dashes: beam.dashes,
        } like own_keys(beam.radius, beam.shared()))
    }
}
