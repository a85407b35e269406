//! Straight light in a shader's block.

use super::{Exported, Row};
use crate::wave::pack::layout::Falloff;
use crate::wave::pack::{beam, cylinder, segment};

macro_rules! exported {
    ($Type:ty, $file:literal, $names:expr, |$source:ident| $rows:expr) => {
        impl Exported for $Type {
            const TEXT: &'static [&'static str] = &[include_str!(concat!("../../wgsl/", $file))];

            const ROW_NAMES: &'static [&'static str] = &$names;

            fn falloff(&self) -> Falloff {
                self.falloff
            }

            fn rows(&self, _: [usize; 2]) -> Vec<Row> {
                let $source = self;
                $rows
            }

            fn emission(&self) -> Row {
                self.emission
            }
        }
    };
}
exported!(
    cylinder::Cylinder,
    "cylinder.wgsl",
    ["point", "direction"],
    |it| vec![it.point, it.direction]
);
exported!(
    segment::Segment,
    "segment.wgsl",
    ["first", "last", "direction"],
    |it| vec![it.from, it.to, it.direction]
);
exported!(
    beam::Beam,
    "beam.wgsl",
    ["tip", "direction", "parts"],
    |it| vec![it.tip, it.direction, it.parts()]
);
