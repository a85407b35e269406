//! What a volume is where it changes little, so that rays take long steps there: a grid of half as many cells along
//! each axis, to be interpolated linearly, and for every 8x8x8 cells what such steps leave.
//!
//! Linear interpolation adds, in the mean, a twelfth of the second difference along each axis; what is stored has it
//! taken away. Steps of 8 cells by two Gauss-Legendre points leave f'''' L^4 / 4320 of the mean, f'''' of the fourth
//! difference, and what linear interpolation at a point differs from its mean, 0.037 of the second difference.

use std::sync::Arc;

use crate::scene::VolumeInterpolation;
use crate::threads::for_each_chunk;
use crate::volume::{Storage, Texture};

use super::pack::{side_by_side, strides};

/// Cells of a brick along an edge, and of the grid of half as many.
pub(super) const BRICK: usize = 8;
const COARSE: usize = BRICK / 2;

/// What cells of the coarse grid a step of 8 cells may touch beyond the brick in which its middle is.
const BEYOND: usize = 3;

/// Grids with fewer cells along an edge are drawn cell by cell.
const LEAST: u32 = 16;

/// A brick without light; kernels compare with 0.
const EMPTY: f32 = -1.0;

/// Light below this is none: the reciprocal of what stands for none.
const BLACK: f32 = 1e-14;

/// Relative to its brightest cell, a volume has no digits below this.
const FLOOR: f32 = 1e-7;

/// The share of a cell's greatest channel that others count for at least.
const OF_CHANNELS: f32 = 0.1;

/// The coarse grid, and of each brick what a step by two points leaves of light there, relative: by linear
/// interpolation, and by the points.
#[derive(Debug)]
pub(super) struct Smooth {
    of: Arc<Vec<f32>>,
    interpolation: VolumeInterpolation,
    pub(super) cells: Arc<Vec<f32>>,
    pub(super) bricks: Arc<Vec<f32>>,
}

/// Values of a grid, x fastest.
struct Field {
    size: [usize; 3],
    values: Vec<f32>,
}

/// Returns whether a grid has bricks.
pub(super) fn has_bricks(cells: [u32; 3]) -> bool {
    cells.iter().all(|it| *it >= LEAST)
}

/// Returns how many cells the coarse grid has.
fn coarse_size(cells: [u32; 3]) -> [usize; 3] {
    cells.map(|it| it.div_ceil(2) as usize)
}

/// Returns what is between the values of one row and the next of the coarse grid, and of one layer and the next.
pub(super) fn coarse_strides(cells: [u32; 3], channels: u32) -> [u32; 2] {
    strides(coarse_size(cells).map(|it| it as u32), channels)
}

impl Smooth {
    /// Makes one of a texture that has bricks.
    pub(super) fn new(texture: &Texture, interpolation: VolumeInterpolation) -> Self {
        let cells = texture.cells();
        let plane = texture.values().len() / texture.channels() as usize;
        let (storage, floor) = (texture.storage(), texture.floor());
        let is_linear = interpolation == VolumeInterpolation::Linear;
        let fields = texture.values().chunks_exact(plane).map(|values| {
            let light = halved(cells, values, |it| emission(storage, floor, it));
            let has_other = is_linear && storage != Storage::Emission;
            let stored = has_other.then(|| halved(cells, values, |it| it));
            (light, stored)
        });
        let fields: Vec<(Field, Option<Field>)> = fields.collect();
        let size = coarse_size(cells);
        let [columns, rows, layers] = size;
        let mut coarse = vec![0.0; fields.len() * columns * rows * layers];
        let bias = if is_linear { 1.0 / 48.0 } else { 0.0 };
        for_each_chunk(&mut coarse, columns * rows, |number, sheet| {
            let (light, stored) = &fields[number / layers];
            let stored = stored.as_ref().unwrap_or(light);
            for (y, row) in sheet.chunks_mut(columns).enumerate() {
                let at = [y, number % layers];
                light.without_what_interpolation_adds(stored, storage, bias, at, row);
            }
        });
        let strides = coarse_strides(cells, texture.channels()).map(|it| it as usize);
        let coarse = side_by_side(coarse.chunks_exact(columns * rows * layers), size, strides);
        let lights: Vec<&Field> = fields.iter().map(|(light, _)| light).collect();
        Self {
            of: Arc::clone(texture.values()),
            interpolation,
            cells: Arc::new(coarse),
            bricks: Arc::new(bricks(&lights, cells)),
        }
    }

    /// Returns whether it is that of a texture.
    pub(super) fn is_of(&self, texture: &Texture, interpolation: VolumeInterpolation) -> bool {
        Arc::ptr_eq(&self.of, texture.values()) && self.interpolation == interpolation
    }
}

/// Along an axis, the two cells of which a coarse one is, and their weights: beyond the last a straight line goes on.
fn pair(place: usize, count: usize) -> [(usize, f32); 2] {
    match 2 * place + 1 < count {
        true => [(2 * place, 0.5), (2 * place + 1, 0.5)],
        false => [(count - 1, 1.5), (count - 2, -0.5)],
    }
}

/// Returns the mean of every eight cells, of what `value` makes of what they store.
fn halved(cells: [u32; 3], values: &[f32], value: impl Fn(f32) -> f32 + Send + Sync) -> Field {
    let [columns, rows, layers] = cells.map(|it| it as usize);
    let size = coarse_size(cells);
    let mut halved = vec![0.0_f32; size.iter().product()];
    for_each_chunk(&mut halved, size[0] * size[1], |z, sheet| {
        for (y, row) in sheet.chunks_exact_mut(size[0]).enumerate() {
            for (near, of_near) in pair(z, layers) {
                for (low, of_low) in pair(y, rows) {
                    let first = (near * rows + low) * columns;
                    let fine = &values[first..first + columns];
                    let weight = of_near * of_low;
                    for (sum, pair) in row.iter_mut().zip(fine.chunks_exact(2)) {
                        *sum += 0.5 * weight * (value(pair[0]) + value(pair[1]));
                    }
                    if columns % 2 == 1 {
                        let ends =
                            pair(size[0] - 1, columns).map(|(x, share)| share * value(fine[x]));
                        row[size[0] - 1] += weight * (ends[0] + ends[1]);
                    }
                }
            }
            row.iter_mut().for_each(|it| *it = it.max(0.0));
        }
    });
    Field {
        size,
        values: halved,
    }
}

fn emission(storage: Storage, floor: f32, stored: f32) -> f32 {
    let light = match storage {
        Storage::Emission => return stored,
        Storage::Reciprocal { power: 1 } => 1.0 / stored.max(floor),
        Storage::Reciprocal { .. } => stored.max(floor).sqrt().recip(),
    };
    if light > BLACK { light } else { 0.0 }
}

impl Field {
    /// Returns where a cell and its neighbours along an axis are; at faces those of the next cell within.
    fn around(&self, at: [usize; 3], axis: usize, reach: usize) -> (usize, usize) {
        let stride = [1, self.size[0], self.size[0] * self.size[1]];
        let mut at = at;
        at[axis] = at[axis].clamp(reach, self.size[axis] - 1 - reach);
        let place = at[0] + at[1] * stride[1] + at[2] * stride[2];
        (place, stride[axis])
    }

    /// Returns the second difference along an axis.
    fn second(&self, at: [usize; 3], axis: usize) -> f32 {
        let (place, step) = self.around(at, axis, 1);
        self.values[place - step] - 2.0 * self.values[place] + self.values[place + step]
    }

    /// Returns the fourth difference along an axis.
    fn fourth(&self, at: [usize; 3], axis: usize) -> f32 {
        let (place, step) = self.around(at, axis, 2);
        let sides = |way: usize| self.values[place - way * step] + self.values[place + way * step];
        sides(2) - 4.0 * sides(1) + 6.0 * self.values[place]
    }

    /// Fills a row with what linear interpolation makes a field of that has these means, plus what the fine grid's own
    /// linear interpolation adds to what is `stored`, `bias` times its second differences.
    fn without_what_interpolation_adds(
        &self,
        stored: &Self,
        storage: Storage,
        bias: f32,
        [y, z]: [usize; 2],
        row: &mut [f32],
    ) {
        for (x, filled) in row.iter_mut().enumerate().take(self.size[0]) {
            let at = [x, y, z];
            let light = self.values[(z * self.size[1] + y) * self.size[0] + x];
            let bend = |field: &Self| (0..3).map(|axis| field.second(at, axis)).sum::<f32>();
            let mut sum = light - 11.0 / 96.0 * bend(self);
            if bias > 0.0 {
                let slope = match storage {
                    Storage::Emission => 1.0,
                    Storage::Reciprocal { power: 1 } => -light * light,
                    Storage::Reciprocal { .. } => -0.5 * light * light * light,
                };
                let added = slope * bias * bend(stored);
                sum += if added.is_finite() { added } else { 0.0 };
            }
            *filled = sum;
        }
    }
}

/// Returns of each brick what it leaves, two numbers.
fn bricks(lights: &[&Field], cells: [u32; 3]) -> Vec<f32> {
    let size = lights[0].size;
    let most = lights
        .iter()
        .flat_map(|it| &it.values)
        .fold(0.0_f32, |most, it| most.max(*it));
    let plane = size[0] * size[1];
    // Along x already of bricks.
    let counts = cells.map(|it| (it as usize).div_ceil(BRICK));
    let mut lines = vec![[EMPTY; 2]; counts[0] * size[1] * size[2]];
    for_each_chunk(&mut lines, counts[0] * size[1], |z, lines| {
        let mut row = vec![[EMPTY; 2]; size[0]];
        for (y, line) in lines.chunks_exact_mut(counts[0]).enumerate() {
            for (x, left) in row.iter_mut().enumerate() {
                let place = z * plane + y * size[0] + x;
                let brightest = lights
                    .iter()
                    .fold(0.0_f32, |most, it| most.max(it.values[place]));
                let least = FLOOR * most + OF_CHANNELS * brightest;
                *left = left_at(lights, [x, y, z], place, least);
            }
            for (brick, left) in line.iter_mut().enumerate() {
                *left = worst(brick, size[0], |x| row[x]);
            }
        }
    });
    let mut sheets = vec![[EMPTY; 2]; counts[0] * counts[1] * size[2]];
    for (place, left) in sheets.iter_mut().enumerate() {
        let (x, y, z) = (
            place % counts[0],
            place / counts[0] % counts[1],
            place / counts[0] / counts[1],
        );
        *left = worst(y, size[1], |y| lines[(z * size[1] + y) * counts[0] + x]);
    }
    let area = counts[0] * counts[1];
    let all = (0..area * counts[2])
        .flat_map(|place| worst(place / area, size[2], |z| sheets[z * area + place % area]));
    all.collect()
}

/// Returns what a cell leaves, relative to its light; nothing at all where there is none.
fn left_at(lights: &[&Field], at: [usize; 3], place: usize, least: f32) -> [f32; 2] {
    let mut left = [EMPTY; 2];
    for light in lights {
        let is_dark = light.values[place] == 0.0;
        let bend = |axis| light.second(at, axis).abs();
        let bends: f32 = (0..3).map(bend).sum();
        if is_dark && bends == 0.0 {
            continue;
        }
        let fourths: f32 = (0..3).map(|axis| light.fourth(at, axis).abs()).sum();
        let per = (light.values[place] + least).recip();
        left[0] = left[0].max(0.026 * bends * per);
        left[1] = left[1].max(256.0 / 4320.0 * fourths * per);
    }
    left
}

/// Returns the worst that steps with their middle in a brick meet along an axis.
fn worst(brick: usize, count: usize, left: impl Fn(usize) -> [f32; 2]) -> [f32; 2] {
    let low = (brick * COARSE).saturating_sub(BEYOND).min(count - 1);
    let high = ((brick + 1) * COARSE + BEYOND).min(count);
    (low..high).map(left).fold([EMPTY; 2], |most, it| {
        [most[0].max(it[0]), most[1].max(it[1])]
    })
}
