//! What becomes of particles that hit something: how fast they fly away, where to, and as which shapes (Nito 2013,
//! chapter 3).

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::Varying;
use crate::scene::values::{Checked, Fault, finite, read_vector, vector};

/// How fast particles of the circular pattern fly away, world units a frame: each at a speed within a range around a
/// value, evenly.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Acceleration {
    /// Of continuous ones; 0 or more.
    pub continuous: f64,
    /// By how much it differs from that to either side at most; not more than that.
    pub continuous_range: f64,
    /// Of separate ones; 0 or more.
    pub separate: f64,
    /// By how much it differs from that to either side at most; not more than that.
    pub separate_range: f64,
}

// What is read of `acceleration`.
keys! { pub(in crate::scene) ACCELERATION_KEYS;
    continuous: NOT_NEGATIVE, "world units a frame", Value("1.5"), "how fast continuous particles fly away";
    continuous_range: NOT_NEGATIVE, "world units a frame", Value("0.5"), "by how much that differs at most";
    separate: NOT_NEGATIVE, "world units a frame", Value("2.5"), "how fast separate particles fly away";
    separate_range: NOT_NEGATIVE, "world units a frame", Value("1"), "by how much that differs at most";
}

impl Default for Acceleration {
    fn default() -> Self {
        Self {
            continuous: 1.5,
            continuous_range: 0.5,
            separate: 2.5,
            separate_range: 1.0,
        }
    }
}

impl Acceleration {
    /// Makes one.
    #[must_use]
    pub fn new(continuous: [f64; 2], separate: [f64; 2]) -> Self {
        Self {
            continuous: continuous[0],
            continuous_range: continuous[1],
            separate: separate[0],
            separate_range: separate[1],
        }
    }

    /// Returns value and range of continuous or of separate particles.
    pub(crate) fn of(&self, is_continuous: bool) -> [f64; 2] {
        match is_continuous {
            true => [self.continuous, self.continuous_range],
            false => [self.separate, self.separate_range],
        }
    }

    pub(super) fn check(&self) -> Checked {
        within(
            "acceleration.continuous",
            self.continuous,
            "acceleration.continuous_range",
            self.continuous_range,
        )?;
        within(
            "acceleration.separate",
            self.separate,
            "acceleration.separate_range",
            self.separate_range,
        )
    }
}

/// A point that particles of the irregular pattern fly to.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct ControlPoint {
    /// Along the wave, to its right and up, world units from where the wave's axis meets a collider.
    pub position: Varying<DVec3>,
    /// The share of the particles that fly there, where the probabilities of all control points add up to 1; of others,
    /// in proportion. 0 to 1.
    #[serde(default = "certain")]
    pub probability: f64,
    /// How far each particle's own point is from it at most, along, right and up; world units, 0 or more.
    #[serde(default, deserialize_with = "read_vector")]
    pub range: DVec3,
}

// What is read of `control`.
keys! { pub(in crate::scene) CONTROL_KEYS;
    position: VECTOR, WORLD, Required, "along the wave, right and up, from where its axis meets a collider";
    probability: from_to(0.0, 1.0), NONE, Value("1"), "which share of the particles flies there";
    range: VECTOR, WORLD, Value("[0, 0, 0]"), "how far from it each particle's own point is at most";
}

fn certain() -> f64 {
    1.0
}

impl ControlPoint {
    /// Makes one that all particles fly to, or as many as to others.
    #[must_use]
    pub fn new(position: impl Into<Varying<DVec3>>) -> Self {
        Self {
            position: position.into(),
            probability: 1.0,
            range: DVec3::ZERO,
        }
    }

    /// Scatters the points of single particles around it.
    #[must_use]
    pub fn with_range(mut self, range: DVec3) -> Self {
        self.range = range;
        self
    }

    /// Gives it a share of the particles.
    #[must_use]
    pub fn with_probability(mut self, probability: f64) -> Self {
        self.probability = probability;
        self
    }

    pub(super) fn check(&self) -> Checked {
        self.position.check("position", &|_| Ok(()))?;
        probability("probability", self.probability)?;
        vector("range", self.range)?;
        match self.range.min_element() < 0.0 {
            true => Err(Fault::new(
                "range",
                "must not be negative: it is how far to either side",
            )),
            false => Ok(()),
        }
    }
}

/// Another shape of separate particles of a wave.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Mixture {
    /// The share of the wave's separate particles that have it, 0 to 1; what remains has the wave's own.
    pub probability: f64,
    /// As [`EmittedWave::samples`](super::EmittedWave::samples).
    #[serde(default = "samples")]
    pub samples: u32,
    /// As [`EmittedWave::roundness`](super::EmittedWave::roundness).
    #[serde(default = "roundness")]
    pub roundness: f64,
}

// What is read of `mixture`.
keys! { pub(in crate::scene) MIXTURE_KEYS;
    probability: from_to(0.0, 1.0), NONE, Required,
        "which share of separate particles is so; the rest is as the wave says";
    samples: Whole(1, MOST_SPRITES), NONE, Value("12"), "1: a ball; more: a rod of so many";
    roundness: above_to(0.0, 1.0), NONE, Value("0.5"), "1: a rod with round ends; less: with sharp ones";
}

/// Samples of a rod, and of a thread.
pub(crate) const MOST_SPRITES: u32 = 1024;

pub(super) fn samples() -> u32 {
    12
}

pub(super) fn roundness() -> f64 {
    0.5
}

impl Mixture {
    /// Makes one.
    #[must_use]
    pub fn new(probability: f64, samples: u32, roundness: f64) -> Self {
        Self {
            probability,
            samples,
            roundness,
        }
    }

    pub(super) fn check(&self) -> Checked {
        probability("probability", self.probability)?;
        check_rod(self.samples, self.roundness)
    }
}

/// Checks the numbers of a rod.
pub(super) fn check_rod(samples: u32, roundness: f64) -> Checked {
    count("samples", samples)?;
    finite("roundness", roundness)?;
    match roundness > 0.0 && roundness <= 1.0 {
        true => Ok(()),
        false => Err(Fault::new(
            "roundness",
            format!("lies above 0 and up to 1, from sharp to round; found {roundness}"),
        )),
    }
}

pub(super) fn count(key: &'static str, count: u32) -> Checked {
    match (1..=MOST_SPRITES).contains(&count) {
        true => Ok(()),
        false => Err(Fault::new(
            key,
            format!("{count} of them; give from 1 to {MOST_SPRITES}"),
        )),
    }
}

pub(super) fn probability(key: &'static str, value: f64) -> Checked {
    finite(key, value)?;
    match (0.0..=1.0).contains(&value) {
        true => Ok(()),
        false => Err(Fault::new(
            key,
            format!("a probability lies between 0 and 1; found {value}"),
        )),
    }
}

/// Checks a value, and the range around it, which must not take it below 0.
pub(super) fn within(
    key: &'static str,
    value: f64,
    range_key: &'static str,
    range: f64,
) -> Checked {
    not_negative(key, value)?;
    not_negative(range_key, range)?;
    match range <= value {
        true => Ok(()),
        false => Err(Fault::new(
            range_key,
            format!(
                "{range} is more than the {value} that it is around; give at most that, as both are 0 or more"
            ),
        )),
    }
}

pub(super) fn not_negative(key: &'static str, value: f64) -> Checked {
    finite(key, value)?;
    match value >= 0.0 {
        true => Ok(()),
        false => Err(Fault::new(
            key,
            format!("must not be negative, found {value}"),
        )),
    }
}
