//! The light of a volume along rays, in float64 on the host: that of what interpolates its cells linearly.
//!
//! Between eight middles of cells that is a cubic along a ray, which two Gauss-Legendre points integrate exactly.

use glam::DVec3;

use super::Volume;

/// The points of Gauss and Legendre between 0 and 1, which weigh the same.
const POINTS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

impl Volume {
    /// Returns the emission at a point of the world, linear RGB: that of the eight cells around it, interpolated.
    /// Beyond the middles of the outermost cells it is theirs; outside the box there is none.
    #[must_use]
    pub fn emission(&self, point: DVec3) -> DVec3 {
        let grid = self.grid();
        let [low, high] = grid.bounds();
        match (point.cmpge(low) & point.cmple(high)).all() {
            true => self.interpolated((point - low) / grid.cell() - 0.5),
            false => DVec3::ZERO,
        }
    }

    /// Returns the integral of the emission along a ray over its length, linear RGB.
    #[must_use]
    pub fn integral(&self, origin: DVec3, span: DVec3) -> DVec3 {
        let grid = self.grid();
        let Some([begin, end]) = grid.crossed(origin, span) else {
            return DVec3::ZERO;
        };
        // Counted in cells, from the middle of the first.
        let from = (origin - grid.bounds()[0]) / grid.cell() - 0.5;
        let step = span / grid.cell();
        let at = |s: f64| self.interpolated(from + s * step);
        let (mut sum, mut s) = (DVec3::ZERO, begin);
        while s < end {
            let next = next_middle(from, step, s).min(end);
            let of_piece: DVec3 = POINTS.iter().map(|share| at(s + share * (next - s))).sum();
            sum += 0.5 * (next - s) * of_piece;
            s = next;
        }
        span.length() * sum
    }

    /// Returns what interpolates the cells around a place, which is counted in cells from the middle of the first.
    fn interpolated(&self, place: DVec3) -> DVec3 {
        let last = self.grid().cells().map(|count| count - 1);
        let place = place.clamp(DVec3::ZERO, DVec3::from(last.map(f64::from)));
        let first = place.floor();
        let share = [1.0 - (place - first), place - first];
        let mut sum = DVec3::ZERO;
        for corner in 0..8_usize {
            let side = [0, 1, 2].map(|axis| corner >> axis & 1);
            let weight: f64 = (0..3).map(|axis| share[side[axis]][axis]).product();
            let cell =
                [0, 1, 2].map(|axis| (first[axis] as u32 + side[axis] as u32).min(last[axis]));
            if weight > 0.0 {
                sum += weight * DVec3::from(self.at(cell).map(f64::from));
            }
        }
        sum
    }
}

/// Returns where a ray next crosses a plane of middles of cells, behind `s`.
fn next_middle(from: DVec3, step: DVec3, s: f64) -> f64 {
    let of_axis = |axis: usize| {
        let (from, step) = (from[axis], step[axis]);
        let place = from + s * step;
        // No rounding keeps it where it is.
        let plane = match step > 0.0 {
            true => (place + 1e-9).floor() + 1.0,
            false => (place - 1e-9).ceil() - 1.0,
        };
        match step == 0.0 {
            true => f64::INFINITY,
            false => (plane - from) / step,
        }
    };
    (0..3)
        .map(of_axis)
        .fold(f64::INFINITY, f64::min)
        .max(s + 1e-12)
}

#[cfg(test)]
mod tests {
    use super::super::{CellValue, Grid};
    use super::*;

    /// A volume of 4x3x9 cells, two bricks, whose emission is linear over the world.
    fn linear() -> (Volume, impl Fn(DVec3) -> DVec3) {
        let grid = Grid::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.8, 0.6, 1.8), 9).unwrap();
        let light = |point: DVec3| DVec3::new(point.x, 2.0 * point.y - point.z, 0.5);
        let mut volume = Volume::new(grid, CellValue::Center).unwrap();
        for (layer, height) in [(0, 8), (1, 1)] {
            let cells = (0..4 * 3 * height).map(|it| [it % 4, it / 4 % 3, 8 * layer + it / 12]);
            let cells: Vec<DVec3> = cells.map(|cell| light(grid.middle(cell))).collect();
            let channel = |axis: usize| cells.iter().map(move |cell| cell[axis] as f32);
            let values: Vec<f32> = (0..3).flat_map(channel).collect();
            volume.add_layer(layer, &values, 4).unwrap();
        }
        (volume, light)
    }

    #[test]
    fn what_is_linear_is_interpolated_and_integrated_exactly() {
        let (volume, light) = linear();
        let point = DVec3::new(1.1, 1.95, 3.4);
        assert!((volume.emission(point) - light(point)).length() < 1e-6);
        assert_eq!(volume.emission(DVec3::new(1.41, 2.0, 3.0)), DVec3::ZERO);
        // From middle to middle of the outermost cells.
        let from = volume.grid().middle([0, 0, 0]);
        let span = volume.grid().middle([3, 2, 8]) - from;
        let expected = span.length() * light(from + 0.5 * span);
        assert!((volume.integral(from, span) - expected).length() < 1e-6);
        // All of the box along an axis, from outside; the outer halves of cells are even.
        let middle = DVec3::new(1.0, 2.0, 3.0);
        let along = volume.integral(middle - 5.0 * DVec3::X, 10.0 * DVec3::X);
        assert!((along - 0.8 * light(middle)).length() < 1e-6, "{along}");
        assert_eq!(volume.integral(middle + DVec3::Y, DVec3::X), DVec3::ZERO);
        let wrong = 0.8 * light(middle + 0.1 * DVec3::Y);
        assert!((along - wrong).length() > 1e-2);
    }

    #[test]
    fn grids_cover_their_box_evenly_and_refuse_what_is_none() {
        let grid = Grid::new(DVec3::X, DVec3::new(2.0, 1.1, 0.01), 10).unwrap();
        assert_eq!(grid.cells(), [10, 6, 1]);
        let [low, high] = grid.bounds();
        assert!((0.5 * (low + high) - DVec3::X).length() < 1e-12);
        assert!((high - low - DVec3::new(2.0, 1.2, 0.2)).length() < 1e-12);
        let refused = |size: DVec3, cells: u32| Grid::new(DVec3::ZERO, size, cells).is_err();
        assert!(refused(DVec3::new(1.0, 0.0, 1.0), 8) && refused(DVec3::NAN, 8));
        assert!(refused(DVec3::ONE, 0) && refused(DVec3::ONE, 2049));
        assert!(!refused(DVec3::ONE, 2048));
    }
}
