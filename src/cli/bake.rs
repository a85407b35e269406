//! `energywave bake`: the light that space gives off, as a volume for other programs.

use std::path::Path;
use std::time::Instant;

use energywave::glam::DVec3;
use energywave::volume::{CellValue, Grid, Volume, VolumeFile};
use energywave::{Error, Renderer, Scene};

use super::progress::{Progress, catch_interrupts, was_interrupted};
use super::subcommands::BakeArguments;
use super::{Outcome, choose_devices, names, note, open_scene, shown, warn};

pub fn run(arguments: &BakeArguments) -> Outcome {
    // What it warns of is about pictures.
    let moving = open_scene(&arguments.scene)?;
    let (scene, _) = moving.into_frame(arguments.time.unwrap_or(0.0), |_, _| Ok(()))?;
    let grid = grid(arguments, &scene)?;
    let value = match arguments.mean {
        None => scene.cell_value(),
        Some(1) => CellValue::Center,
        Some(places) => CellValue::Mean(places),
    };
    let file = VolumeFile::create(&arguments.output, arguments.half)?;
    catch_interrupts();
    let devices = choose_devices(arguments.device.device.as_deref())?;
    let begun = Instant::now();
    let mut renderer = Renderer::on_devices(&devices, &arguments.device.options())?;
    let mut progress = Progress::new();
    let volume = renderer.bake(&scene, grid, value, &mut |share| progress.report(share))?;
    drop(progress);
    if was_interrupted() {
        return Err(Error::Interrupted.into());
    }
    let took = begun.elapsed().as_secs_f64();
    if volume.bricks().len() == 0 {
        warn("all cells are black: no light reaches the box");
    }
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
    file.write(&volume, &[("scene".to_owned(), name)])?;
    note(&format!(
        "{} in {took:.2} s on {}",
        told(&volume),
        names(&devices)
    ));
    Ok(())
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
        volume.bricks().len(),
        grid.cells()
            .map(|cells| u64::from(cells.div_ceil(8)))
            .iter()
            .product::<u64>(),
        volume.greatest(),
    )
}
