//! Particles near those that hit something: a grid whose cells are as large as their reach, filled by a stable counting
//! sort, so that sums over neighbours have one order.

use glam::DVec3;

/// A particle this near is at the same place: its direction is unknown.
const COINCIDENT: f64 = 1e-200;

/// Cells for each particle near, at most, and the least number that is allowed.
const CELLS: f64 = 8.0;
const LEAST_CELLS: f64 = 512.0;

/// Cells are so much larger than the reach, more than their places are rounded.
const WIDER: f64 = 1.0 + 1e-9;

/// Neighbours that are summed side by side, each with a sum of its own.
const LANES: usize = 4;

/// Particles by the cells of a grid.
#[derive(Debug, Default)]
pub(super) struct Neighbours {
    low: DVec3,
    /// 1 / the size of a cell.
    cells: f64,
    sizes: [usize; 3],
    /// Where the particles of each cell begin, and the end of the last.
    begins: Vec<u32>,
    /// Their coordinates.
    points: [Vec<f64>; 3],
    /// What is sorted: all that are near, with their cells.
    near: Vec<(DVec3, u32)>,
}

impl Neighbours {
    /// Takes all of some points that can be in reach of `asking` ones.
    pub(super) fn gather(
        &mut self,
        asking: impl Iterator<Item = DVec3>,
        all: impl Iterator<Item = DVec3>,
        reach: f64,
    ) {
        let bounds = asking.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), it| {
            (low.min(it), high.max(it))
        });
        let (low, high) = (bounds.0 - reach, bounds.1 + reach);
        self.near.clear();
        let is_near = |it: &DVec3| it.cmpge(low).all() && it.cmple(high).all();
        self.near
            .extend(all.filter(is_near).map(|point| (point, 0)));
        self.low = low;
        let most = (CELLS * self.near.len() as f64).max(LEAST_CELLS);
        let mut cell = WIDER * reach;
        let sizes = |cell: f64| ((high - low) / cell).floor() + 1.0;
        while sizes(cell).element_product() > most {
            cell *= 1.25; // larger cells hold all neighbours, too
        }
        self.cells = 1.0 / cell;
        self.sizes = sizes(cell).to_array().map(|size| size as usize);
        self.sort();
    }

    fn sort(&mut self) {
        let count: usize = self.sizes.iter().product();
        self.begins.clear();
        self.begins.resize(count + 1, 0);
        for index in 0..self.near.len() {
            let [x, y, z] = self.place(self.near[index].0);
            let cell = x + self.sizes[0] * (y + self.sizes[1] * z);
            self.near[index].1 = cell as u32;
            self.begins[cell + 1] += 1;
        }
        for cell in 0..count {
            self.begins[cell + 1] += self.begins[cell];
        }
        for numbers in &mut self.points {
            numbers.resize(self.near.len(), 0.0);
        }
        // Each begin moves to the end of its cell, which is the begin of the next one.
        for (point, cell) in &self.near {
            let at = &mut self.begins[*cell as usize];
            for (numbers, number) in self.points.iter_mut().zip(point.to_array()) {
                numbers[*at as usize] = number;
            }
            *at += 1;
        }
        self.begins.copy_within(0..count, 1);
        self.begins[0] = 0;
    }

    fn place(&self, point: DVec3) -> [usize; 3] {
        let place = ((point - self.low) * self.cells)
            .max(DVec3::ZERO)
            .to_array();
        [0, 1, 2].map(|k| (place[k] as usize).min(self.sizes[k] - 1))
    }

    /// Returns the sum of (Q - P) / |Q - P|^2 over the particles Q in reach of P, without those at P itself.
    pub(super) fn pull(&self, point: DVec3, reach: f64) -> DVec3 {
        let [x, y, z] = self.place(point);
        let around = |at: usize, size: usize| at.saturating_sub(1)..(at + 2).min(size);
        let columns = around(x, self.sizes[0]);
        let mut sum = DVec3::ZERO;
        for z in around(z, self.sizes[2]) {
            for y in around(y, self.sizes[1]) {
                let row = self.sizes[0] * (y + self.sizes[1] * z);
                let begin = self.begins[row + columns.start] as usize;
                let end = self.begins[row + columns.end] as usize;
                sum += self.pull_of(begin, end, point, reach * reach);
            }
        }
        sum
    }

    /// Returns what of it some neighbours give. Those out of reach count as nothing instead of being left out, so that
    /// several are summed side by side.
    fn pull_of(&self, begin: usize, end: usize, point: DVec3, most: f64) -> DVec3 {
        let [xs, ys, zs] = [0, 1, 2].map(|k| &self.points[k][begin..end]);
        let mut sums = [[0.0; LANES]; 3];
        let mut add = |lane: usize, x: f64, y: f64, z: f64| {
            let (x, y, z) = (x - point.x, y - point.y, z - point.z);
            let square = x * x + y * y + z * z;
            let is_near = square <= most && square > COINCIDENT;
            let weight = 1.0 / if is_near { square } else { f64::INFINITY };
            sums[0][lane] += weight * x;
            sums[1][lane] += weight * y;
            sums[2][lane] += weight * z;
        };
        let (xs, x_rest) = xs.as_chunks::<LANES>();
        let (ys, y_rest) = ys.as_chunks::<LANES>();
        let (zs, z_rest) = zs.as_chunks::<LANES>();
        for ((x, y), z) in xs.iter().zip(ys).zip(zs) {
            for lane in 0..LANES {
                add(lane, x[lane], y[lane], z[lane]);
            }
        }
        for ((x, y), z) in x_rest.iter().zip(y_rest).zip(z_rest) {
            add(0, *x, *y, *z);
        }
        sums.map(|lanes| lanes.iter().sum::<f64>()).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particle::random::{Purpose, units};

    #[test]
    fn the_grid_finds_whom_a_search_among_all_finds() {
        for spread in [1.0, 10.0, 1e7] {
            let place = |id: u32| {
                let [x, y, z, _] = units(3, id, 0, Purpose::Emission);
                // Two crowds, far apart, and some at one place.
                let crowd = f64::from(id % 2) * spread * DVec3::new(1.0, 2.0, 3.0);
                if id.is_multiple_of(17) {
                    crowd
                } else {
                    10.0 * DVec3::new(x, y, z) + crowd
                }
            };
            let points: Vec<DVec3> = (0..700).map(place).collect();
            let asking = &points[..60];
            let reach = 2.5;
            let mut grid = Neighbours::default();
            grid.gather(asking.iter().copied(), points.iter().copied(), reach);
            assert!(grid.begins.len() < 10_000);
            for point in asking {
                let all = points.iter().map(|it| *it - *point);
                let near = all.filter(|it| it.length() <= reach && *it != DVec3::ZERO);
                let expected: DVec3 = near.map(|it| it / it.length_squared()).sum();
                let found = grid.pull(*point, reach);
                let error = (found - expected).length();
                assert!(
                    error <= 1e-9 * (1.0 + expected.length()),
                    "{spread}: {found} {expected}"
                );
            }
        }
    }
}
