//! A point of light on the device (`cl/wave/source/sphere.h`).

use bytemuck::Zeroable;

use super::{Anchor, Pack, SplinePiece, device_struct, is_square, scene};

device_struct! {
    /// A point of light.
    Sphere [64] {
        center: [f32; 4] = 0,
        center_rest: [f32; 4] = 16,
        emission: [f32; 4] = 32,
        is_square: u32 = 48,
        padding_0: u32 = 52,
        padding_1: u32 = 56,
        padding_2: u32 = 60,
    }
}

impl Pack for scene::Sphere {
    type Device = Sphere;

    fn pack(&self, anchor: &Anchor, _: &mut Vec<SplinePiece>) -> Sphere {
        let center = anchor.position(self.center);
        Sphere {
            center: center.value,
            center_rest: center.rest,
            emission: anchor.emission(self.coefficient, self.color),
            is_square: is_square(self.profile),
            ..Zeroable::zeroed()
        }
    }
}
