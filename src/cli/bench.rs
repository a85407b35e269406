//! `energywave bench`: the paper's tables, or the speed of a scene.

use std::path::Path;
use std::time::Duration;

use energywave::bench::{DIVISIONS, RESOLUTIONS, Speed, Table, exact_cost, measure};
use energywave::image::Output;
use energywave::scene::{Method, Sampling};
use energywave::{Device, DeviceType, Error, Renderer, Scene};
use serde::Serialize;

use super::args::BenchArguments;
use super::{Outcome, choose_device, note, print, print_json};

/// A cell of a table.
#[derive(Serialize)]
struct Cell {
    table: u32,
    field: &'static str,
    resolution: u32,
    divisions: u32,
    fps: f64,
    paper_fps: f64,
    ratio: f64,
    kernel_ms: f64,
    frame: u32,
    device: String,
}

/// A scene.
#[derive(Serialize)]
struct SceneSpeed {
    scene: String,
    width: u32,
    height: u32,
    method: Method,
    sampling: Sampling,
    fps: f64,
    kernel_ms: f64,
    evaluations: u64,
    field_evaluations: u64,
    frame: u32,
    device: String,
}

pub fn run(arguments: &BenchArguments) -> Outcome {
    match &arguments.scene {
        Some(path) => bench_scene(arguments, path),
        None => bench_tables(arguments),
    }
}

fn bench_tables(arguments: &BenchArguments) -> Outcome {
    if !arguments.overrides.is_empty() {
        let message = "the tables have sizes, method and divisions of their own; give a scene to measure with others";
        return Err(Error::Unsupported(message.to_owned()).into());
    }
    let tables = match arguments.table {
        Some(2) => vec![Table::Torus],
        Some(_) => vec![Table::Bezier],
        None => vec![Table::Torus, Table::Bezier],
    };
    let (device, mut renderer) = prepare(arguments)?;
    let mut cells = Vec::new();
    for table in tables {
        for (row, resolution) in RESOLUTIONS.into_iter().enumerate() {
            for (column, divisions) in DIVISIONS.into_iter().enumerate() {
                let scene = table.scene(resolution, divisions);
                let speed = measure(&mut renderer, &scene, time(arguments))?;
                let name = format!("{}-{resolution}-{divisions}.exr", table.field());
                save(arguments, &name, &speed, &scene)?;
                let paper_fps = table.paper_fps()[row][column];
                let cell = Cell {
                    table: table.number(),
                    field: table.field(),
                    resolution,
                    divisions,
                    fps: speed.fps,
                    paper_fps,
                    ratio: speed.fps / paper_fps,
                    kernel_ms: 1e3 * speed.kernel.as_secs_f64(),
                    frame: speed.frame,
                    device: device.name.clone(),
                };
                if !arguments.json {
                    print_cell(&cell, cells.is_empty())?;
                }
                cells.push(cell);
            }
        }
    }
    if arguments.json {
        print_json(&cells)?;
    }
    Ok(())
}

/// One row of the text table; a cell takes a second, so that each is printed at once.
fn print_cell(cell: &Cell, is_first: bool) -> Outcome {
    if is_first {
        print(
            "table field   resolution divisions       fps     paper   ratio  kernel ms  besides ms\n",
        )?;
    }
    print(&format!(
        "{:>5} {:<8} {:>9} {:>9} {:>9.2} {:>9.2} {:>7.2} {:>10.3} {:>11.3}\n",
        cell.table,
        cell.field,
        cell.resolution,
        cell.divisions,
        cell.fps,
        cell.paper_fps,
        cell.ratio,
        cell.kernel_ms,
        1e3 / cell.fps - cell.kernel_ms
    ))
}

fn bench_scene(arguments: &BenchArguments, path: &Path) -> Outcome {
    let mut scene = Scene::from_file(path)?;
    arguments.overrides.apply(&mut scene)?;
    scene.validate()?;
    let (device, mut renderer) = prepare(arguments)?;
    let speed = measure(&mut renderer, &scene, time(arguments))?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    save(arguments, &format!("{stem}.exr"), &speed, &scene)?;
    let cost = match (scene.integration.method, device.device_type) {
        (Method::Simpson, _) | (_, DeviceType::Reference) => speed.cost,
        (Method::Exact, _) => exact_cost(&device, &scene)?,
    };
    let record = SceneSpeed {
        scene: path.display().to_string(),
        width: scene.image.width,
        height: scene.image.height,
        method: scene.integration.method,
        sampling: scene.sampling(),
        fps: speed.fps,
        kernel_ms: 1e3 * speed.kernel.as_secs_f64(),
        evaluations: cost.evaluations,
        field_evaluations: cost.field_evaluations,
        frame: speed.frame,
        device: device.name,
    };
    if arguments.json {
        return print_json(&record);
    }
    print(&format!(
        "{}: {:.2} frames a second at {}x{}, {:.3} ms in kernels; {} integrals, {} samples a frame\n",
        record.scene,
        record.fps,
        record.width,
        record.height,
        record.kernel_ms,
        record.evaluations,
        record.field_evaluations
    ))
}

fn prepare(arguments: &BenchArguments) -> Result<(Device, Renderer), super::Failure> {
    if let Some(folder) = &arguments.frames_out {
        std::fs::create_dir_all(folder).map_err(|error| Error::Output {
            path: folder.clone(),
            reason: error.to_string(),
        })?;
    }
    let device = choose_device(arguments.device.device.as_deref())?;
    let renderer = Renderer::new(&device)?;
    note(&format!("a cell takes {} s", arguments.seconds));
    Ok((device, renderer))
}

fn time(arguments: &BenchArguments) -> Duration {
    Duration::from_secs_f64(arguments.seconds)
}

/// Writes the last frame if frames are wanted.
fn save(arguments: &BenchArguments, name: &str, speed: &Speed, scene: &Scene) -> Outcome {
    if let Some(folder) = &arguments.frames_out {
        Output::create(folder.join(name))?.write(&speed.image, &scene.display)?;
    }
    Ok(())
}
