//! `energywave bench --table 2013`: a wave that hits a box, by particles and by what they are drawn as.

use energywave::papers::TABLE_2013;
use energywave::scene::ParticleShape;
use serde::Serialize;

use super::bench::{prepare, save, time};
use super::records::{Origin, Spread};
use super::subcommands::BenchArguments;
use super::{Outcome, names, print};

/// A cell of the table of 2013, drawn in one way.
#[derive(Serialize)]
struct CollisionCell {
    table: u32,
    particles: usize,
    /// Balls, or balls and streaks, that were drawn.
    sprites: usize,
    /// Pixels across, and down.
    resolution: u32,
    height: u32,
    method: &'static str,
    fps: f64,
    paper_fps: f64,
    ratio: f64,
    kernel_ms: f64,
    simulation_ms: f64,
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
    let mut cells: Vec<CollisionCell> = Vec::new();
    for known in TABLE_2013 {
        for (method, shape) in [
            ("sprites", ParticleShape::Sprites),
            ("streaks", ParticleShape::Streaks),
        ] {
            if known.samples == 1 && method == "streaks" {
                continue; // of one sprite, which is a ball
            }
            let found = known.measure(&mut renderer, shape, time(arguments))?;
            let scene = known.scene(shape, 0);
            let file = format!(
                "collision-{}-{}-{}-{method}.exr",
                known.particles, known.samples, scene.image.width
            );
            save(arguments, &file, &found.speed, &scene)?;
            let cell = CollisionCell {
                table: 2013,
                particles: found.particles,
                sprites: found.elements,
                resolution: scene.image.width,
                height: scene.image.height,
                method,
                fps: found.speed.fps,
                paper_fps: known.paper_fps,
                ratio: found.speed.fps / known.paper_fps,
                kernel_ms: 1e3 * found.speed.kernel.as_secs_f64(),
                simulation_ms: 1e3 * found.simulation.as_secs_f64(),
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

fn print_cell(cell: &CollisionCell, is_first: bool) -> Outcome {
    if is_first {
        print(
            "particles sprites      size method        fps     paper   ratio  kernel ms  simulation ms\n",
        )?;
    }
    print(&format!(
        "{:>9} {:>7} {:>9} {:<8} {:>9.2} {:>9.2} {:>7.2} {:>10.3} {:>14.3}\n",
        cell.particles,
        cell.sprites,
        format!("{}x{}", cell.resolution, cell.height),
        cell.method,
        cell.fps,
        cell.paper_fps,
        cell.ratio,
        cell.kernel_ms,
        cell.simulation_ms
    ))
}
