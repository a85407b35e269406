//! The structs of `cl/texture/types.h`, in the same order, and what packs views and volumes into them.

use std::f64::consts::LOG2_E;
use std::sync::Arc;

use glam::DVec3;

use super::smooth::{coarse_strides, has_bricks};
use crate::image::DepthAlong;
use crate::opencl::{DeviceStruct, StructLayout, by_value, device_struct};
use crate::scene::{Scene, ViewPlane, Volume, VolumeInterpolation, VolumeMethod};
use crate::threads::for_each_chunk;
use crate::volume::Texture;

device_struct! {
    /// The rays of the picture, and what light becomes along them.
    TextureView [112] {
        first_pixel: [f32; 4] = 0,
        column_step: [f32; 4] = 16,
        row_step: [f32; 4] = 32,
        toward: [f32; 4] = 48,
        near: f32 = 64,
        ray_length: f32 = 68,
        scale: f32 = 72,
        beta: f32 = 76,
        per_length: f32 = 80,
        absorbed: f32 = 84,
        power: u32 = 88,
        width: u32 = 92,
        height: u32 = 96,
        is_parallel: u32 = 100,
        has_depth: u32 = 104,
        is_along_axis: u32 = 108,
    }
}

device_struct! {
    /// A volume.
    TextureVolume [128] {
        to_x: [f32; 4] = 0,
        to_y: [f32; 4] = 16,
        to_z: [f32; 4] = 32,
        red: f32 = 48,
        green: f32 = 52,
        blue: f32 = 56,
        floor: f32 = 60,
        columns: u32 = 64,
        rows: u32 = 68,
        layers: u32 = 72,
        sheet: u32 = 76,
        channels: u32 = 80,
        power: u32 = 84,
        is_cubic: u32 = 88,
        slices: u32 = 92,
        step: f32 = 96,
        middle: f32 = 100,
        radius: f32 = 104,
        line: u32 = 108,
        coarse_line: u32 = 112,
        coarse_sheet: u32 = 116,
        most_left: f32 = 120,
        has_bricks: u32 = 124,
    }
}

by_value!(TextureView, TextureVolume);

/// Every struct of this engine that crosses to the device.
pub const STRUCTS: &[StructLayout] = &[TextureView::LAYOUT, TextureVolume::LAYOUT];

fn four(v: DVec3, last: f64) -> [f32; 4] {
    [v.x, v.y, v.z, last].map(|it| it as f32)
}

impl TextureView {
    /// Packs the view of a scene; `along` is what depths are measured along that end rays.
    pub(super) fn new(scene: &Scene, plane: &ViewPlane, along: Option<DepthAlong>) -> Self {
        let decay = scene.decay.filter(|decay| decay.power > 0);
        // A decay of power 0 is alpha everywhere.
        let alpha = scene.decay.map_or(1.0, |decay| decay.alpha);
        let measure = scene.integration.scale(plane.ray_length) / plane.ray_length;
        let kappa = scene.absorption.map_or(0.0, |absorption| absorption.kappa);
        Self {
            first_pixel: four(plane.first_pixel, 0.0),
            column_step: four(plane.column_step, 0.0),
            row_step: four(plane.row_step, 0.0),
            toward: four(plane.forward, 0.0),
            near: plane.near as f32,
            ray_length: plane.ray_length as f32,
            scale: (measure * alpha) as f32,
            beta: decay.map_or(1.0, |decay| decay.beta) as f32,
            per_length: decay.map_or(0.0, |_| 1.0 / plane.ray_length) as f32,
            absorbed: (kappa * LOG2_E) as f32,
            power: decay.map_or(0, |decay| decay.power),
            width: scene.image.width,
            height: scene.image.height,
            is_parallel: u32::from(plane.is_parallel),
            has_depth: u32::from(along.is_some()),
            is_along_axis: u32::from(!matches!(along, None | Some(DepthAlong::Ray))),
        }
    }
}

impl TextureVolume {
    pub(super) fn new(volume: &Volume, plane: &ViewPlane, method: VolumeMethod) -> Self {
        let texture = &volume.texture;
        let [columns, rows, layers] = texture.cells();
        let [line, sheet] = strides(texture.cells(), texture.channels());
        let to_cells = volume.to_cells();
        let middle = 0.5 * (DVec3::from(texture.cells().map(f64::from)) - 1.0);
        let from_eye = middle - to_cells * (volume.center - plane.eye);
        let row = |axis: usize| four(to_cells.row(axis), from_eye[axis]);
        let [red, green, blue] = volume.emission().as_vec3().to_array();
        let has_bricks = skips(volume, method);
        let [coarse_line, coarse_sheet] = coarse_strides(texture.cells(), texture.channels());
        let (slices, step) = match method {
            VolumeMethod::Ray { step } => (0, step),
            VolumeMethod::Slices { .. } if volume.is_plate() => (0, 1.0),
            VolumeMethod::Slices { count } => (count, 1.0),
        };
        Self {
            to_x: row(0),
            to_y: row(1),
            to_z: row(2),
            red,
            green,
            blue,
            floor: texture.floor(),
            columns,
            rows,
            layers,
            sheet,
            channels: texture.channels(),
            power: texture.storage().power(),
            is_cubic: u32::from(volume.interpolation == VolumeInterpolation::Cubic),
            slices,
            step: step as f32,
            middle: (volume.center - plane.eye).dot(plane.forward) as f32,
            radius: volume.radius() as f32,
            line,
            coarse_line,
            coarse_sheet,
            most_left: LEFT * (step * step) as f32,
            has_bricks: u32::from(has_bricks),
        }
    }
}

/// What long steps may leave of the light of each, relative, where others are of a cell; much of that averages out.
const LEFT: f32 = 1e-3;

/// Returns whether rays go through a volume by bricks: pieces longer than a cell would go beyond what those say.
pub(super) fn skips(volume: &Volume, method: VolumeMethod) -> bool {
    let is_fine = matches!(method, VolumeMethod::Ray { step } if step <= 1.0);
    is_fine && has_bricks(volume.texture.cells())
}

/// Values of a cache line.
const LINE: u32 = 16;

/// Grids with shorter rows stay as they are, but for rows of fewer cells than are loaded at once.
const LONG: u32 = 64;
const LEAST: u32 = 4;

/// Returns what is between the values of one row and the next, and of one layer and the next: odd numbers of cache
/// lines, because cells that are powers of 2 apart drive each other out of caches (256^3 cells of three channels are
/// drawn 1.8 times as fast as without).
pub(super) fn strides([columns, rows, _]: [u32; 3], channels: u32) -> [u32; 2] {
    if columns < LONG {
        let line = columns.max(LEAST);
        return [line, line * rows];
    }
    let cells = LINE / numbers(channels) as u32;
    let line = cells * (columns.div_ceil(cells) | 1);
    [line, line * (rows | 1)]
}

/// Returns how many numbers a cell takes: of three channels one is to spare.
pub(super) fn numbers(channels: u32) -> usize {
    if channels == 3 { 4 } else { 1 }
}

/// Returns the values of all cells with such strides between them, the channels of a cell side by side. Rows go on with
/// their last cell.
pub(super) fn strided(texture: &Texture) -> Arc<Vec<f32>> {
    let (cells, channels) = (texture.cells(), texture.channels());
    let [columns, rows, layers] = cells.map(|it| it as usize);
    let [line, sheet] = strides(cells, channels).map(|it| it as usize);
    if line == columns && channels == 1 {
        return Arc::clone(texture.values());
    }
    let of_channels = texture.values().chunks_exact(columns * rows * layers);
    Arc::new(side_by_side(
        of_channels,
        [columns, rows, layers],
        [line, sheet],
    ))
}

/// Does the same for the cells of each channel.
pub(super) fn side_by_side<'a>(
    channels: impl ExactSizeIterator<Item = &'a [f32]>,
    [columns, rows, layers]: [usize; 3],
    [line, sheet]: [usize; 2],
) -> Vec<f32> {
    let channels: Vec<&[f32]> = channels.collect();
    let each = numbers(channels.len() as u32);
    let mut values = vec![0.0; each * sheet * layers];
    for_each_chunk(&mut values, each * sheet, |z, values| {
        for (y, row) in values.chunks_exact_mut(each * line).take(rows).enumerate() {
            for (channel, from) in channels.iter().enumerate() {
                let from = &from[(z * rows + y) * columns..][..columns];
                let last = std::iter::repeat(&from[columns - 1]);
                for (cell, value) in row.chunks_exact_mut(each).zip(from.iter().chain(last)) {
                    cell[channel] = *value;
                }
            }
        }
    });
    values
}
