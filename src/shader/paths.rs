//! Chains of straight lines in a shader's block: one of the levels that devices have of each, its corners as rows of
//! the series.

use super::{Exported, Row};
use crate::wave::pack::layout::Falloff;
use crate::wave::pack::path::LightPath;

/// How far straight lines may be off a curved core, as a share of how thick its thinnest light is, and of the core's
/// size where that is not thick.
const OF_RADIUS: f32 = 0.01;
const OF_SIZE: f32 = 1e-4;

/// Rows of a corner among those of devices.
const CORNER: usize = 4;

/// A level as devices have it.
struct Level<'a> {
    /// Of every corner.
    corners: &'a [Row],
    off: f32,
}

impl LightPath {
    /// Returns its levels, from fine to rough.
    fn levels<'a>(&self, packed: &'a [Row]) -> Vec<Level<'a>> {
        let level = |index: usize| {
            let at = self.row as usize + 2 * index;
            let [count, groups, _, balls] = packed[at].map(|size| size.to_bits() as usize);
            let first = balls + groups;
            Level {
                corners: &packed[first..first + CORNER * count],
                off: packed[at + 1][1],
            }
        };
        (0..self.level_count as usize).map(level).collect()
    }

    /// Returns how far off its lines may be.
    fn most_off(&self, packed: &[Row]) -> f32 {
        if self.falloff.radius2 > 0.0 {
            return OF_RADIUS * self.falloff.radius2.sqrt();
        }
        let levels = self.levels(packed);
        let places = || levels[0].corners.iter().step_by(CORNER);
        let span = |axis: usize| {
            let axis = || places().map(|it| it[axis]);
            axis().fold(f32::MIN, f32::max) - axis().fold(f32::MAX, f32::min)
        };
        OF_SIZE * (0..3).map(span).fold(0.0, f32::max)
    }

    /// Returns whether another light is of the same core.
    fn has_core_of(&self, other: &Self, packed: &[Row]) -> bool {
        let [own, others] = [self, other].map(|it| it.levels(packed)[0].corners);
        let places = |rows: &[Row]| rows.iter().step_by(CORNER).copied().collect::<Vec<Row>>();
        own.len() == others.len() && places(own) == places(others)
    }
}

impl Exported for LightPath {
    const TEXT: &'static [&'static str] = &[include_str!("../../wgsl/path.wgsl")];
    const ROW_NAMES: &'static [&'static str] = &["rows"];

    fn falloff(&self) -> Falloff {
        self.falloff
    }

    fn rows(&self, [begin, count]: [usize; 2]) -> Vec<Row> {
        let of_corner = if self.is_even > 0 { 1 } else { 2 };
        let numbers = [begin, count / of_corner, of_corner, 0];
        vec![numbers.map(|it| it as f32)]
    }

    fn emission(&self) -> Row {
        self.emission
    }

    fn series(list: &[Self], index: usize, packed: &[Row]) -> Vec<Row> {
        let path = &list[index];
        // All lights of a core share its rows.
        let of_core = list.iter().filter(|it| path.has_core_of(it, packed));
        let most_off = of_core
            .map(|it| it.most_off(packed))
            .fold(f32::MAX, f32::min);
        let levels = path.levels(packed);
        let rough = levels.iter().rev().find(|level| level.off <= most_off);
        let corners = rough.unwrap_or(&levels[0]).corners.as_chunks::<CORNER>().0;
        let rows = corners
            .iter()
            .flat_map(|[[x, y, z, length], [.., value], [.., radius], _]| {
                let begins = f32::from(u8::from(*length > 0.0));
                let lit = (path.is_even == 0).then_some([*value, *radius, 0.0, 0.0]);
                [Some([*x, *y, *z, begins]), lit].into_iter().flatten()
            });
        rows.collect()
    }
}
