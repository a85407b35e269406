//! What the crate's own tests and benchmarks look at. No part of the interface: it may change with any version.
//!
//! What can run any kernel, or change what kernels do, is `unsafe`: a kernel may write anywhere.
#![allow(missing_docs, unsafe_code)]

use std::ops::ControlFlow;
use std::time::Duration;

pub use crate::bloom::{BloomStep, Spreader};
pub use crate::crowd::pack::STRUCTS as CROWD_STRUCTS;
pub use crate::glow::pack::STRUCTS as GLOW_STRUCTS;
pub use crate::light::pack::STRUCTS as LIGHT_STRUCTS;
pub use crate::mesh::pack::STRUCTS as MESH_STRUCTS;
pub use crate::mesh::{Tree, UploadedTree};
pub use crate::metaball::pack::STRUCTS as METABALL_STRUCTS;
pub use crate::opencl::{
    Argument, Compute, DeviceBuffer, DeviceForm, DeviceStruct, Discovery, Film, FilmFormat,
    FilmPart, Kernel, OpenClDevice, Pixel, Program, SHARED, Sources, StoredDepths, StructLayout,
    Uploaded, discover, host_depth_definitions,
};
pub use crate::reference::{
    CurveField, Field, Integrand, MeshRay, Sample, Source, SurfaceRay, b_spline, exact, integrate,
    mesh_rays, simpson, sources, surface_rays,
};
pub use crate::scene::ViewPlane;
pub use crate::texture::pack::STRUCTS as TEXTURE_STRUCTS;
pub use crate::wave::{Rule, Split, TILE_SHARES, Wave, pack};

use crate::bloom;
use crate::crowd;
use crate::error::{Error, Result};
use crate::glow;
use crate::mesh;
use crate::metaball;
use crate::opencl::{RendererOptions, run_time};
use crate::render::Renderer;
use crate::scene::Scene;
use crate::scene::kinds::KIND_COUNT;
use crate::texture;
use crate::wave;

/// The names of all kinds of source, in the order of the table.
pub const KINDS: [&str; KIND_COUNT] = crate::scene::kinds::KINDS;

/// Adds options for the OpenCL compiler.
///
/// ```
/// use energywave::internals::with_compiler_options;
///
/// // SAFETY: the kernels have no such name.
/// let options = unsafe { with_compiler_options(&Default::default(), "-D NOTHING") };
/// ```
///
/// Kernels that are built otherwise may write anywhere, so without `unsafe` it does not compile:
///
/// ```compile_fail,E0133
/// use energywave::internals::with_compiler_options;
///
/// let options = with_compiler_options(&Default::default(), "-D NOTHING");
/// ```
///
/// # Safety
/// Kernels that are built with them stay within their memory.
#[must_use]
pub unsafe fn with_compiler_options(options: &RendererOptions, more: &str) -> RendererOptions {
    RendererOptions {
        compiler_options: more.to_owned(),
        ..options.clone()
    }
}

/// Makes a renderer integrate by this rule, whatever the tolerance; does nothing on several devices and on the
/// reference.
pub fn set_rule(renderer: &mut Renderer, rule: Rule) {
    if let Some(wave) = renderer.wave() {
        wave.set_rule(Some(rule));
    }
}

/// Cuts a renderer's frames into launches in this way, whatever the pace; `None`: by time. Does nothing on several
/// devices and on the reference.
pub fn force_split(renderer: &mut Renderer, split: Option<Split>) {
    if let Some(wave) = renderer.wave() {
        wave.force_split(split);
    }
}

/// Returns the resolved text of a file of `cl/`, with the kinds of source that are named.
#[must_use]
pub fn resolve(file: &str, kinds: &[&str]) -> String {
    wave::resolve(file, &present(kinds))
}

fn present(kinds: &[&str]) -> wave::Present {
    KINDS.map(|kind| kinds.contains(&kind))
}

/// A program of the wave: which rays its kernel takes, and what it is built for.
#[derive(Debug, Clone, Copy)]
pub struct ProgramTask<'a> {
    /// `tiles`, `render` (every pixel) or `trace` (listed rays).
    pub kernel: &'a str,
    /// Kinds of source, by name.
    pub kinds: &'a [&'a str],
    /// Of the method `exact`; `None`: Simpson's rule.
    pub tolerance: Option<f64>,
    pub has_squares: bool,
    pub has_shapes: bool,
    pub has_convolutions: bool,
    /// The power of the decay where light fades in another way than by that of 2015.
    pub fading: Option<u32>,
    pub has_series: bool,
    pub has_depth: bool,
    /// Rays that a work-item carries side by side.
    pub lanes: u32,
    /// Work-items that share a tile.
    pub workers: u32,
}

/// Returns the text and the options with which the driver's compiler is given a program, for compilers that run
/// without a device.
#[must_use]
pub fn program_text(program: &ProgramTask<'_>) -> (String, String) {
    let rule = Rule::of(program.tolerance.unwrap_or(1.0), program.has_squares, false);
    let task = wave::Task {
        method: match program.tolerance {
            None => wave::Variant::Simpson,
            Some(_) => wave::Variant::Exact {
                nodes: rule.nodes,
                coarse: rule.coarse,
            },
        },
        kinds: present(program.kinds),
        has_squares: program.has_squares,
        has_shapes: program.has_shapes,
        has_convolutions: program.has_convolutions,
        fading: program.fading,
        reduced: wave::Reduced::Sum,
        has_series: program.has_series,
        has_ends: program.has_shapes && program.kernel == "tiles",
        has_footprints: program.tolerance.is_some() && program.kernel != "trace",
        has_depth: program.has_depth,
        film: FilmFormat::Floats,
        rays: match program.kernel {
            "tiles" => wave::Rays::Tiles,
            "trace" => wave::Rays::Listed,
            _ => wave::Rays::Pixels,
        },
    };
    let form = (program.lanes, program.workers);
    let (_, text, options) = wave::program_text(&task, &rule, form);
    (text, options)
}

/// Builds a text that may include files of `cl/`, with the kinds of source that are named; `name` stands for it in the
/// compiler's log.
///
/// # Errors
/// [`crate::Error::Build`] with the compiler's log, places as `cl/FILE:LINE`.
pub fn build_text(
    compute: &Compute,
    name: &str,
    text: &str,
    kinds: &[&str],
    options: &RendererOptions,
) -> Result<Program> {
    let text = wave::resolve_text(name, text, &present(kinds));
    let definitions = wave::common_definitions(options.counts_samples);
    Program::build(compute, text, &definitions, options)
}

/// Builds a text that may include files of `cl/bloom/`, as [`build_text`] does with those of the wave.
///
/// # Errors
/// As there.
pub fn build_bloom_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    bloom::build_text(compute, name, text, options)
}

/// Returns what a renderer finds of a scene's surfaces: the length of every ray, and the light of every pixel, RGBA.
///
/// # Errors
/// As [`Renderer::render`].
pub fn see_surfaces(renderer: &mut Renderer, scene: &Scene) -> Result<(Vec<f32>, Vec<f32>)> {
    scene.validate()?;
    let (seen, _) = renderer.see_surfaces(scene)?;
    Ok((seen.depth.as_slice().to_vec(), seen.light.to_vec()))
}

/// Returns what a renderer finds of all surfaces of a scene, meshes too: as [`see_surfaces`] does of metaballs.
///
/// # Errors
/// As [`Renderer::render`].
pub fn see_all_surfaces(renderer: &mut Renderer, scene: &Scene) -> Result<(Vec<f32>, Vec<f32>)> {
    scene.validate()?;
    let seen = renderer.see_all_surfaces(scene)?;
    Ok((seen.depth.as_slice().to_vec(), seen.light.to_vec()))
}

/// Builds a text that may include files of `cl/metaball/`, as [`build_text`] does with those of the wave.
///
/// # Errors
/// As there.
pub fn build_metaball_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    metaball::build_text(compute, name, text, options)
}

/// Builds a text that may include files of `cl/mesh/`, as [`build_text`] does with those of the wave.
///
/// # Errors
/// As there.
pub fn build_mesh_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    mesh::build_text(compute, name, text, options)
}

/// Builds a text that may include files of `cl/glow/`, as [`build_text`] does with those of the wave.
///
/// # Errors
/// As there.
pub fn build_glow_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    glow::build_text(compute, name, text, options)
}

/// Builds a text that may include files of `cl/crowd/`, as [`build_text`] does with those of the wave.
///
/// # Errors
/// As there.
pub fn build_crowd_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    crowd::build_text(compute, name, text, options)
}

/// Builds a text that may include files of `cl/texture/`, as [`build_text`] does with those of the wave.
///
/// # Errors
/// As there.
pub fn build_texture_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    texture::build_text(compute, name, text, options)
}

/// Runs a kernel over `items` work-items, in groups of `group`, waits for it, and returns how long the device worked.
///
/// Whoever runs one promises that it stays within its memory:
///
/// ```
/// use energywave::internals::{Compute, Program, run};
///
/// fn promised(compute: &Compute, program: &Program) {
///     // SAFETY: the kernel does nothing.
///     let _ = unsafe { run(compute, program, "nothing", &[], 1, 1) };
/// }
/// ```
///
/// Without the promise it does not compile:
///
/// ```compile_fail,E0133
/// use energywave::internals::{Compute, Program, run};
///
/// fn promised(compute: &Compute, program: &Program) {
///     let _ = run(compute, program, "nothing", &[], 1, 1);
/// }
/// ```
///
/// # Safety
/// The kernel stays within the memory that it is given.
///
/// # Errors
/// [`crate::Error::Device`] if an argument or the launch is refused.
pub unsafe fn run(
    compute: &Compute,
    program: &Program,
    kernel: &str,
    arguments: &[(&str, &dyn Argument)],
    items: usize,
    group: usize,
) -> Result<Duration> {
    let kernel = program.kernel(kernel)?;
    let event = kernel.launch(compute, arguments, items, group)?;
    run_time(compute, &event)
}

/// Draws a whole frame into a film, as a renderer does, and waits for it.
///
/// # Errors
/// As [`Renderer::render`]; [`Error::OutOfMemory`] if the image is larger than one buffer of the device,
/// [`Error::Unsupported`] if the film is of another size.
pub fn draw_wave(
    wave: &mut Wave,
    compute: &Compute,
    scene: &Scene,
    film: &mut Film,
) -> Result<crate::FrameCost> {
    scene.validate()?;
    let pixels = scene.image.pixels();
    let plan = wave.plan(compute, scene, film.format())?;
    if film.reserve_band(compute, pixels, plan.grain())? < pixels {
        let message = "the image is larger than one buffer of the device".to_owned();
        return Err(Error::OutOfMemory(message));
    }
    wave.begin(compute, &plan, pixels)?;
    film.begin_at(0);
    let nothing = &mut |_: u32| ControlFlow::Continue(());
    wave.draw(compute, &plan, 0..pixels as u32, film, nothing)?;
    wave.settle(compute, &plan)?;
    wave.settle_uploads(compute)?;
    Ok(wave.cost())
}

/// Runs a kernel of another engine over all pixels of a film, a work-item for `lanes` of them, and waits for it. The
/// film's parameters have the names of `cl/film.h`.
///
/// ```
/// use energywave::internals::{Compute, Film, Program, run_on_film};
///
/// fn promised(compute: &Compute, program: &Program, film: &mut Film) {
///     // SAFETY: the kernel stores the pixels that it is told of.
///     let _ = unsafe { run_on_film(compute, program, "paint", &[], film, (8, 8)) };
/// }
/// ```
///
/// ```compile_fail,E0133
/// use energywave::internals::{Compute, Film, Program, run_on_film};
///
/// fn promised(compute: &Compute, program: &Program, film: &mut Film) {
///     let _ = run_on_film(compute, program, "paint", &[], film, (8, 8));
/// }
/// ```
///
/// # Safety
/// The kernel stays within the memory that it is given.
///
/// # Errors
/// [`crate::Error::Device`] if an argument or the launch is refused.
pub unsafe fn run_on_film(
    compute: &Compute,
    program: &Program,
    kernel: &str,
    arguments: &[(&str, &dyn Argument)],
    film: &mut Film,
    size: (u32, u32),
) -> Result<Duration> {
    let pixels = 0..size.0 * size.1;
    let items = pixels.len().div_ceil(program.lanes as usize);
    let on_film = film.arguments(compute, &pixels, size, true, true)?;
    let arguments = [&on_film.named(), arguments].concat();
    // SAFETY: the caller's promise.
    unsafe { run(compute, program, kernel, &arguments, items, 16) }
}
