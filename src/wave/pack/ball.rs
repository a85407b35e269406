//! Balls that hold all light of sources, for kernels that ask where none can be (`cl/wave/tiles/ball.h`).

use super::layout::Falloff;
use super::{Anchor, Row};
use crate::scene::kinds::KIND_COUNT;

/// The share by which float32 may make a ball too small.
const MARGIN: f64 = 2e-5;

/// The same as a share of the distance from the eye.
const ROUNDED: f64 = 1e-6;

/// Number of a Gaussian, which is 0 beyond so many radii.
const GAUSSIAN: u32 = 3;
const GAUSSIAN_END: f64 = 9.0;

/// Light that goes on.
const ENDLESS: Row = [0.0, 0.0, 0.0, -1.0];

/// Packs the ball that holds the light around a core which lies in a ball: its centre and radius; a negative radius
/// where there is none.
pub fn ball(core: Option<(glam::DVec3, f64)>, falloff: &Falloff, anchor: &Anchor) -> Row {
    let (Some((center, radius)), Some(end)) = (core, end(falloff)) else {
        return ENDLESS;
    };
    let [x, y, z, _] = anchor.position(center).value;
    let rounded = ROUNDED * center.distance(anchor.origin);
    [x, y, z, ((radius + end) * (1.0 + MARGIN) + rounded) as f32]
}

/// Returns the distance from which on there is no light, as `cl/wave/source/profile.h` has it.
fn end(falloff: &Falloff) -> Option<f64> {
    let last =
        (falloff.profile == GAUSSIAN).then_some(GAUSSIAN_END * f64::from(falloff.radius2).sqrt());
    let reach = (falloff.reach2 > 0.0).then_some(f64::from(falloff.reach2).sqrt());
    let ends = [reach, last].into_iter().flatten();
    ends.reduce(f64::min)
}

/// Returns where the balls of every kind begin, if they stand at this row, one after another.
pub fn first_balls(row: usize, counts: [u64; KIND_COUNT]) -> [u32; KIND_COUNT] {
    let mut next = row as u64;
    counts.map(|count| {
        next += count;
        (next - count) as u32
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn balls_hold_light_that_ends_and_kinds_follow_each_other() {
        let anchor = Anchor {
            origin: DVec3::new(0.0, -5.0, 0.0),
            reach: 20.0,
            measure: 1.0,
            reduction: crate::scene::Reduction::Sum,
            pixel: crate::wave::pack::Pixel::OfDistance(1e-3),
            tolerance: 1e-3,
        };
        let falloff = |profile, reach2| Falloff {
            profile,
            radius2: 0.01,
            reach2,
            reach2_rest: 0.0,
        };
        let core = Some((DVec3::ZERO, 2.0));
        let radius = |core, falloff| ball(core, &falloff, &anchor)[3];
        let about = |found: f32, expected: f32| {
            assert!(found > expected && found < 1.0001 * expected, "{found}");
        };
        about(radius(core, falloff(1, 0.25)), 2.5);
        about(radius(core, falloff(GAUSSIAN, 0.25)), 2.5);
        about(radius(core, falloff(GAUSSIAN, 0.0)), 2.9);
        assert_eq!(radius(core, falloff(0, 0.0)), -1.0);
        assert_eq!(radius(None, falloff(0, 0.25)), -1.0);
        let mut counts = [0; KIND_COUNT];
        (counts[0], counts[2]) = (3, 4);
        let first = first_balls(10, counts);
        assert_eq!(first[..4], [10, 13, 13, 17]);
    }
}
