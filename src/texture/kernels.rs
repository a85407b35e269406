//! The kernel that draws volumes, as it is built for a film's format.

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
) -> Result<Kernel> {
    let sizes = STRUCTS.iter().chain([&FilmPart::LAYOUT]);
    let sizes = sizes.map(|it| format!(" -D SIZEOF_{}={}", it.name.to_uppercase(), it.size));
    let definitions = sizes.collect::<String>() + format.definitions();
    let text = sources().resolve("texture/texture.cl");
    Program::build(compute, text, &definitions, options)?.kernel("draw_texture")
}
