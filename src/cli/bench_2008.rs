//! `energywave bench --table 2008`: metaballs by number, size of the picture and method.

use energywave::papers::{Cell2008, methods_2008, table_2008};
use energywave::scene::MetaballMethod;
use energywave::{Renderer, RendererOptions};
use serde::Serialize;

use super::bench::{prepare, save, time};
use super::records::{Origin, Spread};
use super::subcommands::BenchArguments;
use super::{Outcome, names, print};

/// A cell of the table of 2008, by a method.
#[derive(Serialize)]
struct MetaballCell {
    table: u32,
    particles: u32,
    resolution: u32,
    view: &'static str,
    method: &'static str,
    /// Of sampling.
    interval: Option<f64>,
    samples: Option<u32>,
    fps: f64,
    paper_fps: f64,
    ratio: f64,
    /// The part of the rays that meet the surface, and of those the part that the method misses.
    hit: f64,
    holes: f64,
    /// A ray: places at which the summed field was taken, and fields of particles that were added up for it.
    passes: f64,
    pairs: f64,
    kernel_ms: f64,
    sort_ms: f64,
    frame: u32,
    device: String,
    #[serde(flatten)]
    spread: Spread,
    #[serde(flatten)]
    origin: Origin,
}

pub fn run(arguments: &BenchArguments) -> Outcome {
    let (devices, mut renderer) = prepare(arguments)?;
    let mut options = RendererOptions::default();
    options.counts_samples = true;
    options.skips_self_test = true; // those that draw have passed it
    let mut counting = Renderer::on_devices(&devices, &options)?;
    let origin = Origin::now(&devices);
    let mut cells: Vec<MetaballCell> = Vec::new();
    for known in table_2008() {
        for method in methods_2008() {
            let found = known.measure((&mut renderer, &mut counting), method, time(arguments))?;
            let (name, sampling) = match method {
                MetaballMethod::Sampling(sampling) => ("sampling", Some(sampling)),
                _ => ("exact", None),
            };
            let samples = sampling.map(|it| it.samples);
            let of_samples = samples.map_or(String::new(), |samples| format!("-{samples}"));
            let Cell2008 {
                particles,
                resolution,
                is_near,
                paper_fps,
            } = known;
            let view = if is_near { "near" } else { "far" };
            let file = format!("metaballs-{particles}-{resolution}-{view}-{name}{of_samples}.exr");
            save(arguments, &file, &found.speed, &known.scene(method)?)?;
            let cell = MetaballCell {
                table: 2008,
                particles,
                resolution,
                view,
                method: name,
                interval: sampling.and_then(|it| it.interval),
                samples,
                fps: found.speed.fps,
                paper_fps,
                ratio: found.speed.fps / paper_fps,
                hit: found.hit,
                holes: found.holes,
                passes: found.passes,
                pairs: found.pairs,
                kernel_ms: 1e3 * found.speed.kernel.as_secs_f64(),
                sort_ms: 1e3 * found.sort.as_secs_f64(),
                frame: found.speed.frame,
                device: names(&devices),
                spread: found.speed.times.into(),
                origin: origin.clone(),
            };
            if arguments.data.is_text() {
                print_cell(&cell, cells.is_empty())?;
            }
            cells.push(cell);
        }
    }
    arguments.data.print(&cells)
}

fn print_cell(cell: &MetaballCell, is_first: bool) -> Outcome {
    if is_first {
        print(
            "particles resolution view method   samples       fps     paper   ratio    hit  holes passes   pairs  \
             kernel ms  sort ms\n",
        )?;
    }
    let samples = cell
        .samples
        .map_or(String::new(), |samples| samples.to_string());
    print(&format!(
        "{:>9} {:>10} {:<4} {:<8} {:>7} {:>9.2} {:>9.2} {:>7.2} {:>5.1}% {:>5.1}% {:>6.1} {:>7.1} {:>10.3} {:>8.3}\n",
        cell.particles,
        cell.resolution,
        cell.view,
        cell.method,
        samples,
        cell.fps,
        cell.paper_fps,
        cell.ratio,
        100.0 * cell.hit,
        100.0 * cell.holes,
        cell.passes,
        cell.pairs,
        cell.kernel_ms,
        cell.sort_ms
    ))
}
