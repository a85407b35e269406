//! `energywave render`: a scene file to an image file.

use std::io::{IsTerminal, stdout};
use std::path::Path;

use energywave::image::{Display, Exposure, ImageFile, ImageFormat};
use energywave::scene::Method;
use energywave::{Device, Error, Renderer, Scene, shown};

use super::args::{FormatName, RenderArguments};
use super::progress::{Progress, catch_interrupts, was_interrupted};
use super::{Outcome, choose_devices, note, read_scene, tell_depths};

pub fn run(arguments: RenderArguments) -> Outcome {
    let format = format(&arguments)?;
    check_bits(&arguments, format)?;
    let overrides = &arguments.overrides;
    let mut scene = read_scene(&arguments.scene, |scene, keys| {
        overrides.apply(scene, keys)?;
        let display = &mut scene.display;
        display.bits = arguments.bits.or(display.bits);
        display.exposure = arguments.exposure.unwrap_or(display.exposure);
        format.check(display)
    })?;
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
    if scene.display.exposure == Exposure::Auto {
        let stops = image.auto_exposure();
        scene.display.exposure = stops.into();
        if !arguments.quiet {
            note(&format!("exposure: {stops:.2} stops, by auto"));
        }
    }
    let output = noted(output, &arguments.scene, &scene, &devices);
    output.write(&image, &scene.display)?;
    Ok(())
}

/// Checks the bits that were typed, which stand in no file.
fn check_bits(arguments: &RenderArguments, format: ImageFormat) -> Result<(), Error> {
    let typed = Display {
        bits: arguments.bits,
        ..Display::default()
    };
    format.check(&typed).map_err(|error| match error {
        Error::Scene(fault) => Error::Unsupported(format!("--bits: {}", fault.message)),
        other => other,
    })
}

/// Says in the file what it shows, and how that was made.
fn noted(output: ImageFile, name: &Path, scene: &Scene, devices: &[Device]) -> ImageFile {
    let name = match name == Path::new("-") {
        true => "standard input".to_owned(),
        false => shown(&name.file_name().unwrap_or_default().to_string_lossy()),
    };
    let method = match scene.integration.method {
        Method::Exact { tolerance, .. } => format!("exact, tolerance {tolerance:e}"),
        Method::Simpson { divisions } => format!("simpson, {divisions} divisions"),
        Method::Jittered { divisions, .. } => format!("jittered, {divisions} divisions"),
        _ => String::new(),
    };
    let devices: Vec<String> = devices.iter().map(ToString::to_string).collect();
    output
        .note("scene", name)
        .note("method", method)
        .note("device", devices.join(", "))
}

/// Whether the output is standard output.
fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

fn format(arguments: &RenderArguments) -> Result<ImageFormat, Error> {
    match arguments.format {
        Some(FormatName::Png) => Ok(ImageFormat::Png),
        Some(FormatName::Exr) => Ok(ImageFormat::Exr),
        Some(FormatName::Webp) => Ok(ImageFormat::WebP),
        Some(FormatName::Jpeg) => Ok(ImageFormat::Jpeg),
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
