//! The light that points of space give off, in float64.

use glam::DVec3;

use super::field::{self, Source};
use crate::scene::Scene;
use crate::volume::{CellValue, Grid};

/// The emission of a scene: the sum of colour, coefficient and field over its sources.
#[derive(Debug)]
pub(crate) struct Emitter {
    sources: Vec<Source>,
    softening2: f64,
}

impl Emitter {
    pub(crate) fn new(scene: &Scene) -> Self {
        Self {
            sources: field::sources(scene),
            softening2: scene.integration.softening.powi(2),
        }
    }

    /// Returns what a point gives off, linear RGB for each world unit of length; no squared distance to a core is taken
    /// below `floor2`.
    pub(crate) fn at(&self, point: DVec3, floor2: f64) -> DVec3 {
        let light = |source: &Source| {
            let softening2 = self.softening2 + source.falloff.radius.powi(2);
            let field = source
                .field
                .light(point, &source.falloff, softening2, floor2);
            source.emission * field
        };
        self.sources.iter().map(light).sum()
    }

    /// Returns what a cell of a grid is given.
    pub(crate) fn in_cell(&self, grid: &Grid, value: CellValue, cell: [u32; 3]) -> DVec3 {
        let (parts, floor2) = (value.parts(), value.floor2(grid.cell()));
        let piece = |part: u32| (f64::from(part) + 0.5) / f64::from(parts) - 0.5;
        let middle = grid.middle(cell);
        let mut sum = DVec3::ZERO;
        for part in 0..parts.pow(3) {
            let place = [part % parts, part / parts % parts, part / parts / parts].map(piece);
            sum += self.at(middle + grid.cell() * DVec3::from(place), floor2);
        }
        sum / f64::from(parts.pow(3))
    }
}
