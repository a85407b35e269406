//! `energywave watch`: a scene that is drawn again whenever it, or a file that it names, is saved. The renderer stays,
//! and with it all kernels.

mod changes;
#[cfg(feature = "window")]
mod orbit;
mod picture;
#[cfg_attr(not(feature = "window"), path = "no_window.rs")]
mod window;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anstyle::AnsiColor;
use clap::Args;
use energywave::image::{ImageFile, ImageFormat};
use energywave::{Error, ErrorKind};

use super::args::{DeviceArgument, rate, time};
use super::overrides::Overrides;
use super::progress::{catch_interrupts, was_interrupted};
use super::render::{drawn, noted};
use super::{Outcome, names, note, tell};
use picture::Pictures;

#[derive(Debug, Args)]
pub struct WatchArguments {
    /// Scene file, TOML or (.json) JSON
    pub scene: PathBuf,
    /// Image to write again after every change: .png, .webp, .jpg (sRGB) or .exr (linear) [default: a window]
    #[arg(short, long)]
    pub output: Option<PathBuf>,
    /// When it is in a scene that moves, seconds; of a window, when it begins [default: 0]
    #[arg(long, value_name = "SECONDS", value_parser = time, allow_hyphen_values = true)]
    pub time: Option<f64>,
    /// Frames a second, of which [time] shutter is a share: blurs motion [default: the moment alone]
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true)]
    pub fps: Option<f64>,
    #[command(flatten)]
    pub overrides: Overrides,
    #[command(flatten)]
    pub device: DeviceArgument,
}

/// A wait looks for Ctrl-C so often.
const LOOK: Duration = Duration::from_millis(100);

pub fn run(arguments: WatchArguments) -> Outcome {
    if arguments.scene == Path::new("-") {
        let message = "watch: standard input is never saved again; name a file";
        return Err(Error::Unsupported(message.to_owned()).into());
    }
    match arguments.output.clone() {
        Some(output) => to_file(arguments, &output),
        None => window::run(arguments),
    }
}

/// Draws to a file until Ctrl-C.
fn to_file(arguments: WatchArguments, output: &Path) -> Outcome {
    let format = ImageFormat::of(output)?;
    ImageFile::create(output)?; // refused before the work
    catch_interrupts();
    let mut pictures = Pictures::open(arguments)?;
    loop {
        let begun = Instant::now();
        match draw_to(&mut pictures, output, format, begun) {
            Ok(()) => {}
            Err(Error::Interrupted) if was_interrupted() => return Ok(()),
            Err(Error::Interrupted) => {}
            Err(error) => say(error)?,
        }
        while !pictures.changes.wait(LOOK) {
            if was_interrupted() {
                return Ok(());
            }
        }
    }
}

fn draw_to(
    pictures: &mut Pictures,
    output: &Path,
    format: ImageFormat,
    begun: Instant,
) -> Result<(), Error> {
    let time = pictures.arguments.time.unwrap_or(0.0);
    let picture = pictures.draw_change(time, Some(format))?;
    let file = ImageFile::create(output)?;
    let scene = &picture.scene;
    let file = noted(file, &pictures.arguments.scene, scene, &pictures.devices);
    file.write(&picture.light, &scene.display)?;
    let device = names(&pictures.devices);
    let (light, moments) = (&picture.light, picture.moments);
    note(&drawn(light, scene, moments, begun.elapsed(), &device));
    Ok(())
}

/// Says what is wrong and can be righted; what cannot ends the program.
fn say(error: Error) -> Result<(), Error> {
    match error.kind() {
        ErrorKind::Scene | ErrorKind::Input | ErrorKind::Output | ErrorKind::Unsupported => {
            tell("error", AnsiColor::Red, &error.to_string());
            Ok(())
        }
        _ => Err(error),
    }
}
