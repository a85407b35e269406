//! Lights of simple forms in the place of what casts light, for programs that know only such.

use glam::DVec3;

use super::pack::parabola;
use crate::error::Result;
use crate::scene::{Emitter, EmitterCore, Scene};

/// A light that emits evenly in all directions and evenly along a straight line, or at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CapsuleLight {
    /// One end, world space.
    pub a: DVec3,
    /// The other end; the first one for a point.
    pub b: DVec3,
    /// Within which its light grows no more, world units: how thick a glowing tube of it is.
    pub radius: f64,
    /// Linear RGB; the channel that is greatest is 1 or, of a source that takes light away, -1.
    pub color: DVec3,
    /// What all of it emits per solid angle, 0 or more: at a distance d that is large beside its length, a surface that
    /// faces it has the irradiance `intensity color / d^2`.
    pub intensity: f64,
}

/// Straight pieces in the place of a whole circle, of a curve, and of a line along which light changes.
const OF_CIRCLE: f64 = 24.0;
const OF_CURVE: u32 = 8;
const OF_LINE: u32 = 4;

/// Returns capsules in the place of what casts light in a scene: their intensities add up to that of each core. Circles
/// are 24 of them, curves 8 a piece, a line along which light changes 4 between two of its values. Lines without end
/// are cut at the length of the scene's view rays from their begin or, where they have none, from the point nearest to
/// the camera's target.
///
/// # Errors
/// [`Error::Scene`](crate::Error::Scene) if the scene is not valid.
pub fn proxies(scene: &Scene) -> Result<Vec<CapsuleLight>> {
    scene.validate()?;
    let mut capsules = Vec::new();
    for emitter in scene.emitters(&scene.lighting.unwrap_or_default()) {
        add_capsules(scene, &emitter, &mut capsules);
    }
    Ok(capsules)
}

fn add_capsules(scene: &Scene, emitter: &Emitter, capsules: &mut Vec<CapsuleLight>) {
    let is_even = emitter.light.iter().all(|light| *light == emitter.light[0]);
    let mut add = |count: u32, length: f64, at: &dyn Fn(f64) -> DVec3| {
        for k in 0..count {
            let [from, to] = [k, k + 1].map(|k| f64::from(k) / f64::from(count));
            let middle = 0.5 * (from + to);
            // Simpson's rule, which is exact for parabolas.
            let ends = parabola(emitter.light, from) + parabola(emitter.light, to);
            let light = (ends + 4.0 * parabola(emitter.light, middle)) / 6.0;
            let piece = length / f64::from(count);
            capsules.extend(capsule([at(from), at(to)], emitter.radius, piece * light));
        }
    };
    match emitter.core {
        EmitterCore::Point(place) => add(1, 1.0, &|_| place),
        EmitterCore::Line {
            point,
            direction,
            range,
        } => {
            let middle = (scene.camera.target - point).dot(direction);
            let begin = if range[0].is_finite() {
                range[0]
            } else {
                middle
            };
            let [from, to] = match range.map(f64::is_finite) {
                [true, true] => range,
                [true, false] => [begin, begin + scene.ray_length()],
                _ => [begin - scene.ray_length(), begin + scene.ray_length()],
            };
            let count = if is_even { 1 } else { OF_LINE };
            add(count, to - from, &|s| {
                point + direction * (from + s * (to - from))
            });
        }
        EmitterCore::Arc {
            center,
            x,
            y,
            angles: [from, to],
        } => {
            let share = (to - from) / std::f64::consts::TAU;
            let count = (OF_CIRCLE * share).ceil().max(1.0) as u32;
            add(count, (to - from) * x.length(), &|s| {
                let angle = from + s * (to - from);
                center + angle.cos() * x + angle.sin() * y
            });
        }
        EmitterCore::Curve(piece) => {
            for k in 0..OF_CURVE {
                let [from, to] = [k, k + 1].map(|k| f64::from(k) / f64::from(OF_CURVE));
                let part = piece.part(from, to);
                let light = parabola(emitter.light, 0.5 * (from + to));
                let ends = [part.at(0.0), part.at(1.0)];
                capsules.extend(capsule(ends, emitter.radius, part.length(1.0) * light));
            }
        }
    }
}

/// Makes a capsule of what all of it emits; `None` where that is nothing.
fn capsule([a, b]: [DVec3; 2], radius: f64, light: DVec3) -> Option<CapsuleLight> {
    let intensity = light.abs().max_element();
    (intensity > 0.0).then(|| CapsuleLight {
        a,
        b,
        radius,
        color: light / intensity,
        intensity,
    })
}
