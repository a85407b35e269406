//! Curves in a shader's block; a path of many pieces has no form there.

use super::{Exported, Row};
use crate::wave::pack::layout::Falloff;
use crate::wave::pack::{curve, path::LightPath};

impl Exported for curve::Curve {
    const TEXT: Option<&'static str> = Some(include_str!("../../wgsl/curve.wgsl"));
    const IS_MAPPED: bool = true;

    fn falloff(&self) -> Falloff {
        self.falloff
    }

    fn rows(&self) -> Vec<Row> {
        vec![self.middle, self.velocity, self.second]
    }

    fn emission(&self) -> Row {
        self.emission
    }

    fn changes_along(&self) -> bool {
        self.spline_count > 0
    }
}

impl Exported for LightPath {
    const TEXT: Option<&'static str> = None;

    fn falloff(&self) -> Falloff {
        self.falloff
    }

    fn rows(&self) -> Vec<Row> {
        Vec::new()
    }

    fn emission(&self) -> Row {
        self.emission
    }
}
