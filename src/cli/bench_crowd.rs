//! `energywave bench --table crowd`: points of light in a ball, from a thousand to a million, by both profiles.

use energywave::glam::DVec3;
use energywave::image::ImageSize;
use energywave::papers::turned;
use energywave::reference::light_of_points;
use energywave::scene::{Antialias, Camera, Decay, PointList, Points, Profile, Ray};
use energywave::{Error, RadianceImage, Scene};
use serde::Serialize;

use super::bench::{prepare, save, time};
use super::records::{Origin, Spread};
use super::subcommands::BenchArguments;
use super::{Outcome, names, print};

/// How many points.
const COUNTS: [u32; 4] = [1000, 10_000, 100_000, 1_000_000];

/// So many pixels are compared with the float64 sum over all points; of many points fewer, for a sum of so many terms.
const COMPARED: usize = 2000;
const LEAST_COMPARED: usize = 100;
const TERMS: usize = 50_000_000;

/// A number of points, drawn with one profile.
#[derive(Serialize)]
struct CrowdCell {
    table: &'static str,
    points: u32,
    profile: Profile,
    width: u32,
    height: u32,
    method: &'static str,
    fps: f64,
    kernel_ms: f64,
    /// Integrals of a frame: rays and points, or nodes that stand for points.
    evaluations: u64,
    /// Relative errors of pixels, of the worst colour of each.
    median_error: f64,
    error_of_999_in_1000: f64,
    greatest_error: f64,
    /// How the time of a frame grows from a tenth of the points: with this power of their number.
    exponent: Option<f64>,
    frame: u32,
    device: String,
    #[serde(flatten)]
    spread: Spread,
    #[serde(flatten)]
    origin: Origin,
}

pub fn run(arguments: &BenchArguments) -> Outcome {
    let (devices, mut renderer) = prepare(arguments)?;
    let origin = Origin::now(&devices);
    let mut cells: Vec<CrowdCell> = Vec::new();
    for (name, profile) in [
        ("inverse", Profile::Inverse),
        ("inverse-square", Profile::InverseSquare),
    ] {
        for points in COUNTS {
            let scene = scene(points, profile)?;
            let speed = energywave::papers::measure(&mut renderer, &scene, time(arguments))?;
            save(
                arguments,
                &format!("crowd-{name}-{points}.exr"),
                &speed,
                &scene,
            )?;
            let errors = errors(&turned(&scene, speed.frame), &speed.image);
            let spread: Spread = speed.times.into();
            let before = cells.last().filter(|cell| cell.profile == profile);
            let exponent = before.map(|it| (spread.median_ms / it.spread.median_ms).log10());
            let cell = CrowdCell {
                table: "crowd",
                points,
                profile,
                width: scene.image.width,
                height: scene.image.height,
                method: "crowd",
                fps: speed.fps,
                kernel_ms: 1e3 * speed.kernel.as_secs_f64(),
                evaluations: speed.cost.integrals,
                median_error: errors[errors.len() / 2],
                error_of_999_in_1000: errors[errors.len() * 999 / 1000],
                greatest_error: errors[errors.len() - 1],
                exponent,
                frame: speed.frame,
                device: names(&devices),
                spread,
                origin: origin.clone(),
            };
            if arguments.data.is_text() {
                print_cell(&cell, name, cells.is_empty())?;
            }
            cells.push(cell);
        }
    }
    arguments.data.print(&cells)
}

/// Makes points that lie evenly in a ball, seen from 4 away at 1920x1080.
fn scene(count: u32, profile: Profile) -> Result<Scene, Error> {
    // A sequence that fills the cube evenly (Roberts 2018): multiples of powers of the root of x^4 = x + 1.
    const ROOT: f64 = 1.220_744_084_605_759_5;
    let mut number = 0.0;
    let mut place = || loop {
        number += 1.0;
        let share = |power: i32| 2.0 * (number * ROOT.powi(-power)).fract() - 1.0;
        let place = DVec3::new(share(1), share(2), share(3));
        if place.length_squared() <= 1.0 {
            return place;
        }
    };
    let positions: Vec<DVec3> = (0..count).map(|_| place()).collect();
    let lights = (0..count).map(|k| {
        let warm = (k % 97) as f32 / 97.0;
        [1.0, 0.4 + 0.4 * warm, 0.2 + 0.7 * warm]
    });
    let mut points = Points::new(PointList::with_lights(positions, lights.collect())?);
    points.profile = profile;
    points.coefficient = 2.0 / f64::from(count);
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO));
    scene.camera.ray_length = Some(12.0);
    scene.image = ImageSize {
        width: 1920,
        height: 1080,
    };
    // Single rays, which have a truth.
    scene.integration.antialias = Antialias::None;
    scene.decay = Some(Decay::new(0.1, 0.1));
    scene.points.push(points);
    Ok(scene)
}

/// Returns the sorted errors of pixels that are spread evenly over a picture.
fn errors(scene: &Scene, image: &RadianceImage) -> Vec<f64> {
    let (plane, width) = (scene.view_plane(), scene.image.width);
    // Steps that meet every column.
    let pixel = |k: usize| (k * 1_000_003) % scene.image.pixels();
    let points: usize = scene.points.iter().map(|it| it.points.len()).sum();
    let compared = (TERMS / points.max(1)).clamp(LEAST_COMPARED, COMPARED);
    let pixels: Vec<usize> = (0..compared).map(pixel).collect();
    let ray = |index: &usize| plane.ray(*index as u32 % width, *index as u32 / width);
    let rays: Vec<Ray> = pixels.iter().map(ray).collect();
    let lights = light_of_points(scene, &rays);
    let error = |(index, light): (&usize, &[f64; 3])| {
        let found = &image.as_slice()[4 * index..];
        let off = |k: usize| (f64::from(found[k]) / light[k] - 1.0).abs();
        off(0).max(off(1)).max(off(2))
    };
    let mut errors: Vec<f64> = pixels.iter().zip(&lights).map(error).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

fn print_cell(cell: &CrowdCell, name: &str, is_first: bool) -> Outcome {
    if is_first {
        print(
            "   points profile              fps  median ms   evaluations   99.9 % within  exponent\n",
        )?;
    }
    print(&format!(
        "{:>9} {name:<14} {:>9.2} {:>10.1} {:>13} {:>15.1e} {:>9}\n",
        cell.points,
        cell.fps,
        cell.spread.median_ms,
        cell.evaluations,
        cell.error_of_999_in_1000,
        cell.exponent.map_or(String::new(), |it| format!("{it:.2}"))
    ))
}
