//! The kernels of crowds, as they are built for a film's format.

use super::pack::STRUCTS;
use super::sources::sources;
use crate::error::Result;
use crate::opencl::{
    Compute, DeviceStruct, FilmFormat, FilmPart, Kernel, Program, RendererOptions,
};

/// One for each of the things that a frame does, in that order.
#[derive(Debug)]
pub(super) struct Kernels {
    pub clear: Kernel,
    /// Where rays end at depths.
    pub find_ends: Option<Kernel>,
    pub find_peaks: Kernel,
    pub sum_cells: Kernel,
    pub sum_quarters: Kernel,
    pub lay_sources: Kernel,
    pub lay_quarters: Kernel,
    pub light_tiles: Kernel,
    pub draw: Kernel,
}

/// Builds them, for rays that end at depths or are whole.
///
/// # Errors
/// As [`Program::build`].
pub(super) fn build(
    compute: &Compute,
    (format, has_ends): (FilmFormat, bool),
    options: &RendererOptions,
) -> Result<(Kernels, Program)> {
    let text = sources().resolve("crowd/draw.cl");
    let more = if has_ends { " -D WITH_ENDS" } else { "" };
    let definitions = definitions(format) + more;
    let program = Program::build(compute, text, &definitions, options)?;
    let find_ends = has_ends.then(|| program.kernel("find_ends"));
    let kernels = Kernels {
        clear: program.kernel("clear_crowd")?,
        find_ends: find_ends.transpose()?,
        find_peaks: program.kernel("find_peaks")?,
        sum_cells: program.kernel("sum_cells")?,
        sum_quarters: program.kernel("sum_quarters")?,
        lay_sources: program.kernel("lay_sources")?,
        lay_quarters: program.kernel("lay_quarters")?,
        light_tiles: program.kernel("light_tiles")?,
        draw: program.kernel("draw_crowd")?,
    };
    Ok((kernels, program))
}

fn definitions(format: FilmFormat) -> String {
    let sizes = STRUCTS.iter().chain([&FilmPart::LAYOUT]);
    let sizes = sizes.map(|it| format!(" -D SIZEOF_{}={}", it.name.to_uppercase(), it.size));
    sizes.collect::<String>() + format.definitions()
}

/// Builds a text that includes files of `cl/crowd/`, for tests; `name` stands for it in the compiler's log.
pub(crate) fn build_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    let text = sources().resolve_text(name, text);
    Program::build(compute, text, &definitions(FilmFormat::Floats), options)
}
