//! A particle system of a host: a million sparks that turn about a core, whose places are made anew for every frame and
//! drawn as a crowd. Leaves three frames in the folder given, and says how long each took.
//!
//! `cargo run --release --example sparks -- FOLDER [NUMBER OF SPARKS]`

use std::path::PathBuf;
use std::time::Instant;

use energywave::image::{Exposure, ImageSize, ToneMap};
use energywave::scene::{Camera, PointList, Points, Profile};
use energywave::{Device, Renderer, Scene};
use glam::DVec3;

/// Returns where a spark is, and its light: linear RGB.
fn spark(number: u32, count: u32, time: f64) -> (DVec3, [f32; 3]) {
    // Multiples of irrational numbers lie evenly.
    let share = |step: f64| (f64::from(number) * step).fract();
    let radius = 2.2 * (f64::from(number) + 0.5) / f64::from(count);
    let arm = std::f64::consts::PI * f64::from(number % 2) + 2.0 * radius;
    let turn = arm + 1.6 * (share(0.618_034) - 0.5) / (0.3 + radius) + time / (0.2 + radius);
    let height = 0.15 * (share(0.414_214) - 0.5) * (1.0 - 0.3 * radius);
    let heat = 1.0 / (1.0 + 3.0 * radius * radius) as f32;
    let light = [0.25 + heat, 0.35 + 0.6 * heat, 1.0];
    let place = DVec3::new(radius * turn.cos(), radius * turn.sin(), height);
    (place, light)
}

fn main() -> energywave::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().unwrap_or_default());
    let count = arguments.next().and_then(|it| it.parse().ok());
    let count: u32 = count.unwrap_or(1_000_000);
    let mut renderer = Renderer::new(&Device::best()?)?;
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.5, 2.6), DVec3::ZERO));
    scene.image = ImageSize {
        width: 640,
        height: 360,
    };
    // All that light together is a veil: dark enough, only the arms and the core are left.
    scene.display.exposure = Exposure::Stops(-4.6);
    scene.display.tone_map = ToneMap::Aces;
    for frame in 0..3 {
        let begun = Instant::now();
        let time = 0.04 * f64::from(frame);
        let (places, lights) = (0..count).map(|number| spark(number, count, time)).unzip();
        let mut sparks = Points::new(PointList::with_lights(places, lights)?);
        sparks.profile = Profile::InverseSquare;
        sparks.coefficient = 1.0 / f64::from(count);
        scene.points = vec![sparks].into();
        let radiance = renderer.render(&scene)?;
        let taken = begun.elapsed().as_secs_f64();
        println!("frame {frame}: {count} sparks in {:.0} ms", 1e3 * taken);
        radiance.save(folder.join(format!("sparks-{frame}.png")), &scene.display)?;
    }
    Ok(())
}
