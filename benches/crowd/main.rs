//! Crowds of points beside each point by itself, and beside a plain tree code: the table of `energywave bench --table
//! crowd`, what a tree takes for the same pictures, and a plot.
//!
//! `cargo bench --bench crowd` prints tables; `cargo bench --bench crowd -- benches/results/NAME` also writes NAME.md
//! and the plot NAME.svg. Some minutes, most of them for the truth.
#![allow(clippy::unwrap_used, clippy::panic)] // a bench that fails stops

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/plot.rs"]
mod plot;
mod tree;

use std::fmt::Write;
use std::process::{Command, Stdio};
use std::time::Instant;

use energywave::papers::crowd;
use energywave::reference::light_of_points;
use energywave::scene::{Profile, Ray};
use glam::DVec3;
use plot::Line;
use plotters::style::{Color, RGBColor};
use serde_json::Value;
use tree::Tree;

const PROFILES: [(&str, Profile); 2] = [
    ("inverse", Profile::Inverse),
    ("inverse-square", Profile::InverseSquare),
];

/// How many points a tree has.
const TREES: [u32; 4] = [1000, 10_000, 100_000, 1_000_000];

/// From so many on powers are fitted.
const FITTED_FROM: f64 = 1e4;

/// So many rows of neighbouring pixels a tree is asked for, and so many are in a row.
const ROWS: usize = 40;
const IN_A_ROW: usize = 16;

/// What 99.9 % of the pixels are within, the tolerance of the table; and how wide the nodes of trees may be for that,
/// by their distance.
const TOLERANCE: f64 = 1e-3;
const OPENINGS: [f64; 7] = [0.7, 0.5, 0.35, 0.25, 0.18, 0.125, 0.09];

/// A tree's picture.
struct Grown {
    profile: &'static str,
    count: u32,
    opening: f64,
    error: f64,
    evaluations: f64,
    build: f64,
    /// Of a whole frame, as of the pixels that were asked for.
    seconds: f64,
}

/// Runs the program's table.
fn table() -> Vec<Value> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_energywave"));
    command.args(["bench", "--table", "crowd", "--seconds", "1", "--json"]);
    let done = command.stderr(Stdio::inherit()).output().unwrap();
    assert!(done.status.success(), "{}", done.status);
    serde_json::from_slice(&done.stdout).unwrap()
}

fn grown(count: u32, (name, profile): (&'static str, Profile)) -> Grown {
    let scene = crowd(count, profile).unwrap();
    let (plane, pixels) = (scene.view_plane(), scene.image.pixels());
    let pixel = |k: usize| k / IN_A_ROW * (pixels / ROWS) + pixels / (2 * ROWS) + k % IN_A_ROW;
    let ray = |k: usize| {
        let pixel = pixel(k) as u32;
        plane.ray(pixel % scene.image.width, pixel / scene.image.width)
    };
    let rays: Vec<Ray> = (0..ROWS * IN_A_ROW).map(ray).collect();
    let truth = light_of_points(&scene, &rays);
    let begun = Instant::now();
    let tree = Tree::new(&scene.points[0], scene.decay.unwrap());
    let build = begun.elapsed().as_secs_f64();
    for opening in OPENINGS {
        let (lights, evaluations, seconds) = on_both_cores(&tree, &rays, opening);
        let error = |((light, truth), ray): ((&DVec3, &[f64; 3]), &Ray)| {
            let off = *light * ray.span.length() / DVec3::from(*truth) - 1.0;
            off.abs().max_element()
        };
        let both = lights.iter().zip(&truth).zip(&rays);
        let mut errors: Vec<f64> = both.map(error).collect();
        errors.sort_by(f64::total_cmp);
        let error = errors[errors.len() * 999 / 1000];
        if error <= TOLERANCE {
            let share = pixels as f64 / rays.len() as f64;
            return Grown {
                profile: name,
                count,
                opening,
                error,
                evaluations: evaluations as f64 * share,
                build,
                seconds: build + seconds * share,
            };
        }
    }
    panic!("no tree of {count} points is within {TOLERANCE:e}");
}

/// Returns what rays see, how many points and nodes that took, and the time.
fn on_both_cores(tree: &Tree, rays: &[Ray], opening: f64) -> (Vec<DVec3>, usize, f64) {
    let half = rays.len() / 2;
    let of = |rays: &[Ray]| {
        let mut evaluations = 0;
        let lights: Vec<DVec3> = (rays.iter())
            .map(|ray| tree.light(ray, opening, &mut evaluations))
            .collect();
        (lights, evaluations)
    };
    let begun = Instant::now();
    let ((mut lights, first), (others, second)) = std::thread::scope(|scope| {
        let other = scope.spawn(|| of(&rays[half..]));
        (of(&rays[..half]), other.join().unwrap())
    });
    let seconds = begun.elapsed().as_secs_f64();
    lights.extend(others);
    (lights, first + second, seconds)
}

fn is_of(row: &Value, profile: &str, method: &str) -> bool {
    let of = |key: &str| row[key].as_str().unwrap().to_owned();
    of("profile") == profile && of("method") == method && row["boxes"] == 0
}

fn lines(table: &[Value], trees: &[Grown]) -> Vec<Line> {
    let colors = [RGBColor(20, 70, 200), RGBColor(200, 80, 20)];
    let mut lines = Vec::new();
    for (label, shade) in [("crowd", 1.0), ("each by itself", 0.5), ("tree code", 0.25)] {
        for ((profile, _), color) in PROFILES.into_iter().zip(colors) {
            let points = match label {
                "tree code" => (trees.iter())
                    .filter(|tree| tree.profile == profile)
                    .map(|tree| (f64::from(tree.count), tree.seconds))
                    .collect(),
                _ => {
                    let method = if label == "crowd" { label } else { "apart" };
                    (table.iter())
                        .filter(|row| is_of(row, profile, method))
                        .map(|row| {
                            let of = |key: &str| row[key].as_f64().unwrap();
                            (of("points"), 1e-3 * of("median_ms"))
                        })
                        .collect()
                }
            };
            lines.push(Line {
                label: format!("{label}, {profile}"),
                color: color.mix(shade),
                points,
            });
        }
    }
    lines
}

fn text_of(table: &[Value], trees: &[Grown], lines: &[Line]) -> String {
    let mut text = String::new();
    let (device, _) = common::device();
    text += &common::header(&device, "cargo bench --bench crowd");
    let _ = writeln!(
        text,
        "\n`energywave bench --table crowd --seconds 1`: 1920x1080, a ray a pixel, tolerance 1e-3, `[[points]]` that \
         lie evenly in a ball seen from 4 away; times in milliseconds. Errors are relative to the float64 sum over all \
         points, of the worst colour, of {} pixels.\n\n\
         | points | profile | kind | median | least | sorting | cells | tiles | pixels | evaluations \
         | median error | 99.9 % within | greatest error |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|",
        table[0]["compared"]
    );
    for row in table {
        let of = |key: &str| row[key].as_f64().unwrap();
        let kind = match row["boxes"].as_u64().unwrap() {
            0 => row["method"].as_str().unwrap().to_owned(),
            boxes => format!("{boxes} boxes"),
        };
        let _ = writeln!(
            text,
            "| {} | {} | {kind} | {:.1} | {:.1} | {:.1} | {:.1} | {:.1} | {:.1} | {} | {:.1e} | {:.1e} | {:.1e} |",
            row["points"],
            row["profile"].as_str().unwrap(),
            of("median_ms"),
            of("least_ms"),
            of("sorting_ms"),
            of("cells_ms"),
            of("tiles_ms"),
            of("pixels_ms"),
            row["evaluations"],
            of("median_error"),
            of("error_of_999_in_1000"),
            of("greatest_error"),
        );
    }
    let _ = writeln!(
        text,
        "\nA plain tree code for the same pictures ([`benches/crowd/tree.rs`](../crowd/tree.rs)): an octree of which a \
         ray takes nodes that are narrow beside their distance as one point (Barnes, Hut 1986), float64, one closed \
         form after the other, on two threads. The widest opening that is within 1e-3; {} pixels were asked for, and \
         their time is taken for all.\n\n\
         | points | profile | width / distance | 99.9 % within | evaluations | build, s | frame, s |\n\
         |---|---|---|---|---|---|---|",
        ROWS * IN_A_ROW
    );
    for tree in trees {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.1e} | {:.2e} | {:.2} | {:.1} |",
            tree.count,
            tree.profile,
            tree.opening,
            tree.error,
            tree.evaluations,
            tree.build,
            tree.seconds
        );
    }
    let _ = writeln!(
        text,
        "\nFrom 10000 points on the time of a frame grows so:\n"
    );
    for line in lines {
        let large = |point: &&(f64, f64)| point.0 >= FITTED_FROM;
        let large: Vec<(f64, f64)> = line.points.iter().filter(large).copied().collect();
        if large.len() > 1 {
            let _ = writeln!(
                text,
                "* {}: with the power {:.2}",
                line.label,
                plot::power(&large)
            );
        }
    }
    text
}

fn main() {
    let table = table();
    let kinds = PROFILES
        .into_iter()
        .flat_map(|kind| TREES.map(|count| (count, kind)));
    let trees: Vec<Grown> = kinds.map(|(count, kind)| grown(count, kind)).collect();
    let lines = lines(&table, &trees);
    let mut text = text_of(&table, &trees, &lines);
    if let Some(stem) = std::env::args().skip(1).find(|a| !a.starts_with("--")) {
        let name = std::path::Path::new(&stem)
            .file_name()
            .unwrap()
            .to_str()
            .unwrap();
        let _ = writeln!(
            text,
            "\n![Seconds a frame against the number of points]({name}.svg)"
        );
        std::fs::write(format!("{stem}.md"), &text).unwrap();
        plot::plot(&format!("{stem}.svg"), "points", "seconds a frame", &lines);
    }
    println!("{text}");
}
