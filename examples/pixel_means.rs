//! Compares pixels with the means of 16x16 rays each, over scenes of files or random ones: prints for each which share
//! of the pixels is off by more than a hundredth (of itself, or of a thousandth of the brightest), which by more than a
//! tenth, and how much longer a frame takes than by one ray a pixel.
//!
//! `cargo run --release --example pixel_means -- [--random N] [--seed S] [--width N] [SCENE...]`: without scenes or
//! random ones those of `scenes/presets/`; a width of 0 is that of the scene. Scenes without depths only: 16x16 rays
//! would need finer ones.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use energywave::image::ImageSize;
use energywave::scene::{AnimatedScene, Antialias, Method, Profile};
use energywave::{Device, RadianceImage, Renderer, Scene};
use fastrand::Rng;

#[path = "../tests/common/random.rs"]
#[allow(dead_code)] // it is for tests
mod random;

/// Rays a side of a pixel.
const RAYS: u32 = 16;

/// What pixels may be off, how many of them, and below which share of the brightest they are measured by it.
const MOST_ERROR: f32 = 1e-2;
const MOST_WRONG: f64 = 1e-3;
const LEAST_LIGHT: f32 = 1e-3;

/// At which share of its time a scene is that moves.
const MOMENT: f64 = 0.4;

/// Rounds of which the least time counts.
const ROUNDS: usize = 3;

type Failure = Box<dyn std::error::Error>;

struct Arguments {
    random: u64,
    seed: u64,
    width: u32,
    scenes: Vec<PathBuf>,
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Failure> {
    let arguments = arguments()?;
    let mut scenes = Vec::new();
    for file in &arguments.scenes {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        let scene = read(file, arguments.width).map_err(|error| format!("{name}: {error}"))?;
        scenes.push((name.into_owned(), scene));
    }
    for seed in arguments.seed..arguments.seed + arguments.random {
        scenes.push((
            format!("random {seed}"),
            random_scene(seed, arguments.width),
        ));
    }
    let mut renderer = Renderer::new(&Device::best()?)?;
    println!(
        "| scene | off by a hundredth | by a tenth | time of one ray | |\n|---|---|---|---|---|"
    );
    let (mut over, count) = (0, scenes.len());
    let (mut wrong_pixels, mut pixels) = (0.0, 0.0);
    for (name, mut scene) in scenes {
        let truth = means(&mut renderer, &scene)?;
        let (image, time) = draw(&mut renderer, &scene)?;
        scene.integration.antialias = Antialias::None;
        let (_, of_one_ray) = draw(&mut renderer, &scene)?;
        let [wrong, far_off] =
            [MOST_ERROR, 10.0 * MOST_ERROR].map(|most| share_off(&image, &truth, most));
        let cost = time.as_secs_f64() / of_one_ray.as_secs_f64();
        let mark = if wrong > MOST_WRONG { "over" } else { "" };
        over += u32::from(wrong > MOST_WRONG);
        let of = image.size().pixels() as f64;
        (wrong_pixels, pixels) = (wrong_pixels + wrong * of, pixels + of);
        println!("| {name} | {wrong:.2e} | {far_off:.2e} | {cost:.2} | {mark} |");
    }
    println!(
        "\n{over} of {count} scenes have more than {MOST_WRONG} of their pixels off by {MOST_ERROR}; together they \
         have {:.2e}",
        wrong_pixels / pixels
    );
    Ok(())
}

fn arguments() -> Result<Arguments, Failure> {
    let mut arguments = Arguments {
        random: 0,
        seed: 1,
        width: 120,
        scenes: Vec::new(),
    };
    let mut given = std::env::args().skip(1);
    while let Some(word) = given.next() {
        let mut number =
            || -> Result<u32, Failure> { Ok(given.next().ok_or("a number is missing")?.parse()?) };
        match word.as_str() {
            "--random" => arguments.random = number()?.into(),
            "--seed" => arguments.seed = number()?.into(),
            "--width" => arguments.width = number()?,
            scene => arguments.scenes.push(scene.into()),
        }
    }
    if arguments.scenes.is_empty() && arguments.random == 0 {
        let presets = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/presets");
        for entry in std::fs::read_dir(presets)? {
            arguments.scenes.push(entry?.path());
        }
        arguments.scenes.sort();
    }
    Ok(arguments)
}

/// Reads a scene as it is drawn here.
fn read(file: &Path, width: u32) -> Result<Scene, Failure> {
    let scene = AnimatedScene::from_file(file)?;
    let time = scene.span().map_or(0.0, |span| MOMENT * span.seconds);
    let mut scene = scene.at(time)?;
    if scene.depth.is_some() {
        return Err("it has depths".into());
    }
    if width > 0 {
        let height =
            f64::from(width) * f64::from(scene.image.height) / f64::from(scene.image.width);
        (scene.image.width, scene.image.height) = (width, height.round().max(1.0) as u32);
    }
    scene.integration.antialias = Antialias::Footprint;
    scene.integration.method = Method::exact(1e-3);
    scene.display.bloom = None;
    Ok(scene)
}

/// Makes a scene of every kind of source, or several of one; cores are a tenth to four pixels thick, but for 1/q, whose
/// mean is finite without.
fn random_scene(seed: u64, width: u32) -> Scene {
    let mut scene = random::random_scene(seed, width.max(1));
    let mut random = Rng::with_seed(seed);
    let pixel = 2.0 * (0.5 * scene.camera.fov_y).to_radians().tan() / f64::from(scene.image.height);
    let near = pixel * scene.camera.eye.length();
    macro_rules! vary {
        ($($list:ident)*) => { $(for index in 0..scene.$list.len() {
            let source = &mut scene.$list[index];
            source.profile = [Profile::Inverse, Profile::InverseSquare, Profile::InverseCube][random.usize(0..3)];
            source.radius = near * 0.1 * 40.0_f64.powf(random.f64());
        })* };
    }
    vary!(spheres cylinders beams tori curves);
    scene.integration.antialias = Antialias::Footprint;
    scene.integration.method = Method::exact(1e-3);
    scene
}

/// Returns the means of many rays.
fn means(renderer: &mut Renderer, scene: &Scene) -> energywave::Result<RadianceImage> {
    let mut fine = scene.clone();
    let size = scene.image;
    fine.image = ImageSize {
        width: RAYS * size.width,
        height: RAYS * size.height,
    };
    fine.integration.antialias = Antialias::None;
    let rays = renderer.render(&fine)?;
    let mut image = RadianceImage::new(size)?;
    let share = 1.0 / (RAYS * RAYS) as f32;
    for (index, light) in rays.as_slice().chunks(4).enumerate() {
        let (column, row) = (
            index as u32 % fine.image.width,
            index as u32 / fine.image.width,
        );
        let pixel = (row / RAYS * size.width + column / RAYS) as usize;
        let sums = &mut image.as_mut_slice()[4 * pixel..];
        sums.iter_mut()
            .zip(light)
            .for_each(|(sum, value)| *sum += share * value);
    }
    Ok(image)
}

/// Draws a scene, and returns how long that takes, too.
fn draw(renderer: &mut Renderer, scene: &Scene) -> energywave::Result<(RadianceImage, Duration)> {
    let mut image = renderer.render(scene)?;
    let mut least = Duration::MAX;
    for _ in 0..ROUNDS {
        let begun = Instant::now();
        image = renderer.render(scene)?;
        least = least.min(begun.elapsed());
    }
    Ok((image, least))
}

/// Returns the share of pixels that are off by more than so much of themselves, in any channel.
fn share_off(image: &RadianceImage, truth: &RadianceImage, most: f32) -> f64 {
    let [found, expected] = [image, truth].map(|image| image.as_slice().as_chunks::<4>().0);
    let rgb = expected.iter().flat_map(|pixel| &pixel[..3]);
    let brightest = rgb.copied().fold(0.0, f32::max);
    let is_off = |(found, expected): &(&[f32; 4], &[f32; 4])| {
        let is_right = |channel: usize| {
            let error = (found[channel] - expected[channel]).abs();
            error <= most * expected[channel].abs().max(LEAST_LIGHT * brightest)
        };
        !(0..3).all(is_right)
    };
    found.iter().zip(expected).filter(is_off).count() as f64 / found.len() as f64
}
