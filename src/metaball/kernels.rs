//! The kernels of the metaballs, as they are built for the fields and methods that a scene's surfaces have.

use super::pack::STRUCTS;
use super::plan::Variant;
use super::sources::sources;
use crate::error::Result;
use crate::opencl::{Compute, Kernel, Program, RendererOptions};
use crate::scene::{AMBIENT, LAMP};

/// One kernel for each step.
#[derive(Debug)]
pub(super) struct Kernels {
    pub clear_cells: Kernel,
    pub count_particles: Kernel,
    pub sum_chunks: Kernel,
    pub begin_chunks: Kernel,
    pub begin_cells: Kernel,
    pub scatter_particles: Kernel,
    pub sort_cells: Kernel,
    pub find_slabs: Kernel,
    pub draw_surfaces: Kernel,
}

impl Kernels {
    /// Builds them.
    ///
    /// # Errors
    /// As [`Program::build`].
    pub(super) fn build(
        compute: &Compute,
        variant: Variant,
        options: &RendererOptions,
    ) -> Result<(Self, Program)> {
        let text = sources().resolve("metaball/metaball.cl");
        let mut definitions = definitions();
        for (is_there, word) in [
            (variant.has_cones, " -D CONES"),
            (variant.has_smooth, " -D SMOOTH"),
            (variant.has_sampling, " -D SAMPLING"),
            (options.counts_samples, " -D COUNT_NODES"),
        ] {
            definitions += if is_there { word } else { "" };
        }
        let program = Program::build(compute, text, &definitions, options)?;
        let kernels = Self {
            clear_cells: program.kernel("clear_cells")?,
            count_particles: program.kernel("count_particles")?,
            sum_chunks: program.kernel("sum_chunks")?,
            begin_chunks: program.kernel("begin_chunks")?,
            begin_cells: program.kernel("begin_cells")?,
            scatter_particles: program.kernel("scatter_particles")?,
            sort_cells: program.kernel("sort_cells")?,
            find_slabs: program.kernel("find_slabs")?,
            draw_surfaces: program.kernel("draw_surfaces")?,
        };
        Ok((kernels, program))
    }
}

fn definitions() -> String {
    let sizes = STRUCTS.iter();
    let sizes = sizes.map(|it| format!(" -D SIZEOF_{}={}", it.name.to_uppercase(), it.size));
    let lamp = LAMP.normalize();
    let [x, y, z] = [lamp.x, lamp.y, lamp.z].map(|axis| format!("{axis:.9}f"));
    sizes.collect::<String>() + &format!(" -D AMBIENT={AMBIENT:?}f -D LAMP={x},{y},{z}")
}

/// Builds a text that includes files of `cl/metaball/`, for tests; `name` stands for it in the compiler's log.
pub(crate) fn build_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    let text = sources().resolve_text(name, text);
    Program::build(compute, text, &definitions(), options)
}
