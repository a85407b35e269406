//! Animated parameters: a shot that charges, leaves and swells. One renderer draws all frames: it keeps kernels and
//! buffers, and uploads only what changed. Writes `frame-00.png` to `frame-23.png` into the folder given.
//!
//! `cargo run --release --example animation -- FOLDER`

use std::path::PathBuf;

use energywave::image::{Display, Exposure, ImageSize, ToneMap};
use energywave::scene::{Camera, Decay, Measure, Profile, Segment, Sphere};
use energywave::{Device, Renderer, Scene};
use glam::DVec3;

const FRAMES: u32 = 24;

/// Rises from 0 before `from` to 1 after `to`, smoothly.
fn ramp(time: f64, from: f64, to: f64) -> f64 {
    let x = ((time - from) / (to - from)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Returns the scene at a time from 0 to 1.
fn scene_at(time: f64) -> Scene {
    let mut camera = Camera::new(DVec3::new(0.6, -5.0, 1.2), DVec3::new(0.6, 0.0, 0.0));
    camera.near = 3.5;
    camera.ray_length = Some(4.0);
    let mut scene = Scene::new(camera);
    scene.image = ImageSize {
        width: 320,
        height: 180,
    };
    scene.integration.measure = Measure::Parameter;
    scene.decay = Some(Decay::new(1.0, 1.0));
    scene.display = Display {
        exposure: Exposure::Stops(-0.8),
        tone_map: ToneMap::Aces,
        ..Display::default()
    };
    let hand = DVec3::new(-1.2, 0.0, 0.0);
    let charge = ramp(time, 0.0, 0.5);
    scene.spheres.push(Sphere {
        center: hand,
        coefficient: 0.16 * charge,
        color: DVec3::new(0.25, 0.55, 1.3),
        profile: Profile::InverseSquare,
        ..Sphere::default()
    });
    let strength = 0.07 * ramp(time, 0.45, 0.7);
    if strength > 0.0 {
        let flown = 6.0 * ramp(time, 0.45, 1.0);
        scene.segments.push(Segment {
            coefficient: strength,
            color: DVec3::new(0.2, 0.5, 1.3),
            profile: Profile::InverseSquare,
            ..Segment::new(hand, hand + DVec3::X * flown)
        });
    }
    scene
}

fn main() -> energywave::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_default());
    let mut renderer = Renderer::new(&Device::best()?)?;
    for frame in 0..FRAMES {
        let scene = scene_at(f64::from(frame) / f64::from(FRAMES - 1));
        let radiance = renderer.render(&scene)?;
        radiance.save(folder.join(format!("frame-{frame:02}.png")), &scene.display)?;
    }
    Ok(())
}
