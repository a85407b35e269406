//! Options that replace values of the scene file.

use std::cell::OnceCell;
use std::fmt;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use energywave::Error;
use energywave::image::{DepthAlong, DepthImage, DepthOptions, ImageSize};
use energywave::scene::{self, Antialias, MethodKeys, Sampling, Scene};

use super::args::{divisions, scale, size, tolerance};

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
    pub opened_depth: OpenedDepth,
}

/// A depth image that was read, of which nothing was typed: it is not shown.
#[derive(Default)]
pub struct OpenedDepth(OnceCell<DepthImage>);

impl OpenedDepth {
    /// Lets it be read again.
    pub fn forget(&mut self) {
        self.0.take();
    }
}

impl fmt::Debug for OpenedDepth {
    fn fmt(&self, _: &mut fmt::Formatter<'_>) -> fmt::Result {
        Ok(())
    }
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

impl From<SamplingName> for Sampling {
    fn from(name: SamplingName) -> Self {
        match name {
            SamplingName::Pixels => Self::Pixels,
            SamplingName::Tiles => Self::Tiles,
        }
    }
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

impl From<MethodName> for scene::MethodName {
    fn from(name: MethodName) -> Self {
        match name {
            MethodName::Simpson => Self::Simpson,
            MethodName::Jittered => Self::Jittered,
            MethodName::Exact => Self::Exact,
        }
    }
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
            scene.depth = Some(match self.opened_depth.0.get() {
                Some(depth) => depth.clone(),
                None => self.open_depth(file, scene)?,
            });
        }
        let values = scene::Overrides {
            method: self.method.map(Into::into),
            divisions: self.divisions,
            tolerance: self.tolerance,
            sampling: self.sampling.map(Into::into),
            antialias: self.antialias.map(Into::into),
            ..scene::Overrides::default()
        };
        // What was typed is at odds with itself, whatever the scene is.
        values.apply(scene, keys).map_err(|error| match error {
            Error::Scene(fault) => Error::Unsupported(format!("--sampling: {}", fault.message)),
            other => other,
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
            let _ = self.opened_depth.0.set(depth.clone()); // it was empty
        }
        Ok(depth)
    }
}
