//! Searches for scenes that break the promise that a tolerance is met (docs/accuracy.md): draws hard scenes by tiles
//! and by pixels, at tolerances from 1e-1 to 1e-5, and compares with the float64 reference.
//!
//! `cargo run --release --example hard_scenes -- [--seed 1] [--count 1000]`
//!
//! Prints a line for each miss and a summary by family; exit code 1 if any scene misses but by a documented limit.

mod check;
mod scenes;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::Parser;
use energywave::scene::Sampling;
use energywave::{Device, Renderer, RendererOptions, Result};

use check::{Checked, Found};
use scenes::{HardScene, families, hard_scene};

const TOLERANCES: [f64; 5] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5];

/// Searches for scenes that miss a tolerance.
#[derive(Parser)]
struct Arguments {
    /// Seed of all scenes.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of the first scene.
    #[arg(long, default_value_t = 0)]
    from: u64,
    /// Scenes to draw.
    #[arg(long, default_value_t = 1000)]
    count: u64,
    /// Draws only the scenes of these numbers.
    #[arg(long, value_name = "N", value_delimiter = ',')]
    only: Vec<u64>,
    /// Draws only scenes of this family.
    #[arg(long)]
    family: Option<String>,
    /// Draws only at this tolerance.
    #[arg(long)]
    tolerance: Option<f64>,
    /// Begins no further scene after so many seconds.
    #[arg(long)]
    seconds: Option<u64>,
    /// Writes the scenes that miss, as TOML, and where hidden their depths.
    #[arg(long, value_name = "FOLDER")]
    write: Option<PathBuf>,
    /// The OpenCL device, as for `energywave render`.
    #[arg(long, default_value = "cpu")]
    device: String,
}

/// What a family came to.
#[derive(Default, Clone)]
struct Tally {
    scenes: usize,
    images: usize,
    limits: usize,
    missing_scenes: usize,
    misses: [usize; TOLERANCES.len()],
}

fn main() -> ExitCode {
    match search(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("hard_scenes: {error}");
            ExitCode::from(2)
        }
    }
}

/// Returns whether every scene meets every tolerance.
fn search(arguments: &Arguments) -> Result<bool> {
    let mut options = RendererOptions::default();
    options.skips_self_test = true; // what is wrong is to be seen
    let mut renderer = Renderer::with_options(&Device::select(&arguments.device)?, &options)?;
    let begun = Instant::now();
    let is_over = || {
        let limit = arguments.seconds.map(Duration::from_secs);
        limit.is_some_and(|limit| begun.elapsed() >= limit)
    };
    let mut tallies = vec![Tally::default(); families().len()];
    let numbers = match arguments.only.is_empty() {
        true => (arguments.from..arguments.from + arguments.count).collect(),
        false => arguments.only.clone(),
    };
    for number in numbers {
        let index = number as usize % families().len();
        let is_wanted = |family: &String| families()[index].contains(family.as_str());
        if !arguments.family.as_ref().is_none_or(is_wanted) {
            continue;
        }
        if is_over() {
            println!("out of time before scene {number}");
            break;
        }
        let hard = hard_scene(arguments.seed, number);
        check_scene(arguments, number, &hard, &mut renderer, &mut tallies[index])?;
    }
    summarise(&tallies);
    Ok(tallies.iter().all(|tally| tally.missing_scenes == 0))
}

/// Draws a scene in all ways and tells what misses.
fn check_scene(
    arguments: &Arguments,
    number: u64,
    hard: &HardScene,
    renderer: &mut Renderer,
    tally: &mut Tally,
) -> Result<()> {
    let checked = Checked::new(hard)?;
    tally.scenes += 1;
    let mut misses = false;
    for sampling in [Sampling::Pixels, Sampling::Tiles] {
        for (index, tolerance) in TOLERANCES.into_iter().enumerate() {
            if arguments
                .tolerance
                .is_some_and(|wanted| wanted != tolerance)
            {
                continue;
            }
            let found = checked.draw(renderer, sampling, tolerance)?;
            tally.images += 1;
            if found.meets {
                continue;
            }
            println!("{}", line(arguments.seed, number, hard, &found));
            if found.is_limit {
                tally.limits += 1;
            } else {
                tally.misses[index] += 1;
                misses = true;
            }
        }
    }
    tally.missing_scenes += usize::from(misses);
    match &arguments.write {
        Some(folder) if misses || !arguments.only.is_empty() => {
            write(folder, arguments.seed, number, hard)
        }
        _ => Ok(()),
    }
}

fn line(seed: u64, number: u64, hard: &HardScene, found: &Found) -> String {
    let what = if found.is_limit { "limit" } else { "miss" };
    let HardScene { family, kind, .. } = hard;
    let Found {
        sampling,
        tolerance,
        max,
        p999,
        worst: (column, row),
        values: (drawn, expected),
        beyond: (some, far),
        ..
    } = found;
    let pixels = hard.scene.image.pixels();
    format!(
        "{what}: seed {seed} scene {number} ({family}, {kind:?}) by {sampling:?} at {tolerance:e}: worst {max:.2e} at \
         column {column}, row {row}: {drawn} not {expected}; 99.9 % {p999:.2e}; {some} pixels beyond the tolerance, \
         {far} beyond ten times, of {pixels}"
    )
}

/// Writes a scene, and its depths beside it.
fn write(folder: &std::path::Path, seed: u64, number: u64, hard: &HardScene) -> Result<()> {
    let mut scene = hard.scene.clone();
    let name = folder.join(format!("seed-{seed}-scene-{number}.toml"));
    if let Some(depth) = &scene.depth {
        let file = name.with_extension("exr");
        depth.save(&file)?;
        scene.depth = Some(energywave::image::DepthImage::open(&file, depth.along())?);
    }
    scene.save(name)
}

fn summarise(tallies: &[Tally]) {
    let tolerances = TOLERANCES
        .map(|tolerance| format!("{tolerance:>6.0e}"))
        .join("");
    println!("\nfamily                 scenes  images  missing  limits  misses at{tolerances}");
    let mut all = Tally::default();
    for (name, tally) in families().into_iter().zip(tallies) {
        print_row(name, tally);
        all.scenes += tally.scenes;
        all.images += tally.images;
        all.missing_scenes += tally.missing_scenes;
        all.limits += tally.limits;
        for (sum, misses) in all.misses.iter_mut().zip(tally.misses) {
            *sum += misses;
        }
    }
    print_row("all", &all);
}

fn print_row(name: &str, tally: &Tally) {
    let misses = tally.misses.map(|count| format!("{count:>6}")).join("");
    println!(
        "{name:<22} {:>6}  {:>6}  {:>7}  {:>6}           {misses}",
        tally.scenes, tally.images, tally.missing_scenes, tally.limits
    );
}
