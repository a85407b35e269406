//! Volumes: the light that space gives off, sampled on a grid of cells, for programs that draw such grids.
//!
//! A volume is sparse: it is made of bricks of 8x8x8 cells, the leaves of OpenVDB, and a brick in which nothing glows
//! takes no memory.

mod brick;
#[cfg(feature = "json")]
mod file;
mod grid;

pub use brick::Brick;
#[cfg(feature = "json")]
pub use file::{VolumeFile, VolumeFormat};
pub use grid::Grid;

use std::collections::BTreeMap;

use glam::DVec3;

use crate::error::{Error, Result};
use crate::memory;

/// Cells along an edge of a brick.
pub const BRICK: u32 = 8;

/// What the cells of a volume were given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellValue {
    /// The emission at the middle of the cell.
    Center,
    /// The mean of the emission in the middles of the cell's pieces, so many along each edge. Next to a core where light
    /// has no end, as without a radius, no distance is taken below half the edge of a piece.
    Mean(u32),
}

impl CellValue {
    /// Returns how many places along an edge of a cell are looked at.
    pub(crate) fn parts(self) -> u32 {
        match self {
            Self::Center => 1,
            Self::Mean(parts) => parts,
        }
    }

    /// Returns what no squared distance to a core is taken below, world units squared, in cells with such an edge: of
    /// means, half the edge of a piece of a cell; else next to nothing.
    pub(crate) fn floor2(self, cell: f64) -> f64 {
        match self {
            Self::Center => (1e-4 * cell).powi(2),
            Self::Mean(parts) => (0.5 * cell / f64::from(parts)).powi(2),
        }
    }
}

/// Emission on a grid: what a world unit of length gives off, linear RGB in float32.
#[derive(Debug, Clone)]
pub struct Volume {
    grid: Grid,
    value: CellValue,
    bricks: BTreeMap<[u32; 3], Brick>,
}

impl Volume {
    /// Makes a black one.
    #[must_use]
    pub fn new(grid: Grid, value: CellValue) -> Self {
        Self {
            grid,
            value,
            bricks: BTreeMap::new(),
        }
    }

    /// Returns where its cells are.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Returns what its cells hold.
    #[must_use]
    pub fn value(&self) -> CellValue {
        self.value
    }

    /// Returns the bricks in which something glows, by their places along z, y and x, counted in bricks.
    pub fn bricks(&self) -> impl ExactSizeIterator<Item = ([u32; 3], &Brick)> {
        self.bricks.iter().map(|(place, brick)| (*place, brick))
    }

    /// Returns the emission of a cell, linear RGB; 0 outside the grid.
    #[must_use]
    pub fn at(&self, [x, y, z]: [u32; 3]) -> [f32; 3] {
        let brick = self.bricks.get(&[z / BRICK, y / BRICK, x / BRICK]);
        brick.map_or([0.0; 3], |brick| brick.at([x, y, z].map(|it| it % BRICK)))
    }

    /// Writes a row of cells along x into `row`, RGB after RGB.
    ///
    /// # Panics
    /// Where `row` is no row of the grid.
    pub fn read_row(&self, y: u32, z: u32, row: &mut [f32]) {
        let cells = self.grid.cells();
        assert_eq!(row.len(), 3 * cells[0] as usize, "a row of the grid");
        for (x, cell) in (0..).zip(row.as_chunks_mut::<3>().0) {
            *cell = self.at([x, y, z]);
        }
    }

    /// Returns the largest emission of any cell and channel.
    #[must_use]
    pub fn greatest(&self) -> f32 {
        let of_bricks = self.bricks.values().map(Brick::greatest);
        of_bricks.fold(0.0, f32::max)
    }

    /// Adds a layer of bricks, the `layer`th along z: `values` are those of its cells, of which a row is `stride`
    /// values long, all red ones first, then green, then blue.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(crate) fn add_layer(&mut self, layer: u32, values: &[f32], stride: usize) -> Result<()> {
        let [columns, rows, layers] = self.grid.cells();
        let depth = (layers - layer * BRICK).min(BRICK);
        let plane = values.len() / 3;
        self.check_memory(columns.div_ceil(BRICK) * rows.div_ceil(BRICK))?;
        for y in 0..rows.div_ceil(BRICK) {
            for x in 0..columns.div_ceil(BRICK) {
                let (first_x, first_y) = (x * BRICK, y * BRICK);
                let width = (columns - first_x).min(BRICK);
                let height = (rows - first_y).min(BRICK);
                let mut brick = Brick::default();
                for (channel, values) in values.chunks_exact(plane).enumerate() {
                    for z in 0..depth {
                        for y in 0..height {
                            let row = (z * rows + first_y + y) as usize * stride + first_x as usize;
                            brick.set_row(channel, [y, z], &values[row..row + width as usize]);
                        }
                    }
                }
                if brick.glows() {
                    self.bricks.insert([layer, y, x], brick);
                }
            }
        }
        Ok(())
    }

    fn check_memory(&self, bricks: u32) -> Result<()> {
        let bytes = u64::from(bricks) * size_of::<Brick>() as u64;
        match memory::shortage(bytes) {
            Some(shortage) => Err(Error::OutOfMemory(format!(
                "a volume of {} cells: {shortage}",
                self.grid
            ))),
            None => Ok(()),
        }
    }

    /// Returns the emission at a point of the world, linear RGB: that of the eight cells around it, interpolated. Beyond
    /// the middles of the outermost cells it is theirs; outside the box there is none.
    #[must_use]
    pub fn emission(&self, point: DVec3) -> DVec3 {
        let Some((first, share)) = self.grid.around(point) else {
            return DVec3::ZERO;
        };
        let mut sum = DVec3::ZERO;
        for corner in 0..8_u32 {
            let bit = |axis: u32| corner >> axis & 1;
            let cell = [0, 1, 2].map(|axis| {
                let most = self.grid.cells()[axis as usize] - 1;
                (first[axis as usize] + bit(axis)).min(most)
            });
            let weight = |axis: u32| match bit(axis) {
                0 => 1.0 - share[axis as usize],
                _ => share[axis as usize],
            };
            let light = DVec3::from(self.at(cell).map(f64::from));
            sum += weight(0) * weight(1) * weight(2) * light;
        }
        sum
    }
}
