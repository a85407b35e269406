//! The size of an image.

use serde::{Deserialize, Serialize};

/// Size of an image in pixels, at most [`ImageSize::LIMIT`] each way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImageSize {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
}

impl ImageSize {
    /// The largest width and the largest height.
    pub const LIMIT: u32 = 16384;

    /// Returns the number of pixels.
    #[must_use]
    pub fn pixels(self) -> usize {
        self.width as usize * self.height as usize
    }
}

impl Default for ImageSize {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
        }
    }
}
