//! `energywave bake`: the light that space gives off, as a volume for other programs.

use std::path::{Path, PathBuf};
use std::time::Instant;

use energywave::glam::DVec3;
use energywave::volume::{CellValue, Grid, Storage, Texture, Volume, VolumeFile};
use energywave::{Error, Renderer, Scene};

use super::animate::Names;
use super::progress::{Progress, catch_interrupts, was_interrupted};
use super::subcommands::{BakeArguments, Store};
use super::{Failure, Outcome, choose_devices, names, note, open_scene, shown, warn};

pub fn run(arguments: &BakeArguments) -> Outcome {
    let moving = open_scene(&arguments.scene)?;
    let works = works(arguments)?;
    let mut files = Vec::new();
    for (path, time) in works {
        // What it warns of is about pictures.
        let (scene, _) = moving.at_with_warnings(time, |_, _| Ok(()))?;
        let grid = grid(arguments, &scene)?;
        let storage = match arguments.store {
            Store::Emission => Storage::Emission,
            Store::Reciprocal => scene.reciprocal(),
        };
        let file = VolumeFile::create(&path, arguments.half)?.storing(storage)?;
        files.push((scene, grid, storage, file));
    }
    // A series of files has one number a cell throughout, or three.
    let mut colors = files.iter().map(|(scene, ..)| scene.one_color());
    let first = colors.next().flatten();
    let color = first.filter(|_| colors.all(|other| other == first));
    catch_interrupts();
    let devices = choose_devices(arguments.device.device.as_deref())?;
    let mut renderer = Renderer::on_devices(&devices, &arguments.device.options())?;
    let name = match arguments.scene == Path::new("-") {
        true => "standard input".to_owned(),
        false => shown(
            &arguments
                .scene
                .file_name()
                .unwrap_or_default()
                .to_string_lossy(),
        ),
    };
    for (scene, grid, storage, file) in files {
        let begun = Instant::now();
        let volume = baked(arguments, &mut renderer, &scene, (grid, storage))?;
        let took = begun.elapsed().as_secs_f64();
        if volume.bricks().next().is_none() {
            warn("all cells are black: no light reaches the box");
        }
        note(&format!(
            "{} in {took:.2} s on {}",
            told(&volume),
            names(&devices)
        ));
        warn_of_thin_cores(&scene, &volume, storage);
        let mut notes = vec![("scene".to_owned(), name.clone())];
        let error = match storage {
            Storage::Emission => renderer.bake_error(&scene, &volume)?,
            Storage::Reciprocal { .. } => {
                // As `[[volume]]` draws it; other programs have no use for it.
                let drawn = energywave::scene::Volume::new(Texture::of(&volume, storage, color)?);
                renderer.drawn_error(&scene, volume.grid(), &drawn)?
            }
        };
        if let Some(error) = error {
            let error = format!(
                "median {:.1e}, 99.9 % at most {:.1e}, worst {:.1e}, of {} rays of the scene's camera",
                error.median, error.most, error.worst, error.rays
            );
            note(&format!("error: {error}"));
            notes.push(("error".to_owned(), error));
        }
        file.in_one_color(color).write(&volume, &notes)?;
    }
    Ok(())
}

/// Says where the middles of cells meet cores by chance.
fn warn_of_thin_cores(scene: &Scene, volume: &Volume, storage: Storage) {
    let cell = volume.grid().cell();
    if storage == Storage::Emission
        && volume.value() == CellValue::Center
        && scene.is_thinner_than(cell)
    {
        warn(&format!(
            "cells are {cell:.4} wide, and some core is thinner: it comes out as beads; more --cells help, or \
             --mean 4, which takes longer"
        ));
    }
}

/// Returns the files to write, and when each is.
fn works(arguments: &BakeArguments) -> Result<Vec<(PathBuf, f64)>, Error> {
    let time = arguments.time.unwrap_or(0.0);
    let Some(frames) = arguments.frames else {
        return Ok(vec![(arguments.output.clone(), time)]);
    };
    let names = Names::of(&arguments.output)?;
    let at = |frame: u32| (names.path(frame), time + f64::from(frame) / arguments.fps);
    Ok((frames.first..=frames.last).map(at).collect())
}

fn baked(
    arguments: &BakeArguments,
    renderer: &mut Renderer,
    scene: &Scene,
    (grid, storage): (Grid, Storage),
) -> Result<Volume, Failure> {
    let value = match arguments.mean {
        None if storage != Storage::Emission => scene.reciprocal_cell_value(),
        None => scene.cell_value(),
        Some(1) => CellValue::Center,
        Some(places) => CellValue::Mean(places),
    };
    let mut progress = Progress::new();
    let volume = renderer.bake(scene, grid, value, &mut |share| progress.report(share))?;
    drop(progress);
    match was_interrupted() {
        true => Err(Error::Interrupted.into()),
        false => Ok(volume),
    }
}

/// Returns the box that was typed, else that around all light, cut into cells.
fn grid(arguments: &BakeArguments, scene: &Scene) -> Result<Grid, Error> {
    let (middle, edges) = match (arguments.bounds.as_deref(), scene.light_bounds()) {
        (Some(&[middle, edges]), _) => (middle, edges),
        (_, Some([low, high])) => (0.5 * (low + high), high - low),
        _ => {
            let message = "--box MIDDLE EDGES is needed, such as --box 0,0,0 4,2,2: the light of some source has no \
                           end (or there is none); with a reach it has";
            return Err(Error::Unsupported(message.to_owned()));
        }
    };
    Grid::new(middle, edges, arguments.cells)
}

/// Says what was made.
fn told(volume: &Volume) -> String {
    let grid = volume.grid();
    let [low, high] = grid.bounds();
    let point = |point: DVec3| {
        let [x, y, z] = point.to_array().map(|it| format!("{it:.4}"));
        format!("{x},{y},{z}")
    };
    format!(
        "baked: {grid} cells of {:.4} from {} to {}, {} of {} bricks glow, at most {:.4}",
        grid.cell(),
        point(low),
        point(high),
        volume.bricks().count(),
        grid.cells()
            .map(|cells| u64::from(cells.div_ceil(8)))
            .iter()
            .product::<u64>(),
        volume.greatest(),
    )
}
