//! Volumes: the light that space gives off, sampled on a grid of cells, for programs that draw such grids.
//!
//! A volume is sparse: it is made of bricks of 8x8x8 cells, the leaves of OpenVDB, and a brick in which nothing glows
//! takes no memory.

mod brick;
#[cfg(feature = "json")]
mod file;
mod grid;
mod integral;
mod light_ball;
mod picture;
#[cfg(feature = "files")]
mod read;
mod texture;

pub use brick::Brick;
#[cfg(feature = "json")]
pub use file::{VolumeFile, VolumeFormat};
pub use grid::Grid;
pub use light_ball::LightBall;
pub use texture::{MOST_TEXELS, Storage, Texture, TextureOrigin};

use crate::error::{Error, Result};
use crate::memory;

/// Cells along an edge of a brick.
pub const BRICK: u32 = 8;

/// What the cells of a volume were given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellValue {
    /// The emission at the middle of the cell.
    Center,
    /// The mean of the emission in the middles of the cell's pieces, so many along each edge. Next to a core where
    /// light has no end, as without a radius, no distance is taken below half the edge of a piece.
    Mean(u32),
    /// The emission at the middle of the cell, and apart that of all sources but the strongest: [`Volume::rest`], with
    /// which reciprocals are exact where light of one source lies beside the core of another.
    Apart,
}

impl CellValue {
    /// Returns how many places along an edge of a cell are looked at.
    pub(crate) fn parts(self) -> u32 {
        match self {
            Self::Center | Self::Apart => 1,
            Self::Mean(parts) => parts,
        }
    }

    /// Returns what no squared distance to a core is taken below, world units squared, in cells with such an edge: of
    /// means, half the edge of a piece of a cell; else next to nothing.
    pub(crate) fn floor2(self, cell: f64) -> f64 {
        match self {
            Self::Center | Self::Apart => (1e-4 * cell).powi(2),
            Self::Mean(parts) => (0.5 * cell / f64::from(parts)).powi(2),
        }
    }
}

/// Emission on a grid: what a world unit of length gives off, linear RGB in float32.
#[derive(Debug, Clone)]
pub struct Volume {
    grid: Grid,
    value: CellValue,
    /// By their places, x fastest, then y, then z.
    bricks: Vec<Option<Brick>>,
    rest: Option<Box<Volume>>,
}

impl Volume {
    /// Makes a black one.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn new(grid: Grid, value: CellValue) -> Result<Self> {
        let bricks = grid.bricks().map(|count| count as usize).iter().product();
        check_memory(&grid, bricks * size_of::<Option<Brick>>())?;
        Ok(Self {
            grid,
            value,
            bricks: vec![None; bricks],
            rest: match value {
                CellValue::Apart => Some(Self::new(grid, CellValue::Center)?.into()),
                _ => None,
            },
        })
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

    /// Returns the emission of all sources but the strongest, if it was asked for ([`CellValue::Apart`]): what passes
    /// smoothly from one to the other where both are alike.
    #[must_use]
    pub fn rest(&self) -> Option<&Self> {
        self.rest.as_deref()
    }

    /// Returns the bricks in which something glows, with their places along x, y and z, counted in bricks.
    pub fn bricks(&self) -> impl Iterator<Item = ([u32; 3], &Brick)> {
        let [columns, rows, _] = self.grid.bricks();
        let place = move |number: u32| {
            [
                number % columns,
                number / columns % rows,
                number / columns / rows,
            ]
        };
        let numbered = (0..).zip(&self.bricks);
        numbered.filter_map(move |(number, brick)| Some((place(number), brick.as_ref()?)))
    }

    /// Returns the emission of a cell, linear RGB; 0 outside the grid.
    #[must_use]
    pub fn at(&self, cell: [u32; 3]) -> [f32; 3] {
        let most = self.grid.cells();
        if (0..3).any(|axis| cell[axis] >= most[axis]) {
            return [0.0; 3];
        }
        let brick = &self.bricks[self.place(cell.map(|it| it / BRICK))];
        brick
            .as_ref()
            .map_or([0.0; 3], |brick| brick.at(cell.map(|it| it % BRICK)))
    }

    /// Writes a row of cells along x into `row`, RGB after RGB.
    ///
    /// # Panics
    /// Where `row` is no row of the grid.
    pub fn read_row(&self, y: u32, z: u32, row: &mut [f32]) {
        let [columns, ..] = self.grid.cells();
        assert_eq!(row.len(), 3 * columns as usize, "a row of the grid");
        for (x, cell) in (0..).zip(row.as_chunks_mut::<3>().0) {
            *cell = self.at([x, y, z]);
        }
    }

    /// Returns the rest that stands beside what is stored so, if there is one.
    pub(crate) fn rest_beside(&self, storage: Storage) -> Option<&Self> {
        self.rest().filter(|_| storage != Storage::Emission)
    }

    /// Writes what a row of cells stores into `row`, RGB after RGB: of reciprocals beside a rest, without that.
    pub(crate) fn read_stored_row(&self, y: u32, z: u32, storage: Storage, row: &mut [f32]) {
        self.read_row(y, z, row);
        if let Some(rest) = self.rest_beside(storage) {
            let mut others = vec![0.0; row.len()];
            rest.read_row(y, z, &mut others);
            row.iter_mut().zip(others).for_each(|(all, it)| *all -= it);
        }
        row.iter_mut().for_each(|it| *it = storage.stored(*it));
    }

    /// Returns the largest emission of any cell and channel.
    #[must_use]
    pub fn greatest(&self) -> f32 {
        let of_bricks = self.bricks.iter().flatten().map(Brick::greatest);
        of_bricks.fold(0.0, f32::max)
    }

    fn place(&self, [x, y, z]: [u32; 3]) -> usize {
        let [columns, rows, _] = self.grid.bricks().map(|count| count as usize);
        (z as usize * rows + y as usize) * columns + x as usize
    }

    /// Adds a layer of bricks, the `layer`th along z: `values` are those of its cells, of which a row is `stride`
    /// values long, all red ones first, then green, then blue; then the same of the rest, where that is apart.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(crate) fn add_layer(&mut self, layer: u32, values: &[f32], stride: usize) -> Result<()> {
        let [columns, rows, layers] = self.grid.cells();
        let [brick_columns, brick_rows, _] = self.grid.bricks();
        let depth = (layers - layer * BRICK).min(BRICK);
        let values = match &mut self.rest {
            Some(rest) => {
                let (all, of_rest) = values.split_at(values.len() / 2);
                rest.add_layer(layer, of_rest, stride)?;
                all
            }
            None => values,
        };
        let plane = values.len() / 3;
        check_memory(
            &self.grid,
            (brick_columns * brick_rows) as usize * brick::BYTES,
        )?;
        for y in 0..brick_rows {
            for x in 0..brick_columns {
                let (first_x, first_y) = (x * BRICK, y * BRICK);
                let width = (columns - first_x).min(BRICK) as usize;
                let height = (rows - first_y).min(BRICK);
                let mut brick = Brick::default();
                for (channel, values) in values.chunks_exact(plane).enumerate() {
                    for (y, z) in (0..depth).flat_map(|z| (0..height).map(move |y| (y, z))) {
                        let row = (z * rows + first_y + y) as usize * stride + first_x as usize;
                        brick.set_row(channel, [y, z], &values[row..row + width]);
                    }
                }
                if brick.glows() {
                    let place = self.place([x, y, layer]);
                    self.bricks[place] = Some(brick);
                }
            }
        }
        Ok(())
    }
}

fn check_memory(grid: &Grid, bytes: usize) -> Result<()> {
    match memory::shortage(bytes as u64) {
        Some(shortage) => Err(Error::OutOfMemory(format!(
            "a volume of {grid} cells: {shortage}"
        ))),
        None => Ok(()),
    }
}
