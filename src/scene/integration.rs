//! How the light along a ray is summed.

use serde::{Deserialize, Serialize};

use super::lit_points::Crowd;
use super::values::{Checked, Fault, finite, positive};

/// On every device the squared distance to a core is never taken below `(CORE_FLOOR |E - S|)^2`, so that every pixel is
/// finite.
pub const CORE_FLOOR: f64 = 1e-6;

/// Decay with distance, `zeta(s) = alpha / (s + beta)^power` over s in `[0,1]`; with the power 2 that of Watanabe, Abe,
/// Konno 2015, eq. 21.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Decay {
    /// Strength; positive.
    pub alpha: f64,
    /// Offset; positive.
    pub beta: f64,
    /// 0, 1, 2 or 3; with 0 zeta is alpha everywhere.
    #[serde(default = "square", skip_serializing_if = "is_square")]
    pub power: u32,
}

// What is read of `[decay]`.
keys! { pub(super) DECAY_KEYS;
    alpha: POSITIVE, NONE, Required, "strength of alpha / (s + beta)^power, s from 0 to 1 along a ray";
    beta: POSITIVE, NONE, Required, "its offset";
    power: Whole(0, 3), NONE, Value("2"), "2 is that of 2015; with 0 light is alpha everywhere";
}

fn square() -> u32 {
    2
}

#[allow(clippy::trivially_copy_pass_by_ref)] // serde gives a reference
fn is_square(power: &u32) -> bool {
    *power == square()
}

impl Decay {
    /// Makes the decay of 2015, `alpha / (s + beta)^2`.
    #[must_use]
    pub fn new(alpha: f64, beta: f64) -> Self {
        Self {
            alpha,
            beta,
            power: square(),
        }
    }

    /// Returns `zeta(s)`.
    #[must_use]
    pub fn at(self, s: f64) -> f64 {
        let base = s + self.beta;
        match self.power {
            2 => self.alpha / (base * base),
            power => self.alpha / base.powi(power as i32),
        }
    }

    pub(super) fn check(&self) -> Checked {
        positive("alpha", self.alpha)?;
        positive("beta", self.beta)?;
        if self.power <= 3 {
            return Ok(());
        }
        let message = format!(
            "{}; light decays by one of the powers 0, 1, 2 and 3",
            self.power
        );
        Err(Fault::new("power", message))
    }
}

/// Absorption on the way from S (Beer, Lambert): light falls by `exp(-kappa x)` over the length x, world units.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Absorption {
    /// Per world unit; 0: none.
    pub kappa: f64,
}

// What is read of `[absorption]`.
keys! { pub(super) ABSORPTION_KEYS;
    kappa: NOT_NEGATIVE, "per world unit", Required,
        "light falls by exp(-kappa x), x the length from the ray's beginning";
}

impl Absorption {
    /// Returns what is left after a length, world units.
    #[must_use]
    pub fn at(self, length: f64) -> f64 {
        (-self.kappa * length).exp()
    }

    pub(super) fn check(&self) -> Checked {
        finite("kappa", self.kappa)?;
        if self.kappa >= 0.0 {
            return Ok(());
        }
        let message = format!(
            "light that passes is absorbed, or with 0 it is not; found {}",
            self.kappa
        );
        Err(Fault::new("kappa", message))
    }
}

/// How the integral along a ray is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integration {
    /// The quadrature.
    pub method: Method,
    /// Method `exact` by tiles: what the light of a source may be off by beside the tolerance, linear light, 0 or more.
    pub absolute_tolerance: f64,
    /// Over what the integral runs.
    pub measure: Measure,
    /// What a pixel has of the integrals.
    pub reduction: Reduction,
    /// Which rays a pixel stands for.
    pub antialias: Antialias,
    /// Softening radius epsilon, world units: the squared distance to every core grows by its square.
    pub softening: f64,
    /// Whether meshes, metaballs and colliders hide the light behind them; without, they are seen through all of it, as
    /// in 2010 without hidden surfaces.
    pub hidden_surfaces: bool,
    /// How the light of volumes is summed.
    pub volumes: VolumeMethod,
    /// How the light of many points is summed.
    pub crowd: Crowd,
}

impl Default for Integration {
    fn default() -> Self {
        Self {
            method: Method::default(),
            absolute_tolerance: 0.0,
            measure: Measure::Length,
            reduction: Reduction::Sum,
            antialias: Antialias::default(),
            softening: 0.0,
            hidden_surfaces: true,
            volumes: VolumeMethod::default(),
            crowd: Crowd::default(),
        }
    }
}

impl Integration {
    /// Returns whether pixels are means over their squares. Sums of samples are for comparison with the paper, and
    /// roots of integrals do not add up: their pixels are what one ray gets.
    pub(crate) fn has_footprints(&self) -> bool {
        self.antialias == Antialias::Footprint
            && matches!(self.method, Method::Exact { .. })
            && self.reduction == Reduction::Sum
    }

    /// Returns what the light of a ray of this length, world units, is multiplied with if it was taken over s.
    pub(crate) fn scale(&self, length: f64) -> f64 {
        match self.measure {
            Measure::Parameter => 1.0,
            Measure::Length => self.reduction.of(length),
        }
    }
}

/// A quadrature, with what it needs to know.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Method {
    /// Composite Simpson rule with equal divisions (2015, eq. 23), beads at the core included.
    Simpson {
        /// Number of equal divisions, even, 2 to 65536.
        divisions: u32,
    },
    /// Stratified samples (Cook 1986): one in each of equal divisions, at the same random place in all divisions of a
    /// ray. For comparison with the Simpson rule: what that makes rings, here is grain.
    Jittered {
        /// Number of equal divisions, 1 to 65536.
        divisions: u32,
        /// Chooses the random numbers: a pixel's is a function of it and of the pixel's number, by rows from the top
        /// left; that of a ray that is no pixel's, of its place in the list.
        seed: u32,
    },
    /// The integral itself.
    Exact {
        /// Relative error aimed at, 1e-12 to 1, 1 excluded.
        tolerance: f64,
        /// Where integrals are taken.
        sampling: Sampling,
    },
}

impl Method {
    /// Makes the Simpson rule with this many divisions.
    #[must_use]
    pub fn simpson(divisions: u32) -> Self {
        Self::Simpson { divisions }
    }

    /// Makes the method that takes the integral itself to a relative error, by tiles.
    #[must_use]
    pub fn exact(tolerance: f64) -> Self {
        Self::Exact {
            tolerance,
            sampling: Sampling::Tiles,
        }
    }

    /// Returns its name in files: `simpson`, `jittered` or `exact`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Simpson { .. } => "simpson",
            Self::Jittered { .. } => "jittered",
            Self::Exact { .. } => "exact",
        }
    }

    /// Returns the relative error aimed at; the default's for sums, which aim at none.
    pub(crate) fn tolerance(&self) -> f64 {
        match *self {
            Self::Simpson { .. } | Self::Jittered { .. } => 1e-3,
            Self::Exact { tolerance, .. } => tolerance,
        }
    }

    /// Returns where integrals are taken.
    pub(crate) fn sampling(&self) -> Sampling {
        match *self {
            Self::Simpson { .. } | Self::Jittered { .. } => Sampling::Pixels,
            Self::Exact { sampling, .. } => sampling,
        }
    }

    /// Returns where the method `exact` would take integrals.
    #[cfg(feature = "papers")]
    pub(crate) fn sampling_or_default(&self) -> Sampling {
        match *self {
            Self::Simpson { .. } | Self::Jittered { .. } => Sampling::default(),
            Self::Exact { sampling, .. } => sampling,
        }
    }

    /// Returns how many samples a ray takes of a light; `None` where the light decides that.
    pub(crate) fn samples(&self) -> Option<u32> {
        match *self {
            Self::Simpson { divisions } => Some(divisions + 1),
            Self::Jittered { divisions, .. } => Some(divisions),
            Self::Exact { .. } => None,
        }
    }

    pub(super) fn check(&self) -> Checked {
        match *self {
            Self::Simpson { divisions } => check_divisions(divisions),
            Self::Jittered { divisions, .. } => check_strata(divisions),
            Self::Exact { tolerance, .. } => check_tolerance(tolerance),
        }
    }
}

impl Default for Method {
    /// Returns the method that takes the integral to 1e-3, by tiles.
    fn default() -> Self {
        Self::exact(1e-3)
    }
}

pub(super) fn check_divisions(divisions: u32) -> Checked {
    if (2..=65536).contains(&divisions) && divisions.is_multiple_of(2) {
        return Ok(());
    }
    let message = format!("{divisions}; Simpson's rule needs an even number from 2 to 65536");
    Err(Fault::new("divisions", message))
}

pub(super) fn check_strata(divisions: u32) -> Checked {
    if (1..=65536).contains(&divisions) {
        return Ok(());
    }
    let message = format!("{divisions}; stratified samples need 1 to 65536 divisions");
    Err(Fault::new("divisions", message))
}

pub(super) fn check_tolerance(tolerance: f64) -> Checked {
    finite("tolerance", tolerance)?;
    if (1e-12..1.0).contains(&tolerance) {
        return Ok(());
    }
    let message = "must lie between 1e-12 and 1, 1 excluded";
    Err(Fault::new("tolerance", message))
}

/// How the light of volumes is summed along rays.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum VolumeMethod {
    /// The part of each ray in a volume's box, divided evenly into pieces.
    Ray {
        /// Length of a piece at most, cells, 0.01 to 100.
        step: f64,
    },
    /// Planes perpendicular to the view, at equal distances within the ball around a volume's box (Sakai 2006).
    Slices {
        /// How many, 1 to 65536.
        count: u32,
    },
}

impl Default for VolumeMethod {
    /// Returns that by rays, in pieces of a cell.
    fn default() -> Self {
        Self::Ray { step: 1.0 }
    }
}

impl VolumeMethod {
    pub(super) fn check(&self) -> Checked {
        match *self {
            Self::Ray { step } => check_step(step),
            Self::Slices { count } => check_slices(count),
        }
    }
}

pub(super) fn check_step(step: f64) -> Checked {
    if (0.01..=100.0).contains(&step) {
        return Ok(());
    }
    let message = format!("{step}; pieces of rays are 0.01 to 100 cells long");
    Err(Fault::new("volume_step", message))
}

pub(super) fn check_slices(count: u32) -> Checked {
    if (1..=65536).contains(&count) {
        return Ok(());
    }
    let message = format!("{count}; a volume has 1 to 65536 slices");
    Err(Fault::new("slices", message))
}

/// Where integrals are taken.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Sampling {
    /// At every pixel.
    Pixels,
    /// For each source, at every pixel near its core; elsewhere at a few pixels of a tile, the others interpolated
    /// within the tolerance. Every pixel is taken nevertheless where sources of opposite signs cancel, whose errors do
    /// not, and on the built-in reference.
    #[default]
    Tiles,
}

/// Over what the integral runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Measure {
    /// The ray's parameter s in `[0,1]` (2015).
    Parameter,
    /// Length in world units: `|E - S|` times as much (2010, 2006).
    Length,
}

/// Which rays a pixel stands for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Antialias {
    /// All that pass its square: the pixel is the mean of their light, so that thin cores that move do not flicker.
    /// Where a method other than `exact` takes integrals, or [`Reduction::Rms`] their roots, as [`Antialias::None`].
    #[default]
    Footprint,
    /// The one through its centre, as in the papers.
    None,
}

/// What a pixel has of the integrals along its ray.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Reduction {
    /// Their sum (2015).
    #[default]
    Sum,
    /// Colour times coefficient times the root of the integral of the squared field, times the decay: light that lies
    /// along a ray stands out less (2015, section 5.4). Such light does not add up: for scenes of one light.
    Rms,
}

impl Reduction {
    /// Returns what becomes of an integral, for [`Reduction::Rms`] of squares.
    pub(crate) fn of(self, integral: f64) -> f64 {
        match self {
            Self::Sum => integral,
            Self::Rms => integral.sqrt(),
        }
    }

    /// Returns what is integrated of a field.
    pub(crate) fn summand(self, field: f64) -> f64 {
        match self {
            Self::Sum => field,
            Self::Rms => field * field,
        }
    }

    #[allow(clippy::trivially_copy_pass_by_ref)] // serde gives a reference
    #[cfg(feature = "files")]
    pub(super) fn is_sum(&self) -> bool {
        *self == Self::Sum
    }
}
