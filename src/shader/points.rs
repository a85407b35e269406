//! Points, rings and curves of light in a shader's block; paths have no form there.

use super::{Exported, Row};
use crate::wave::pack::layout::Falloff;
use crate::wave::pack::path::LightPath;
use crate::wave::pack::{curve, sphere, torus};

impl Exported for sphere::Sphere {
    const TEXT: Option<&'static str> = Some(include_str!("../../wgsl/sphere.wgsl"));

    fn falloff(&self) -> Falloff {
        self.falloff
    }

    fn rows(&self) -> Vec<Row> {
        vec![self.center]
    }

    fn emission(&self) -> Row {
        self.emission
    }
}

impl Exported for torus::Torus {
    const TEXT: Option<&'static str> = Some(include_str!("../../wgsl/torus.wgsl"));
    const IS_MAPPED: bool = true;

    fn falloff(&self) -> Falloff {
        self.falloff
    }

    fn rows(&self) -> Vec<Row> {
        let [x, y, z, _] = self.center;
        vec![[x, y, z, self.major_radius], self.axis]
    }

    fn emission(&self) -> Row {
        self.emission
    }
}

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
