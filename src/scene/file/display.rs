//! `[display]`: an exposure that is not named is made to fit the scene.

use serde::{Deserialize, Serialize};

use crate::image::{Display, ToneMap};
use crate::scene::Scene;

#[derive(Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct DisplayTable {
    exposure: Option<f64>,
    tone_map: ToneMap,
}

// What is read of `[display]`.
keys! { pub(in crate::scene) DISPLAY_KEYS;
    exposure: from_to(-100.0, 100.0), "stops", Otherwise("fits the scene"), "radiance times 2^exposure";
    tone_map: Word(&["clamp", "exponential", "reinhard", "aces"]), NONE, Value("\"exponential\""),
        "the curve that brings radiance into a picture's range";
}

impl DisplayTable {
    pub(super) fn of(display: &Display) -> Self {
        Self {
            exposure: Some(display.exposure),
            tone_map: display.tone_map,
        }
    }

    /// Returns it as a scene has it, before its exposure is made to fit.
    pub(super) fn display(&self) -> Display {
        Display {
            exposure: self.exposure.unwrap_or(0.0),
            tone_map: self.tone_map,
        }
    }

    /// Gives a scene of right values the exposure that fits it, unless one is named.
    pub(super) fn fit_exposure(&self, scene: &mut Scene) {
        if self.exposure.is_none() {
            scene.display.exposure = scene.fitting_exposure();
        }
    }
}
