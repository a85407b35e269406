//! Frames of a camera that pans by a tenth of a pixel: tiles must not pop, and light must not come and go. And the
//! animations that come with the crate.

use crate::common::{device, renderer, sampled};
use energywave::image::ImageSize;
use energywave::scene::{AnimatedScene, Antialias, Method, Preset, Sampling};
use energywave::{RadianceImage, Scene};
use glam::DVec2;

/// How far a pixel may change otherwise by tiles than by pixels, of its light, and all of the light at all.
const MOST_POP: f32 = 2e-3;
const MOST_CHANGE: f64 = 1e-3;

/// Pixels below this share of the brightest are measured by it.
const LEAST_LIGHT: f32 = 1e-3;

const FRAMES: u32 = 6;

/// The frames of a scene over which the camera pans.
fn pan(name: &str) -> Vec<Scene> {
    let preset = Preset::ALL.iter().find(|preset| preset.name == name);
    let mut scene = Scene::from_toml(preset.unwrap().text).unwrap();
    scene.image = ImageSize {
        width: 240,
        height: 135,
    };
    scene.integration.method = Method::exact(1e-3);
    scene.display.bloom = None;
    let frame = |number: u32| {
        let mut frame = scene.clone();
        frame.camera.jitter = f64::from(number) * DVec2::new(0.1, 0.03);
        frame
    };
    (0..FRAMES).map(frame).collect()
}

fn draw(frames: &[Scene], sampling: Sampling, options: &str) -> Vec<RadianceImage> {
    let mut renderer = renderer(device().lanes, options);
    let draw = |scene: &Scene| renderer.render(&sampled(scene, sampling)).unwrap();
    frames.iter().map(draw).collect()
}

/// Returns by how much a pixel changes more, or less, from frame to frame by tiles than by pixels, at most.
fn pop(tiles: &[RadianceImage], pixels: &[RadianceImage]) -> f32 {
    let brightest = pixels[0].as_slice().iter().copied().fold(0.0, f32::max);
    let changes = tiles.windows(2).zip(pixels.windows(2)).flat_map(|(a, b)| {
        let [a, next_a, b, next_b] = [&a[0], &a[1], &b[0], &b[1]].map(RadianceImage::as_slice);
        (0..a.len()).map(move |i| {
            let change = (next_a[i] - a[i]) - (next_b[i] - b[i]);
            change.abs() / next_b[i].max(LEAST_LIGHT * brightest)
        })
    });
    changes.fold(0.0, f32::max)
}

/// Returns by how much of itself all light changes from frame to frame, at most.
fn change(images: &[RadianceImage]) -> f64 {
    let sum = |image: &RadianceImage| -> f64 {
        let pixels = image.as_slice().chunks(4);
        pixels
            .map(|pixel| f64::from(pixel[0] + pixel[1] + pixel[2]))
            .sum()
    };
    let sums: Vec<f64> = images.iter().map(sum).collect();
    let changes = sums.windows(2).map(|pair| (pair[1] / pair[0] - 1.0).abs());
    changes.fold(0.0, f64::max)
}

#[test]
fn what_a_camera_pans_over_neither_pops_nor_flickers() {
    for name in ["kamehameha", "nova"] {
        let frames = pan(name);
        let pixels = draw(&frames, Sampling::Pixels, "");
        let tiles = draw(&frames, Sampling::Tiles, "");
        assert!(
            pop(&tiles, &pixels) < MOST_POP,
            "{name}: {}",
            pop(&tiles, &pixels)
        );
        assert!(change(&tiles) < MOST_CHANGE, "{name}: {}", change(&tiles));
        let coarse = frames.iter().cloned().map(|mut frame| {
            frame.integration.method = Method::exact(1e-1);
            frame
        });
        let coarse = draw(&coarse.collect::<Vec<_>>(), Sampling::Tiles, "");
        // Of the other hardly anything is smooth.
        assert!(pop(&coarse, &pixels) > MOST_POP || name == "nova", "{name}");
    }
    let nova = pan("nova");
    let pixels = draw(&nova, Sampling::Pixels, "");
    let sudden = draw(&nova, Sampling::Tiles, "-DPASSES_FROM=0.9999f");
    assert!(pop(&sudden, &pixels) > MOST_POP);
    let rays = nova.into_iter().map(|mut frame| {
        frame.integration.antialias = Antialias::None;
        frame
    });
    let rays = draw(&rays.collect::<Vec<_>>(), Sampling::Tiles, "");
    assert!(change(&rays) > MOST_CHANGE, "{}", change(&rays));
}

#[test]
fn every_animation_is_read_at_all_its_times_and_closes() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/animations");
    let files = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut count = 0;
    for file in files {
        let scene = AnimatedScene::from_file(&file).unwrap();
        let span = scene.span().unwrap();
        for step in 0..=8 {
            let time = span.seconds * f64::from(step) / 8.0;
            let frame = scene.at(time).unwrap_or_else(|error| panic!("{error}"));
            assert!(
                frame.warnings().is_empty(),
                "{}: {:?}",
                file.display(),
                frame.warnings()
            );
        }
        if span.loops {
            assert_eq!(scene.at(span.seconds).unwrap(), scene.at(0.0).unwrap());
        }
        assert_ne!(
            scene.at(0.4 * span.seconds).unwrap(),
            scene.at(0.0).unwrap()
        );
        count += 1;
    }
    assert_eq!(count, 6);
}
