//! `[display]` of files: alpha, backgrounds, bits, formats and exposure, as other programs find them in the files.

use std::fs;
use std::path::PathBuf;

use crate::common::program::{Folder, expect, stderr};
use energywave::image::{
    Alpha, Background, BackgroundImage, Display, Exposure, ImageFile, ImageSize,
};
use energywave::{RadianceImage, Scene, reference};
use image::{DynamicImage, ImageReader};

const SIZE: ImageSize = ImageSize {
    width: 40,
    height: 24,
};

/// A blue ring and a hot orange ball.
const SCENE: &str = "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n[image]\nwidth = 40\nheight = 24\n\
    [[torus]]\nmajor_radius = 1\ncolor = [0.15, 0.35, 1]\n\
    [[sphere]]\ncenter = [0.3, 0, 0.4]\nradius = 0.1\ncoefficient = 0.3\ncolor = [1, 0.4, 0.1]\n";

/// Of 255; half a step of rounding is the other program's.
const WITHIN: f64 = 1.0 + 1e-3;

pub fn scene(display: &str) -> String {
    format!("{SCENE}[display]\n{display}\n")
}

pub fn save(folder: &Folder, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).unwrap();
}

fn light() -> RadianceImage {
    reference::render(&Scene::from_toml(SCENE).unwrap()).unwrap()
}

fn exposure() -> Exposure {
    Scene::from_toml(SCENE).unwrap().display.exposure
}

fn decoded(encoded: f64) -> f64 {
    match encoded <= 0.04045 {
        true => encoded / 12.92,
        false => ((encoded + 0.055) / 1.055).powf(2.4),
    }
}

fn encoded(linear: f64) -> f64 {
    match linear <= 0.0031308 {
        true => 12.92 * linear,
        false => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
    }
}

fn read(path: &PathBuf) -> DynamicImage {
    ImageReader::open(path)
        .unwrap()
        .with_guessed_format()
        .unwrap()
        .decode()
        .unwrap()
}

/// A plate of every brightness and hue, 8 bits.
pub fn plate(folder: &Folder) -> (PathBuf, image::RgbImage) {
    let path = folder.path().join("plate.png");
    let plate = image::RgbImage::from_fn(SIZE.width, SIZE.height, |x, y| {
        image::Rgb([(x * 6) as u8, (y * 10) as u8, ((x * y * 7) % 256) as u8])
    });
    plate.save(&path).unwrap();
    (path, plate)
}

fn write(folder: &Folder, name: &str, display: &Display) -> PathBuf {
    let path = folder.path().join(name);
    ImageFile::create(&path)
        .unwrap()
        .write(&light(), display)
        .unwrap();
    path
}

/// The textbook's `over` in linear light, of straight alpha; of 255. Premultiplied values are spoiled.
fn over(front: &DynamicImage, behind: &image::RgbImage, is_spoiled: bool) -> Vec<f64> {
    let front = front.to_rgba16();
    let pixels = front.pixels().zip(behind.pixels());
    let laid = pixels.flat_map(|(front, behind)| {
        let alpha = f64::from(front[3]) / 65535.0;
        [0, 1, 2].map(|k| {
            let color = decoded(f64::from(front[k]) / 65535.0);
            let behind = decoded(f64::from(behind[k]) / 255.0);
            let share = if is_spoiled { 1.0 } else { alpha };
            255.0 * encoded(share * color + (1.0 - alpha) * behind)
        })
    });
    laid.collect()
}

/// The largest difference of a picture from values of 255.
fn off(picture: &DynamicImage, values: &[f64]) -> f64 {
    let found = picture.to_rgb16();
    let found = found.as_raw().iter().map(|value| f64::from(*value) / 257.0);
    found
        .zip(values)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

#[test]
fn a_picture_with_alpha_over_a_plate_is_our_own_over_that_background() {
    let folder = Folder::new();
    let (path, plate) = plate(&folder);
    let black = image::RgbImage::new(SIZE.width, SIZE.height);
    for bits in [8, 16] {
        let display = Display {
            exposure: exposure(),
            alpha: Alpha::Luminance,
            bits: Some(bits),
            ..Display::default()
        };
        let front = read(&write(&folder, "front.png", &display));
        let image = BackgroundImage::open(&path).unwrap();
        let with_plate = Display {
            background: Some(Background::Image(image.into())),
            ..display.clone()
        };
        let own = read(&write(&folder, "own.png", &with_plate));
        let opaque = read(&write(
            &folder,
            "opaque.png",
            &Display {
                alpha: Alpha::Opaque,
                ..display
            },
        ));
        assert!(
            !own.color().has_alpha() && !opaque.color().has_alpha() && front.color().has_alpha()
        );
        let limit = if bits == 8 { WITHIN } else { 0.02 };
        let found = [
            off(&own, &over(&front, &plate, false)),
            off(&opaque, &over(&front, &black, false)),
        ];
        println!("{bits} bits: {found:?} of 255");
        assert!(found.iter().all(|off| *off < limit), "{bits}: {found:?}");
        assert!(off(&own, &over(&front, &plate, true)) > 10.0);
        assert!(off(&opaque, &over(&front, &plate, false)) > 10.0);
    }
}

#[test]
fn linear_light_with_alpha_over_a_plate_is_our_own_over_that_background() {
    let folder = Folder::new();
    let mut behind = RadianceImage::new(SIZE).unwrap();
    for (i, value) in behind.as_mut_slice().iter_mut().enumerate() {
        *value = 0.01 * (i % 97) as f32;
    }
    for (alpha, bits, within) in [
        (Alpha::Additive, 32, 1e-6),
        (Alpha::Luminance, 32, 1e-6),
        (Alpha::Additive, 16, 1e-3),
    ] {
        let display = Display {
            exposure: exposure(),
            alpha,
            bits: Some(bits),
            ..Display::default()
        };
        let front = RadianceImage::open(write(&folder, "front.exr", &display)).unwrap();
        let image = BackgroundImage::new(behind.clone(), true);
        let background = Some(Background::Image(image.into()));
        let own = write(
            &folder,
            "own.exr",
            &Display {
                background,
                ..display
            },
        );
        let own = RadianceImage::open(own).unwrap();
        let mut worst = [0.0_f32; 2];
        let pixels = front
            .as_slice()
            .chunks_exact(4)
            .zip(behind.as_slice().chunks_exact(4));
        for ((front, behind), own) in pixels.zip(own.as_slice().chunks_exact(4)) {
            assert_eq!(own[3], 1.0);
            assert!(alpha == Alpha::Luminance || (front[3] == 0.0 && front[2] > 0.0));
            for k in 0..3 {
                // Premultiplied; spoiled as if it were straight.
                for (worst, share) in worst.iter_mut().zip([1.0, front[3]]) {
                    let expected = share * front[k] + (1.0 - front[3]) * behind[k];
                    *worst = worst.max((own[k] - expected).abs() / expected.abs().max(1.0));
                }
            }
        }
        println!("{alpha:?}, {bits} bits: {worst:?}");
        assert!(worst[0] < within && worst[1] > 0.01, "{alpha:?}: {worst:?}");
    }
}

#[test]
fn light_over_a_background_that_is_light_is_tone_mapped_with_it_and_else_added_to_what_is_shown() {
    let color = [0.05, 0.2, 0.4];
    let mut behind = RadianceImage::new(SIZE).unwrap();
    behind
        .as_mut_slice()
        .chunks_exact_mut(4)
        .for_each(|pixel| pixel.copy_from_slice(&[0.05, 0.2, 0.4, 1.0]));
    let display = Display {
        exposure: Exposure::Stops(-4.0),
        bits: Some(16),
        ..Display::default()
    };
    let shown = |background: Background| {
        let display = Display {
            background: Some(background),
            ..display.clone()
        };
        light().tone_map(&display)
    };
    let of =
        |is_light: bool| Background::Image(BackgroundImage::new(behind.clone(), is_light).into());
    assert_eq!(shown(Background::Color(color)), shown(of(false)));
    let map = |light: [f32; 3]| display.tone_map.apply(light.map(|l| l / 16.0));
    let (lit, flat) = (shown(of(true)), shown(of(false)));
    let value = |picture: &energywave::DisplayImage, at: usize| {
        let pair = &picture.as_slice()[2 * at..2 * at + 2];
        f64::from(u16::from_ne_bytes([pair[0], pair[1]])) / 65535.0
    };
    for (i, pixel) in light().as_slice().chunks_exact(4).enumerate() {
        let own = [pixel[0], pixel[1], pixel[2]];
        let added = [0, 1, 2].map(|k| own[k] + color[k] as f32);
        for (k, behind) in color.into_iter().enumerate() {
            let expected = encoded(map(added)[k].into());
            assert!((value(&lit, 3 * i + k) - expected).abs() < 1e-4);
            let expected = encoded((f64::from(map(own)[k]) + behind).min(1.0));
            assert!((value(&flat, 3 * i + k) - expected).abs() < 1e-4);
        }
    }
    assert_ne!(lit, flat);
}

#[test]
fn files_of_every_format_say_what_they_hold() {
    let folder = Folder::new();
    let small = ["--device", "reference", "-q"];
    let draw = |name: &str, display: &str, more: &[&str]| {
        save(&folder, "scene.toml", &scene(display));
        folder.run(&[&["render", "scene.toml", "-o", name][..], &small, more].concat())
    };
    let at = |name: &str| folder.path().join(name);
    expect(&draw("a.webp", "alpha = \"luminance\"", &[]), 0, "");
    expect(&draw("a.png", "alpha = \"luminance\"", &[]), 0, "");
    assert_eq!(read(&at("a.webp")), read(&at("a.png"))); // nothing is lost
    for (name, quality) in [("fine.jpg", 95), ("coarse.jpeg", 5)] {
        expect(&draw(name, &format!("quality = {quality}"), &[]), 0, "");
        assert_eq!(read(&at(name)).color(), image::ColorType::Rgb8);
    }
    let bytes = |name: &str| fs::read(at(name)).unwrap();
    assert!(bytes("fine.jpg").len() > bytes("coarse.jpeg").len());
    expect(&draw("sixteen.png", "", &["--bits", "16"]), 0, "");
    assert_eq!(read(&at("sixteen.png")).color(), image::ColorType::Rgb16);
    expect(&draw("half.exr", "bits = 16", &[]), 0, "");
    expect(&draw("float.exr", "", &[]), 0, "");
    for (name, kind) in [
        ("half.exr", exr::prelude::SampleType::F16),
        ("float.exr", exr::prelude::SampleType::F32),
    ] {
        let meta = exr::prelude::MetaData::read_from_file(at(name), false).unwrap();
        let header = &meta.headers[0];
        assert!(
            header
                .channels
                .list
                .iter()
                .all(|channel| channel.sample_type == kind),
            "{name}"
        );
        let text = format!("{:?}", header.own_attributes);
        for word in [
            "energywave 0.",
            "scene.toml",
            "exact, tolerance 1e-3",
            "reference",
        ] {
            assert!(text.contains(word), "{name}: no {word} in {text}");
        }
    }
    let (half, float) = (
        RadianceImage::open(at("half.exr")),
        RadianceImage::open(at("float.exr")),
    );
    let (half, float) = (half.unwrap(), float.unwrap());
    let near = |half: f32, float: f32| (half - float).abs() <= float.abs() / 2048.0;
    let mut pairs = half.as_slice().iter().zip(float.as_slice());
    assert!(
        pairs
            .clone()
            .all(|(half, float)| near(*half, float.min(65504.0)))
    );
    assert!(pairs.any(|(half, float)| half != float));
}

#[test]
fn an_exposure_that_fits_the_picture_is_told_and_a_number_takes_its_place() {
    let folder = Folder::new();
    save(&folder, "auto.toml", &scene("exposure = \"auto\""));
    save(&folder, "fixed.toml", &scene("exposure = -20.0"));
    let draw = |file: &str, name: &str, more: &[&str]| {
        folder.run(
            &[
                &["render", file, "-o", name, "--device", "reference"][..],
                more,
            ]
            .concat(),
        )
    };
    let told = draw("auto.toml", "auto.png", &[]);
    let stops = light().auto_exposure();
    expect(&told, 0, &format!("exposure: {stops:.2} stops, by auto"));
    assert!(!stderr(&draw("auto.toml", "quiet.png", &["-q"])).contains("exposure"));
    expect(
        &draw("fixed.toml", "typed.png", &["--exposure", "auto"]),
        0,
        "by auto",
    );
    expect(
        &draw(
            "fixed.toml",
            "number.png",
            &["--exposure", &stops.to_string()],
        ),
        0,
        "",
    );
    let bytes = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(bytes("auto.png") == bytes("typed.png") && bytes("auto.png") == bytes("number.png"));
    expect(&draw("fixed.toml", "dark.png", &[]), 0, "");
    assert!(bytes("dark.png") != bytes("auto.png"));
    // A black picture has an exposure, too.
    save(
        &folder,
        "black.toml",
        "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\nray_length = 9\n",
    );
    expect(
        &draw(
            "black.toml",
            "black.png",
            &["--exposure", "auto", "--size", "8x8"],
        ),
        0,
        "exposure: 0.00 stops",
    );
}
