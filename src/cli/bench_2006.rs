//! `energywave bench --table 2006`: the beam of 2006 by ray casting, by slices, along rays and as a billboard.

use energywave::papers::{Method2006, beam_2006, table_2006};
use energywave::volume::Texture;
use serde::Serialize;

use super::bench::{prepare, save, time};
use super::records::{Origin, Spread};
use super::subcommands::BenchArguments;
use super::{Outcome, names, print};

/// A cell of the table of 2006.
#[derive(Serialize)]
struct VolumeCell {
    table: u32,
    method: &'static str,
    resolution: u32,
    /// Along the beam, and in all; of ray casting there are none.
    cells: Option<u32>,
    cells_in_all: Option<u64>,
    fps: f64,
    kernel_ms: f64,
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
    let mut textures: Vec<(u32, Texture)> = Vec::new();
    let mut cells: Vec<VolumeCell> = Vec::new();
    for known in table_2006() {
        let count = known.cells.max(1);
        let texture = match textures.iter().find(|(of, _)| *of == count) {
            Some((_, texture)) => texture.clone(),
            None => {
                let texture = beam_2006(&mut renderer, count)?;
                textures.push((count, texture.clone()));
                texture
            }
        };
        let speed = known.measure(&mut renderer, &texture, time(arguments))?;
        let has_cells = known.method != Method2006::RayCasting;
        let name = known.method.name();
        let of_cells = match has_cells {
            true => format!("-{count}"),
            false => String::new(),
        };
        let file = format!("beam-{name}-{}{of_cells}.exr", known.resolution);
        save(arguments, &file, &speed, &known.scene(&texture))?;
        let in_all = texture.cells().map(u64::from).iter().product();
        let cell = VolumeCell {
            table: 2006,
            method: name,
            resolution: known.resolution,
            cells: has_cells.then_some(count),
            cells_in_all: has_cells.then_some(in_all),
            fps: speed.fps,
            kernel_ms: 1e3 * speed.kernel.as_secs_f64(),
            frame: speed.frame,
            device: names(&devices),
            spread: speed.times.into(),
            origin: origin.clone(),
        };
        if arguments.data.is_text() {
            print_cell(&cell, cells.is_empty())?;
        }
        cells.push(cell);
    }
    arguments.data.print(&cells)
}

fn print_cell(cell: &VolumeCell, is_first: bool) -> Outcome {
    if is_first {
        print("method      resolution cells   in all        fps  kernel ms\n")?;
    }
    let or_none = |number: Option<u64>| number.map_or(String::new(), |it| it.to_string());
    print(&format!(
        "{:<11} {:>10} {:>5} {:>8} {:>10.2} {:>10.3}\n",
        cell.method,
        cell.resolution,
        or_none(cell.cells.map(u64::from)),
        or_none(cell.cells_in_all),
        cell.fps,
        cell.kernel_ms
    ))
}
