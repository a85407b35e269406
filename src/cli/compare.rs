//! `energywave compare`: how far each way to integrate is from the truth on a scene, and how fast it is.

use std::time::Duration;

use energywave::image::{Display, ImageFile, ImageFormat, relative_errors};
use energywave::papers::{Accuracy, accuracies};
use energywave::scene::{Antialias, Method};
use energywave::{Device, Error, RadianceImage, Renderer, Scene};
use serde::Serialize;

use super::error_map;
use super::progress::{Progress, catch_interrupts};
use super::records::{Origin, Spread};
use super::subcommands::CompareArguments;
use super::{Outcome, choose_devices, method_name, names, note, print, read_scene, tell_depths};

#[derive(Serialize)]
struct Row {
    method: &'static str,
    divisions: Option<u32>,
    tolerance: Option<f64>,
    max: f64,
    worst: (u32, u32),
    p999: f64,
    rms: f64,
    fps: f64,
    device: String,
    #[serde(flatten)]
    spread: Spread,
    #[serde(flatten)]
    origin: Origin,
}

impl Row {
    fn new(accuracy: Accuracy, device: &str, origin: &Origin) -> Self {
        let (divisions, tolerance) = match accuracy.method {
            Method::Simpson { divisions } => (Some(divisions), None),
            Method::Exact { tolerance, .. } => (None, Some(tolerance)),
            _ => (None, None),
        };
        Self {
            method: accuracy.method.name(),
            divisions,
            tolerance,
            max: accuracy.difference.max,
            worst: accuracy.difference.worst,
            p999: accuracy.difference.p999,
            rms: accuracy.difference.rms,
            fps: accuracy.fps,
            device: device.to_owned(),
            spread: accuracy.times.into(),
            origin: origin.clone(),
        }
    }
}

pub fn run(arguments: &CompareArguments) -> Outcome {
    let maps = arguments.maps.iter().map(ImageFile::create);
    let maps = maps.collect::<Result<Vec<_>, _>>()?;
    let mut mapped = Method::default();
    let scene = read_scene(&arguments.scene, |scene, keys| {
        mapped = Method::Exact {
            tolerance: keys.tolerance,
            sampling: keys.sampling,
        };
        scene.image = arguments.size.unwrap_or(scene.image);
        scene.integration.antialias = Antialias::None; // methods are compared along rays
        Ok(())
    })?;
    tell_depths(&scene);
    let devices = choose_devices(arguments.device.device.as_deref())?;
    let origin = Origin::now(&devices);
    let mut renderer = Renderer::on_devices(&devices, &arguments.device.options())?;
    catch_interrupts();
    note("the truth is computed in float64 first; --size makes it quicker");
    let mut exact = scene.clone();
    exact.integration.method = Method::default();
    let mut progress = Progress::new();
    let mut reference = Renderer::new(&Device::reference())?;
    let truth = reference.render_with_progress(&exact, &mut |share| progress.report(share))?;
    drop(progress);
    if !maps.is_empty() {
        exact.integration.method = mapped;
        write_maps(maps, &renderer.render(&exact)?, &truth, &exact)?;
    }
    let time = Duration::from_secs_f64(arguments.seconds);
    let rows: Vec<Row> = accuracies(&mut renderer, &scene, &truth, time)?
        .into_iter()
        .map(|accuracy| Row::new(accuracy, &names(&devices), &origin))
        .collect();
    match arguments.data.is_text() {
        true => print(&table(&rows)),
        false => arguments.data.print(&rows),
    }
}

/// Writes the relative errors of an image: an EXR as they are, another format as a picture of the worst channel.
fn write_maps(
    maps: Vec<ImageFile>,
    image: &RadianceImage,
    truth: &RadianceImage,
    scene: &Scene,
) -> Result<(), Error> {
    let errors = relative_errors(image, truth)?
        .ok_or_else(|| Error::Unsupported("the truth has another size".to_owned()))?;
    for map in maps {
        match map.format() {
            ImageFormat::Exr => map
                .note("content", "relative error of each channel against float64")
                .note("method", method_name(scene.integration.method))
                .write(&errors, &Display::default())?,
            _ => map.write_picture(&error_map::picture(&errors)?)?,
        }
    }
    note(&format!(
        "error map: {}",
        method_name(scene.integration.method)
    ));
    Ok(())
}

/// Lists the relative errors of the pixels against the reference, and frames a second.
fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:<14} {:>9} {:>9} {:>9} {:>9}\n",
        "", "max", "99.9 %", "rms", "fps"
    );
    for row in rows {
        let name = match (row.divisions, row.tolerance) {
            (Some(divisions), _) => format!("simpson {divisions}"),
            (_, Some(tolerance)) => format!("exact {tolerance:.0e}"),
            _ => String::new(),
        };
        text += &format!(
            "{name:<14} {:>9.1e} {:>9.1e} {:>9.1e} {:>9.1}\n",
            row.max, row.p999, row.rms, row.fps
        );
    }
    text
}
