//! A point of light on the device (`cl/wave/source/sphere.h`).


use super::{Anchor, Pack, Rows, device_struct, falloff, scene};
use super::layout::Falloff;
use crate::scene::SourceKind;

device_struct! {
    /// A point of light.
    Sphere [64] {
        center: [f32; 4] = 0,
        center_rest: [f32; 4] = 16,
        emission: [f32; 4] = 32,
        falloff: Falloff = 48,
    }
}

impl Pack for scene::Sphere {
    type Device = Sphere;

    fn pack(&self, anchor: &Anchor, _: &mut Rows) -> Sphere {
        let center = anchor.position(self.center);
        Sphere {
            center: center.value,
            center_rest: center.rest,
            emission: anchor.emission(self.light().coefficient, self.color),
            falloff: falloff(self.light().falloff),
        }
    }
}
