//! The kernels of particles as light: what draws them, as it is built for a film's format, and what integrates along
//! listed rays.

use super::pack::STRUCTS;
use super::sources::sources;
use crate::error::Result;
use crate::opencl::{
    Compute, DeviceStruct, FilmFormat, FilmPart, Kernel, Program, RendererOptions,
};

/// Builds it.
///
/// # Errors
/// As [`Program::build`].
pub(super) fn build(
    compute: &Compute,
    format: FilmFormat,
    options: &RendererOptions,
) -> Result<(Kernel, Program)> {
    let text = sources().resolve("glow/glow.cl");
    let program = Program::build(compute, text, &definitions(format), options)?;
    Ok((program.kernel("draw_particles")?, program))
}

/// Builds the kernel that integrates along listed rays.
///
/// # Errors
/// As [`Program::build`].
pub(super) fn build_along(
    compute: &Compute,
    options: &RendererOptions,
) -> Result<(Kernel, Program)> {
    let text = sources().resolve("glow/trace.cl");
    let program = Program::build(compute, text, &definitions(FilmFormat::Floats), options)?;
    Ok((program.kernel("trace_particles")?, program))
}

fn definitions(format: FilmFormat) -> String {
    let sizes = STRUCTS.iter().chain([&FilmPart::LAYOUT]);
    let sizes = sizes.map(|it| format!(" -D SIZEOF_{}={}", it.name.to_uppercase(), it.size));
    sizes.collect::<String>() + format.definitions()
}

/// Builds a text that includes files of `cl/glow/`, for tests; `name` stands for it in the compiler's log.
pub(crate) fn build_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    let text = sources().resolve_text(name, text);
    Program::build(compute, text, &definitions(FilmFormat::Floats), options)
}
