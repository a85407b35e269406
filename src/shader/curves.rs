//! Curves in a shader's block.

use super::{Exported, Row};
use crate::wave::pack::curve;
use crate::wave::pack::layout::Falloff;

const CURVE: &str = include_str!("../../wgsl/curve.wgsl");

impl Exported for curve::Curve {
    const TEXT: &'static [&'static str] = &[CURVE, include_str!("../../wgsl/curve_even.wgsl")];
    const TEXT_WITH_SERIES: &'static [&'static str] =
        &[CURVE, include_str!("../../wgsl/curve_series.wgsl")];
    const ROW_NAMES: &'static [&'static str] = &["middle", "velocity", "second"];
    const IS_MAPPED: bool = true;

    fn falloff(&self) -> Falloff {
        self.falloff
    }

    fn rows(&self, [begin, count]: [usize; 2]) -> Vec<Row> {
        let with = |[x, y, z, _]: Row, last: f32| [x, y, z, last];
        vec![
            with(self.middle, begin as f32),
            with(self.velocity, count as f32),
            self.second,
        ]
    }

    fn emission(&self) -> Row {
        self.emission
    }

    fn series(list: &[Self], index: usize, packed: &[Row]) -> Vec<Row> {
        let begin = list[index].spline_begin as usize;
        packed[begin..begin + list[index].spline_count as usize].to_vec()
    }
}
