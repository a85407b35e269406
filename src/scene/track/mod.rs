//! Values as functions of time.
//!
//! Between two keys a time dt apart, s from 0 to 1 on the way, values are
//!
//! ```text
//! step      a                                                              until the next key
//! linear    a + (b - a) s
//! cubic     (2 s^3 - 3 s^2 + 1) a + dt (s^3 - 2 s^2 + s) out_a             glTF 2.0, appendix C.5
//!           + (3 s^2 - 2 s^3) b + dt (s^3 - s^2) in_b
//! smooth    the same, with tangents that let no value overshoot            Fritsch, Butland 1984
//! ```

mod noise;
mod smooth;
mod table;
#[cfg(test)]
mod tests;
mod value;

use serde::{Deserialize, Serialize};

#[cfg(feature = "files")]
pub(in crate::scene) use noise::NOISE_KEYS;
pub use noise::TrackNoise;
#[cfg(feature = "files")]
pub(in crate::scene) use table::TRACK_KEYS;
pub(in crate::scene) use table::TrackTable;
pub use value::TrackValue;

use super::values::{Checked, Fault, LARGEST};
use smooth::tangent;

/// How values go on from one key of a [`Track`] to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Interpolation {
    /// They stay, and jump at the next key.
    Step,
    /// Straight.
    #[default]
    Linear,
    /// As glTF's CUBICSPLINE: every key has three values, a tangent in, the value and a tangent out, tangents per
    /// second.
    Cubic,
    /// A cubic through all keys without a kink, which stays between the values of two neighbours (Fritsch, Butland
    /// 1984).
    Smooth,
}

/// What a [`Track`] does before its first key and behind its last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum TrackLoop {
    /// It stays at the first and the last value.
    #[default]
    Once,
    /// It begins again.
    Repeat,
    /// It goes back, and begins again.
    PingPong,
}

/// So far from its end a cycle may be, as a part of it, before its seam is seen.
#[cfg(feature = "files")]
const SEAM: f64 = 1e-3;

/// Stands for the values that a track lacks which is none.
static MISSING: TrackValue = TrackValue::Number(f64::NAN);

/// A value as a function of time.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Track {
    /// When the keys are, seconds, each later than the one before; none where the value is constant but for its noise.
    pub times: Vec<f64>,
    /// The values at the keys, all of one shape; with [`Interpolation::Cubic`] three for each. One without times.
    pub values: Vec<TrackValue>,
    /// How values go on from one key to the next.
    pub interpolation: Interpolation,
    /// What is before the first key and behind the last.
    pub looping: TrackLoop,
    /// By which part of its cycle it is ahead, any number; a cycle is from the first key to the last, of
    /// [`TrackLoop::PingPong`] there and back.
    pub phase: f64,
    /// What is added.
    pub noise: Option<TrackNoise>,
}

impl Track {
    /// Makes a linear track that ends with its last key.
    #[must_use]
    pub fn new<T: Into<TrackValue>>(keys: impl IntoIterator<Item = (f64, T)>) -> Self {
        let (times, values) = keys.into_iter().map(|(t, v)| (t, v.into())).unzip();
        Self {
            times,
            values,
            ..Self::constant(0.0)
        }
    }

    /// Makes a value that does not change, to which noise may be added.
    #[must_use]
    pub fn constant(value: impl Into<TrackValue>) -> Self {
        Self {
            times: Vec::new(),
            values: vec![value.into()],
            interpolation: Interpolation::default(),
            looping: TrackLoop::default(),
            phase: 0.0,
            noise: None,
        }
    }

    /// Checks that it is a track: that times grow, that values have one shape, and that all is within its bounds.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) with a key such as `track.times[1]`.
    pub fn validate(&self) -> crate::Result<()> {
        Ok(self.check().map_err(|fault| fault.of("track"))?)
    }

    /// Returns the value at a time, seconds; of what is no valid track, no number.
    #[must_use]
    pub fn at(&self, time: f64) -> TrackValue {
        self.at_in(time, None)
    }

    /// Returns the value at a time of a scene that begins again after `period`, seconds: so does the noise.
    pub(super) fn at_in(&self, time: f64, period: Option<f64>) -> TrackValue {
        let value = self.without_noise(time);
        match &self.noise {
            Some(noise) => noise.add_to(&value, time, period),
            None => value,
        }
    }

    fn without_noise(&self, time: f64) -> TrackValue {
        let time = self.place(time);
        let key = self.times.partition_point(|key| *key <= time).max(1) - 1;
        let (Some(begin), Some(end)) = (self.times.get(key), self.times.get(key + 1)) else {
            return self.value(key).clone();
        };
        let (from, to) = (self.value(key), self.value(key + 1));
        let length = end - begin;
        let share = (time - begin) / length;
        let of = |values: [&TrackValue; 4]| {
            TrackValue::of(values, &mut |[from, to, out, into]| {
                hermite(share, from, to, length * out, length * into)
            })
        };
        match self.interpolation {
            Interpolation::Step => from.clone(),
            Interpolation::Linear => {
                TrackValue::of([from, to], &mut |[from, to]| from + (to - from) * share)
            }
            Interpolation::Cubic => of([from, to, self.nth(3 * key + 2), self.nth(3 * key + 3)]),
            Interpolation::Smooth => of([from, to, &tangent(self, key), &tangent(self, key + 1)]),
        }
    }

    fn nth(&self, index: usize) -> &TrackValue {
        self.values.get(index).unwrap_or(&MISSING)
    }

    /// Returns the value at a key.
    fn value(&self, key: usize) -> &TrackValue {
        match self.interpolation {
            Interpolation::Cubic if !self.times.is_empty() => self.nth(3 * key + 1),
            _ => self.nth(key),
        }
    }

    /// Returns from when to when it goes, seconds.
    fn span(&self) -> Option<(f64, f64)> {
        Some((*self.times.first()?, *self.times.last()?))
    }

    /// Returns after how many seconds it begins again; `None` if it does not.
    pub(super) fn cycle(&self) -> Option<f64> {
        let (first, last) = self.span()?;
        match self.looping {
            TrackLoop::Once => None,
            TrackLoop::Repeat => Some(last - first),
            TrackLoop::PingPong => Some(2.0 * (last - first)),
        }
    }

    /// Returns its cycle, seconds, if that is not over where a scene begins again after so many, and its value jumps
    /// there. Noise does not: its steps are fitted into the scene's.
    #[cfg(feature = "files")]
    pub(super) fn unfinished_cycle(&self, period: f64) -> Option<f64> {
        let cycle = self.cycle()?;
        let turns = period / cycle;
        let is_over = turns.round() >= 1.0 && (turns - turns.round()).abs() <= SEAM;
        let jumps = || self.without_noise(period) != self.without_noise(0.0);
        (!is_over && jumps()).then_some(cycle)
    }

    /// Returns until when it changes for the first time: its last key, or the end of its first cycle; `None` if all
    /// that changes is noise.
    #[cfg(feature = "files")]
    pub(super) fn end(&self) -> Option<f64> {
        let (first, last) = self.span()?;
        Some(match self.cycle() {
            Some(cycle) => first + cycle,
            None => last - self.phase * (last - first),
        })
    }

    /// Returns which time between its first and its last key a time is.
    /// A track that repeats is at its first key where it is at its last.
    fn place(&self, time: f64) -> f64 {
        let Some((first, last)) = self.span() else {
            return 0.0;
        };
        let length = last - first;
        let cycle = self.cycle().unwrap_or(length);
        let time = time + self.phase * cycle;
        if (first..last).contains(&time) {
            return time; // to the bit, so that no key is missed
        }
        match self.looping {
            TrackLoop::Once => time.max(first).min(last),
            TrackLoop::Repeat => first + wrapped(time - first, cycle),
            TrackLoop::PingPong => first + length - (wrapped(time - first, cycle) - length).abs(),
        }
    }

    /// Checks it; the key of a fault is one of those that a file has.
    pub(super) fn check(&self) -> Checked {
        let finite = |value: f64| value.abs() <= LARGEST;
        let first = self.values.first();
        if let Some(index) = self.times.iter().position(|time| !finite(*time)) {
            let message = "is not finite, or beyond 1e9 seconds";
            return Err(Fault::new(format!("times[{index}]"), message));
        }
        if let Some(index) = self.times.windows(2).position(|pair| pair[0] >= pair[1]) {
            let message = format!(
                "{} s is not later than the {} s before it; times grow from key to key",
                self.times[index + 1],
                self.times[index]
            );
            return Err(Fault::new(format!("times[{}]", index + 1), message));
        }
        self.check_counts()?;
        for (index, value) in self.values.iter().enumerate() {
            let fault = |message: String| Err(Fault::new(format!("values[{index}]"), message));
            if value.is_empty() {
                return fault("is empty: there is no number in it that could change".to_owned());
            }
            if !value.all(&finite) {
                return fault("has a number that is not finite, or beyond 1e9".to_owned());
            }
            if let Some(first) = first.filter(|first| !value.is_shaped_as(first)) {
                return fault(format!(
                    "is {}, the first value is {}; all are of one shape",
                    value.shape(),
                    first.shape()
                ));
            }
        }
        if !finite(self.phase) {
            return Err(Fault::new("phase", "is not finite, or beyond 1e9"));
        }
        match (&self.noise, first) {
            (Some(noise), Some(value)) => noise.check(value),
            _ => Ok(()),
        }
    }

    /// Checks that there are as many values as keys need.
    fn check_counts(&self) -> Checked {
        let (times, values) = (self.times.len(), self.values.len());
        if times == 1 {
            let message = "one key is no motion: give two or more, or write the value alone";
            return Err(Fault::new("times", message));
        }
        let is_cubic = self.interpolation == Interpolation::Cubic;
        let expected = match (times, is_cubic) {
            (0, _) => 1,
            (_, true) => 3 * times,
            (_, false) => times,
        };
        if values == expected {
            return Ok(());
        }
        let message = match (times, is_cubic) {
            (0, _) => format!("{values} values without times"),
            (_, true) => format!(
                "{values} values for {times} times; \"cubic\" takes three for each: tangent in, value, tangent out"
            ),
            (_, false) => format!("{values} values for {times} times; there is one for each"),
        };
        Err(Fault::new("values", message))
    }
}

/// Returns a time modulo a period, from 0 to below the period.
pub(super) fn wrapped(time: f64, period: f64) -> f64 {
    let time = time.rem_euclid(period);
    if time < period { time } else { 0.0 } // the sum of a tiny negative time and the period is rounded to the period
}

/// Returns the cubic with these ends and tangents, the latter per share; a constant to the bit where both are equal and
/// tangents are 0.
fn hermite(s: f64, from: f64, to: f64, out: f64, into: f64) -> f64 {
    let (s2, s3) = (s * s, s * s * s);
    from + (to - from) * (3.0 * s2 - 2.0 * s3) + (s3 - 2.0 * s2 + s) * out + (s3 - s2) * into
}
