//! Points and rings of light in a shader's block.

use super::{Exported, Row};
use crate::wave::pack::layout::Falloff;
use crate::wave::pack::{sphere, torus};

impl Exported for sphere::Sphere {
    const TEXT: &'static [&'static str] = &[include_str!("../../wgsl/sphere.wgsl")];
    const ROW_NAMES: &'static [&'static str] = &["center"];

    fn falloff(&self) -> Falloff {
        self.falloff
    }

    fn rows(&self, _: [usize; 2]) -> Vec<Row> {
        vec![self.center]
    }

    fn emission(&self) -> Row {
        self.emission
    }
}

impl Exported for torus::Torus {
    const TEXT: &'static [&'static str] = &[include_str!("../../wgsl/torus.wgsl")];
    const ROW_NAMES: &'static [&'static str] = &["center", "axis"];
    const IS_MAPPED: bool = true;

    fn falloff(&self) -> Falloff {
        self.falloff
    }

    fn rows(&self, _: [usize; 2]) -> Vec<Row> {
        let [x, y, z, _] = self.center;
        vec![[x, y, z, self.major_radius], self.axis]
    }

    fn emission(&self) -> Row {
        self.emission
    }
}
