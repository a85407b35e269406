//! What can be typed.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};
use energywave::glam::DVec3;
use energywave::image::{Exposure, ImageSize};
use energywave::{RendererOptions, SlowStart};

use super::animate::AnimateArguments;
use super::examples;
use super::overrides::Overrides;
use super::subcommands::*;
use super::warn;
use super::watch::WatchArguments;

/// Volumetric energy effects, integrated along every view ray on any OpenCL device.
#[derive(Debug, Parser)]
#[command(version, arg_required_else_help = true, disable_help_subcommand = true, after_help = examples::PROGRAM)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,
    /// Say nothing but warnings and errors: no device, no progress, nothing of what was done
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw a scene
    #[command(after_help = examples::RENDER)]
    Render(RenderArguments),
    /// Draw the frames of a scene that moves
    #[command(after_help = examples::ANIMATE)]
    Animate(AnimateArguments),
    /// Draw a scene again whenever it is saved: to a file, or in a window
    #[command(after_help = examples::WATCH)]
    Watch(WatchArguments),
    /// Sample the light that space gives off on a grid, for programs that draw volumes
    #[command(after_help = examples::BAKE)]
    Bake(BakeArguments),
    /// Write a scene as a shader: its closed forms and its values, for engines that draw by themselves
    #[command(after_help = examples::EXPORT)]
    Export(ExportArguments),
    /// Write a scene to begin with: a preset, with comments that say what to change
    #[command(after_help = examples::NEW)]
    New(NewArguments),
    /// List the devices, which one is the default and why, and what is missing
    #[command(after_help = examples::DEVICES)]
    Devices(DevicesArguments),
    /// Measure the paper's speed tables, or a scene
    #[command(after_help = examples::BENCH)]
    Bench(BenchArguments),
    /// Compare the methods on a scene: error against float64, and frames a second
    #[command(after_help = examples::COMPARE)]
    Compare(CompareArguments),
    /// Tell where and when waves of particles hit something, as JSON
    #[command(after_help = examples::CONTACTS)]
    Contacts(ContactsArguments),
    /// Draw the papers' figures into a folder, with a page that shows each beside its caption
    #[command(after_help = examples::FIGURES)]
    Figures(FiguresArguments),
    /// Check a device against rays whose integrals are known
    #[command(after_help = examples::VERIFY)]
    Verify(VerifyArguments),
    /// Print the JSON Schema of scene files, by which editors complete them
    #[command(after_help = examples::SCHEMA)]
    Schema,
    /// Print what makes a shell complete what is typed
    #[command(after_help = examples::COMPLETIONS)]
    Completions(CompletionsArguments),
    /// Print the manual page of the program or of a subcommand, for man
    #[command(after_help = examples::MAN)]
    Man(ManArguments),
    /// Say what can be typed, or what a scene file may have: help scene
    #[command(after_help = examples::HELP)]
    Help(HelpArguments),
}

#[derive(Debug, Args)]
pub struct RenderArguments {
    /// Scene file, TOML or (.json) JSON; - is standard input
    pub scene: PathBuf,
    /// Image to write: .png, .webp, .jpg (sRGB) or .exr (linear); - is standard output
    #[arg(short, long)]
    pub output: PathBuf,
    /// Format of the image [default: by the ending of its name; png where that has none]
    #[arg(long)]
    pub format: Option<FormatName>,
    /// Bits of a channel: 8 or 16 of a PNG, 16 or 32 of an EXR [default: the scene's, else 8, and 32]
    #[arg(long, value_name = "N")]
    pub bits: Option<u32>,
    /// Exposure in stops, or auto, which fits the picture [default: the scene's, else fits the scene]
    #[arg(long, value_name = "STOPS|auto", value_parser = exposure, allow_hyphen_values = true)]
    pub exposure: Option<Exposure>,
    /// Write a layer into the EXR for each light_group of the scene, and one for the rest
    #[arg(long)]
    pub light_groups: bool,
    /// When it is in a scene that moves, seconds [default: 0]
    #[arg(long, value_name = "SECONDS", value_parser = time, allow_hyphen_values = true)]
    pub time: Option<f64>,
    /// Frames a second, of which [time] shutter is a share: blurs motion from --time on [default: the moment alone]
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true)]
    pub fps: Option<f64>,
    #[command(flatten)]
    pub overrides: Overrides,
    #[command(flatten)]
    pub device: DeviceArgument,
}

#[derive(Debug, Args)]
pub struct DeviceArgument {
    /// Index, part of a name, gpu, cpu or reference; several, such as 0,1 or gpu,cpu, share each frame; all: every
    /// OpenCL device [env: ENERGYWAVE_DEVICE] [default: best GPU, else CPU, else reference]
    #[arg(long)]
    pub device: Option<String>,
    /// Use the device even if its kernels fail the self-test
    #[arg(long)]
    pub no_self_test: bool,
    /// Rays that a work-item carries side by side: 1, 4, 8 or 16 [default: what suits the device]
    #[arg(long, value_name = "N", hide_short_help = true)]
    pub lanes: Option<u32>,
    /// Work-items that share a tile, at most 16 divided by the lanes, or 32 of one [default: what suits the device]
    #[arg(long, value_name = "N", hide_short_help = true)]
    pub tile_workers: Option<u32>,
}

impl DeviceArgument {
    /// Returns what was typed as options of the library.
    pub fn options(&self) -> RendererOptions {
        let mut options = RendererOptions::default();
        options.skips_self_test = self.no_self_test;
        (options.lanes, options.tile_workers) = (self.lanes, self.tile_workers);
        options.slow_start = Some(SLOW_START);
        options
    }
}

/// Most drivers need seconds, Intel's a minute.
pub const SLOW_START: SlowStart = SlowStart {
    after: Duration::from_secs(60),
    tell: warn,
};

#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum FormatName {
    /// sRGB, tone-mapped
    Png,
    /// Linear light
    Exr,
    /// 8-bit sRGB, tone-mapped, lossless
    Webp,
    /// 8-bit sRGB, tone-mapped, without alpha
    Jpeg,
}

pub(super) fn size(text: &str) -> Result<ImageSize, String> {
    let pixels = |text: &str| text.trim().parse().ok().filter(|pixels: &u32| *pixels > 0);
    let sides = text
        .split_once(['x', 'X'])
        .map(|(w, h)| (pixels(w), pixels(h)));
    match sides {
        Some((Some(width), Some(height))) => Ok(ImageSize { width, height }),
        _ => Err("a size is two positive numbers of pixels, such as 640x360".to_owned()),
    }
}

pub(super) fn divisions(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(divisions @ 2..=65536) if divisions % 2 == 0 => Ok(divisions),
        _ => Err("Simpson's rule needs an even number from 2 to 65536".to_owned()),
    }
}

pub(super) fn exposure(text: &str) -> Result<Exposure, String> {
    match (text, text.parse()) {
        ("auto", _) => Ok(Exposure::Auto),
        (_, Ok(stops)) if (-100.0..=100.0).contains(&stops) => Ok(Exposure::Stops(stops)),
        _ => Err("an exposure is a number of stops from -100 to 100, or auto".to_owned()),
    }
}

pub(super) fn scale(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(scale) if f64::is_finite(scale) && scale != 0.0 => Ok(scale),
        _ => Err("a scale is a number but 0, such as 0.01".to_owned()),
    }
}

pub(super) fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.0..=3600.0).contains(&seconds) => Ok(seconds),
        _ => Err("a time is a number of seconds up to 3600".to_owned()),
    }
}

pub(super) fn point(text: &str) -> Result<DVec3, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .filter_map(|it| it.trim().parse().ok())
        .collect();
    let point = match (numbers.as_slice(), text.matches(',').count()) {
        (&[x, y, z], 2) => DVec3::new(x, y, z),
        (&[all], 0) => DVec3::splat(all),
        _ => DVec3::NAN,
    };
    match point.is_finite() {
        true => Ok(point),
        false => Err(
            "three numbers with commas between them, such as 0,1.5,-2, or one for all three"
                .to_owned(),
        ),
    }
}

pub(super) fn time(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(time) if f64::abs(time) <= 1e9 => Ok(time),
        _ => Err("a time is a number of seconds, such as 1.5".to_owned()),
    }
}

pub(super) fn rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(rate) if (1e-6..=1e6).contains(&rate) => Ok(rate),
        _ => {
            Err("a rate is a positive number of frames a second, such as 24, up to 1e6".to_owned())
        }
    }
}

pub(super) fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(tolerance) if (1e-12..1.0).contains(&tolerance) => Ok(tolerance),
        _ => Err("a tolerance lies between 1e-12 and 1, such as 1e-3".to_owned()),
    }
}
