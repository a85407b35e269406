//! Particles near those that hit something: a grid whose cells are as large as their reach, filled by a stable counting
//! sort, so that sums over neighbours have one order.

use glam::DVec3;

/// A particle this near is at the same place: its direction is unknown.
const COINCIDENT: f64 = 1e-200;

/// Cells for each particle near, at most, and the least number that is allowed.
const CELLS: f64 = 8.0;
const LEAST_CELLS: f64 = 512.0;

/// Particles by the cells of a grid.
#[derive(Debug, Default)]
pub(super) struct Neighbours {
    low: DVec3,
    cell: f64,
    sizes: [usize; 3],
    /// Where the particles of each cell begin, and the end of the last.
    begins: Vec<u32>,
    points: Vec<DVec3>,
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
        self.cell = reach;
        let most = (CELLS * self.near.len() as f64).max(LEAST_CELLS);
        let sizes = |cell: f64| ((high - low) / cell).floor() + 1.0;
        while sizes(self.cell).element_product() > most {
            self.cell *= 1.25; // larger cells hold all neighbours, too
        }
        self.sizes = sizes(self.cell).to_array().map(|size| size as usize);
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
        self.points.clear();
        self.points.resize(self.near.len(), DVec3::ZERO);
        // Each begin moves to the end of its cell, which is the begin of the next one.
        for (point, cell) in &self.near {
            let at = &mut self.begins[*cell as usize];
            self.points[*at as usize] = *point;
            *at += 1;
        }
        self.begins.copy_within(0..count, 1);
        self.begins[0] = 0;
    }

    fn place(&self, point: DVec3) -> [usize; 3] {
        let place = ((point - self.low) / self.cell).max(DVec3::ZERO).to_array();
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
                for other in &self.points[begin..end] {
                    let away = *other - point;
                    let square = away.length_squared();
                    if square <= reach * reach && square > COINCIDENT {
                        sum += away / square;
                    }
                }
            }
        }
        sum
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
