//! `energywave render`: a scene file to an image file.

use std::io::{IsTerminal, stdout};
use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant};

use energywave::image::{Display, Exposure, ImageFile, ImageFormat};
use energywave::scene::{AnimatedScene, MethodKeys};
use energywave::{Device, Error, RadianceImage, Renderer, Scene, shown};

use super::args::{FormatName, RenderArguments};
use super::progress::{Progress, catch_interrupts, was_interrupted};
use super::{Outcome, choose_devices, method_name, names, note, open_scene, tell_depths, warn_all};

pub fn run(arguments: RenderArguments) -> Outcome {
    let format = format(&arguments)?;
    check_bits(&arguments, format)?;
    if arguments.light_groups && format != ImageFormat::Exr {
        let message = "--light-groups: they are layers, which need an .exr";
        return Err(Error::Unsupported(message.to_owned()).into());
    }
    let overrides = &arguments.overrides;
    let adjust = |scene: &mut Scene, keys: &MethodKeys| {
        overrides.apply(scene, keys)?;
        let display = &mut scene.display;
        display.bits = arguments.bits.or(display.bits);
        display.exposure = arguments.exposure.unwrap_or(display.exposure);
        format.check(display)
    };
    let (mut scene, blur) = read(&arguments, adjust)?;
    let groups = match arguments.light_groups {
        true => light_groups(&scene)?,
        false => Vec::new(),
    };
    // Waits for the reader of a pipe: before Ctrl-C is caught.
    let output = create(&arguments.output, format)?;
    tell_depths(&scene);
    catch_interrupts();
    let devices = choose_devices(arguments.device.device.as_deref())?;
    let begun = Instant::now();
    let mut progress = Progress::new();
    let mut renderer = Renderer::on_devices(&devices, &arguments.device.options())?;
    let is_auto = scene.display.exposure == Exposure::Auto;
    // An exposure that fits is that of the light before its bloom.
    renderer.spread_bloom(!is_auto);
    let parts = 1.0 + groups.len() as f32;
    let (mut drawn_parts, mut moments) = (0.0, 1);
    // A part, or all, of the light, at a moment or of all of them while the shutter is open.
    let mut draw = |scene: &Scene, part: &dyn Fn(Scene) -> Scene| {
        let report = &mut |share| progress.report((drawn_parts + share) / parts);
        let image = match &blur {
            None => renderer.render_with_progress(scene, report),
            Some(Blur { moving, times }) => {
                let scene_at = &mut |time| Ok(part(moving.at_with(time, adjust)?));
                renderer.render_mean_with_progress(times.clone(), scene_at, report)
            }
        };
        drawn_parts += 1.0;
        moments = moments.max(renderer.last_moments());
        image
    };
    let mut image = draw(&scene, &|scene| scene)?;
    let layers = groups.into_iter().map(|group| {
        let light = draw(&group.scene, &|scene| {
            scene.of_light_group(group.light_group.as_deref())
        })?;
        Ok((group.layer, light))
    });
    let mut layers = layers.collect::<Result<Vec<_>, Error>>()?;
    drop(progress);
    if was_interrupted() {
        return Err(Error::Interrupted.into());
    }
    if is_auto {
        let stops = image.auto_exposure();
        scene.display.exposure = stops.into();
        note(&format!("exposure: {stops:.2} stops, by auto"));
        if let Some(bloom) = &scene.display.bloom {
            renderer.bloom(&mut image, bloom)?;
            for (_, layer) in &mut layers {
                renderer.bloom(layer, bloom)?;
            }
        }
    }
    let took = begun.elapsed();
    let output = noted(output, &arguments.scene, &scene, &devices);
    match layers.as_slice() {
        [] => output.write(&image, &scene.display)?,
        layers => output.write_light_groups(&image, layers, &scene.display)?,
    }
    note(&drawn(&image, &scene, moments, took, &names(&devices)));
    Ok(())
}

/// A scene that moves while its shutter is open.
struct Blur {
    moving: AnimatedScene,
    times: Range<f64>,
}

/// Reads the scene at its time, says what was hardly meant in it, and finds out what is blurred.
fn read(
    arguments: &RenderArguments,
    adjust: impl Fn(&mut Scene, &MethodKeys) -> Result<(), Error>,
) -> Result<(Scene, Option<Blur>), Error> {
    let moving = open_scene(&arguments.scene)?;
    let time = arguments.time.unwrap_or(0.0);
    let is_blurred = moving.is_animated() && moving.shutter() > 0.0;
    let Some(rate) = arguments.fps.filter(|_| is_blurred) else {
        let (scene, warnings) = moving.into_frame(time, adjust)?;
        warn_all(&warnings);
        if is_blurred {
            note(
                "time.shutter: a share of a frame whose length is not given (--fps); drawn as at the moment",
            );
        }
        return Ok((scene, None));
    };
    let (scene, warnings) = moving.at_with_warnings(time, adjust)?;
    warn_all(&warnings);
    let times = moving.open_at(time, rate);
    Ok((scene, Some(Blur { moving, times })))
}

/// The layer of light that belongs to no group.
const UNGROUPED: &str = "rest";

/// A layer of an image.
struct LightGroup {
    layer: String,
    /// `None`: what belongs to none.
    light_group: Option<String>,
    scene: Scene,
}

/// Returns a layer for each group of lights, and one for what belongs to none.
fn light_groups(scene: &Scene) -> Result<Vec<LightGroup>, Error> {
    let names = scene.light_groups();
    if names.is_empty() {
        let message = "--light-groups: no source or [[group]] of the scene names a light_group";
        return Err(Error::Unsupported(message.to_owned()));
    }
    if scene.has_ungrouped_light() && names.contains(&UNGROUPED) {
        let message = format!(
            "--light-groups: `{UNGROUPED}` is the layer of sources without a light_group; call that one otherwise"
        );
        return Err(Error::Unsupported(message));
    }
    let rest = scene.has_ungrouped_light().then_some((UNGROUPED, None));
    let named = names.into_iter().map(|name| (name, Some(name)));
    let layer = |(layer, name): (&str, Option<&str>)| LightGroup {
        layer: layer.to_owned(),
        light_group: name.map(str::to_owned),
        scene: scene.of_light_group(name),
    };
    Ok(named.chain(rest).map(layer).collect())
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
pub(super) fn noted(
    output: ImageFile,
    name: &Path,
    scene: &Scene,
    devices: &[Device],
) -> ImageFile {
    let name = match name == Path::new("-") {
        true => "standard input".to_owned(),
        false => shown(&name.file_name().unwrap_or_default().to_string_lossy()),
    };
    let devices: Vec<String> = devices.iter().map(ToString::to_string).collect();
    output
        .note("scene", name)
        .note("method", method_name(scene.integration.method))
        .note("device", devices.join(", "))
}

/// Says what was drawn.
pub(super) fn drawn(
    image: &RadianceImage,
    scene: &Scene,
    moments: u32,
    took: Duration,
    device: &str,
) -> String {
    let mean = match moments {
        ..=1 => String::new(),
        _ => format!(", the mean of {moments} moments,"),
    };
    let light = image
        .as_slice()
        .chunks_exact(4)
        .flat_map(|pixel| &pixel[..3]);
    let (least, greatest) = light.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), light| {
        (low.min(*light), high.max(*light))
    });
    let (least, greatest) = (digits(least.into()), digits(greatest.into()));
    format!(
        "drawn: {}x{} pixels{mean} in {:.2} s on {device}; radiance {least} to {greatest}, exposure {} stops",
        image.size().width,
        image.size().height,
        took.as_secs_f64(),
        digits(scene.display.exposure.stops(image))
    )
}

/// Writes a number with four digits.
pub(super) fn digits(value: f64) -> String {
    let short = format!("{value:.3e}");
    match short.parse::<f64>() {
        Ok(rounded) if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) => {
            rounded.to_string()
        }
        _ => short,
    }
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

#[cfg(test)]
mod tests {
    use super::digits;

    #[test]
    fn numbers_have_four_digits() {
        let found = [0.0, 1.0, 12.345_67, -0.001_234_56, 1.5e-7, 123_456.0, 1e12].map(digits);
        let expected = [
            "0",
            "1",
            "12.35",
            "-0.001235",
            "1.500e-7",
            "123500",
            "1.000e12",
        ];
        assert_eq!(found, expected);
    }
}
