//! The buffers of a crowd on a device, which are kept from frame to frame and grow when they must.

use bytemuck::Pod;

use super::COUNTS;
use super::pack::{CrowdSource, CrowdTile, CrowdView, MOST_ENDS, ROW_OF_ENDS};
use crate::error::Result;
use crate::opencl::{Argument, Compute, DeviceBuffer};

/// Numbers of the ranges of ends in a tile of 8 pixels.
const ROW_OF_RANGES: usize = 18;

/// Rays of a tile.
pub(super) const NODES_OF_TILE: usize = 16;

#[derive(Debug)]
pub(super) struct Buffers {
    pub sources: Kept<CrowdSource>,
    pub cells: Kept<u32>,
    pub starts: Kept<u32>,
    pub rest: Kept<f32>,
    pub peaks: Kept<[f32; 4]>,
    pub levels: Kept<[f32; 4]>,
    pub nodes: Kept<[f32; 4]>,
    pub planes: Kept<f32>,
    pub limits: Kept<[f32; 4]>,
    pub numbers: Kept<f32>,
    pub roots: Kept<u32>,
    pub tiles: Kept<CrowdTile>,
    pub values: Kept<f32>,
    pub owners: Kept<u32>,
    pub is_wanted: Kept<u32>,
    pub counts: Kept<u32>,
    /// Where rays end: of each pixel, of tiles of 8 pixels, and at the nodes of all tiles.
    pub shares: Kept<f32>,
    pub ranges: Kept<f32>,
    pub ends: Kept<f32>,
}

/// A buffer that grows when it must.
#[derive(Debug)]
pub(super) struct Kept<T> {
    what: &'static str,
    /// One in so many elements more is room for what changes a little from frame to frame.
    spare: usize,
    pub buffer: Option<DeviceBuffer<T>>,
}

/// Of points, of which others are in view in every frame, one in so many.
const SPARE: usize = 16;

impl<T: Pod> Kept<T> {
    pub fn new(what: &'static str) -> Self {
        Self {
            what,
            spare: usize::MAX,
            buffer: None,
        }
    }

    fn of_points(what: &'static str) -> Self {
        Self {
            spare: SPARE,
            ..Self::new(what)
        }
    }

    pub fn reserve(&mut self, compute: &Compute, len: usize) -> Result<&mut DeviceBuffer<T>> {
        // One that is too small is given back first.
        let buffer = match self.buffer.take().filter(|it| it.len() >= len) {
            Some(buffer) => buffer,
            None => DeviceBuffer::new(compute, self.what, len + len / self.spare)?,
        };
        Ok(self.buffer.insert(buffer))
    }

    fn bytes(&self) -> usize {
        let len = self.buffer.as_ref().map_or(0, DeviceBuffer::len);
        len * size_of::<T>()
    }

    pub fn write(&mut self, compute: &Compute, values: &[T]) -> Result<()> {
        self.reserve(compute, values.len())?.write(compute, values)
    }

    pub fn argument(&self) -> &dyn Argument {
        &self.buffer
    }
}

impl super::Crowd {
    /// Returns how much memory it takes on the device, and to sort on the host.
    pub(crate) fn bytes(&self) -> u64 {
        (self.buffers.bytes() + self.depths.bytes() + self.sorter.bytes()) as u64
    }
}

impl Buffers {
    fn bytes(&self) -> usize {
        // A buffer that is left out here is an error.
        let Self {
            sources,
            cells,
            starts,
            rest,
            peaks,
            levels,
            nodes,
            planes,
            limits,
            numbers,
            roots,
            tiles,
            values,
            owners,
            is_wanted,
            counts,
            shares,
            ranges,
            ends,
        } = self;
        let vectors = [peaks, levels, nodes, limits].map(Kept::bytes);
        let words = [cells, starts, roots, owners, is_wanted, counts].map(Kept::bytes);
        let numbers = [rest, planes, numbers, values, shares, ranges, ends].map(Kept::bytes);
        let all = vectors.iter().chain(&words).chain(&numbers);
        sources.bytes() + tiles.bytes() + all.sum::<usize>()
    }

    pub fn new() -> Self {
        Self {
            sources: Kept::of_points("the points of a crowd"),
            cells: Kept::of_points("the cells of points"),
            starts: Kept::new("where the points of cells begin"),
            rest: Kept::of_points("the points beside the image"),
            peaks: Kept::new("the light of cells"),
            levels: Kept::new("the light around cells"),
            nodes: Kept::new("the nodes of cells"),
            planes: Kept::new("the depths of the nodes"),
            limits: Kept::of_points("the nodes of small cells"),
            numbers: Kept::new("the weights of nodes"),
            roots: Kept::new("the first tiles"),
            tiles: Kept::new("the tiles of a crowd"),
            values: Kept::new("the light of tiles"),
            owners: Kept::new("which tile has which pixels"),
            is_wanted: Kept::new("which cells are looked at"),
            counts: Kept::new("the counts of a crowd"),
            shares: Kept::new("the ends of rays"),
            ranges: Kept::new("the ranges of ends"),
            ends: Kept::new("the ends in tiles"),
        }
    }

    /// Makes room for what a view needs, whose rays end at depths or are whole.
    pub fn reserve(&mut self, compute: &Compute, view: &CrowdView, has_ends: bool) -> Result<()> {
        let cells = view.cells_below(view.top + 1);
        let tiles: usize = (0..=view.top).map(|level| view.tile_count(level)).sum();
        let deep = cells - view.cells_below(view.base);
        self.rest.reserve(compute, 6)?;
        self.sources.reserve(compute, 1)?;
        self.cells.reserve(compute, 1)?;
        self.peaks.reserve(compute, cells)?;
        self.levels.reserve(compute, cells)?;
        self.nodes.reserve(compute, deep * view.nodes_of_cell())?;
        self.planes.reserve(compute, deep * view.planes_of_cell())?;
        self.limits.reserve(compute, view.numbers_of_limits())?;
        self.tiles.reserve(compute, tiles)?;
        let smallest = (view.tile_columns * view.height.div_ceil(8)) as usize;
        let mut values = tiles;
        if has_ends {
            values = MOST_ENDS * tiles;
            let pixels = view.width as usize * view.height as usize;
            self.shares.reserve(compute, pixels)?;
            self.ranges.reserve(compute, ROW_OF_RANGES * smallest)?;
            self.ends.reserve(compute, ROW_OF_ENDS * tiles)?;
        }
        self.values.reserve(compute, 3 * NODES_OF_TILE * values)?;
        self.owners.reserve(compute, smallest)?;
        self.is_wanted.reserve(compute, cells)?;
        self.counts.reserve(compute, COUNTS)?;
        Ok(())
    }
}
