//! A line of light on the device (`cl/wave/source/cylinder.h`).


use super::{Anchor, Pack, Rows, device_struct, falloff, line, scene};
use super::layout::Falloff;
use crate::scene::SourceKind;

device_struct! {
    /// A line of light.
    Cylinder [96] {
        point: [f32; 4] = 0,
        point_rest: [f32; 4] = 16,
        direction: [f32; 4] = 32,
        direction_rest: [f32; 4] = 48,
        emission: [f32; 4] = 64,
        falloff: Falloff = 80,
    }
}

impl Pack for scene::Cylinder {
    type Device = Cylinder;

    fn pack(&self, anchor: &Anchor, _: &mut Rows) -> Cylinder {
        let (point, direction) = line(anchor, self.point, self.direction);
        Cylinder {
            point: point.value,
            point_rest: point.rest,
            direction: direction.value,
            direction_rest: direction.rest,
            emission: anchor.emission(self.light().coefficient, self.color),
            falloff: falloff(self.light().falloff),
        }
    }
}
