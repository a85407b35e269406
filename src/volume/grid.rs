//! Where the cells of a volume are: cubes that fill a box along the axes of the world.

use std::fmt;

use glam::DVec3;

use super::BRICK;
use crate::error::{Error, Result};

/// Most cells along an edge: programs that read volumes take no more.
pub const MOST_CELLS: u32 = 2048;

/// A box of cubic cells along the axes of the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    low: DVec3,
    cell: f64,
    cells: [u32; 3],
}

impl Grid {
    /// Makes one around `center`, world units, whose longest edge has so many cells. Other edges have as many as are
    /// needed to cover their `size`, and lie evenly around it.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a box that is not finite or has an edge that is not above 0, and for no cells or more
    /// than 2048.
    pub fn new(center: DVec3, size: DVec3, longest: u32) -> Result<Self> {
        let refuse = |message: String| Err(Error::Unsupported(message));
        if !(1..=MOST_CELLS).contains(&longest) {
            return refuse(format!(
                "a volume has 1 to {MOST_CELLS} cells along its longest edge, not {longest}"
            ));
        }
        if !(center.is_finite() && size.is_finite() && size.min_element() > 0.0) {
            return refuse(format!(
                "a box needs a finite centre and edges above 0, not {center} and {size}"
            ));
        }
        let cell = size.max_element() / f64::from(longest);
        let count = |edge: f64| ((edge / cell - 1e-9).ceil() as u32).clamp(1, longest);
        let cells = size.to_array().map(count);
        let whole = cell * DVec3::from(cells.map(f64::from));
        Ok(Self {
            low: center - 0.5 * whole,
            cell,
            cells,
        })
    }

    /// Returns how many cells it has along x, y and z.
    #[must_use]
    pub fn cells(&self) -> [u32; 3] {
        self.cells
    }

    /// Returns how many bricks its cells are in, along x, y and z.
    pub(super) fn bricks(&self) -> [u32; 3] {
        self.cells.map(|count| count.div_ceil(BRICK))
    }

    /// Returns the edge of a cell, world units.
    #[must_use]
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// Returns its lowest and its highest corner, world space.
    #[must_use]
    pub fn bounds(&self) -> [DVec3; 2] {
        let whole = self.cell * DVec3::from(self.cells.map(f64::from));
        [self.low, self.low + whole]
    }

    /// Returns the middle of a cell, world space.
    #[must_use]
    pub fn middle(&self, cell: [u32; 3]) -> DVec3 {
        self.low + self.cell * (DVec3::from(cell.map(f64::from)) + 0.5)
    }

    /// Returns where a ray is in the box, as parameters of it; `None`: nowhere.
    #[must_use]
    pub fn crossed(&self, origin: DVec3, span: DVec3) -> Option<[f64; 2]> {
        let [low, high] = self.bounds();
        let (mut begin, mut end) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let one = (low[axis] - origin[axis]) / span[axis];
            let other = (high[axis] - origin[axis]) / span[axis];
            match span[axis] == 0.0 {
                true if (low[axis]..=high[axis]).contains(&origin[axis]) => {}
                true => return None,
                false => (begin, end) = (begin.max(one.min(other)), end.min(one.max(other))),
            }
        }
        (begin < end).then_some([begin, end])
    }
}

impl fmt::Display for Grid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.cells;
        write!(f, "{x}x{y}x{z}")
    }
}
