//! Tiles of pixels, and which particles each of them sees: counted, added up, listed. All are listed by their numbers,
//! so that sums over a list have one order; a streak is in the list of every tile that it crosses.

use std::ops::Range;

use crate::threads;

/// Pixels across and down in the smallest tile, and in the largest: powers of two.
const LEAST: u32 = 8;
const MOST: u32 = 256;

/// Entries of all lists, for each particle, that tiles are made so large for.
const ENTRIES: f64 = 24.0;

/// So few particles are listed by one thread.
const FEW: usize = 4096;

/// Pixels by which a particle's are wider than they need to be, so that rounding loses none.
const ROUNDING: f64 = 0.05;

/// The pixels that a particle is seen in, all included; of a streak also the line along which they lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PixelBox {
    columns: [u32; 2],
    rows: [u32; 2],
    /// From one end to the other, pixels, and how far from that line the pixels are at most; of a ball that is
    /// infinite.
    line: [[f32; 2]; 2],
    width: f32,
}

impl PixelBox {
    /// Makes that of ranges of columns and of rows; `None`: it is beside the image.
    pub(super) fn new(cover: [[f64; 2]; 2], size: [u32; 2]) -> Option<Self> {
        Some(Self {
            columns: pixels_in(cover[0], size[0])?,
            rows: pixels_in(cover[1], size[1])?,
            line: [[0.0; 2]; 2],
            width: f32::INFINITY,
        })
    }

    /// Makes that of what lies between two balls.
    pub(super) fn around(one: [[f64; 2]; 2], other: [[f64; 2]; 2], size: [u32; 2]) -> Option<Self> {
        let both = [0, 1].map(|axis| {
            let (one, other) = (one[axis], other[axis]);
            [one[0].min(other[0]), one[1].max(other[1])]
        });
        let middle = |cover: [[f64; 2]; 2]| cover.map(|[low, high]| (0.5 * (low + high)) as f32);
        let half = |cover: [[f64; 2]; 2]| {
            let [across, down] = cover.map(|[low, high]| 0.5 * (high - low));
            across.hypot(down) as f32
        };
        let mut pixels = Self::new(both, size)?;
        let line = [middle(one), middle(other)];
        if line.as_flattened().iter().all(|at| at.is_finite()) {
            pixels.line = line;
            pixels.width = half(one).max(half(other));
        }
        Some(pixels)
    }

    /// Returns the numbers of tiles across and down of this size, both ends included.
    fn tiles(&self, tile: u32) -> [[u32; 2]; 2] {
        let shift = tile.trailing_zeros();
        let ([left, right], [top, bottom]) = (self.columns, self.rows);
        [
            [left >> shift, right >> shift],
            [top >> shift, bottom >> shift],
        ]
    }

    /// Calls `visit` with every tile of some rows, counted from the first of these.
    fn for_each_tile(
        &self,
        tile: u32,
        tile_columns: u32,
        rows: Range<u32>,
        mut visit: impl FnMut(usize),
    ) {
        let [[left, right], [top, bottom]] = self.tiles(tile);
        let is_line = self.width.is_finite() && (right > left && bottom > top);
        for row in top.max(rows.start)..(bottom + 1).min(rows.end) {
            for column in left..=right {
                if !is_line || self.crosses(tile as f32, column as f32, row as f32) {
                    visit(((row - rows.start) * tile_columns + column) as usize);
                }
            }
        }
    }

    /// Returns whether what is along the line comes into a tile's circle.
    fn crosses(&self, tile: f32, column: f32, row: f32) -> bool {
        let [[x0, y0], [x1, y1]] = self.line;
        let middle = |at: f32| (at + 0.5) * tile - 0.5;
        let (x, y) = (middle(column) - x0, middle(row) - y0);
        let (along_x, along_y) = (x1 - x0, y1 - y0);
        let length2 = (along_x * along_x + along_y * along_y).max(f32::MIN_POSITIVE);
        let share = ((x * along_x + y * along_y) / length2).clamp(0.0, 1.0);
        let distance = (x - share * along_x).hypot(y - share * along_y);
        distance <= 1.001 * self.width + 0.72 * tile + 1.0
    }
}

/// Returns the pixels in a range, both included, of so many; `None`: none is.
fn pixels_in([low, high]: [f64; 2], count: u32) -> Option<[u32; 2]> {
    let last = f64::from(count) - 1.0;
    let (low, high) = (low - ROUNDING, high + ROUNDING);
    if !(low <= last && high >= 0.0) {
        return None;
    }
    // Rounded down by the conversion: `ceil` and `floor` are calls on processors of long ago.
    let low = low.max(0.0);
    let first = low as u32 + u32::from(low > f64::from(low as u32));
    let end = high.min(last) as u32;
    (first <= end).then_some([first, end])
}

/// The lists of tiles.
#[derive(Debug, Default)]
pub(super) struct Tiles {
    /// Pixels across and down in a tile.
    pub size: u32,
    pub columns: u32,
    /// Where the list of each tile ends.
    pub ends: Vec<u32>,
    /// All lists, one after the other: numbers of particles.
    pub numbers: Vec<u32>,
}

impl Tiles {
    /// Lists the particles of every tile of an image; tiles are no smaller than a unit of rays is wide.
    pub(super) fn list(&mut self, boxes: &[PixelBox], [width, height]: [u32; 2], unit: u32) {
        self.size = size_for(boxes, unit.max(LEAST));
        self.columns = width.div_ceil(self.size);
        let (tile, columns) = (self.size, self.columns);
        let rows = height.div_ceil(tile);
        self.ends.clear();
        self.ends.resize((columns * rows) as usize, 0);
        let bands = match boxes.len() {
            ..FEW => 1,
            _ => threads::count().min(rows as usize).max(1),
        };
        let band = rows.div_ceil(bands as u32) * columns; // tiles of a band of whole rows
        threads::for_each_part(&mut self.ends, band as usize, |first, counts| {
            for pixels in boxes {
                let row = first as u32 / columns;
                let rows = row..row + counts.len() as u32 / columns;
                pixels.for_each_tile(tile, columns, rows, |at| counts[at] += 1);
            }
        });
        let mut begin = 0;
        for end in &mut self.ends {
            (begin, *end) = (begin + *end, begin);
        }
        self.numbers.clear();
        self.numbers.resize(begin as usize, 0);
        let mut parts = Vec::new();
        let (mut rest, mut at) = (self.numbers.as_mut_slice(), 0);
        let mut ends = self.ends.as_mut_slice();
        while !ends.is_empty() {
            let (these, others) = ends.split_at_mut(ends.len().min(band as usize));
            let next = others.first().copied().unwrap_or(begin);
            let (numbers, others_numbers) = rest.split_at_mut((next - at) as usize);
            parts.push((at, these, numbers));
            (ends, rest, at) = (others, others_numbers, next);
        }
        threads::for_each_chunk(&mut parts, 1, |number, part| {
            let (begin, ends, numbers) = &mut part[0];
            let row = number as u32 * band / columns;
            let rows = row..row + ends.len() as u32 / columns;
            for (number, pixels) in (0_u32..).zip(boxes) {
                pixels.for_each_tile(tile, columns, rows.clone(), |at| {
                    numbers[(ends[at] - *begin) as usize] = number;
                    ends[at] += 1;
                });
            }
        });
    }
}

/// Returns the smallest tile for which the lists are not too long.
fn size_for(boxes: &[PixelBox], least: u32) -> u32 {
    let most = ENTRIES * boxes.len() as f64 + 4096.0;
    let entries = |tile: u32| {
        threads::sum(boxes, |pixels| {
            let count = |[first, last]: [u32; 2]| u64::from(last - first) + 1;
            let [columns, rows] = pixels.tiles(tile);
            (count(columns) * count(rows)) as f64
        })
    };
    let mut tile = least;
    while tile < MOST && entries(tile) > most {
        tile *= 2;
    }
    tile
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_the_pixels_between_its_ends() {
        let of = |low: f64, high: f64| pixels_in([low + ROUNDING, high - ROUNDING], 10);
        for low in -30..130 {
            for high in -30..130 {
                let [low, high] = [low, high].map(|it| (f64::from(it) + 0.5) / 8.0);
                let inside = |pixel: &u32| (low..=high).contains(&f64::from(*pixel));
                let mut all = (0..10).filter(inside);
                let expected = all
                    .next()
                    .map(|first| [first, all.next_back().unwrap_or(first)]);
                assert_eq!(of(low, high), expected, "{low} to {high}");
            }
        }
        assert_eq!(of(f64::NEG_INFINITY, f64::INFINITY), Some([0, 9]));
        assert_eq!(of(f64::NAN, 3.0), None);
    }

    #[test]
    fn every_tile_lists_in_order_all_that_it_sees() {
        let size = [100, 60];
        let ball = |x: f64, y: f64, r: f64| PixelBox::new([[x - r, x + r], [y - r, y + r]], size);
        let places =
            (0..500).map(|k| ball(f64::from(k * 37 % 120) - 10.0, f64::from(k * 17 % 70), 3.5));
        let mut boxes: Vec<PixelBox> = places.flatten().collect();
        let cover = |x: f64, y: f64| [[x - 2.0, x + 2.0], [y - 2.0, y + 2.0]];
        boxes.extend(PixelBox::around(cover(3.0, 4.0), cover(90.0, 50.0), size));
        let mut tiles = Tiles::default();
        tiles.list(&boxes, size, 1);
        assert_eq!(*tiles.ends.last().unwrap() as usize, tiles.numbers.len());
        let mut begin = 0;
        for (tile, &end) in tiles.ends.iter().enumerate() {
            let list = &tiles.numbers[begin..end as usize];
            assert!(list.windows(2).all(|pair| pair[0] < pair[1]));
            let place = [tile as u32 % tiles.columns, tile as u32 / tiles.columns];
            for (number, pixels) in (0_u32..).zip(&boxes).take(boxes.len() - 1) {
                let [[left, right], [top, bottom]] = pixels.tiles(tiles.size);
                let sees = (left..=right).contains(&place[0]) && (top..=bottom).contains(&place[1]);
                assert_eq!(
                    list.contains(&number),
                    sees,
                    "tile {tile}, particle {number}"
                );
            }
            begin = end as usize;
        }
        // The streak is in the tiles of its points, and not in those of the corners beside it.
        let streak = boxes.len() as u32 - 1;
        let has = |x: u32, y: u32| {
            let tile = (y / tiles.size * tiles.columns + x / tiles.size) as usize;
            let begin = tile.checked_sub(1).map_or(0, |it| tiles.ends[it] as usize);
            tiles.numbers[begin..tiles.ends[tile] as usize].contains(&streak)
        };
        for share in 0..=20 {
            assert!(has(3 + 87 * share / 20, 4 + 46 * share / 20));
        }
        assert!(!has(90, 4) && !has(3, 50));
    }
}
