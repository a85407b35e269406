//! A ring of light on the device (`cl/wave/source/torus.h`).

use bytemuck::Zeroable;

use super::{Anchor, Pack, Rows, device_struct, fine, falloff, rest, scene};
use super::layout::Falloff;
use crate::scene::SourceKind;

device_struct! {
    /// A ring of light.
    Torus [112] {
        center: [f32; 4] = 0,
        center_rest: [f32; 4] = 16,
        axis: [f32; 4] = 32,
        axis_rest: [f32; 4] = 48,
        emission: [f32; 4] = 64,
        major_radius: f32 = 80,
        major_radius_rest: f32 = 84,
        padding_0: u32 = 88,
        padding_1: u32 = 92,
        falloff: Falloff = 96,
    }
}

impl Pack for scene::Torus {
    type Device = Torus;

    fn pack(&self, anchor: &Anchor, _: &mut Rows) -> Torus {
        let (center, axis) = (anchor.position(self.center), fine(self.axis.normalize()));
        Torus {
            center: center.value,
            center_rest: center.rest,
            axis: axis.value,
            axis_rest: axis.rest,
            emission: anchor.emission(self.light().coefficient, self.color),
            major_radius: self.major_radius as f32,
            major_radius_rest: rest(self.major_radius),
            falloff: falloff(self.light().falloff),
            ..Zeroable::zeroed()
        }
    }
}
