//! The structs of `cl/crowd/types.h`, in the same order, and what they say of a scene and its grid.

use crate::error::Result;
use crate::image::{DepthAlong, ImageSize};
use crate::opencl::{DeviceStruct, StructLayout, by_value, device_struct};
use crate::scene::{CORE_FLOOR, CrowdSight, Profile, Scene};

device_struct! {
    /// The grid, what light becomes along its rays, and what is allowed.
    CrowdView [136] {
        first_u: f32 = 0,
        first_v: f32 = 4,
        step_u: f32 = 8,
        step_v: f32 = 12,
        near_plane: f32 = 16,
        ray_length: f32 = 20,
        nearness: f32 = 24,
        advance: f32 = 28,
        pole: f32 = 32,
        scale: f32 = 36,
        tolerance: f32 = 40,
        floor2: f32 = 44,
        is_square: u32 = 48,
        nodes: u32 = 52,
        depths: u32 = 56,
        top: u32 = 60,
        base: u32 = 64,
        width: u32 = 68,
        height: u32 = 72,
        left: u32 = 76,
        above: u32 = 80,
        sources: u32 = 84,
        rest: u32 = 88,
        roots: u32 = 92,
        tile_columns: u32 = 96,
        has_near_form: u32 = 100,
        thickness: f32 = 104,
        across: u32 = 108,
        block: u32 = 112,
        shallow: u32 = 116,
        is_along_axis: u32 = 120,
        slab_begin: f32 = 124,
        per_slab: f32 = 128,
        whole_depths: u32 = 132,
    }
}

device_struct! {
    /// A source in the grid.
    CrowdSource [32] {
        x: f32 = 0,
        y: f32 = 4,
        z: f32 = 8,
        red: f32 = 12,
        green: f32 = 16,
        blue: f32 = 20,
        peak: f32 = 24,
        level: f32 = 28,
    }
}

device_struct! {
    /// A tile that has light at its nodes.
    CrowdTile [16] {
        code: u32 = 0,
        parent: u32 = 4,
        level: u32 = 8,
        is_open: u32 = 12,
    }
}

by_value!(CrowdView);

/// Every struct of this engine that crosses to the device.
pub const STRUCTS: &[StructLayout] = &[CrowdView::LAYOUT, CrowdSource::LAYOUT, CrowdTile::LAYOUT];

/// Nodes of a cell along a side, and in depth, at most.
const MOST_NODES: usize = 6;
const MOST_DEPTHS: usize = 16;

/// A pixel that is a mean over its square sees a core as so thick, in pixels: that of 1/d^2 would have no end.
const LEAST_THICKNESS: f64 = 1.0 / 64.0;

/// Fewer cells of 8 pixels than this are few.
const FEW_CELLS: u32 = 1000;

/// Of so many sources the form of near ones does up to a greater width of what is around a tile, a slope.
const MANY: u32 = 50_000;
const WIDEST_OF_MANY: f64 = 0.16;

/// What a tile errs at most of the light of cells of 1/d^2 that only its neighbours part from it.
const LEAST_NEXT_TO_CELLS: f64 = 5e-4;

/// Places in the table of numbers.
const CELL_NODES: usize = 8;
const DEPTH_NODES: usize = 16;
const FACTORS: usize = 32;
const QUARTER_WEIGHTS: usize = 64;
const WHOLE_NODES: usize = 96;
const DEPTH_WEIGHTS: usize = 112;
const NUMBERS: usize = 368;

/// What is known of a crowd once its sources are sorted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sorted {
    pub sources: u32,
    pub rest: u32,
    /// How many cells of 8 pixels have a source.
    pub occupied: u32,
    /// The least and the greatest ln z of sources in the grid.
    pub t: [f64; 2],
}

/// Of a tile: ends of rays at most, and numbers in a row of the table of ends.
pub(super) const MOST_ENDS: usize = 25;
pub(super) const ROW_OF_ENDS: usize = 26;

/// Slabs of depth in and around a crowd, between the one before them and the one behind; how far before it and behind
/// it they go, in its own extents.
const SLABS_INSIDE: f64 = 6.0;
const AROUND: [f64; 2] = [0.5, 2.0];

/// Where rays end, light changes as fast with a source's depth as with the end: so many more depths, and cells with
/// depths so far down that a level has no more than these in a row.
const MORE_DEPTHS: u32 = 4;
const MOST_CELLS_ACROSS: u32 = 256;

/// Packs what a scene says of its light, and of the grid; `along` is what depths are measured along that end rays.
///
/// # Errors
/// As [`CrowdSight::new`].
pub(super) fn view(
    scene: &Scene,
    profile: Profile,
    sorted: &Sorted,
    along: Option<DepthAlong>,
) -> Result<CrowdView> {
    let sight = CrowdSight::new(scene)?;
    let ImageSize { width, height } = scene.image;
    let length = sight.ray_length;
    let decay = scene.decay.filter(|decay| decay.power == 2);
    let beta = decay.map_or(0.0, |decay| decay.beta);
    let nearness = decay.map_or(1.0, |_| beta / (1.0 + beta));
    let strength = match (scene.decay, decay) {
        (_, Some(decay)) => decay.alpha / decay.beta,
        // A decay of power 0 is alpha everywhere.
        (Some(even), None) => even.alpha,
        (None, None) => 1.0,
    };
    let tolerance = scene.integration.method.tolerance();
    let pixel = (sight.step[0] * sight.step[1]).sqrt();
    let thickness = match scene.integration.has_footprints() {
        true => LEAST_THICKNESS * pixel,
        false => 0.0,
    };
    let is_square = profile == Profile::InverseSquare;
    let [low, high] = sorted.t;
    let (nodes, more) = match tolerance {
        t if t >= 7e-4 => (3, 0),
        t if t >= 2e-4 => (4, 1),
        _ => (5, 2),
    };
    // Errors of many cells cancel, those of few add up; more nodes cost little there. 1/d^2 needs more room, too.
    let is_concentrated = sorted.occupied < FEW_CELLS;
    let is_tight = is_square && tolerance < LEAST_NEXT_TO_CELLS;
    let block = 1 + u32::from(is_tight || is_square && is_concentrated);
    let nodes = nodes + u32::from(is_square) + u32::from(is_concentrated);
    // Of many points those around a tile are a small part of its light.
    let is_dense =
        sorted.sources >= MANY && 8.0 * pixel * f64::from(2 * block + 1) < WIDEST_OF_MANY;
    let depths = (2.5 + 2.0 * (high - low)).ceil() as u32 + more + u32::from(is_square);
    let shallow = sight.base(block);
    let whole_depths = depths;
    let (base, depths) = match along {
        None => (shallow, depths),
        Some(_) => {
            let is_coarse = |level: &u32| sight.across << (sight.top - level) <= MOST_CELLS_ACROSS;
            let least = (0..sight.top).find(is_coarse).unwrap_or(sight.top);
            (shallow.min(least), depths.max(4) + MORE_DEPTHS)
        }
    };
    let [begin, end] = slabs(scene, &sight, sorted.t);
    let tiles = |level: u32, offset: u32, size: u32| {
        let side = 8 << level;
        (offset + size).div_ceil(side) - offset / side
    };
    let roots = tiles(sight.top, sight.left, width) * tiles(sight.top, sight.above, height);
    Ok(CrowdView {
        first_u: sight.first[0] as f32,
        first_v: sight.first[1] as f32,
        step_u: sight.step[0] as f32,
        step_v: sight.step[1] as f32,
        near_plane: sight.near as f32,
        ray_length: length as f32,
        nearness: nearness as f32,
        advance: decay.map_or(1.0, |_| nearness / beta) as f32,
        pole: (beta * length) as f32,
        scale: (strength * scene.integration.scale(length)) as f32,
        tolerance: tolerance as f32,
        floor2: (CORE_FLOOR * length).powi(2) as f32,
        is_square: u32::from(is_square),
        nodes: nodes.min(MOST_NODES as u32),
        depths: depths.clamp(4, MOST_DEPTHS as u32),
        top: sight.top,
        base,
        width,
        height,
        left: sight.left,
        above: sight.above,
        sources: sorted.sources,
        rest: sorted.rest,
        roots,
        tile_columns: width.div_ceil(8),
        has_near_form: u32::from(shallow > 0 || is_dense),
        thickness: thickness as f32,
        across: sight.across,
        block,
        shallow,
        is_along_axis: u32::from(!matches!(along, None | Some(DepthAlong::Ray))),
        slab_begin: begin as f32,
        per_slab: (SLABS_INSIDE / (end - begin).max(1e-3)) as f32,
        whole_depths: whole_depths.clamp(4, MOST_DEPTHS as u32),
    })
}

/// Returns the shares of rays between which there are slabs of depth: in and around the crowd, as far as rays end
/// there.
fn slabs(scene: &Scene, sight: &CrowdSight, t: [f64; 2]) -> [f64; 2] {
    let share = |z: f64| (z - sight.near) / sight.ray_length;
    let [low, high] = t.map(f64::exp);
    let wide = high - low;
    let crowd = [low - AROUND[0] * wide, high + AROUND[1] * wide].map(share);
    let Some(depth) = &scene.depth else {
        return crowd;
    };
    let (mut first, mut last) = (f32::INFINITY, 0.0_f32);
    for length in depth.as_slice().iter().filter(|it| it.is_finite()) {
        (first, last) = (first.min(*length), last.max(*length));
    }
    let ends = [first, last].map(|length| share(f64::from(length)).clamp(0.0, 1.0));
    let both = [crowd[0].max(ends[0]), crowd[1].min(ends[1])];
    match both[0] < both[1] {
        true => both,
        false => ends,
    }
}

impl CrowdView {
    /// Returns how many cells a level has.
    pub(super) fn cells(&self, level: u32) -> usize {
        (self.across as usize).pow(2) << (2 * (self.top - level))
    }

    /// Returns how many cells levels below one have.
    pub(super) fn cells_below(&self, level: u32) -> usize {
        (0..level).map(|it| self.cells(it)).sum()
    }

    /// Returns the columns and rows of tiles of a level that have a part of the image: first and end of each.
    fn tiles(&self, level: u32) -> [(u32, u32); 2] {
        let side = 8_u32 << level;
        let ends = |offset: u32, size: u32| (offset / side, (offset + size).div_ceil(side));
        [ends(self.left, self.width), ends(self.above, self.height)]
    }

    /// Returns how many tiles of a level have a part of the image.
    pub(super) fn tile_count(&self, level: u32) -> usize {
        let [columns, rows] = self.tiles(level).map(|(first, end)| (end - first) as usize);
        columns * rows
    }

    /// Returns the Morton codes of the highest tiles.
    pub(super) fn roots(&self) -> Vec<u32> {
        let [columns, rows] = self.tiles(self.top).map(|(first, end)| first..end);
        rows.flat_map(|row| columns.clone().map(move |column| morton(column, row)))
            .collect()
    }

    /// Returns how many numbers the nodes of one cell have, of which each has red, green and blue.
    pub(super) fn nodes_of_cell(&self) -> usize {
        (self.nodes * self.nodes * self.depths) as usize
    }

    /// Returns how many numbers limits on nodes have, of which each has red, green and blue: those of cells of more
    /// sources than nodes.
    pub(super) fn numbers_of_limits(&self) -> usize {
        let nodes = (self.nodes * self.nodes) as usize;
        let most = self.sources as usize / (nodes + 1) + 1;
        nodes
            * (0..self.shallow)
                .map(|it| self.cells(it).min(most))
                .sum::<usize>()
    }

    /// Returns how many numbers say where the depths of one cell are.
    pub(super) fn planes_of_cell(&self) -> usize {
        2 + (self.depths + self.whole_depths) as usize
    }

    /// Returns nodes and factors of their weights.
    pub(super) fn numbers(&self) -> Vec<f32> {
        let mut numbers = vec![0.0_f32; NUMBERS];
        let kinds = [(0, 4), (CELL_NODES, self.nodes), (DEPTH_NODES, self.depths)];
        for (at, count) in kinds {
            let nodes = chebyshev(count as usize);
            for (i, node) in nodes.iter().enumerate() {
                let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
                let product: f64 = others.map(|(_, other)| node - other).product();
                numbers[at + i] = *node as f32;
                numbers[FACTORS + at + i] = (1.0 / product) as f32;
            }
        }
        let nodes = chebyshev(4);
        for (k, weight) in numbers[QUARTER_WEIGHTS..WHOLE_NODES].iter_mut().enumerate() {
            let (side, own, parents) = (k / 16, k / 4 % 4, k % 4);
            let place = 0.5 * nodes[own] + side as f64 - 0.5;
            let others = nodes.iter().enumerate().filter(|(j, _)| *j != parents);
            let share = |(_, other): (usize, &f64)| (place - other) / (nodes[parents] - other);
            *weight = others.map(share).product::<f64>() as f32;
        }
        let deep = chebyshev(self.depths as usize);
        let whole = chebyshev(self.whole_depths as usize);
        for (number, node) in numbers[WHOLE_NODES..].iter_mut().zip(&whole) {
            *number = *node as f32;
        }
        for (q, own) in whole.iter().enumerate() {
            for (from, node) in deep.iter().enumerate() {
                let others = whole.iter().enumerate().filter(|(other, _)| *other != q);
                let weight: f64 = others.map(|(_, it)| (node - it) / (own - it)).product();
                numbers[DEPTH_WEIGHTS + q * MOST_DEPTHS + from] = weight as f32;
            }
        }
        numbers
    }
}

const _: () = assert!(CELL_NODES + MOST_NODES <= DEPTH_NODES);

/// Returns `cos(pi (2i + 1) / 2n)`.
fn chebyshev(count: usize) -> Vec<f64> {
    let node = |i: usize| {
        let turn = (2 * i + 1) as f64 / (2 * count) as f64;
        (std::f64::consts::PI * turn).cos()
    };
    (0..count).map(node).collect()
}

/// Returns the code in which the bits of column and row alternate.
#[inline]
pub(super) fn morton(column: u32, row: u32) -> u32 {
    let spread = |mut number: u32| {
        number = (number | number << 8) & 0x00ff_00ff;
        number = (number | number << 4) & 0x0f0f_0f0f;
        number = (number | number << 2) & 0x3333_3333;
        (number | number << 1) & 0x5555_5555
    };
    spread(column) | spread(row) << 1
}

/// Returns the column of a code, and above 16 bits the row.
#[inline]
pub(super) fn column_and_row(code: u32) -> u32 {
    let gather = |mut number: u32| {
        number &= 0x5555_5555;
        number = (number | number >> 1) & 0x3333_3333;
        number = (number | number >> 2) & 0x0f0f_0f0f;
        number = (number | number >> 4) & 0x00ff_00ff;
        (number | number >> 8) & 0x0000_ffff
    };
    gather(code) | gather(code >> 1) << 16
}
