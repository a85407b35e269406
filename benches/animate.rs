//! The frames of the firing beam, 512x512, as PNG and EXR: drawing alone, encoding alone, and both as `energywave
//! animate` does them, side by side. `cargo bench --bench animate`
#![allow(clippy::unwrap_used, clippy::panic)] // a bench fails by panicking

use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

use energywave::image::{ImageSize, RadianceImage};
use energywave::scene::AnimatedScene;
use energywave::{Device, Renderer};

const FRAMES: u32 = 240;
const RATE: f64 = 30.0;
const ROUNDS: usize = 3;

/// Every so many frames are kept, to be encoded again and again.
const KEPT: u32 = 12;

fn main() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenes/animations/firing-beam.toml"
    );
    let scene = AnimatedScene::from_file(path).unwrap();
    let mut renderer = Renderer::new(&Device::best().unwrap()).unwrap();
    let mut kept = Vec::new();
    let mut times = [const { Vec::new() }; 5];
    for round in 0..=ROUNDS {
        let mut took = vec![seconds(|| kept = draw(&scene, &mut renderer))];
        for ending in ["png", "exr"] {
            took.push(seconds(|| encode(&scene, &kept, ending)));
            took.push(seconds(|| animate(path, ending)));
        }
        if round > 0 {
            times
                .iter_mut()
                .zip(took)
                .for_each(|(times, took)| times.push(took));
        }
    }
    let [drawing, png, png_frames, exr, exr_frames] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[ROUNDS / 2]
    });
    println!(
        "{FRAMES} frames of 512x512, seconds, medians of {ROUNDS}; drawing alone {drawing:.2}"
    );
    for (ending, encoding, all) in [("png", png, png_frames), ("exr", exr, exr_frames)] {
        let rate = f64::from(FRAMES) / all;
        let ratio = all / drawing.max(encoding);
        println!(
            "{ending}: encoding alone {encoding:.2}, both {all:.2}, {rate:.1} frames a second: {ratio:.2} of the slower"
        );
    }
}

fn seconds(work: impl FnOnce()) -> f64 {
    let begun = Instant::now();
    work();
    begun.elapsed().as_secs_f64()
}

/// Draws all frames, and returns some of them.
fn draw(animated: &AnimatedScene, renderer: &mut Renderer) -> Vec<RadianceImage> {
    let at = |time: f64| {
        let mut scene = animated.at(time)?;
        (scene.image.width, scene.image.height) = (512, 512);
        Ok(scene)
    };
    let mut kept = Vec::new();
    let size = ImageSize {
        width: 512,
        height: 512,
    };
    let mut image = RadianceImage::new(size).unwrap();
    for frame in 0..FRAMES {
        let time = f64::from(frame) / RATE;
        let open = animated.open_at(time, RATE);
        image = match open.is_empty() {
            true => renderer.render(&at(time).unwrap()).unwrap(),
            false => renderer.render_mean(open, &mut |time| at(time)).unwrap(),
        };
        if frame % KEPT == 0 {
            kept.push(image.clone());
        }
    }
    std::hint::black_box(&image);
    kept
}

/// Encodes as many frames on all cores.
fn encode(animated: &AnimatedScene, kept: &[RadianceImage], ending: &str) {
    let folder = tempfile::tempdir().unwrap();
    let next = AtomicU32::new(0);
    let display = animated.at(0.0).unwrap().display;
    let work = || loop {
        let frame = next.fetch_add(1, Ordering::Relaxed);
        if frame >= FRAMES {
            return;
        }
        let image = &kept[frame as usize % kept.len()];
        image
            .save(folder.path().join(format!("{frame}.{ending}")), &display)
            .unwrap();
    };
    std::thread::scope(|scope| {
        let cores = std::thread::available_parallelism().unwrap().get();
        (0..cores).for_each(|_| drop(scope.spawn(work)));
    });
}

fn animate(scene: impl AsRef<Path>, ending: &str) {
    let folder = tempfile::tempdir().unwrap();
    let done = Command::new(env!("CARGO_BIN_EXE_energywave"))
        .args(["animate", "--quiet", "--size", "512x512", "--frames"])
        .args([&format!("0..{}", FRAMES - 1), "--fps", "30", "-o"])
        .arg(folder.path().join(format!("f.{ending}")))
        .arg(scene.as_ref())
        .status();
    assert!(done.unwrap().success());
}
