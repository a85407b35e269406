//! Points of light in a shader's block; rings and curves have no closed form.

use super::{Exported, Row};
use crate::wave::pack::layout::Falloff;
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

macro_rules! without_form {
    ($($Type:ty),*) => {
        $(impl Exported for $Type {
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
        })*
    };
}
without_form!(
    torus::Torus,
    curve::Curve,
    crate::wave::pack::path::LightPath
);
