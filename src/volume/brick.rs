//! A cube of cells that lie side by side in memory.

use super::BRICK;

const EDGE: usize = BRICK as usize;

/// Cells of a brick.
const CELLS: usize = EDGE * EDGE * EDGE;

/// What the cells of a brick take.
pub(super) const BYTES: usize = size_of::<[[f32; CELLS]; 3]>();

/// The emission of 8x8x8 cells, linear RGB; cells beyond the grid are 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Brick {
    /// Of each channel, x fastest, then y, then z.
    channels: Box<[[f32; CELLS]; 3]>,
}

impl Default for Brick {
    fn default() -> Self {
        Self {
            channels: Box::new([[0.0; CELLS]; 3]),
        }
    }
}

impl Brick {
    /// Returns the emission of a cell by its place in the brick, linear RGB.
    ///
    /// # Panics
    /// Where a place is not below 8.
    #[must_use]
    pub fn at(&self, [x, y, z]: [u32; 3]) -> [f32; 3] {
        let place = place(y, z) + x as usize;
        let [red, green, blue] = &*self.channels;
        [red[place], green[place], blue[place]]
    }

    /// Returns whether any cell gives off light.
    pub(super) fn glows(&self) -> bool {
        let mut values = self.channels.iter().flatten();
        values.any(|value| *value != 0.0)
    }

    pub(super) fn greatest(&self) -> f32 {
        let values = self.channels.iter().flatten();
        values.fold(0.0, |most, value| value.max(most))
    }

    pub(super) fn set_row(&mut self, channel: usize, [y, z]: [u32; 2], values: &[f32]) {
        let begin = place(y, z);
        self.channels[channel][begin..begin + values.len()].copy_from_slice(values);
    }
}

fn place(y: u32, z: u32) -> usize {
    (z as usize * EDGE + y as usize) * EDGE
}
