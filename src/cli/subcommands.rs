//! What can be typed after every subcommand but `render`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use energywave::glam::DVec3;
use energywave::image::ImageSize;

use super::animate::{Range, range};
use super::args::{DeviceArgument, point, rate, seconds, size, time, tolerance};
use super::overrides::Overrides;
use super::records::DataArgument;

#[derive(Debug, Args)]
pub struct BakeArguments {
    /// Scene file, TOML or (.json) JSON; - is standard input
    pub scene: PathBuf,
    /// Volume to write: .vdb, .nrrd, .vti, or with a .json beside it .exr (layers side by side) or .raw
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Cells along the longest edge of the box, at most 2048; they are cubes
    #[arg(long, value_name = "N", default_value_t = 128)]
    pub cells: u32,
    /// Box that is sampled: its middle and its edges, world units, such as 0,0,0 4,2,2 [default: around all light,
    /// which must have a reach]
    #[arg(long = "box", num_args = 2, value_names = ["MIDDLE", "EDGES"], value_parser = point)]
    #[arg(allow_hyphen_values = true)]
    pub bounds: Option<Vec<DVec3>>,
    /// Give each cell the mean of NxNxN places in it; 1: what its middle gives off [default: 1; 4 where a core without
    /// radius gives off light without end]
    #[arg(long, value_name = "N")]
    pub mean: Option<u32>,
    /// Write half floats, into a .vdb or an .exr
    #[arg(long)]
    pub half: bool,
    /// When it is in a scene that moves, seconds [default: 0]
    #[arg(long, value_name = "SECONDS", value_parser = time, allow_hyphen_values = true)]
    pub time: Option<f64>,
    /// Write a volume for each of these frames: wave.vdb becomes wave.0000.vdb, wave.####.vdb and wave.%04d.vdb too
    #[arg(long, value_name = "A..B", value_parser = range, allow_hyphen_values = true)]
    pub frames: Option<Range>,
    /// Frames a second
    #[arg(long, value_name = "RATE", value_parser = rate, allow_hyphen_values = true, default_value_t = 24.0)]
    pub fps: f64,
    #[command(flatten)]
    pub device: DeviceArgument,

    /// What cells store: light, or for volumes of scenes its reciprocal, with which cubic interpolation is exact
    /// near cores
    #[arg(long, value_name = "WHAT", value_enum, default_value_t)]
    pub store: Store,
}

#[derive(Debug, Args)]
pub struct ExportArguments {
    /// Scene file, TOML or (.json) JSON; - is standard input
    pub scene: PathBuf,
    /// What the shader is written in
    #[arg(long = "to", value_enum, value_name = "LANGUAGE")]
    pub language: LanguageName,
    /// Text to write; - is standard output
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Where the text begins
    #[arg(long, value_enum, default_value_t = EntryName::Image)]
    pub entry: EntryName,
    /// File for the uniform block: its bytes, little-endian float32, or (.json) name, offset and numbers of each field
    #[arg(long, value_name = "FILE")]
    pub uniforms: Option<PathBuf>,
    /// When it is in a scene that moves, seconds [default: 0]
    #[arg(long, visible_alias = "at", value_name = "SECONDS", value_parser = time, allow_hyphen_values = true)]
    pub time: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LanguageName {
    /// WebGPU's
    Wgsl,
    /// OpenGL's, version 3.30
    Glsl,
    /// Direct3D's
    Hlsl,
    /// GLSL ES to paste into Shadertoy, with its values in the text
    Shadertoy,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EntryName {
    /// The function wave_light, to call from a shader of your own
    Function,
    /// Also a picture by the scene's camera
    Image,
    /// The function wave_irradiance alone: the light that points and straight cores cast on a surface
    Irradiance,
}

#[derive(Debug, Args)]
pub struct NewArguments {
    /// Name of the preset, one of those that --list shows
    #[arg(required_unless_present = "list")]
    pub name: Option<String>,
    /// Scene file to write; - is standard output [default: NAME.toml]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Write in the place of a file that is there
    #[arg(long)]
    pub force: bool,
    /// List the presets, a line for each
    #[arg(long, conflicts_with_all = ["name", "output", "force"])]
    pub list: bool,
}

#[derive(Debug, Args)]
pub struct DevicesArguments {
    /// Print a JSON array
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct VerifyArguments {
    /// JSON file of rays instead of the built-in ones
    #[arg(long)]
    pub rays: Option<PathBuf>,
    /// Relative error aimed at by the exact method, and allowed to it
    #[arg(long, default_value_t = 1e-3, value_parser = tolerance, allow_hyphen_values = true)]
    pub tolerance: f64,
    /// Print a JSON array
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub device: DeviceArgument,
}

#[derive(Debug, Args)]
pub struct BenchArguments {
    /// Scene file to measure instead of the paper's tables
    pub scene: Option<PathBuf>,
    /// A paper's table: 2 (torus) or 3 (Bezier) of 2015, both without; 2010 (beam, with and without hidden surfaces);
    /// 2008 (metaballs); 2013 (particles that hit a box); 2006 (a volume); crowd (points of light)
    #[arg(long, value_enum, conflicts_with = "scene")]
    pub table: Option<TableName>,
    #[command(flatten)]
    pub data: DataArgument,
    /// Folder for the last frame of each measurement, as EXR
    #[arg(long, value_name = "DIR")]
    pub frames_out: Option<PathBuf>,
    /// Time of each measurement
    #[arg(long, default_value_t = 1.0, value_parser = seconds)]
    pub seconds: f64,
    #[command(flatten)]
    pub overrides: Overrides,
    #[command(flatten)]
    pub device: DeviceArgument,
}

#[derive(Debug, Args)]
pub struct CompareArguments {
    /// Scene file, TOML or JSON
    pub scene: PathBuf,
    /// Size of the images in pixels, such as 128x128 [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<ImageSize>,
    /// Map of the relative errors of the exact method to write: .exr (of R, G, B) or .png (in colours, on a logarithmic
    /// scale from 1e-7 to 1e-1); several may be given
    #[arg(long = "map", value_name = "FILE")]
    pub maps: Vec<PathBuf>,
    #[command(flatten)]
    pub data: DataArgument,
    /// Time of each measurement of speed
    #[arg(long, default_value_t = 0.5, value_parser = seconds)]
    pub seconds: f64,
    #[command(flatten)]
    pub device: DeviceArgument,
}

#[derive(Debug, Args)]
pub struct ContactsArguments {
    /// Scene file, TOML or (.json) JSON; - is standard input
    pub scene: PathBuf,
    /// First and last frame of the simulation whose contacts are told [default: 0 to the scene's [simulation] time]
    #[arg(long, value_name = "A..B", value_parser = range, allow_hyphen_values = true)]
    pub frames: Option<Range>,
    /// File to write; - is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    pub output: PathBuf,
}

#[derive(Debug, Args)]
pub struct FiguresArguments {
    /// Folder for the pictures and index.html; it is made where there is none
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Size of the pictures in pixels, such as 512x512 [default: those of the scenes]
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<ImageSize>,
    #[command(flatten)]
    pub device: DeviceArgument,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TableName {
    /// A torus by Simpson's rule (2015)
    #[value(name = "2")]
    Torus,
    /// A Bezier curve by Simpson's rule (2015)
    #[value(name = "3")]
    Bezier,
    /// A beam in closed form, with and without hidden surfaces
    #[value(name = "2010")]
    Beam,
    /// Metaballs, exactly and by samples
    #[value(name = "2008")]
    Metaballs,
    /// Particles that hit a box, as sprites and as streaks
    #[value(name = "2013")]
    Collisions,
    /// A beam by ray casting, and as a volume by slices, along rays and as a billboard
    #[value(name = "2006")]
    Volumes,
    /// Points of light, up to a million
    Crowd,
}

#[derive(Debug, Args)]
pub struct CompletionsArguments {
    /// The shell
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub struct ManArguments {
    /// A subcommand [default: the program]
    pub subcommand: Option<String>,
}

#[derive(Debug, Args)]
pub struct HelpArguments {
    /// A subcommand; or scene, for the keys of scene files, and one of their tables
    #[arg(value_name = "TOPIC", num_args = 0..=2)]
    pub topic: Vec<String>,
}

/// What cells store.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Store {
    /// Light that a world unit of length gives off
    #[default]
    Emission,
    /// 1 over its square, or over itself where all light falls off with the square of the distance
    Reciprocal,
}
