//! The kernels of the bloom, as they are built for a film's format.

use crate::error::Result;
use crate::opencl::{
    Compute, DeviceStruct, FilmFormat, FilmPart, Kernel, Program, RendererOptions,
};

use super::sources::sources;
use super::steps::{BloomStep, Stage};

/// One kernel for each stage.
#[derive(Debug)]
pub(super) struct Kernels([Kernel; 5]);

impl Kernels {
    /// Builds them.
    ///
    /// # Errors
    /// As [`Program::build`].
    pub(super) fn build(
        compute: &Compute,
        format: FilmFormat,
        options: &RendererOptions,
    ) -> Result<(Self, Program)> {
        let text = sources().resolve("bloom/bloom.cl");
        let program = Program::build(compute, text, &definitions(format), options)?;
        let kernels = Self([
            program.kernel("halve_picture")?,
            program.kernel("halve_level")?,
            program.kernel("small_levels")?,
            program.kernel("double_level")?,
            program.kernel("finish")?,
        ]);
        Ok((kernels, program))
    }

    /// Returns the kernel of a stage.
    pub(super) fn of(&self, stage: Stage) -> &Kernel {
        let [
            halve_picture,
            halve_level,
            small_levels,
            double_level,
            finish,
        ] = &self.0;
        match stage {
            Stage::HalvePicture => halve_picture,
            Stage::HalveLevel => halve_level,
            Stage::SmallLevels => small_levels,
            Stage::DoubleLevel => double_level,
            Stage::Finish => finish,
        }
    }
}

fn definitions(format: FilmFormat) -> String {
    let sizes = [FilmPart::LAYOUT, BloomStep::LAYOUT];
    let sizes = sizes.map(|it| format!(" -D SIZEOF_{}={}", it.name.to_uppercase(), it.size));
    sizes.concat() + format.definitions()
}

/// Builds a text that includes files of `cl/bloom/`, for tests; `name` stands for it in the compiler's log.
pub(crate) fn build_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    let text = sources().resolve_text(name, text);
    Program::build(compute, text, &definitions(FilmFormat::Floats), options)
}
