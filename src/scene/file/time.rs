//! `[time]`: after how many seconds a scene begins again.

use serde::Deserialize;

use crate::scene::values::{Checked, positive};

/// `[time]` of a scene file.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct TimeTable {
    pub r#loop: Option<f64>,
}

// What is read of `[time]`.
keys! { pub(in crate::scene) TIME_KEYS;
    loop: POSITIVE, "seconds", Otherwise("it does not"), "after which the scene begins again, with its noise";
}

impl TimeTable {
    pub(super) fn check(self) -> Checked {
        self.r#loop
            .map_or(Ok(()), |seconds| positive("loop", seconds))
    }

    /// Returns after how many seconds the scene begins again, if that is a time.
    pub(super) fn period(self) -> Option<f64> {
        self.r#loop.filter(|seconds| is_period(*seconds))
    }
}

pub(super) fn is_period(seconds: f64) -> bool {
    positive("loop", seconds).is_ok()
}
