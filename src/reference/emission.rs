//! The light that points of space give off, in float64.

use glam::DVec3;

use super::field::{self, Source};
use crate::scene::Scene;
use crate::volume::{CellValue, Grid};

/// The emission of a scene: the sum of colour, coefficient and field over its sources.
#[derive(Debug)]
pub(crate) struct Emitter {
    /// The parts of each.
    lights: Vec<Vec<Source>>,
    softening2: f64,
}

impl Emitter {
    pub(crate) fn new(scene: &Scene) -> Self {
        Self {
            lights: field::lights(scene),
            softening2: scene.integration.softening.powi(2),
        }
    }

    /// Returns what each light gives off at a point, linear RGB for each world unit of length; no squared distance to a
    /// core is taken below `floor2`.
    fn lights(&self, point: DVec3, floor2: f64) -> impl Iterator<Item = DVec3> {
        let light = move |source: &Source| {
            let softening2 = self.softening2 + source.falloff.radius.powi(2);
            let field = source
                .field
                .light(point, &source.falloff, softening2, floor2);
            source.emission * field
        };
        let of_parts = move |parts: &Vec<Source>| parts.iter().map(&light).sum();
        self.lights.iter().map(of_parts)
    }

    /// Returns what all sources but the strongest give off in the middle of a cell: of each to the power of 4, summed,
    /// over those to the power of 3, what a source after the other adds.
    pub(crate) fn rest_in_cell(&self, grid: &Grid, cell: [u32; 3]) -> DVec3 {
        let floor2 = CellValue::Apart.floor2(grid.cell());
        let (mut all, mut strongest) = (DVec3::ZERO, DVec3::ZERO);
        for light in self.lights(grid.middle(cell), floor2) {
            all += light;
            let (more, less) = (strongest.max(light), strongest.min(light).max(DVec3::ZERO));
            let powers = |power| more.powf(power) + less.powf(power);
            let of_two = powers(4.0) / powers(3.0);
            let is_alone = less.cmple(DVec3::ZERO);
            strongest = DVec3::select(is_alone, strongest + light, of_two);
        }
        all - strongest
    }

    /// Returns what a cell of a grid is given.
    pub(crate) fn in_cell(&self, grid: &Grid, value: CellValue, cell: [u32; 3]) -> DVec3 {
        let (parts, floor2) = (value.parts(), value.floor2(grid.cell()));
        let piece = |part: u32| (f64::from(part) + 0.5) / f64::from(parts) - 0.5;
        let middle = grid.middle(cell);
        let mut sum = DVec3::ZERO;
        for part in 0..parts.pow(3) {
            let place = [part % parts, part / parts % parts, part / parts / parts].map(piece);
            sum += self
                .lights(middle + grid.cell() * DVec3::from(place), floor2)
                .sum::<DVec3>();
        }
        sum / f64::from(parts.pow(3))
    }
}
