//! A half-line of light on the device (`cl/wave/source/beam.h`).

use bytemuck::Zeroable;

use super::{Anchor, Pack, Rows, device_struct, falloff, line, rest, scene};
use super::layout::Falloff;
use crate::scene::Light;

device_struct! {
    /// A half-line of light.
    Beam [160] {
        tip: [f32; 4] = 0,
        tip_rest: [f32; 4] = 16,
        point: [f32; 4] = 32,
        point_rest: [f32; 4] = 48,
        direction: [f32; 4] = 64,
        direction_rest: [f32; 4] = 80,
        emission: [f32; 4] = 96,
        line: f32 = 112,
        cap: f32 = 116,
        sphere: f32 = 120,
        per_taper: f32 = 124,
        per_taper_rest: f32 = 128,
        padding_0: u32 = 132,
        padding_1: u32 = 136,
        padding_2: u32 = 140,
        falloff: Falloff = 144,
    }
}

impl Beam {
    /// Returns the coefficients of line, cap and sphere, and 1 over the length of the taper, or 0.
    pub fn parts(&self) -> [f32; 4] {
        [self.line, self.cap, self.sphere, self.per_taper]
    }
}

impl Pack for scene::Beam {
    type Device = Beam;

    fn pack(&self, light: &Light, anchor: &Anchor, _: &mut Rows) -> Beam {
        let tip = anchor.position(self.tip);
        let per_taper = self.taper_length().map_or(0.0, |length| 1.0 / length);
        let (point, direction) = line(anchor, self.tip, self.direction);
        Beam {
            tip: tip.value,
            tip_rest: tip.rest,
            point: point.value,
            point_rest: point.rest,
            direction: direction.value,
            direction_rest: direction.rest,
            emission: anchor.emission(1.0, light.color),
            line: light.coefficient as f32,
            cap: self.cap(light) as f32,
            sphere: self.sphere_coefficient as f32,
            per_taper: per_taper as f32,
            per_taper_rest: rest(per_taper),
            falloff: falloff(light.falloff),
            ..Zeroable::zeroed()
        }
    }
}
