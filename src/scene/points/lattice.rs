//! Particles on a lattice: layers of columns by rows, one on the other, as in the tests of Mishima, Tanaka, Sagawa 2008
//! (24 by 24 a layer). The paper gives no spacing; it decides whether a block, beads or single balls are seen.

use glam::DVec3;

use crate::scene::random;
use crate::scene::values::{Checked, Fault, positive};

/// A lattice about the origin, whose layers lie in the plane of x and y and are stacked along z.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice {
    /// Particles along x and along y, each at least 1.
    pub columns: [u32; 2],
    /// How many particles there are; the last layer may be begun only.
    pub count: u32,
    /// From one to the next, world units.
    pub spacing: f64,
    /// By which share of the spacing each may be moved along every axis, either way, 0 to 1.
    pub jitter: f64,
    /// Chooses the moves.
    pub seed: u32,
}

impl Lattice {
    /// Makes a lattice of 24 by 24 particles a layer, without jitter.
    #[must_use]
    pub fn new(count: u32, spacing: f64) -> Self {
        Self {
            columns: [24, 24],
            count,
            spacing,
            jitter: 0.0,
            seed: 0,
        }
    }

    pub(in crate::scene) fn check(&self) -> Checked {
        if self.columns.contains(&0) {
            return Err(Fault::new(
                "columns",
                "there is at least one along x and along y",
            ));
        }
        if self.count as usize > super::MOST_POINTS {
            let message = format!(
                "{} particles; there may be {}",
                self.count,
                super::MOST_POINTS
            );
            return Err(Fault::new("count", message));
        }
        positive("spacing", self.spacing)?;
        match (0.0..=1.0).contains(&self.jitter) {
            true => Ok(()),
            false => {
                let message = format!("{}; it is a share of the spacing, 0 to 1", self.jitter);
                Err(Fault::new("jitter", message))
            }
        }
    }

    /// Returns the places of its particles, those of the lowest layer first.
    pub(super) fn positions(&self) -> Vec<DVec3> {
        let [across, along] = self.columns.map(u64::from);
        let layers = u64::from(self.count).div_ceil(across * along).max(1);
        let middle = 0.5 * DVec3::new((across - 1) as f64, (along - 1) as f64, (layers - 1) as f64);
        let place = |number: u64| {
            let (column, rest) = (number % across, number / across);
            let cell = DVec3::new(column as f64, (rest % along) as f64, (rest / along) as f64);
            let moved = match self.jitter > 0.0 {
                true => self.jitter * self.shift(number),
                false => DVec3::ZERO,
            };
            self.spacing * (cell - middle + moved)
        };
        (0..u64::from(self.count)).map(place).collect()
    }

    /// Returns a place in a cube from -1 to 1.
    fn shift(&self, number: u64) -> DVec3 {
        let along = |axis| 2.0 * random::unit([u64::from(self.seed), number, axis]) - 1.0;
        DVec3::new(along(0), along(1), along(2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_lie_about_the_origin_and_jitter_stays_within_its_share() {
        let still = Lattice {
            columns: [3, 2],
            ..Lattice::new(15, 0.5)
        };
        let places = still.positions();
        assert_eq!(places.len(), 15);
        assert_eq!(places[0], DVec3::new(-0.5, -0.25, -0.5));
        assert_eq!(places[4], DVec3::new(0.0, 0.25, -0.5));
        assert_eq!(places[14], DVec3::new(0.5, -0.25, 0.5));
        let moved = Lattice {
            jitter: 0.2,
            seed: 7,
            ..still.clone()
        };
        let shifts: Vec<DVec3> = moved
            .positions()
            .iter()
            .zip(&places)
            .map(|(a, b)| (a - b).abs())
            .collect();
        assert!(
            shifts
                .iter()
                .all(|shift| shift.max_element() <= 0.1 + 1e-12)
        );
        assert!(shifts.iter().any(|shift| shift.max_element() > 0.08));
        assert_eq!(moved.positions(), moved.positions());
    }
}
