//! Sees the points of a crowd from the eye and sorts them by their cells of 8 pixels, anew for every frame, on all
//! cores of the host. Within a cell they stay in the order of the scene: sums have the same bits in every frame.

use std::ops::Range;

use glam::DVec3;

use super::pack::{CrowdSource, Sorted, morton};
use crate::scene::{CrowdSight, NEAREST, Points, Profile, Scene};
use crate::threads;

/// Points that one thread sees at a time.
const PIECE: usize = 1 << 16;

/// Cells are first told apart by so many bits of their codes.
const BUCKET_BITS: u32 = 9;

/// Sources in the order of their cells, and those beside the grid.
#[derive(Debug, Default)]
pub(super) struct Sorter {
    pub sources: Vec<CrowdSource>,
    /// The Morton code of the cell of each.
    pub cells: Vec<u32>,
    /// Where the sources of each cell begin; one more than there are cells.
    pub starts: Vec<u32>,
    /// Place and light of sources beside the grid: 6 numbers for each.
    pub rest: Vec<f32>,
    pieces: Vec<Piece>,
}

/// What one thread saw.
#[derive(Debug, Default)]
struct Piece {
    list: usize,
    points: Range<usize>,
    buckets: Vec<Vec<(u32, CrowdSource)>>,
    rest: Vec<f32>,
    t: [f64; 2],
}

/// The sources and cells of a bucket.
struct Bucket<'a> {
    sources: &'a mut [CrowdSource],
    cells: &'a mut [u32],
    /// How many sources each of its cells has.
    counts: &'a mut [u32],
}

impl Sorter {
    /// Sees and sorts the points of a profile that are no brighter than the crowd's limit.
    pub(super) fn sort(&mut self, scene: &Scene, sight: &CrowdSight, profile: Profile) -> Sorted {
        let lists: Vec<&Points> = scene
            .points
            .iter()
            .filter(|it| it.profile == profile)
            .collect();
        let limit = scene.crowd_limit(profile);
        let bits = 2 * (sight.across.ilog2() + sight.top);
        let shift = bits.saturating_sub(BUCKET_BITS);
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
            piece.see(points, sight, limit, shift);
        });
        self.join(bits, shift)
    }

    /// Puts what all threads saw into one order.
    fn join(&mut self, bits: u32, shift: u32) -> Sorted {
        let Self {
            sources,
            cells,
            starts,
            rest,
            pieces,
        } = self;
        rest.clear();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for piece in pieces.iter() {
            rest.extend_from_slice(&piece.rest);
            (low, high) = (low.min(piece.t[0]), high.max(piece.t[1]));
        }
        let len_of = |bucket: usize| {
            pieces
                .iter()
                .map(|it| it.buckets[bucket].len())
                .sum::<usize>()
        };
        let lens: Vec<usize> = (0..1_usize << (bits - shift)).map(len_of).collect();
        let all: usize = lens.iter().sum();
        sources.resize(all, bytemuck::Zeroable::zeroed());
        cells.resize(all, 0);
        starts.clear();
        starts.resize((1 << bits) + 1, 0);
        let mut buckets = Vec::with_capacity(lens.len());
        let (mut left, mut cells_left) = (&mut sources[..], &mut cells[..]);
        let mut counts_left = &mut starts[1..];
        for len in &lens {
            let (sources, others) = left.split_at_mut(*len);
            let (cells, other_cells) = cells_left.split_at_mut(*len);
            let (counts, other_counts) = counts_left.split_at_mut(1 << shift);
            (left, cells_left, counts_left) = (others, other_cells, other_counts);
            buckets.push(Bucket {
                sources,
                cells,
                counts,
            });
        }
        threads::for_each_chunk(&mut buckets, 1, |number, bucket| {
            let seen = pieces.iter().map(|it| it.buckets[number].as_slice());
            bucket[0].fill(seen, shift);
        });
        let occupied = starts.iter().filter(|count| **count > 0).count();
        let mut sum = 0;
        for start in starts.iter_mut() {
            sum += *start;
            *start = sum;
        }
        let t = if low <= high { [low, high] } else { [0.0; 2] };
        Sorted {
            sources: all as u32,
            rest: (rest.len() / 6) as u32,
            occupied: occupied as u32,
            t,
        }
    }
}

impl Piece {
    /// Sees its points but for those brighter than a limit, and those where rays begin.
    fn see(&mut self, points: &Points, sight: &CrowdSight, limit: f64, shift: u32) {
        self.buckets.iter_mut().for_each(Vec::clear);
        self.rest.clear();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let side = f64::from((8 * sight.across) << sight.top);
        let per_step = sight.step.map(|step| 1.0 / step);
        let positions = points.points.positions();
        for index in self.points.clone() {
            let light = points.light(index);
            if light.max_element() > limit || light == DVec3::ZERO {
                continue;
            }
            let [x, y, z] = sight.seen(positions[index]);
            if sight.is_at_plane([x, y, z]) {
                continue;
            }
            let [red, green, blue] = light.as_vec3().to_array();
            let column = (x / z - sight.first[0]) * per_step[0];
            let row = (y / z - sight.first[1]) * per_step[1];
            let is_in_grid = (0.0..side).contains(&column) && (0.0..side).contains(&row);
            if z < NEAREST * sight.near || !is_in_grid {
                self.rest
                    .extend([x as f32, y as f32, z as f32, red, green, blue]);
                continue;
            }
            let (across, down) = ((column / 8.0) as u32, (row / 8.0) as u32);
            let t = z.ln();
            (low, high) = (low.min(t), high.max(t));
            let cell = morton(across, down);
            let source = CrowdSource {
                x: (column - f64::from(8 * across + 4)) as f32,
                y: (row - f64::from(8 * down + 4)) as f32,
                t: t as f32,
                red,
                green,
                blue,
                peak: 0.0,
                level: 0.0,
            };
            self.buckets[(cell >> shift) as usize].push((cell, source));
        }
        self.t = [low, high];
    }
}

impl Bucket<'_> {
    fn fill<'a>(
        &mut self,
        seen: impl Iterator<Item = &'a [(u32, CrowdSource)]> + Clone,
        shift: u32,
    ) {
        let place = |cell: u32| (cell & ((1 << shift) - 1)) as usize;
        for (cell, _) in seen.clone().flatten() {
            self.counts[place(*cell)] += 1;
        }
        let mut next = vec![0_u32; self.counts.len()];
        let mut sum = 0;
        for (next, count) in next.iter_mut().zip(self.counts.iter()) {
            *next = sum;
            sum += count;
        }
        for (cell, source) in seen.flatten() {
            let next = &mut next[place(*cell)];
            self.sources[*next as usize] = *source;
            self.cells[*next as usize] = *cell;
            *next += 1;
        }
    }
}
