//! The kernel that draws volumes, as it is built for a film's format.

use super::pack::STRUCTS;
use super::sources::sources;
use crate::error::Result;
use crate::opencl::{
    Compute, DeviceStruct, FilmFormat, FilmPart, Kernel, Program, RendererOptions,
};

/// What a kernel is built for: the film, and whether cells are texels of images.
pub(super) type Form = (FilmFormat, bool);

/// Builds it.
///
/// # Errors
/// As [`Program::build`].
pub(super) fn build(
    compute: &Compute,
    (format, has_images): Form,
    options: &RendererOptions,
) -> Result<(Kernel, Program)> {
    let text = sources().resolve("texture/texture.cl");
    let images = if has_images {
        " -D CELLS_IN_IMAGES"
    } else {
        ""
    };
    let definitions = definitions(format) + images;
    let program = Program::build(compute, text, &definitions, options)?;
    Ok((program.kernel("draw_texture")?, program))
}

fn definitions(format: FilmFormat) -> String {
    let sizes = STRUCTS.iter().chain([&FilmPart::LAYOUT]);
    let sizes = sizes.map(|it| format!(" -D SIZEOF_{}={}", it.name.to_uppercase(), it.size));
    sizes.collect::<String>() + format.definitions()
}

/// Builds a text that includes files of `cl/texture/`, for tests; `name` stands for it in the compiler's log.
pub(crate) fn build_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    let text = sources().resolve_text(name, text);
    Program::build(compute, text, &definitions(FilmFormat::Floats), options)
}
