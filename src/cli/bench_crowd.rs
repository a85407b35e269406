//! `energywave bench --table crowd`: points of light in a ball, from a thousand to three million, by both profiles, and
//! behind a hundred boxes.

use energywave::glam::DVec3;
use energywave::image::{DepthAlong, DepthImage, ImageSize};
use energywave::papers::turned;
use energywave::reference::light_of_points_up_to;
use energywave::scene::{Antialias, Camera, Decay, PointList, Points, Profile, Ray};
use energywave::{Error, RadianceImage, Scene};
use serde::Serialize;

use super::bench::{prepare, save, time};
use super::records::{Origin, Spread};
use super::subcommands::BenchArguments;
use super::{Outcome, names, print};

/// How many points.
const COUNTS: [u32; 5] = [1000, 10_000, 100_000, 1_000_000, 3_000_000];

/// How many of them are drawn behind boxes, too.
const BEHIND_BOXES: [u32; 2] = [100_000, 1_000_000];
const BOXES: u32 = 100;

/// So many pixels are compared with the float64 sum over all points.
const COMPARED: usize = 2000;

/// A number of points, drawn with one profile.
#[derive(Serialize)]
struct CrowdCell {
    table: &'static str,
    points: u32,
    profile: Profile,
    /// In the depth image that ends rays; 0: they are whole.
    boxes: u32,
    width: u32,
    height: u32,
    method: &'static str,
    fps: f64,
    kernel_ms: f64,
    /// What the stages of the last frame took: seeing and sorting on the host, kernels over cells, tiles and pixels.
    sorting_ms: f64,
    cells_ms: f64,
    tiles_ms: f64,
    pixels_ms: f64,
    /// Integrals of a frame: rays and points, or nodes that stand for points.
    evaluations: u64,
    /// Relative errors of pixels, of the worst colour of each.
    compared: usize,
    median_error: f64,
    error_of_999_in_1000: f64,
    greatest_error: f64,
    /// How the time of a frame grows from the cell before: with this power of the number of points.
    exponent: Option<f64>,
    /// How many times as long as without boxes.
    times: Option<f64>,
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
    let open = COUNTS.map(|count| (count, 0)).into_iter();
    let kinds = open.chain(BEHIND_BOXES.map(|count| (count, BOXES)));
    for (name, profile) in [
        ("inverse", Profile::Inverse),
        ("inverse-square", Profile::InverseSquare),
    ] {
        for (points, boxes) in kinds.clone() {
            let mut scene = scene(points, profile)?;
            if boxes > 0 {
                scene.depth = Some(depths_of_boxes(&scene, boxes)?);
            }
            let speed = energywave::papers::measure(&mut renderer, &scene, time(arguments))?;
            let kind = if boxes > 0 { "-boxes" } else { "" };
            let file = format!("crowd-{name}-{points}{kind}.exr");
            save(arguments, &file, &speed, &scene)?;
            let errors = errors(&turned(&scene, speed.frame), &speed.image);
            let spread: Spread = speed.times.into();
            let (mut exponent, mut times) = (None, None);
            if boxes == 0 {
                let before = cells.last().filter(|cell| cell.profile == profile);
                exponent = before.map(|it| {
                    let growth = (spread.median_ms / it.spread.median_ms).ln();
                    growth / (f64::from(points) / f64::from(it.points)).ln()
                });
            } else {
                let is_open = |it: &&CrowdCell| (it.points, it.profile) == (points, profile);
                let open = cells.iter().find(is_open);
                times = open.map(|it| spread.median_ms / it.spread.median_ms);
            }
            let crowds = speed.cost.crowds;
            let stages = [crowds.sorting, crowds.cells, crowds.tiles, crowds.pixels];
            let [sorting_ms, cells_ms, tiles_ms, pixels_ms] =
                stages.map(|stage| 1e3 * stage.as_secs_f64());
            let cell = CrowdCell {
                table: "crowd",
                points,
                profile,
                boxes,
                width: scene.image.width,
                height: scene.image.height,
                method: "crowd",
                fps: speed.fps,
                kernel_ms: 1e3 * speed.kernel.as_secs_f64(),
                sorting_ms,
                cells_ms,
                tiles_ms,
                pixels_ms,
                evaluations: speed.cost.integrals,
                compared: errors.len(),
                median_error: errors[errors.len() / 2],
                error_of_999_in_1000: errors[errors.len() * 999 / 1000],
                greatest_error: errors[errors.len() - 1],
                exponent,
                times,
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

/// Returns numbers that lie evenly in a cube from -1 to 1: multiples of powers of the root of x^4 = x + 1 (Roberts
/// 2018).
fn even(number: f64) -> DVec3 {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    let share = |power: i32| 2.0 * (number * ROOT.powi(-power)).fract() - 1.0;
    DVec3::new(share(1), share(2), share(3))
}

/// Makes points that lie evenly in a ball, seen from 4 away at 1920x1080.
fn scene(count: u32, profile: Profile) -> Result<Scene, Error> {
    let mut number = 0.0;
    let mut place = || loop {
        number += 1.0;
        let place = even(number);
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

/// Returns how far from the eye rays meet boxes that lie evenly in and around the ball.
fn depths_of_boxes(scene: &Scene, count: u32) -> Result<DepthImage, Error> {
    let boxes: Vec<(DVec3, DVec3)> = (0..count)
        .map(|number| {
            let (middle, size) = (even(f64::from(number)), even(f64::from(number) + 0.5));
            let half = 0.12 * size.abs() + 0.03;
            (1.6 * middle - half, 1.6 * middle + half)
        })
        .collect();
    let (plane, size) = (scene.view_plane(), scene.image);
    let length = |index: usize| {
        let ray = plane.ray(index as u32 % size.width, index as u32 / size.width);
        let toward = (ray.origin - plane.eye).normalize();
        let hit = |(low, high): &(DVec3, DVec3)| {
            let (a, b) = ((*low - plane.eye) / toward, (*high - plane.eye) / toward);
            let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
            (enter <= leave && enter > 0.0).then_some(enter)
        };
        let lengths = boxes.iter().filter_map(hit);
        lengths.fold(f64::INFINITY, f64::min) as f32
    };
    DepthImage::new(
        size,
        DepthAlong::Ray,
        (0..size.pixels()).map(length).collect(),
    )
}

/// Returns the sorted errors of pixels that are spread evenly over a picture.
fn errors(scene: &Scene, image: &RadianceImage) -> Vec<f64> {
    let (plane, width) = (scene.view_plane(), scene.image.width);
    // Steps that meet every column.
    let pixel = |k: usize| (k * 1_000_003) % scene.image.pixels();
    let pixels: Vec<usize> = (0..COMPARED).map(pixel).collect();
    let up_to = |index: &usize| -> (Ray, f64) {
        let ray = plane.ray(*index as u32 % width, *index as u32 / width);
        let depth = scene.depth.as_ref();
        let end = depth.map_or(1.0, |it| plane.end(&ray, it.as_slice()[*index], it.along()));
        (ray, end)
    };
    let rays: Vec<(Ray, f64)> = pixels.iter().map(up_to).collect();
    let lights = light_of_points_up_to(scene, &rays);
    let error = |(index, light): (&usize, &[f64; 3])| {
        let found = &image.as_slice()[4 * index..];
        let off = |k: usize| match light[k] > 0.0 {
            true => (f64::from(found[k]) / light[k] - 1.0).abs(),
            false => f64::from(found[k]).abs(),
        };
        off(0).max(off(1)).max(off(2))
    };
    let mut errors: Vec<f64> = pixels.iter().zip(&lights).map(error).collect();
    errors.sort_by(f64::total_cmp);
    errors
}

fn print_cell(cell: &CrowdCell, name: &str, is_first: bool) -> Outcome {
    if is_first {
        print("   points profile        boxes  median ms  sort cells tiles pixels   evaluations")?;
        print("  99.9 % within  exponent\n")?;
    }
    let growth = match (cell.exponent, cell.times) {
        (Some(exponent), _) => format!("{exponent:.2}"),
        (_, Some(times)) => format!("{times:.2} times"),
        _ => String::new(),
    };
    print(&format!(
        "{:>9} {name:<14} {:>5} {:>10.1} {:>5.0} {:>5.0} {:>5.0} {:>6.0} {:>13} {:>14.1e} {growth:>9}\n",
        cell.points,
        cell.boxes,
        cell.spread.median_ms,
        cell.sorting_ms,
        cell.cells_ms,
        cell.tiles_ms,
        cell.pixels_ms,
        cell.evaluations,
        cell.error_of_999_in_1000,
    ))
}
