//! Looks for flicker: over every scene a camera pans by a tenth of a pixel a frame, by tiles and by exact pixels.
//! Prints for each by how much a pixel changes otherwise by tiles than by pixels from frame to frame, at most (of its
//! light, or of a thousandth of the brightest), the same of 99.9 % of the pixels of any frame, and by how much of
//! itself all light changes in a frame.
//!
//! `cargo run --release --example flicker -- [--frames N] [--width N] [SCENE...]`: without scenes those of `scenes/`
//! and `scenes/presets/`; a width of 0 is that of the scene. Pixels are means over their squares, light is exact to
//! 1e-3, and there is no bloom.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use energywave::image::ImageSize;
use energywave::scene::{AnimatedScene, Antialias, Camera, Method, Sampling};
use energywave::{Device, RadianceImage, Renderer, Scene};
use glam::{DQuat, DVec2};

/// What may be seen of neither: the bars of `tests/image/flicker.rs`.
const MOST_POP: f32 = 2e-3;
const MOST_CHANGE: f64 = 1e-3;

/// Pixels below this share of the brightest are measured by it.
const LEAST_LIGHT: f32 = 1e-3;

/// Pixels from one frame to the next, by which the camera turns to the right and up.
const STEP: DVec2 = DVec2::new(0.1, 0.03);

/// At which share of its time a scene is that moves.
const MOMENT: f64 = 0.4;

type Failure = Box<dyn std::error::Error>;

struct Arguments {
    frames: u32,
    width: u32,
    scenes: Vec<PathBuf>,
}

/// What a pan over a scene shows.
#[derive(Default)]
struct Found {
    pop: f32,
    /// Of 99.9 % of the pixels.
    pop_999: f32,
    /// By tiles.
    change: f64,
    /// By which all light changes more, or less, by tiles than by pixels.
    beside: f64,
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
    let mut renderer = Renderer::new(&Device::best()?)?;
    println!(
        "| scene | pop | of 99.9 % | change of all light | beside that of pixels | |\n|---|---|---|---|---|---|"
    );
    let mut over = 0;
    for file in &arguments.scenes {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        let found =
            pan(&mut renderer, &arguments, file).map_err(|error| format!("{name}: {error}"))?;
        let is_over = found.pop >= MOST_POP || found.change >= MOST_CHANGE;
        over += u32::from(is_over);
        let mark = if is_over { "over" } else { "" };
        let Found {
            pop,
            pop_999,
            change,
            beside,
        } = found;
        println!("| {name} | {pop:.1e} | {pop_999:.1e} | {change:.1e} | {beside:.1e} | {mark} |");
    }
    println!(
        "\n{over} of {} scenes are over {MOST_POP} or {MOST_CHANGE}",
        arguments.scenes.len()
    );
    Ok(())
}

fn arguments() -> Result<Arguments, Failure> {
    let mut arguments = Arguments {
        frames: 60,
        width: 128,
        scenes: Vec::new(),
    };
    let mut given = std::env::args().skip(1);
    while let Some(word) = given.next() {
        let mut number =
            || -> Result<u32, Failure> { Ok(given.next().ok_or("a number is missing")?.parse()?) };
        match word.as_str() {
            "--frames" => arguments.frames = number()?,
            "--width" => arguments.width = number()?,
            scene => arguments.scenes.push(scene.into()),
        }
    }
    if arguments.scenes.is_empty() {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        for folder in [scenes.clone(), scenes.join("presets")] {
            for entry in std::fs::read_dir(folder)? {
                let path = entry?.path();
                if path.extension().is_some_and(|ending| ending == "toml") {
                    arguments.scenes.push(path);
                }
            }
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
    // Depths are as many as the pixels.
    if scene.depth.is_none() && width > 0 {
        let height =
            f64::from(width) * f64::from(scene.image.height) / f64::from(scene.image.width);
        (scene.image.width, scene.image.height) = (width, height.round().max(1.0) as u32);
    }
    scene.integration.antialias = Antialias::Footprint;
    scene.display.bloom = None;
    Ok(scene)
}

fn pan(renderer: &mut Renderer, arguments: &Arguments, file: &Path) -> Result<Found, Failure> {
    let mut scene = read(file, arguments.width)?;
    let mut found = Found::default();
    let mut before: Option<[RadianceImage; 2]> = None;
    let camera = scene.camera.clone();
    for number in 0..arguments.frames {
        scene.camera = turned(&camera, scene.image, f64::from(number) * STEP);
        let mut draw = |sampling| {
            scene.integration.method = Method::Exact {
                tolerance: 1e-3,
                sampling,
            };
            renderer.render(&scene)
        };
        let now = [draw(Sampling::Tiles)?, draw(Sampling::Pixels)?];
        if let Some(before) = &before {
            let pops = pops(before, &now);
            let most = pops.len() - 1;
            found.pop = found.pop.max(pops[most]);
            found.pop_999 = found.pop_999.max(pops[most - pops.len() / 1000]);
            let [tiles, pixels] = [0, 1].map(|by| light(&now[by]) / light(&before[by]) - 1.0);
            found.change = found.change.max(tiles.abs());
            found.beside = found.beside.max((tiles - pixels).abs());
        }
        before = Some(now);
    }
    Ok(found)
}

/// Turns a camera by so many pixels of the middle of its picture.
fn turned(camera: &Camera, image: ImageSize, pixels: DVec2) -> Camera {
    let way = camera.target - camera.eye;
    let right = way.cross(camera.up).normalize();
    let pixel = 2.0 * (0.5 * camera.fov_y).to_radians().tan() / f64::from(image.height);
    let turn = DQuat::from_axis_angle(camera.up.normalize(), -pixel * pixels.x)
        * DQuat::from_axis_angle(right, pixel * pixels.y);
    Camera {
        target: camera.eye + turn * way,
        ..camera.clone()
    }
}

/// Returns by how much pixels change more, or less, by tiles than by pixels, the least first.
fn pops(before: &[RadianceImage; 2], now: &[RadianceImage; 2]) -> Vec<f32> {
    let [[tiles, pixels], [next_tiles, next_pixels]] =
        [before, now].map(|images| [images[0].as_slice(), images[1].as_slice()]);
    let brightest = pixels.iter().copied().fold(0.0, f32::max);
    let changes = (0..tiles.len()).map(|i| {
        let change = (next_tiles[i] - tiles[i]) - (next_pixels[i] - pixels[i]);
        change.abs() / next_pixels[i].abs().max(LEAST_LIGHT * brightest)
    });
    let mut changes: Vec<f32> = changes.collect();
    changes.sort_by(f32::total_cmp);
    changes
}

/// Returns the sum of all light.
fn light(image: &RadianceImage) -> f64 {
    let pixels = image.as_slice().chunks_exact(4);
    pixels
        .map(|pixel| f64::from(pixel[0] + pixel[1] + pixel[2]))
        .sum()
}
