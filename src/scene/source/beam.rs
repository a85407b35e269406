//! A half-line of light.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Brightness, Core, Falloff, Light, Profile, SourceKind, one, white};
use crate::scene::values::{Checked, direction, finite, named, positive, read_vector, vector};

/// A half-line of light (Abe, Watanabe 2010, eq. 6, 11, 12); `1/d^2` for `1/d` by its [`Profile`]. Ahead of the plane
/// through its tip M, perpendicular to its direction, `1/d` with d the distance to the line; behind it what its
/// [`BeamEnd`] says.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "BeamTable", into = "BeamTable")]
pub struct Beam {
    /// The point at which it begins, M.
    pub tip: DVec3,
    /// Where it goes, of any length but zero.
    pub direction: DVec3,
    /// The energy coefficient of the line, b.
    pub coefficient: f64,
    /// Linear RGB.
    pub color: DVec3,
    /// What glows behind the tip.
    pub end: BeamEnd,
    /// The coefficient of a further sphere around M, everywhere (2010, eq. 12: a).
    pub sphere_coefficient: f64,
    /// How the fields fall off.
    pub profile: Profile,
    /// How thick the core is: `d^2 + radius^2` stands for `d^2`; world units, 0 for none.
    pub radius: f64,
    /// The distance at which the light ends, smoothly; world units, more than the radius. `None`: nowhere.
    pub reach: Option<f64>,
    /// Takes the coefficient's place: the light of a ray straight across the core, measured by length, without decay.
    /// It needs a radius, and where the light of the profile has no end, a reach.
    pub peak: Option<f64>,
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

impl Beam {
    /// Makes a white beam from the origin.
    #[must_use]
    pub fn new(direction: DVec3) -> Self {
        Self {
            tip: DVec3::ZERO,
            direction,
            coefficient: one(),
            color: white(),
            end: BeamEnd::Cap(None),
            sphere_coefficient: 0.0,
            profile: Profile::default(),
            radius: 0.0,
            reach: None,
            peak: None,
        }
    }

    /// Returns the coefficient of the sphere behind the tip; 0 where there is a taper instead.
    pub(crate) fn cap(&self) -> f64 {
        match self.end {
            BeamEnd::Cap(coefficient) => coefficient.unwrap_or(self.light().coefficient),
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
    fn check(&self, brightness: &Brightness) -> Checked {
        vector("tip", self.tip)?;
        direction("direction", self.direction)?;
        match self.end {
            BeamEnd::Taper(length) => positive("taper_length", length)?,
            BeamEnd::Cap(Some(cap)) => finite("cap_coefficient", cap)?,
            BeamEnd::Cap(None) => {}
        }
        finite("sphere_coefficient", self.sphere_coefficient)?;
        brightness.check_light(self.light(), self.peak, 1.0)?;
        let line = self.light().coefficient.abs().max(self.cap().abs());
        let strongest = line + self.sphere_coefficient.abs();
        let strongest = Light {
            coefficient: strongest,
            ..self.light()
        };
        brightness.check_light(strongest, self.peak, 1.0)
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

    fn for_each_emission(&self, add: &mut dyn FnMut(DVec3)) {
        for coefficient in [self.light().coefficient, self.cap(), self.sphere_coefficient] {
            add(coefficient * self.color);
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

/// A beam as a file describes it.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct BeamTable {
    #[serde(default, deserialize_with = "read_vector")]
    tip: DVec3,
    #[serde(deserialize_with = "read_vector")]
    direction: DVec3,
    #[serde(default = "one")]
    coefficient: f64,
    #[serde(default = "white", deserialize_with = "read_vector")]
    color: DVec3,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    cap_coefficient: Option<f64>,
    #[serde(default)]
    sphere_coefficient: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    taper_length: Option<f64>,
    #[serde(default)]
    profile: Profile,
    #[serde(default)]
    radius: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reach: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    peak: Option<f64>,
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
        Ok(Self {
            tip: table.tip,
            direction: table.direction,
            coefficient: table.coefficient,
            color: table.color,
            end,
            sphere_coefficient: table.sphere_coefficient,
            profile: table.profile,
            radius: table.radius,
            reach: table.reach,
            peak: table.peak,
        })
    }
}

impl From<Beam> for BeamTable {
    fn from(beam: Beam) -> Self {
        Self {
            tip: beam.tip,
            direction: beam.direction,
            coefficient: beam.coefficient,
            color: beam.color,
            cap_coefficient: match beam.end {
                BeamEnd::Cap(coefficient) => coefficient,
                BeamEnd::Taper(_) => None,
            },
            sphere_coefficient: beam.sphere_coefficient,
            taper_length: beam.taper_length(),
            profile: beam.profile,
            radius: beam.radius,
            reach: beam.reach,
            peak: beam.peak,
        }
    }
}
