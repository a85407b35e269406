//! `energywave render`: a scene file to an image file.

use std::io::{IsTerminal, stdout};
use std::path::Path;

use energywave::image::{ImageFile, ImageFormat};
use energywave::{Error, Renderer};

use super::args::{FormatName, RenderArguments};
use super::progress::{Progress, catch_interrupts, was_interrupted};
use super::{Outcome, choose_devices, read_scene, tell_depths};

pub fn run(arguments: RenderArguments) -> Outcome {
    let format = format(&arguments)?;
    let overrides = &arguments.overrides;
    let scene = read_scene(&arguments.scene, |scene, keys| overrides.apply(scene, keys))?;
    // Waits for the reader of a pipe: before Ctrl-C is caught.
    let output = create(&arguments.output, format)?;
    tell_depths(&scene, arguments.quiet);
    catch_interrupts();
    let devices = choose_devices(arguments.device.device.as_deref())?;
    let mut renderer = Renderer::on_devices(&devices, &arguments.device.options())?;
    let mut progress = Progress::new(arguments.quiet);
    let image = renderer.render_with_progress(&scene, &mut |share| progress.report(share))?;
    drop(progress);
    if was_interrupted() {
        return Err(Error::Interrupted.into());
    }
    output.write(&image, &scene.display)?;
    Ok(())
}

/// Whether the output is standard output.
fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

fn format(arguments: &RenderArguments) -> Result<ImageFormat, Error> {
    match arguments.format {
        Some(FormatName::Png) => Ok(ImageFormat::Png),
        Some(FormatName::Exr) => Ok(ImageFormat::Exr),
        None if is_stdout(&arguments.output) => Ok(ImageFormat::Png),
        None => ImageFormat::of(&arguments.output),
    }
}

fn create(path: &Path, format: ImageFormat) -> Result<ImageFile, Error> {
    match is_stdout(path) {
        false => ImageFile::create_as(path, format),
        true if stdout().is_terminal() => Err(Error::output(
            "standard output",
            "it is a terminal; name a file, or send it to a program",
        )),
        true => Ok(ImageFile::stdout(format)),
    }
}
