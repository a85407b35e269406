//! Parts of a frame's work, one for each launch: some pixels, and some of their sources or of their tiles.

use std::ops::Range;

use super::pack::layout::Launch;
use super::tiles;
use crate::scene::kinds::KIND_COUNT;

/// How many sources there are of each kind, in the order of the table.
pub(super) type Counts = [u64; KIND_COUNT];

/// Shares that a pass over tiles is cut into: more than a launch has tiles that are worth a launch of their own.
pub const TILE_SHARES: u32 = 1 << 16;

impl Work {
    /// Pixels of a launch at most.
    pub(super) fn most_pixels(&self) -> u32 {
        (self.most_pixels / self.grain)
            .max(1)
            .saturating_mul(self.grain)
    }

    /// Passes over the tiles; 0: by pixels.
    pub(super) fn passes(&self) -> u32 {
        match self.first_tile_size {
            0 => 0,
            size => tiles::pass_count(size),
        }
    }

    /// What a pass takes at most, of what all pixels and sources would: 32 rays for each tile, the last pass also every
    /// pixel. Passes before the last are nothing beside it.
    pub(super) fn weight(&self, pass: u32) -> f64 {
        let size = f64::from(self.first_tile_size >> pass);
        let last = f64::from(u32::from(pass + 1 == self.passes()));
        32.0 / (size * size) + last
    }
}

/// Where some pixels' work goes on.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Place {
    pub source: u64,
    pub pass: u32,
    pub share: u32,
}

/// A part of the work: consecutive pixels, and a range of the sources, counted over all kinds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Part {
    pub pixels: Range<u32>,
    pub sources: Range<u64>,
    /// By tiles: which passes, and, of [`TILE_SHARES`], which of their tiles.
    pub passes: Range<u32>,
    pub shares: Range<u32>,
}

impl Part {
    /// Samples of fields that it takes.
    pub(super) fn samples(&self, work: &Work) -> f64 {
        let sources = (self.sources.end - self.sources.start) as f64;
        let all = self.pixels.len() as f64 * sources * f64::from(work.node_count);
        match self.passes.len() as u32 == work.passes() {
            true => all,
            false => {
                let share = f64::from(self.shares.len() as u32) / f64::from(TILE_SHARES);
                all * share * work.weight(self.passes.start)
            }
        }
    }

    /// Whether no launch has looked at these pixels and these sources before.
    pub(super) fn is_first(&self) -> bool {
        self.passes.start == 0 && self.shares.start == 0
    }

    /// Returns where these pixels' work goes on; `None`: it is done.
    pub(super) fn next(&self, work: &Work) -> Option<Place> {
        let here = Place {
            source: self.sources.start,
            pass: self.passes.start,
            share: self.shares.end,
        };
        if self.shares.end < TILE_SHARES {
            return Some(here);
        }
        if self.passes.end < work.passes() {
            let (pass, share) = (self.passes.end, 0);
            return Some(Place {
                pass,
                share,
                ..here
            });
        }
        (self.sources.end < work.source_count).then(|| Place {
            source: self.sources.end,
            ..Place::default()
        })
    }
}

/// What every pixel of a frame costs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Work {
    /// Nodes of the quadrature, or about as many Simpson samples as its cost is worth.
    pub node_count: u32,
    /// Sources of all kinds.
    pub source_count: u64,
    /// Below this many pixels a launch leaves the device idle.
    pub fewest_pixels: u32,
    /// Pixels of a launch are a multiple of this, but for the last one's.
    pub grain: u32,
    /// Above this many pixels, and this many sources, a launch takes too much memory.
    pub most_pixels: u32,
    pub most_sources: u64,
    /// Side of the largest tiles, pixels; 0: by pixels.
    pub first_tile_size: u32,
}

/// Sources of each kind in a part, as ranges of the lists.
fn ranges(part: &Part, counts: &Counts) -> [Range<u32>; KIND_COUNT] {
    let mut begin_of_kind = 0;
    counts.map(|count| {
        let clip =
            |at: u64| (at.clamp(begin_of_kind, begin_of_kind + count) - begin_of_kind) as u32;
        let range = clip(part.sources.start)..clip(part.sources.end);
        begin_of_kind += count;
        range
    })
}

/// Words of 32 sources that hold a bit for each source of a part; each kind begins with a new word.
pub(super) fn word_count(part: &Part, counts: &Counts) -> u32 {
    let words = |range: &Range<u32>| (range.len() as u32).div_ceil(32);
    ranges(part, counts).iter().map(words).sum()
}

/// Which sources of each kind a part takes; where their balls are, others know.
pub(super) fn launch(part: &Part, counts: &Counts) -> Launch {
    let ranges = ranges(part, counts);
    Launch {
        begin: ranges.each_ref().map(|range| range.start),
        end: ranges.each_ref().map(|range| range.end),
        first_ball: [0; KIND_COUNT],
        first_count: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_of_sources_falls_into_its_kinds() {
        let mut counts = [0; KIND_COUNT];
        (counts[0], counts[3], counts[4]) = (3, 2, 4);
        let part = Part {
            pixels: 7..9,
            sources: 2..6,
            passes: 0..0,
            shares: 0..TILE_SHARES,
        };
        let Launch { begin, end, .. } = launch(&part, &counts);
        let range = |kind: usize| (begin[kind], end[kind]);
        assert_eq!((range(0), range(1), range(2)), ((2, 3), (0, 0), (0, 0)));
        assert_eq!((range(3), range(4)), ((0, 2), (0, 1)));
    }
}
