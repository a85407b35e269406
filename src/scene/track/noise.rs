//! Noise over time: flicker and trembling. Value noise: random numbers at equal steps of time, smooth between, in
//! octaves of which each is twice as fast and half as large. It is a function of the time and its keys alone.

use serde::{Deserialize, Serialize};

use super::TrackValue;
use crate::scene::random;
use crate::scene::values::{Checked, Fault, positive};

/// How many octaves there may be, and the highest frequency, 1/s: the count of steps stays whole.
const MOST_OCTAVES: u32 = 8;
const MOST_FREQUENCY: f64 = 1e6;

/// Tells the random numbers of tracks from others of the same seed.
const PURPOSE: u64 = 0x0074_7261_636b;

/// Noise that is added to a [`Track`](super::Track): every number of its value has its own.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct TrackNoise {
    /// How far it goes to either side at most: for all numbers of the value, or of its shape; 0 or more.
    pub amplitude: TrackValue,
    /// How many random numbers there are a second, 1/s; more than 0, at most 1e6. In a scene that says after how many
    /// seconds it begins again, a whole number of them fits in.
    pub frequency: f64,
    /// Which noise.
    #[serde(default)]
    pub seed: u32,
    /// How many octaves there are, 1 to 8.
    #[serde(default = "one")]
    pub octaves: u32,
}

// What is read of `noise`.
keys! { pub(in crate::scene) NOISE_KEYS;
    amplitude: TrackValue, "of the value", Required, "how far it goes at most, one for all numbers or for each";
    frequency: from_to(1e-9, 1e6), "1/s", Required, "how many random numbers there are a second";
    seed: WHOLE, NONE, Value("0"), "which noise";
    octaves: Whole(1, 8), NONE, Value("1"), "each twice as fast and half as large";
}

fn one() -> u32 {
    1
}

impl TrackNoise {
    /// Makes noise of one octave.
    #[must_use]
    pub fn new(amplitude: impl Into<TrackValue>, frequency: f64, seed: u32) -> Self {
        Self {
            amplitude: amplitude.into(),
            frequency,
            seed,
            octaves: 1,
        }
    }

    pub(super) fn check(&self, value: &TrackValue) -> Checked {
        if !self.amplitude.all(&|it| it.is_finite() && it >= 0.0) {
            return Err(Fault::new(
                "noise.amplitude",
                "must be finite, and 0 or more",
            ));
        }
        let is_one = matches!(self.amplitude, TrackValue::Number(_));
        if !is_one && !self.amplitude.is_shaped_as(value) {
            let message = format!(
                "is {}, the value is {}: write a number, which is for all, or one of that shape",
                self.amplitude.shape(),
                value.shape()
            );
            return Err(Fault::new("noise.amplitude", message));
        }
        positive("noise.frequency", self.frequency)?;
        if self.frequency > MOST_FREQUENCY {
            let message = format!("must be at most 1e6 a second, found {}", self.frequency);
            return Err(Fault::new("noise.frequency", message));
        }
        match self.octaves {
            1..=MOST_OCTAVES => Ok(()),
            octaves => {
                let message = format!("must be 1 to {MOST_OCTAVES}, found {octaves}");
                Err(Fault::new("noise.octaves", message))
            }
        }
    }

    /// Adds the noise to a value; `period` is after how many seconds it begins again.
    pub(super) fn add_to(&self, value: &TrackValue, time: f64, period: Option<f64>) -> TrackValue {
        let mut which = 0;
        TrackValue::of([value, &self.amplitude], &mut |[value, amplitude]| {
            which += 1;
            value + amplitude * self.at(which, time, period)
        })
    }

    /// Returns the noise of a number, from -1 to 1.
    fn at(&self, which: u64, time: f64, period: Option<f64>) -> f64 {
        let steps = period.map(|period| (self.frequency * period).round().max(1.0));
        let at = match (steps, period) {
            (Some(steps), Some(period)) => time / period * steps,
            _ => time * self.frequency,
        };
        let (mut sum, mut total) = (0.0, 0.0);
        for octave in 0..self.octaves {
            let times = f64::from(1_u32 << octave);
            let weight = 1.0 / times;
            let count = steps.map(|steps| (steps * times) as i64);
            sum += weight * self.octave(which, octave, at * times, count);
            total += weight;
        }
        sum / total
    }

    /// Returns one octave; `count` is after how many steps it begins again.
    fn octave(&self, which: u64, octave: u32, at: f64, count: Option<i64>) -> f64 {
        let named = [PURPOSE, self.seed.into(), which, octave.into()];
        // Octaves have their steps at other times, so that they do not rest together.
        let at = at + random::unit(named);
        let before = at.floor();
        let number = |index: i64| {
            let index = count.map_or(index, |count| index.rem_euclid(count));
            2.0 * random::unit(named.into_iter().chain([index as u64])) - 1.0
        };
        let (index, share) = (before as i64, at - before);
        let (from, to) = (number(index), number(index.saturating_add(1)));
        from + (to - from) * (share * share * (3.0 - 2.0 * share))
    }
}
