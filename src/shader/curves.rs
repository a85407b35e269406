//! Curves in a shader's block; a path of many pieces has no form there.

use super::{Exported, Row};
use crate::wave::pack::layout::Falloff;
use crate::wave::pack::{curve, path::LightPath};

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

    fn rows(&self, series_begin: f32) -> Vec<Row> {
        let with = |[x, y, z, _]: Row, last: f32| [x, y, z, last];
        let count = self.spline_count as f32;
        vec![
            with(self.middle, series_begin),
            with(self.velocity, count),
            self.second,
        ]
    }

    fn emission(&self) -> Row {
        self.emission
    }

    fn series<'a>(&self, rows: &'a [Row]) -> &'a [Row] {
        let begin = self.spline_begin as usize;
        &rows[begin..begin + self.spline_count as usize]
    }
}

impl Exported for LightPath {
    const TEXT: &'static [&'static str] = &[];
    const ROW_NAMES: &'static [&'static str] = &[];

    fn falloff(&self) -> Falloff {
        self.falloff
    }

    fn rows(&self, _: f32) -> Vec<Row> {
        Vec::new()
    }

    fn emission(&self) -> Row {
        self.emission
    }
}
