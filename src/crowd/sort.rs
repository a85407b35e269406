//! Sees the points of a crowd from the eye and sorts them by their cells of 8 pixels, anew for every frame, on all
//! cores of the host. Within a cell they stay in the order of the scene: sums have the same bits in every frame.

use std::ops::Range;

use glam::DVec3;

use super::pack::{CrowdSource, Sorted, column_and_row, morton};
use crate::scene::{CrowdSight, NEAREST, Points, Profile, Scene, Spreading};
use crate::threads;

/// Points that one thread sees at a time.
const PIECE: usize = 1 << 16;

/// Cells are first told apart by so many bits of their codes.
const BUCKET_BITS: u32 = 9;

/// A point in the grid: the Morton code of its cell, and what a source is told of it.
#[derive(Debug, Clone, Copy)]
struct Seen {
    cell: u32,
    x: f32,
    y: f32,
    z: f32,
    light: [f32; 3],
}

/// Where the sources of cells begin, and those beside the grid.
#[derive(Debug, Default)]
pub(super) struct Sorter {
    /// Where the sources of each cell begin; one more than there are cells.
    pub starts: Vec<u32>,
    /// Place and light of sources beside the grid: 6 numbers for each.
    pub rest: Vec<f32>,
    pieces: Vec<Piece>,
    /// How many bits of a cell's code tell the cells of a bucket apart.
    shift: u32,
}

/// What one thread saw.
#[derive(Debug, Default)]
struct Piece {
    list: usize,
    points: Range<usize>,
    buckets: Vec<Vec<Seen>>,
    rest: Vec<f32>,
    z: [f32; 2],
}

/// The sources of a bucket, and in which column and row of cells each is.
struct Bucket<'a> {
    sources: &'a mut [CrowdSource],
    cells: &'a mut [u32],
    /// Where those of each of its cells begin, the first of them at `first`.
    starts: &'a mut [u32],
    first: u32,
    occupied: u32,
}

impl Sorter {
    /// Sees the points of a profile that are no brighter than the crowd's limit; cells that have some are counted when
    /// they are sorted.
    pub(super) fn see(&mut self, scene: &Scene, sight: &CrowdSight, profile: Profile) -> Sorted {
        let lists: Vec<&Points> = scene
            .points
            .iter()
            .filter(|it| it.crowd_profile() == profile)
            .collect();
        let spreading = scene.spreading(profile);
        let bits = 2 * (sight.across.ilog2() + sight.top);
        let shift = bits.saturating_sub(BUCKET_BITS);
        self.shift = shift;
        self.starts.resize((1 << bits) + 1, 0);
        let mut count = 0;
        for (list, points) in lists.iter().enumerate() {
            for begin in (0..points.points.len()).step_by(PIECE) {
                if count == self.pieces.len() {
                    self.pieces.push(Piece::default());
                }
                let piece = &mut self.pieces[count];
                piece.list = list;
                piece.points = begin..points.points.len().min(begin + PIECE);
                piece.buckets.resize(1 << (bits - shift), Vec::new());
                count += 1;
            }
        }
        self.pieces.truncate(count);
        threads::for_each_chunk(&mut self.pieces, 1, |_, piece| {
            let piece = &mut piece[0];
            let points = lists[piece.list];
            piece.see(points, sight, spreading, shift);
        });
        self.rest.clear();
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        let mut sources = 0;
        for piece in &self.pieces {
            self.rest.extend_from_slice(&piece.rest);
            (low, high) = (low.min(piece.z[0]), high.max(piece.z[1]));
            sources += piece.buckets.iter().map(Vec::len).sum::<usize>();
        }
        let t = [low, high].map(|z| f64::from(z).ln());
        Sorted {
            sources: sources as u32,
            rest: (self.rest.len() / 6) as u32,
            occupied: 0,
            t: if low <= high { t } else { [0.0; 2] },
        }
    }

    /// Returns how many bytes it takes.
    pub(super) fn bytes(&self) -> usize {
        let of_piece = |piece: &Piece| {
            let seen: usize = piece.buckets.iter().map(Vec::capacity).sum();
            size_of_val(piece.buckets.as_slice())
                + seen * size_of::<Seen>()
                + piece.rest.capacity() * size_of::<f32>()
        };
        let numbers = self.starts.capacity() + self.rest.capacity();
        numbers * size_of::<u32>() + self.pieces.iter().map(of_piece).sum::<usize>()
    }

    /// Writes what was seen in the order of its cells, and column and row of each; returns how many cells have some.
    pub(super) fn sort(&mut self, mut sources: &mut [CrowdSource], mut cells: &mut [u32]) -> u32 {
        let Self { starts, pieces, .. } = self;
        let (shift, mut first) = (self.shift, 0);
        let all = starts.len() - 1;
        let mut buckets = Vec::with_capacity(all >> shift);
        for (number, starts) in starts[..all].chunks_mut(1 << shift).enumerate() {
            let len = pieces.iter().map(|it| it.buckets[number].len()).sum();
            let (own, others) = sources.split_at_mut(len);
            let (own_cells, other_cells) = cells.split_at_mut(len);
            (sources, cells) = (others, other_cells);
            buckets.push(Bucket {
                sources: own,
                cells: own_cells,
                starts,
                first,
                occupied: 0,
            });
            first += len as u32;
        }
        threads::for_each_chunk(&mut buckets, 1, |number, bucket| {
            let bucket = &mut bucket[0];
            bucket.starts.fill(0);
            pieces
                .iter()
                .for_each(|it| bucket.count(&it.buckets[number], shift));
            bucket.begin();
            let mut next = bucket.starts.to_vec();
            for piece in pieces.iter() {
                bucket.fill(&piece.buckets[number], &mut next, shift);
            }
        });
        let occupied = buckets.iter().map(|it| it.occupied).sum();
        starts[all] = first;
        occupied
    }
}

impl Seen {
    /// Returns which cell of its bucket it is in.
    fn place(&self, shift: u32) -> usize {
        (self.cell & ((1 << shift) - 1)) as usize
    }
}

impl Piece {
    /// Sees its points but for those brighter than a limit, and those where rays begin.
    fn see(&mut self, points: &Points, sight: &CrowdSight, spreading: Spreading, shift: u32) {
        self.buckets.iter_mut().for_each(Vec::clear);
        self.rest.clear();
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        let side = f64::from((8 * sight.across) << sight.top);
        let per_step = sight.step.map(|step| 1.0 / step);
        let nearest = NEAREST * sight.near;
        let range = self.points.clone();
        let Self { buckets, rest, .. } = self;
        let mut add = |[x, y, z]: [f64; 3], light: DVec3| {
            let [red, green, blue] = light.as_vec3().to_array();
            let per_z = 1.0 / z;
            let column = (x * per_z - sight.first[0]) * per_step[0];
            let row = (y * per_z - sight.first[1]) * per_step[1];
            let is_in_grid = (0.0..side).contains(&column) && (0.0..side).contains(&row);
            if z < nearest || !is_in_grid {
                rest.extend([x as f32, y as f32, z as f32, red, green, blue]);
                return;
            }
            let (across, down) = ((column / 8.0) as u32, (row / 8.0) as u32);
            (low, high) = (low.min(z as f32), high.max(z as f32));
            let seen = Seen {
                cell: morton(across, down),
                x: (column - f64::from(8 * across + 4)) as f32,
                y: (row - f64::from(8 * down + 4)) as f32,
                z: z as f32,
                light: [red, green, blue],
            };
            let bucket = &mut buckets[(seen.cell >> shift) as usize];
            if bucket.len() == bucket.capacity() {
                bucket.reserve_exact(bucket.len() / 8 + 16); // twice as much would be half empty
            }
            bucket.push(seen);
        };
        if points.is_spread() {
            let part = |place, light| add(sight.seen(place), light);
            points.for_each_part(range, (sight, spreading), part);
        } else {
            points.for_each(range, |place, light| {
                let seen = sight.seen(place);
                let is_at_plane = seen[2] < 1.001 * nearest && sight.is_at_plane(seen);
                let is_part = light.max_element() <= spreading.limit && light != DVec3::ZERO;
                if is_part && !is_at_plane {
                    add(seen, light);
                }
            });
        }
        self.z = [low, high];
    }
}

impl Bucket<'_> {
    fn count(&mut self, seen: &[Seen], shift: u32) {
        for seen in seen {
            self.starts[seen.place(shift)] += 1;
        }
    }

    /// Finds where those of each cell begin, once they are counted.
    fn begin(&mut self) {
        let mut sum = self.first;
        for start in self.starts.iter_mut() {
            self.occupied += u32::from(*start > 0);
            sum += std::mem::replace(start, sum);
        }
    }

    /// Writes those of a piece, each at the next place of its cell.
    fn fill(&mut self, seen: &[Seen], next: &mut [u32], shift: u32) {
        for seen in seen {
            let next = &mut next[seen.place(shift)];
            let place = (*next - self.first) as usize;
            *next += 1;
            let [red, green, blue] = seen.light;
            self.sources[place] = CrowdSource {
                x: seen.x,
                y: seen.y,
                z: seen.z,
                red,
                green,
                blue,
                peak: 0.0,
                level: 0.0,
            };
            self.cells[place] = column_and_row(seen.cell);
        }
    }
}
