//! A line of light on the device (`cl/wave/source/cylinder.h`).

use bytemuck::Zeroable;

use super::{Anchor, Pack, SplinePiece, device_struct, is_square, line, scene};

device_struct! {
    /// A line of light.
    Cylinder [96] {
        point: [f32; 4] = 0,
        point_rest: [f32; 4] = 16,
        direction: [f32; 4] = 32,
        direction_rest: [f32; 4] = 48,
        emission: [f32; 4] = 64,
        is_square: u32 = 80,
        padding_0: u32 = 84,
        padding_1: u32 = 88,
        padding_2: u32 = 92,
    }
}

impl Pack for scene::Cylinder {
    type Device = Cylinder;

    fn pack(&self, anchor: &Anchor, _: &mut Vec<SplinePiece>) -> Cylinder {
        let (point, direction) = line(anchor, self.point, self.direction);
        Cylinder {
            point: point.value,
            point_rest: point.rest,
            direction: direction.value,
            direction_rest: direction.rest,
            emission: anchor.emission(self.coefficient, self.color),
            is_square: is_square(self.profile),
            ..Zeroable::zeroed()
        }
    }
}
