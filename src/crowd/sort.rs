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

/// A point in the grid: the Morton code of its cell, and what a source is told of it.
#[derive(Debug, Clone, Copy)]
struct Seen {
    cell: u32,
    x: f32,
    y: f32,
    t: f32,
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
    t: [f32; 2],
}

/// The sources and cells of a bucket.
struct Bucket<'a> {
    sources: &'a mut [CrowdSource],
    cells: &'a mut [u32],
    /// Where those of each of its cells begin.
    starts: &'a [u32],
}

impl Sorter {
    /// Sees the points of a profile that are no brighter than the crowd's limit, and counts those of each cell.
    pub(super) fn see(&mut self, scene: &Scene, sight: &CrowdSight, profile: Profile) -> Sorted {
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
        self.count(bits, shift)
    }

    /// Counts what all threads saw.
    fn count(&mut self, bits: u32, shift: u32) -> Sorted {
        let Self {
            starts,
            rest,
            pieces,
            ..
        } = self;
        rest.clear();
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for piece in pieces.iter() {
            rest.extend_from_slice(&piece.rest);
            (low, high) = (low.min(piece.t[0]), high.max(piece.t[1]));
        }
        starts.clear();
        starts.resize((1 << bits) + 1, 0);
        threads::for_each_chunk(&mut starts[..1 << bits], 1 << shift, |bucket, counts| {
            for seen in pieces.iter().flat_map(|it| &it.buckets[bucket]) {
                counts[seen.place(shift)] += 1;
            }
        });
        let occupied = starts.iter().filter(|count| **count > 0).count();
        let mut sum = 0;
        for start in starts.iter_mut() {
            sum += std::mem::replace(start, sum);
        }
        let t = [low, high].map(f64::from);
        let t = if low <= high { t } else { [0.0; 2] };
        self.shift = shift;
        Sorted {
            sources: sum,
            rest: (rest.len() / 6) as u32,
            occupied: occupied as u32,
            t,
        }
    }

    /// Writes what was seen in the order of its cells, and the cell of each.
    pub(super) fn sort(&self, mut sources: &mut [CrowdSource], mut cells: &mut [u32]) {
        let in_bucket = 1 << self.shift;
        let mut buckets = Vec::with_capacity(self.starts.len() / in_bucket);
        for starts in self.starts[..self.starts.len() - 1].chunks(in_bucket) {
            let end = self.starts[(buckets.len() + 1) * in_bucket];
            let len = (end - starts[0]) as usize;
            let (own, others) = sources.split_at_mut(len);
            let (own_cells, other_cells) = cells.split_at_mut(len);
            (sources, cells) = (others, other_cells);
            buckets.push(Bucket {
                sources: own,
                cells: own_cells,
                starts,
            });
        }
        threads::for_each_chunk(&mut buckets, 1, |number, bucket| {
            let seen = self.pieces.iter().flat_map(|it| &it.buckets[number]);
            bucket[0].fill(seen, self.shift);
        });
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
    fn see(&mut self, points: &Points, sight: &CrowdSight, limit: f64, shift: u32) {
        self.buckets.iter_mut().for_each(Vec::clear);
        self.rest.clear();
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        let side = f64::from((8 * sight.across) << sight.top);
        let per_step = sight.step.map(|step| 1.0 / step);
        let farthest = 1.001 * NEAREST * sight.near;
        for index in self.points.clone() {
            let light = points.light(index);
            if light.max_element() > limit || light == DVec3::ZERO {
                continue;
            }
            let [x, y, z] = sight.seen(points.points.position(index));
            if z < farthest && sight.is_at_plane([x, y, z]) {
                continue;
            }
            let [red, green, blue] = light.as_vec3().to_array();
            let per_z = 1.0 / z;
            let column = (x * per_z - sight.first[0]) * per_step[0];
            let row = (y * per_z - sight.first[1]) * per_step[1];
            let is_in_grid = (0.0..side).contains(&column) && (0.0..side).contains(&row);
            if z < NEAREST * sight.near || !is_in_grid {
                self.rest
                    .extend([x as f32, y as f32, z as f32, red, green, blue]);
                continue;
            }
            let (across, down) = ((column / 8.0) as u32, (row / 8.0) as u32);
            let t = (z as f32).ln();
            (low, high) = (low.min(t), high.max(t));
            let seen = Seen {
                cell: morton(across, down),
                x: (column - f64::from(8 * across + 4)) as f32,
                y: (row - f64::from(8 * down + 4)) as f32,
                t,
                light: [red, green, blue],
            };
            self.buckets[(seen.cell >> shift) as usize].push(seen);
        }
        self.t = [low, high];
    }
}

impl Bucket<'_> {
    fn fill<'a>(&mut self, seen: impl Iterator<Item = &'a Seen>, shift: u32) {
        let first = self.starts[0];
        let mut next: Vec<u32> = self.starts.iter().map(|start| start - first).collect();
        for seen in seen {
            let place = &mut next[seen.place(shift)];
            let [red, green, blue] = seen.light;
            self.sources[*place as usize] = CrowdSource {
                x: seen.x,
                y: seen.y,
                t: seen.t,
                red,
                green,
                blue,
                peak: 0.0,
                level: 0.0,
            };
            self.cells[*place as usize] = seen.cell;
            *place += 1;
        }
    }
}
