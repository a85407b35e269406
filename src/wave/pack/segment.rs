//! A finite line of light on the device (`cl/wave/source/segment.h`).

use glam::DVec3;

use super::{Anchor, Pack, Rows, device_struct, falloff, line, scene};
use super::layout::Falloff;
use crate::scene::SourceKind;

device_struct! {
    /// A finite line of light.
    Segment [160] {
        from: [f32; 4] = 0,
        from_rest: [f32; 4] = 16,
        to: [f32; 4] = 32,
        to_rest: [f32; 4] = 48,
        point: [f32; 4] = 64,
        point_rest: [f32; 4] = 80,
        direction: [f32; 4] = 96,
        direction_rest: [f32; 4] = 112,
        emission: [f32; 4] = 128,
        falloff: Falloff = 144,
    }
}

impl Pack for scene::Segment {
    type Device = Segment;

    fn pack(&self, anchor: &Anchor, _: &mut Rows) -> Segment {
        // Any direction will do for a point: its whole line is beyond its ends.
        let direction = (self.to - self.from).try_normalize().unwrap_or(DVec3::X);
        let (from, to) = (anchor.position(self.from), anchor.position(self.to));
        let (point, direction) = line(anchor, self.from, direction);
        Segment {
            from: from.value,
            from_rest: from.rest,
            to: to.value,
            to_rest: to.rest,
            point: point.value,
            point_rest: point.rest,
            direction: direction.value,
            direction_rest: direction.rest,
            emission: anchor.emission(self.light().coefficient, self.color),
            falloff: falloff(self.light().falloff),
        }
    }
}
