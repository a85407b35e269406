//! `[time]`: after how many seconds a scene begins again, and how long its shutter is open.

use super::SceneFile;
use serde::Deserialize;

use crate::scene::values::{Checked, Fault, finite, positive};

/// `[time]` of a scene file.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct TimeTable {
    pub r#loop: Option<f64>,
    pub shutter: f64,
}

// What is read of `[time]`.
keys! { pub(in crate::scene) TIME_KEYS;
    loop: POSITIVE, "seconds", Otherwise("it does not"), "after which the scene begins again, with its noise";
    shutter: from_to(0.0, 1.0), "frames", Value("0"), "how long the shutter is open, of which a picture is the mean";
}

impl TimeTable {
    pub(super) fn check(self) -> Checked {
        self.r#loop
            .map_or(Ok(()), |seconds| positive("loop", seconds))?;
        finite("shutter", self.shutter)?;
        if (0.0..=1.0).contains(&self.shutter) {
            return Ok(());
        }
        let message = format!(
            "a share of a frame from 0, not at all, to 1, all of it; found {}",
            self.shutter
        );
        Err(Fault::new("shutter", message))
    }

    /// Returns after how many seconds the scene begins again, if that is a time.
    pub(super) fn period(self) -> Option<f64> {
        self.r#loop.filter(|seconds| is_period(*seconds))
    }
}

pub(super) fn is_period(seconds: f64) -> bool {
    positive("loop", seconds).is_ok()
}

impl SceneFile {
    /// Returns whether waves are shown as they are at the scene's time.
    pub(super) fn plays(&self) -> bool {
        let time = self.simulation.and_then(|simulation| simulation.time);
        !self.wave.is_empty() && time.is_none()
    }

    /// Shows waves as they are so many seconds after the simulation began, unless the file names a frame.
    pub(super) fn play(&mut self, seconds: f64) {
        if self.plays() {
            let simulation = self.simulation.get_or_insert_default();
            simulation.time = Some((seconds / simulation.frame).max(0.0));
        }
    }
}
