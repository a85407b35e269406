//! `energywave bench`: the paper's tables, or the speed of a scene.

use std::path::Path;
use std::time::Duration;

use energywave::image::ImageFile;
use energywave::papers::{
    DIVISIONS, PAPER_CPU_FPS, RESOLUTIONS, Speed, TABLE_2010, Table, exact_cost, measure,
    single_threaded_fps,
};
use energywave::scene::{Method, Sampling};
use energywave::{Device, DeviceType, Error, Renderer, Scene, shown};
use serde::Serialize;

use super::records::{Origin, Spread};
use super::subcommands::{BenchArguments, TableName};
use super::{
    Outcome, bench_2006, bench_2008, bench_2013, bench_crowd, choose_devices, names, note, print,
    read_scene, tell_depths,
};

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
    #[serde(flatten)]
    spread: Spread,
    #[serde(flatten)]
    origin: Origin,
}

/// A cell of the table of 2010.
#[derive(Serialize)]
struct BeamCell {
    table: u32,
    field: &'static str,
    resolution: u32,
    depth: bool,
    /// The closed form at every pixel, as in the paper.
    fps: f64,
    paper_fps: f64,
    ratio: f64,
    kernel_ms: f64,
    frame: u32,
    /// The same by tiles.
    tiles_fps: f64,
    device: String,
    #[serde(flatten)]
    spread: Spread,
    #[serde(flatten)]
    origin: Origin,
    /// The last cell on the float64 reference, on one thread, and what the paper reports without a GPU.
    single_threaded_fps: Option<f64>,
    paper_single_threaded_fps: Option<f64>,
}

/// The speed of a scene.
#[derive(Serialize)]
struct SceneSpeed {
    scene: String,
    width: u32,
    height: u32,
    method: &'static str,
    sampling: Sampling,
    fps: f64,
    kernel_ms: f64,
    /// Of the last frame.
    mesh_ms: f64,
    evaluations: u64,
    field_evaluations: u64,
    frame: u32,
    device: String,
    #[serde(flatten)]
    spread: Spread,
    #[serde(flatten)]
    origin: Origin,
}

pub fn run(arguments: &BenchArguments) -> Outcome {
    if let Some(path) = &arguments.scene {
        return bench_scene(arguments, path);
    }
    if !arguments.overrides.is_empty() {
        let message = "the tables have sizes, method and divisions of their own; give a scene to measure with others";
        return Err(Error::Unsupported(message.to_owned()).into());
    }
    match arguments.table {
        Some(TableName::Torus) => bench_tables(arguments, &[Table::Torus]),
        Some(TableName::Bezier) => bench_tables(arguments, &[Table::Bezier]),
        Some(TableName::Beam) => bench_table_2010(arguments),
        Some(TableName::Volumes) => bench_2006::run(arguments),
        Some(TableName::Metaballs) => bench_2008::run(arguments),
        Some(TableName::Collisions) => bench_2013::run(arguments),
        Some(TableName::Crowd) => bench_crowd::run(arguments),
        None => bench_tables(arguments, &[Table::Torus, Table::Bezier]),
    }
}

fn bench_tables(arguments: &BenchArguments, tables: &[Table]) -> Outcome {
    let (devices, mut renderer) = prepare(arguments)?;
    let origin = Origin::now(&devices);
    let mut cells = Vec::new();
    for &table in tables {
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
                    device: names(&devices),
                    spread: speed.times.into(),
                    origin: origin.clone(),
                };
                if arguments.data.is_text() {
                    print_cell(&cell, cells.is_empty())?;
                }
                cells.push(cell);
            }
        }
    }
    arguments.data.print(&cells)
}

fn bench_table_2010(arguments: &BenchArguments) -> Outcome {
    let (devices, mut renderer) = prepare(arguments)?;
    let origin = Origin::now(&devices);
    let mut cells: Vec<BeamCell> = Vec::new();
    for (number, known) in TABLE_2010.into_iter().enumerate() {
        let mut scene = known.scene()?;
        scene.integration.method = exact(Sampling::Tiles);
        let by_tiles = measure(&mut renderer, &scene, time(arguments))?;
        scene.integration.method = exact(Sampling::Pixels);
        let speed = measure(&mut renderer, &scene, time(arguments))?;
        let depth = if known.has_depth { "-depth" } else { "" };
        let name = format!("beam-{}{depth}.exr", known.resolution);
        save(arguments, &name, &speed, &scene)?;
        let is_last = number + 1 == TABLE_2010.len();
        let single_threaded_fps = is_last.then(|| single_threaded_fps(&scene)).transpose()?;
        let cell = BeamCell {
            table: 2010,
            field: "beam",
            resolution: known.resolution,
            depth: known.has_depth,
            fps: speed.fps,
            paper_fps: known.paper_fps,
            ratio: speed.fps / known.paper_fps,
            kernel_ms: 1e3 * speed.kernel.as_secs_f64(),
            frame: speed.frame,
            tiles_fps: by_tiles.fps,
            device: names(&devices),
            spread: speed.times.into(),
            origin: origin.clone(),
            single_threaded_fps,
            paper_single_threaded_fps: single_threaded_fps.map(|_| PAPER_CPU_FPS),
        };
        if arguments.data.is_text() {
            print_beam_cell(&cell, number == 0)?;
        }
        cells.push(cell);
    }
    arguments.data.print(&cells)
}

fn exact(sampling: Sampling) -> Method {
    Method::Exact {
        tolerance: 1e-3,
        sampling,
    }
}

fn print_beam_cell(cell: &BeamCell, is_first: bool) -> Outcome {
    if is_first {
        print(
            "table field   resolution     depth       fps     paper   ratio  kernel ms  tiles fps\n",
        )?;
    }
    print(&format!(
        "{:>5} {:<8} {:>9} {:>9} {:>9.2} {:>9.2} {:>7.2} {:>10.3} {:>10.2}\n",
        cell.table,
        cell.field,
        cell.resolution,
        if cell.depth { "yes" } else { "no" },
        cell.fps,
        cell.paper_fps,
        cell.ratio,
        cell.kernel_ms,
        cell.tiles_fps
    ))?;
    let Some(single) = cell.single_threaded_fps else {
        return Ok(());
    };
    print(&format!(
        "the last on the float64 reference, one thread: {single:.3} fps, {:.0} times slower; the paper without a GPU: \
         {PAPER_CPU_FPS} fps, {:.0} times\n",
        cell.fps / single,
        cell.paper_fps / PAPER_CPU_FPS
    ))
}

/// Prints one row of the text table. A cell takes a second, so each is printed at once.
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
    let scene = read_scene(path, |scene, keys| arguments.overrides.apply(scene, keys))?;
    tell_depths(&scene);
    let (devices, mut renderer) = prepare(arguments)?;
    let origin = Origin::now(&devices);
    let speed = measure(&mut renderer, &scene, time(arguments))?;
    let stem = match path.file_stem() {
        Some(stem) if stem != "-" => stem.to_string_lossy(),
        _ => "stdin".into(),
    };
    save(arguments, &format!("{stem}.exr"), &speed, &scene)?;
    let cost = match (scene.integration.method, &devices[0]) {
        (Method::Exact { .. }, device) if device.device_type != DeviceType::Reference => {
            exact_cost(device, &scene)?
        }
        _ => speed.cost,
    };
    let record = SceneSpeed {
        scene: path.display().to_string(),
        width: scene.image.width,
        height: scene.image.height,
        method: scene.integration.method.name(),
        sampling: scene.sampling(),
        fps: speed.fps,
        kernel_ms: 1e3 * speed.kernel.as_secs_f64(),
        mesh_ms: 1e3 * speed.cost.meshes.as_secs_f64(),
        evaluations: cost.integrals,
        field_evaluations: cost.samples,
        frame: speed.frame,
        device: names(&devices),
        spread: speed.times.into(),
        origin,
    };
    if !arguments.data.is_text() {
        return arguments.data.print_one(&record);
    }
    let of_meshes = match scene.meshes.is_empty() {
        true => String::new(),
        false => format!(" (the last one {:.3} ms for meshes)", record.mesh_ms),
    };
    print(&format!(
        "{}: {:.2} frames a second at {}x{}, {:.3} ms in kernels{of_meshes}; {} integrals, {} samples a frame\n",
        shown(&record.scene),
        record.fps,
        record.width,
        record.height,
        record.kernel_ms,
        record.evaluations,
        record.field_evaluations
    ))
}

pub fn prepare(arguments: &BenchArguments) -> Result<(Vec<Device>, Renderer), super::Failure> {
    if let Some(folder) = &arguments.frames_out {
        std::fs::create_dir_all(folder)
            .map_err(|error| Error::output(folder, error.to_string()).caused_by(error))?;
        // Known before the work; nothing is written yet.
        ImageFile::create(folder.join("frame.exr"))?;
    }
    let devices = choose_devices(arguments.device.device.as_deref())?;
    let renderer = Renderer::on_devices(&devices, &arguments.device.options())?;
    note(&format!("a cell takes {} s", arguments.seconds));
    Ok((devices, renderer))
}

pub fn time(arguments: &BenchArguments) -> Duration {
    Duration::from_secs_f64(arguments.seconds)
}

/// Writes the last frame if frames are wanted.
pub fn save(arguments: &BenchArguments, name: &str, speed: &Speed, scene: &Scene) -> Outcome {
    if let Some(folder) = &arguments.frames_out {
        ImageFile::create(folder.join(name))?.write(&speed.image, &scene.display)?;
    }
    Ok(())
}
