//! A [`Track`] as a file writes it.

use serde::{Deserialize, Serialize};

use super::{Interpolation, Track, TrackLoop, TrackNoise, TrackValue};
use crate::scene::values::Fault;

/// A track as a file describes it.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct TrackTable {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    times: Option<Vec<f64>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    values: Option<Vec<TrackValue>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    value: Option<TrackValue>,
    #[serde(default)]
    interpolation: Interpolation,
    #[serde(default)]
    r#loop: TrackLoop,
    #[serde(default)]
    phase: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    noise: Option<TrackNoise>,
}

// What is read of a track.
keys! { pub(in crate::scene) TRACK_KEYS;
    times: Numbers(2, None), "seconds", Otherwise("constant"), "when the keys are, each later than the one before";
    values: TrackValues(2), NONE, Otherwise("constant"), "one for each of the times, all of one shape";
    value: TrackValue, NONE, Otherwise("values"), "in the place of times and values, where only noise changes it";
    interpolation: Word(&["step", "linear", "cubic", "smooth"]), NONE, Value("\"linear\""),
        "between keys; cubic: tangent in, value, tangent out for each";
    loop: Word(&["once", "repeat", "ping-pong"]), NONE, Value("\"once\""), "behind the last key, and before the first";
    phase: ANY, "cycles", Value("0"), "by which part of its cycle the track is ahead";
    noise: Table("noise"), NONE, Otherwise("none"), "what is added, seeded: flicker, trembling";
}

impl TrackTable {
    /// Makes the track, checked; the key of a fault is one of the table's.
    pub(in crate::scene) fn track(self) -> Result<Track, Fault> {
        let has_keys = self.times.is_some() || self.values.is_some();
        let mut track = match (self.times, self.values, self.value) {
            (Some(times), Some(values), None) => Track {
                times,
                values,
                ..Track::constant(0.0)
            },
            (None, None, Some(value)) if self.noise.is_some() => Track::constant(value),
            (None, None, Some(_)) => {
                let message =
                    "a value alone does not change: write it without a table, or add a noise";
                return Err(Fault::new("value", message));
            }
            (_, _, Some(_)) if has_keys => {
                let message = "it stands in the place of `times` and `values`; write either";
                return Err(Fault::new("value", message));
            }
            (None, None, _) => {
                let message =
                    "it is added to something: write a `value` beside it, or `times` and `values`";
                return Err(Fault::new("noise", message));
            }
            (None, ..) => return Err(Fault::new("times", "required, but missing")),
            (_, None, _) => return Err(Fault::new("values", "required, but missing")),
            (Some(_), Some(_), Some(_)) => return Err(Fault::new("value", "one too many")),
        };
        if track.times.is_empty() && has_keys {
            return Err(Fault::new(
                "times",
                "is empty; a track has two keys or more",
            ));
        }
        track.interpolation = self.interpolation;
        track.looping = self.r#loop;
        track.phase = self.phase;
        track.noise = self.noise;
        track.check()?;
        Ok(track)
    }
}

impl From<&Track> for TrackTable {
    fn from(track: &Track) -> Self {
        let has_keys = !track.times.is_empty();
        let constant = || track.values.first().cloned();
        Self {
            times: has_keys.then(|| track.times.clone()),
            values: has_keys.then(|| track.values.clone()),
            value: if has_keys { None } else { constant() },
            interpolation: track.interpolation,
            r#loop: track.looping,
            phase: track.phase,
            noise: track.noise.clone(),
        }
    }
}
