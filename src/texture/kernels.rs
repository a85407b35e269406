//! The kernel that draws volumes, as it is built for a film's format.

use super::pack::STRUCTS;
use crate::error::Result;
use crate::opencl::{
    Compute, DeviceStruct, FilmFormat, FilmPart, Kernel, Program, RendererOptions, SHARED,
    SourceFile, Sources, embed,
};

const FILES: &[SourceFile<'static>] = embed!("texture/texture.cl", "texture/types.h");

/// Builds it.
///
/// # Errors
/// As [`Program::build`].
pub(super) fn build(
    compute: &Compute,
    format: FilmFormat,
    options: &RendererOptions,
) -> Result<Kernel> {
    let sources = Sources {
        files: SHARED.iter().chain(FILES).copied().collect(),
        kinds: Vec::new(),
    };
    let sizes = STRUCTS.iter().chain([&FilmPart::LAYOUT]);
    let sizes = sizes.map(|it| format!(" -D SIZEOF_{}={}", it.name.to_uppercase(), it.size));
    let definitions = sizes.collect::<String>() + format.definitions();
    let text = sources.resolve("texture/texture.cl");
    Program::build(compute, text, &definitions, options)?.kernel("draw_texture")
}
