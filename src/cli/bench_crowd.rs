//! `energywave bench --table crowd`: points of light in a ball, from a thousand to three million, by both profiles,
//! behind a hundred boxes, and each by itself.

use energywave::papers::{crowd, depths_of_boxes, turned};
use energywave::reference::light_of_points_up_to;
use energywave::scene::{Crowd, Profile, Ray};
use energywave::{RadianceImage, Scene};
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

/// How many are drawn each by itself, too.
const APART: [u32; 2] = [1000, 10_000];

/// From so many on the growth of the time is fitted.
const FITTED_FROM: u32 = 10_000;

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
    /// All together, `crowd`, or each by itself, `apart`.
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
    /// Memory on the device and to sort on the host, besides the list of points.
    bytes: u64,
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
    let open = COUNTS.map(|count| (count, 0, "crowd")).into_iter();
    let behind = BEHIND_BOXES.map(|count| (count, BOXES, "crowd"));
    let apart = APART.map(|count| (count, 0, "apart"));
    let kinds = open.chain(behind).chain(apart);
    for (name, profile) in [
        ("inverse", Profile::Inverse),
        ("inverse-square", Profile::InverseSquare),
    ] {
        for (points, boxes, method) in kinds.clone() {
            let mut scene = crowd(points, profile)?;
            if boxes > 0 {
                scene.depth = Some(depths_of_boxes(&scene, boxes)?);
            }
            if method == "apart" {
                scene.integration.crowd = Crowd::Never;
            }
            let speed = energywave::papers::measure(&mut renderer, &scene, time(arguments))?;
            let kind = match (boxes, method) {
                (0, "crowd") => "",
                (0, _) => "-apart",
                _ => "-boxes",
            };
            let file = format!("crowd-{name}-{points}{kind}.exr");
            save(arguments, &file, &speed, &scene)?;
            let errors = errors(&turned(&scene, speed.frame), &speed.image);
            let spread: Spread = speed.times.into();
            let (mut exponent, mut times) = (None, None);
            if boxes == 0 {
                let before = cells
                    .last()
                    .filter(|it| (it.profile, it.method, it.boxes) == (profile, method, 0));
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
                method,
                fps: speed.fps,
                kernel_ms: 1e3 * speed.kernel.as_secs_f64(),
                sorting_ms,
                cells_ms,
                tiles_ms,
                pixels_ms,
                evaluations: speed.cost.integrals,
                bytes: crowds.bytes,
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
        if arguments.data.is_text() {
            let growth = growth(&cells, profile);
            print(&format!(
                "{name}: from {FITTED_FROM} points on time grows with the power {growth:.2} of their number\n"
            ))?;
        }
    }
    arguments.data.print(&cells)
}

/// Returns with which power of their number the time of crowds grows, by least squares of the logarithms.
fn growth(cells: &[CrowdCell], profile: Profile) -> f64 {
    let is_fitted = |it: &&CrowdCell| {
        let is_open_crowd = it.method == "crowd" && it.boxes == 0 && it.profile == profile;
        is_open_crowd && it.points >= FITTED_FROM
    };
    let logs: Vec<(f64, f64)> = cells
        .iter()
        .filter(is_fitted)
        .map(|it| (f64::from(it.points).ln(), it.spread.median_ms.ln()))
        .collect();
    let count = logs.len() as f64;
    let middle = logs.iter().fold((0.0, 0.0), |sum, (x, y)| {
        (sum.0 + x / count, sum.1 + y / count)
    });
    let product = |other: fn(f64, f64) -> f64| -> f64 {
        let terms = logs
            .iter()
            .map(|(x, y)| (x - middle.0) * other(x - middle.0, y - middle.1));
        terms.sum()
    };
    product(|_, y| y) / product(|x, _| x)
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
        print(
            "   points profile        kind       median ms  sort cells tiles pixels   evaluations",
        )?;
        print("  99.9 % within  exponent\n")?;
    }
    let growth = match (cell.exponent, cell.times) {
        (Some(exponent), _) => format!("{exponent:.2}"),
        (_, Some(times)) => format!("{times:.2} times"),
        _ => String::new(),
    };
    let kind = match cell.boxes {
        0 => cell.method.to_owned(),
        boxes => format!("{boxes} boxes"),
    };
    print(&format!(
        "{:>9} {name:<14} {kind:<9} {:>10.1} {:>5.0} {:>5.0} {:>5.0} {:>6.0} {:>13} {:>14.1e} {growth:>9}\n",
        cell.points,
        cell.spread.median_ms,
        cell.sorting_ms,
        cell.cells_ms,
        cell.tiles_ms,
        cell.pixels_ms,
        cell.evaluations,
        cell.error_of_999_in_1000,
    ))
}
