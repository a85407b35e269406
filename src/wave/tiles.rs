//! The passes over an image's tiles, the largest first.

use std::ops::Range;

use super::pack::layout::TilePass;
use super::partition::{Counts, Part, TILE_SHARES, word_count};
use crate::error::Result;
use crate::image::ImageSize;
use crate::opencl::{Compute, DeviceBuffer, DeviceForm, OpenClDevice, RendererOptions, halved};
use crate::scene::Integration;
use crate::scene::kinds::KIND_COUNT;

/// Sides of the smallest and of the largest tile, pixels; each pass halves them.
const SMALLEST: u32 = 8;
const LARGEST: u32 = 256;

/// Passes at most.
pub(super) const MOST_PASSES: usize = (LARGEST / SMALLEST).ilog2() as usize + 1;

/// Returns the side of the first pass' tiles: about a sixteenth of an image, so that many tiles see a wave whole and
/// the first pass costs the same at every size.
pub(super) fn first_size(image: ImageSize) -> u32 {
    let side = image.width.max(image.height);
    (side / 16).next_power_of_two().clamp(64, LARGEST)
}

/// Bytes of the list of tiles that a launch leaves open, at most; a frame of 3840x2160 and up to 8000 sources fits.
const MOST_OPEN_BYTES: usize = 256 << 20;

/// Pixels of one launch on so many sources: all passes together may leave a tile open for 48 pixels.
pub(super) fn most_pixels(sources: u64) -> u32 {
    let words = sources.min(MOST_SOURCES).div_ceil(32) as usize + KIND_COUNT;
    let bytes_of_tile = size_of::<u32>() * (PLACE + words) + size_of::<f32>() * LIGHT;
    (48 * (MOST_OPEN_BYTES / bytes_of_tile)).min(1 << 23) as u32
}

/// Words of 32 sources of one launch, of which a group of work-items holds as many: half a KiB of local memory. A
/// launch takes one tile at least, with all of its sources.
const MOST_WORDS: u32 = 128;

/// Sources of one launch: always as many, so that those of a larger scene are summed in the same order whatever the
/// pace. Each kind begins with a new word, so that all but one may leave 31 bits of a word unused.
pub(super) const MOST_SOURCES: u64 = 32 * (MOST_WORDS as u64 - (KIND_COUNT as u64 - 1));

const _: () = assert!(MOST_SOURCES as usize + 31 * KIND_COUNT <= 32 * MOST_WORDS as usize + 31);

/// Groups of work-items for each compute unit, which share the tiles evenly: enough for a fair share, few enough that
/// those without a tile cost nothing (on PoCL 3.1 with 2 units 4096 groups take a ring at 512x512 1.5 times as long;
/// half as many as 512 save 2 %, and 4 % where two devices share the image).
const GROUPS_A_UNIT: usize = 128;

/// What a tile's light takes: three channels at 16 nodes.
const LIGHT: usize = 48;

/// Column and row of an open tile, before its words of sources.
const PLACE: usize = 2;

/// Returns definitions for the kernels' compiler.
pub(super) fn definitions(workers: u32) -> String {
    format!(" -D MOST_WORDS={MOST_WORDS} -D TILE_WORKERS={workers} -D TILE_SHARES={TILE_SHARES}u")
}

/// Tiles that a pass leaves open, on the device.
#[derive(Debug, Default)]
pub(super) struct OpenTiles {
    pub(super) places: Option<DeviceBuffer<u32>>,
    pub(super) light: Option<DeviceBuffer<f32>>,
}

impl OpenTiles {
    /// Makes room for the passes of a launch.
    pub(super) fn reserve(&mut self, compute: &Compute, passes: &[TilePass]) -> Result<()> {
        let most = passes.iter().map(|pass| pass.write_to).max().unwrap_or(0) as usize;
        let words = passes.first().map_or(0, |pass| pass.word_count) as usize;
        let what = "the list of open tiles";
        reserve(&mut self.places, compute, what, most * (PLACE + words))?;
        reserve(&mut self.light, compute, what, most * LIGHT)
    }
}

fn reserve<T: bytemuck::Pod>(
    buffer: &mut Option<DeviceBuffer<T>>,
    compute: &Compute,
    what: &str,
    len: usize,
) -> Result<()> {
    if buffer.as_ref().is_none_or(|buffer| buffer.len() < len) {
        *buffer = None;
        *buffer = Some(DeviceBuffer::new(compute, what, len)?);
    }
    Ok(())
}

/// By how much the light of a source may be off.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tolerance {
    /// Of itself.
    pub relative: f64,
    /// Beside that, linear light.
    pub absolute: f64,
}

impl Tolerance {
    /// With one beside what light has of itself, light that is interpolated is taken to be positive.
    pub fn of(integration: &Integration, has_negative_light: bool) -> Self {
        let absolute = integration.absolute_tolerance;
        Self {
            relative: integration.method.tolerance(),
            absolute: if has_negative_light { 0.0 } else { absolute },
        }
    }
}

/// By how much float32 rays differ from each other anyway.
const LEAST_TOLERANCE: f64 = 2e-5;

/// How much of the tolerance an interpolation may use up where it is tested.
const MOST_ERROR: f64 = 0.25;

/// Returns how smooth an interpolation must seem to be put to the test for a tolerance: the largest odd and the largest
/// even highest Chebyshev coefficient, relative to the least value. Of a function that is analytic beside the tile the
/// coefficients fall as `rho^-k`: after `rho^-2` and `rho^-3`, the highest of four nodes, `rho^-4` is missing.
fn most_coefficients(tolerance: f64) -> (f32, f32) {
    let missing = 0.1 * tolerance;
    (3.0 * missing.powf(0.75) as f32, 1.6 * missing.sqrt() as f32)
}

/// Returns how many passes there are with first tiles of this side.
pub(super) fn pass_count(first_size: u32) -> u32 {
    (first_size / SMALLEST).ilog2() + 1
}

/// Returns the passes over the tiles of a part that it takes, whole rows of tiles of an image.
pub(super) fn passes(
    part: &Part,
    counts: &Counts,
    (width, pixel_step): (u32, f32),
    first_size: u32,
    tolerance: Tolerance,
) -> Vec<TilePass> {
    let rows = part.pixels.len() as u32 / width;
    let columns = width.div_ceil(first_size);
    let tile_count = columns * rows.div_ceil(first_size);
    let relative = tolerance.relative.max(LEAST_TOLERANCE);
    let (most_odd, most_even) = most_coefficients(relative);
    let last = pass_count(first_size) - 1;
    let mut written: Range<u32> = 0..0;
    let mut pass = |level: u32| {
        let size = first_size >> level;
        let read_from = written.start;
        written = written.end..written.end + (tile_count << (2 * level));
        TilePass {
            size,
            inner: inner(size),
            parent_inner: inner(2 * size),
            level,
            is_last: u32::from(level == last),
            columns,
            tile_count,
            read_from,
            write_to: written.start,
            word_count: word_count(part, counts),
            from: part.shares.start,
            to: part.shares.end,
            pixel_step,
            most_odd,
            most_even,
            most_error: (MOST_ERROR * relative) as f32,
            least_light: (tolerance.absolute / relative) as f32,
        }
    };
    let passes = (0..=last).map(&mut pass);
    passes
        .filter(|pass| part.passes.contains(&pass.level))
        .collect()
}

/// Returns the work-items of a group, which share the 16 nodes of a tile: 32, nodes and tests side by side, where the
/// device runs as many in step, for half of them would idle; no more than it lets a group have.
pub(crate) fn workers(device: &OpenClDevice, options: &RendererOptions) -> u32 {
    let most = match options.lanes.unwrap_or(device.lanes) {
        1 => 32,
        lanes => 16 / lanes,
    };
    let suitable = match device.form {
        DeviceForm::Gpu if device.in_step >= 32 => most,
        DeviceForm::Gpu => most.min(16),
        DeviceForm::Cpu => 1,
    };
    let wanted = options.tile_workers.unwrap_or(suitable).min(most);
    halved(wanted as usize, device.most_workers as usize) as u32
}

/// Returns the groups of work-items for a pass on a device with this many compute units.
pub(super) fn groups(pass: &TilePass, units: u32) -> usize {
    let most = u64::from(pass.tile_count) << (2 * pass.level);
    let share = most * u64::from(pass.to - pass.from);
    (share.div_ceil(TILE_SHARES.into()) as usize).min(GROUPS_A_UNIT * units as usize)
}

/// Returns the second node's pixel: the Chebyshev zeros stretched to the tile's first and last pixel lie 0.29 from
/// them.
fn inner(size: u32) -> u32 {
    9 * size / 32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: u32, height: u32) -> ImageSize {
        ImageSize { width, height }
    }

    #[test]
    fn the_first_tiles_grow_with_the_image() {
        let sizes = [1, 512, 1024, 1025, 1920, 3840, 16384].map(|side| first_size(image(side, 1)));
        assert_eq!(sizes, [64, 64, 64, 64, 128, 256, 256]);
        assert_eq!(first_size(image(1, 3840)), 256);
    }

    #[test]
    fn the_words_of_a_launch_hold_its_sources_however_they_fall_into_kinds() {
        // The worst: one source too many for a word in every kind but one.
        let mut counts = [33; KIND_COUNT];
        counts[0] = MOST_SOURCES - 33 * (KIND_COUNT as u64 - 1);
        let part = Part {
            pixels: 0..1,
            sources: 0..MOST_SOURCES,
            passes: 0..1,
            shares: 0..TILE_SHARES,
        };
        let words = word_count(&part, &counts);
        assert!(
            words <= MOST_WORDS && words + 1 >= MOST_WORDS,
            "{words} of {MOST_WORDS}"
        );
    }

    #[test]
    fn passes_halve_the_tiles_and_keep_lists_of_their_own() {
        let mut counts = [0; KIND_COUNT];
        (counts[0], counts[3]) = (33, 2);
        let part = Part {
            pixels: 0..1000 * 300,
            sources: 0..35,
            passes: 0..5,
            shares: 0..TILE_SHARES,
        };
        let tolerance = Tolerance {
            relative: 1e-3,
            absolute: 0.0,
        };
        let passes = passes(&part, &counts, (1000, 1.0), 128, tolerance);
        let sizes: Vec<u32> = passes.iter().map(|pass| pass.size).collect();
        assert_eq!(sizes, [128, 64, 32, 16, 8]);
        assert!(passes.len() <= MOST_PASSES);
        assert_eq!((passes[0].columns, passes[0].tile_count), (8, 24));
        for pair in passes.windows(2) {
            assert_eq!(pair[1].read_from, pair[0].write_to);
            let most_open = 24 << (2 * pair[0].level);
            assert_eq!(pair[1].write_to, pair[0].write_to + most_open);
            assert_eq!(pair[1].parent_inner, pair[0].inner);
        }
        assert_eq!(passes.last().map(|pass| pass.is_last), Some(1));
        // 33 sources of the first kind take two words, those of another one of their own.
        assert_eq!(passes[0].word_count, 3);
    }
}
