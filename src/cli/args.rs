//! What can be typed.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};
use energywave::image::{DepthAlong, DepthImage, DepthOptions, Exposure, ImageSize};
use energywave::scene::{Antialias, Method, MethodKeys, Sampling, Scene};
use energywave::{Error, RendererOptions, SlowStart};

use super::examples;
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
    /// Draw a scene again whenever it is saved: to a file, or in a window
    #[command(after_help = examples::WATCH)]
    Watch(WatchArguments),
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

/// Options that replace values of the scene file.
#[derive(Debug, Args)]
pub struct Overrides {
    /// Size of the image in pixels, such as 640x360
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true, requires = "scene")]
    pub size: Option<ImageSize>,
    /// The quadrature
    #[arg(long, requires = "scene")]
    pub method: Option<MethodName>,
    /// Divisions of --method simpson or jittered, even, 2 to 65536; chooses simpson where the scene has neither
    #[arg(long, value_parser = divisions, allow_hyphen_values = true, requires = "scene")]
    pub divisions: Option<u32>,
    /// Relative error aimed at by the exact method; chooses --method exact
    #[arg(long, value_parser = tolerance, allow_hyphen_values = true, requires = "scene")]
    pub tolerance: Option<f64>,
    /// Where the exact method takes integrals [default: the scene's, else tiles]; chooses --method exact
    #[arg(long, requires = "scene")]
    pub sampling: Option<SamplingName>,
    /// Which rays a pixel of the exact method stands for [default: the scene's, else footprint]
    #[arg(long, value_enum)]
    pub antialias: Option<AntialiasName>,
    /// Depth image (.exr, 16-bit .png, .raw or .f32) of the scene's size, which hides the light behind it
    #[arg(long, value_name = "FILE", requires = "scene")]
    pub depth: Option<PathBuf>,
    /// What the depths of --depth are lengths of [default: ray]
    #[arg(long, value_name = "WAY", requires = "depth")]
    pub depth_along: Option<DepthAlongName>,
    /// Exact name of the channel of --depth that holds the depths, such as ViewLayer.Depth.Z, or part.channel
    /// [default: Z, else the one whose name says depth]
    #[arg(long, value_name = "NAME", requires = "depth")]
    pub depth_channel: Option<String>,
    /// World units to a unit of --depth, such as 0.01 for centimetres in a scene in metres [default: 1]
    #[arg(long, value_name = "FACTOR", value_parser = scale, allow_hyphen_values = true, requires = "depth")]
    pub depth_scale: Option<f64>,
    /// Value of --depth that means that nothing is there, such as 0, -1 or nan; infinity always does
    #[arg(
        long,
        value_name = "VALUE",
        allow_hyphen_values = true,
        requires = "depth"
    )]
    pub depth_none: Option<f64>,
    /// The image of --depth, once it was read, unless it depends on a camera that may move.
    #[arg(skip)]
    pub opened_depth: OnceCell<DepthImage>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DepthAlongName {
    /// The view ray: a distance from the eye
    Ray,
    /// The direction of view, as most renderers' Z
    Axis,
    /// z / w behind the projection of the scene's camera
    Ndc,
    /// The same as depth buffers hold it, 0 to 1
    Buffer,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum AntialiasName {
    /// All that pass its square: their mean
    Footprint,
    /// The one through its centre, as in the papers
    None,
}

impl From<AntialiasName> for Antialias {
    fn from(name: AntialiasName) -> Self {
        match name {
            AntialiasName::Footprint => Self::Footprint,
            AntialiasName::None => Self::None,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SamplingName {
    /// At every pixel
    Pixels,
    /// At every pixel near cores, interpolated within the tolerance elsewhere
    Tiles,
}

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

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// Composite Simpson rule with equal divisions, as in the paper of 2015
    Simpson,
    /// Stratified samples, at a random place of each pixel's divisions
    Jittered,
    /// The integral itself
    Exact,
}

impl Overrides {
    /// Returns whether nothing was typed.
    pub fn is_empty(&self) -> bool {
        self.size.is_none()
            && self.method.is_none()
            && self.divisions.is_none()
            && self.tolerance.is_none()
            && self.sampling.is_none()
            && self.antialias.is_none()
            && self.depth.is_none()
    }

    /// Replaces what was typed. `keys` is what the file says of all methods.
    pub fn apply(&self, scene: &mut Scene, keys: &MethodKeys) -> Result<(), Error> {
        if let Some(size) = self
            .size
            .filter(|size| size.width.max(size.height) > ImageSize::LIMIT)
        {
            return Err(Error::input(
                "--size",
                format!(
                    "{}x{} pixels; an image is at most {limit}x{limit}",
                    size.width,
                    size.height,
                    limit = ImageSize::LIMIT
                ),
            ));
        }
        scene.image = self.size.unwrap_or(scene.image);
        if let Some(file) = &self.depth {
            scene.depth = Some(match self.opened_depth.get() {
                Some(depth) => depth.clone(),
                None => self.open_depth(file, scene)?,
            });
        }
        scene.integration.method = self.method(scene.integration.method, keys)?;
        if let Some(name) = self.antialias {
            scene.integration.antialias = name.into();
        }
        Ok(())
    }

    fn method(&self, of_scene: Method, keys: &MethodKeys) -> Result<Method, Error> {
        let asks_sum = self.divisions.is_some();
        let asks_exact = self.tolerance.is_some() || self.sampling.is_some();
        let of_scene = match of_scene {
            Method::Simpson { .. } => MethodName::Simpson,
            Method::Jittered { .. } => MethodName::Jittered,
            _ => MethodName::Exact,
        };
        let name = match self.method {
            Some(name) => name,
            // Naming divisions asks for a sum of so many; naming a tolerance asks for it to be met.
            None if asks_sum == asks_exact => of_scene,
            None if asks_exact => MethodName::Exact,
            None if of_scene == MethodName::Exact => MethodName::Simpson,
            None => of_scene,
        };
        if name != MethodName::Exact && self.sampling == Some(SamplingName::Tiles) {
            let message = "--sampling tiles is for --method exact; the others take every pixel";
            return Err(Error::Unsupported(message.to_owned()));
        }
        let divisions = self.divisions.unwrap_or(keys.divisions);
        let sampling = match self.sampling {
            Some(SamplingName::Pixels) => Sampling::Pixels,
            Some(SamplingName::Tiles) => Sampling::Tiles,
            None => keys.sampling,
        };
        Ok(match name {
            MethodName::Simpson => Method::Simpson { divisions },
            MethodName::Jittered => Method::Jittered {
                divisions,
                seed: keys.seed,
            },
            MethodName::Exact => Method::Exact {
                tolerance: self.tolerance.unwrap_or(keys.tolerance),
                sampling,
            },
        })
    }

    /// Opens the image of `--depth`, for a scene.
    fn open_depth(&self, file: &Path, scene: &Scene) -> Result<DepthImage, Error> {
        let image = scene.image;
        let mut options = DepthOptions::from(match self.depth_along {
            Some(DepthAlongName::Axis) => DepthAlong::Axis,
            Some(DepthAlongName::Ndc) => DepthAlong::Ndc,
            Some(DepthAlongName::Buffer) => DepthAlong::Buffer,
            Some(DepthAlongName::Ray) | None => DepthAlong::Ray,
        });
        options.channel.clone_from(&self.depth_channel);
        options.scale = self.depth_scale.unwrap_or(options.scale);
        options.none = self.depth_none;
        options.size = Some(image);
        if let (false, Some(matrices)) = (options.along.is_length(), &scene.camera.matrices) {
            options.clip = Some(matrices.clip_depth()?);
        }
        let is_length = options.along.is_length();
        let depth = DepthImage::open(file, options)?;
        let size = depth.size();
        if size != image {
            return Err(Error::input(
                file,
                format!(
                    "{}x{} pixels, the image has {}x{}; they must be equal",
                    size.width, size.height, image.width, image.height
                ),
            ));
        }
        if is_length {
            let _ = self.opened_depth.set(depth.clone()); // it was empty
        }
        Ok(depth)
    }
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

fn divisions(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(divisions @ 2..=65536) if divisions % 2 == 0 => Ok(divisions),
        _ => Err("Simpson's rule needs an even number from 2 to 65536".to_owned()),
    }
}

fn exposure(text: &str) -> Result<Exposure, String> {
    match (text, text.parse()) {
        ("auto", _) => Ok(Exposure::Auto),
        (_, Ok(stops)) if (-100.0..=100.0).contains(&stops) => Ok(Exposure::Stops(stops)),
        _ => Err("an exposure is a number of stops from -100 to 100, or auto".to_owned()),
    }
}

fn scale(text: &str) -> Result<f64, String> {
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
