//! The kernels of meshes, and their launches.

use opencl3::event::Event;

use super::pack;
use super::sources::sources;
use crate::error::Result;
use crate::light;
use crate::opencl::{Argument, Compute, DeviceForm, Handle, Kernel, Program, RendererOptions};

/// Work-items in a group, which share nothing; of a CPU few enough that all cores are busy to the end.
const GROUP: usize = 16;
const GPU_GROUP: usize = 64;

/// Work-items of a launch: desktop GPUs kill launches of seconds.
const ITEMS: u32 = 1 << 17;

/// One kernel for each step.
#[derive(Debug)]
pub(super) struct Kernels {
    pub trace_pixels: Kernel,
    pub trace_rays: Kernel,
}

impl Kernels {
    /// Builds them.
    ///
    /// # Errors
    /// As [`Program::build`].
    pub(super) fn build(compute: &Compute, options: &RendererOptions) -> Result<(Self, Program)> {
        let text = sources().resolve("mesh/mesh.cl");
        let program = Program::build(compute, text, &pack::definitions(), options)?;
        let kernels = Self {
            trace_pixels: program.kernel("trace_pixels")?,
            trace_rays: program.kernel("trace_rays")?,
        };
        Ok((kernels, program))
    }
}

/// The kernels of the light on meshes, and on points that a host lists.
#[derive(Debug)]
pub(super) struct Shading {
    pub shade_meshes: Kernel,
    pub light_points: Kernel,
    /// What a work-item carries side by side.
    pub lanes: u32,
}

impl Shading {
    /// Builds them, with what looks for shadows, one ray at a time, or without.
    ///
    /// # Errors
    /// As [`Program::build`].
    pub(super) fn build(
        compute: &Compute,
        options: &RendererOptions,
        has_shadows: bool,
    ) -> Result<(Self, Program)> {
        let text = sources().resolve("mesh/shade.cl");
        let mut definitions = pack::definitions() + &light::definitions();
        let mut options = options.clone();
        if has_shadows {
            definitions += " -D SHADOWS";
            options.lanes = Some(1);
        }
        let program = Program::build(compute, text, &definitions, &options)?;
        let shading = Self {
            shade_meshes: program.kernel("shade_meshes")?,
            light_points: program.kernel("light_points")?,
            lanes: options.lanes.unwrap_or(compute.device().lanes),
        };
        Ok((shading, program))
    }
}

/// Builds a text that includes files of `cl/mesh/`, for tests; `name` stands for it in the compiler's log.
pub(crate) fn build_text(
    compute: &Compute,
    name: &str,
    text: &str,
    options: &RendererOptions,
) -> Result<Program> {
    let text = sources().resolve_text(name, text);
    let definitions = pack::definitions() + &light::definitions();
    Program::build(compute, text, &definitions, options)
}

/// Launches a kernel over so many work-items, which it counts from `first` to `end` by these names.
pub(super) fn launch(
    compute: &Compute,
    kernel: &Kernel,
    arguments: &[(&str, &dyn Argument)],
    (first, end, count): (&str, &str, u32),
    under_way: &mut Vec<Handle<Event>>,
) -> Result<()> {
    let wanted = match compute.device().form {
        DeviceForm::Gpu => GPU_GROUP,
        _ => GROUP,
    };
    let group = kernel.group(compute, wanted)?;
    for begin in (0..count).step_by(ITEMS as usize) {
        let stop = count.min(begin + ITEMS);
        let own: [(&str, &dyn Argument); 2] = [(first, &begin), (end, &stop)];
        let all = [arguments, &own[..]].concat();
        let event = kernel.launch(compute, &all, (stop - begin) as usize, group)?;
        under_way.push(event);
    }
    Ok(())
}
