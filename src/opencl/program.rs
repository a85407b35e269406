//! Builds the kernels for a device, with readable logs, and runs them.

use std::ffi::{CStr, CString};
use std::ptr;
use std::time::Duration;

use bytemuck::Pod;
use opencl3::error_codes::{CL_INVALID_KERNEL_NAME, ClError};
use opencl3::event::Event;
use opencl3::kernel::{Kernel, create_kernel};
use opencl3::program::{
    CL_PROGRAM_BINARIES, CL_PROGRAM_BUILD_LOG, build_program, create_program_with_binary,
    create_program_with_source, get_program_build_info, get_program_info,
};
use opencl3::types::cl_mem;

use super::counts::{self, Counts};
use super::depths::Depths;
use super::failure::{code_name, failed};
use super::handle::{Handle, RawProgram};
use super::{Compute, DeviceBuffer, KernelCache, ProgramKey, Uploaded, source};
use crate::error::{Error, Result};
use crate::pack::{Rule, layout};
use crate::reference::CORE_FLOOR;

/// Environment variable with further options for the kernels' compiler, such as `-D NAME` or `-cl-opt-disable`.
const OPTIONS_VARIABLE: &str = "ENERGYWAVE_BUILD_OPTIONS";

/// The kind of a cached program binary.
const BINARY: &str = "bin";

/// How the kernels are built.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BuildOptions {
    /// Lanes: 1, 4, 8 or 16; `None`: what suits the device.
    pub lanes: Option<u32>,
    /// The quadrature of the method `exact`; `None`: what meets the scene's tolerance.
    pub rule: Option<Rule>,
    /// Work-items that share a tile, no more than 16 divided by the lanes; `None`: as many on a GPU, 1 elsewhere.
    pub tile_workers: Option<u32>,
    /// Whether the method `exact` counts its nodes, for [`crate::renderer::FrameCost::field_evaluations`].
    pub counts_nodes: bool,
    /// Further options for the OpenCL compiler.
    pub extra: String,
    /// Whether kernels draw without having shown, at their first use on a device, that they compute right.
    pub skips_self_test: bool,
    /// Whether what was built is kept on disk for the next start.
    pub cache: KernelCache,
}

/// A built program.
#[derive(Debug)]
pub struct Program {
    program: Handle<RawProgram>,
    device: String,
    key: ProgramKey,
    /// Lanes it was built for.
    pub lanes: u32,
}

impl Program {
    /// Builds files of `cl/`.
    ///
    /// # Errors
    /// [`Error::Build`] with the compiler's log, places as `cl/FILE:LINE`.
    pub fn build(compute: &Compute, files: &[&str], options: &BuildOptions) -> Result<Self> {
        Self::build_resolved(compute, &source::resolve(files), options)
    }

    /// Builds a text that may include files of `cl/`; `name` stands for it in the compiler's log.
    ///
    /// # Errors
    /// As [`Program::build`].
    pub fn build_text(
        compute: &Compute,
        name: &str,
        text: &str,
        options: &BuildOptions,
    ) -> Result<Self> {
        Self::build_resolved(compute, &source::resolve_text(name, text), options)
    }

    fn build_resolved(compute: &Compute, text: &str, options: &BuildOptions) -> Result<Self> {
        let device = &compute.device;
        let lanes = options.lanes.unwrap_or(device.lanes);
        let flags = compiler_flags(lanes, options);
        let refused = |code: String, log: String| Error::Build {
            device: device.name.clone(),
            code,
            log,
        };
        let key = ProgramKey::new(device, text, &flags);
        let Ok(flags) = CString::new(flags) else {
            let fault = "options contain a NUL byte".to_owned();
            return Err(refused(fault, String::new()));
        };
        let built = |program| Self {
            program,
            device: device.name.clone(),
            key,
            lanes,
        };
        let folder = options.cache.folder(device);
        let kept = folder.as_ref().and_then(|folder| folder.read(key, BINARY));
        if let Some(program) = kept.and_then(|binary| from_binary(compute, &binary, &flags)) {
            return Ok(built(program));
        }
        let program = create_program_with_source(compute.context.get(), &[text])
            .map(|program| Handle::new(RawProgram::new(program)))
            .map_err(ClError)
            .map_err(failed(&device.name, "clCreateProgramWithSource"))?;
        build(compute, &program, &flags).map_err(|code| {
            let log =
                get_program_build_info(program.get(), device.handle.id(), CL_PROGRAM_BUILD_LOG);
            let log = log.map(String::from).unwrap_or_default();
            let chosen = format!("LANES={lanes} {}", options.extra);
            refused(format!("{}, {}", code_name(code), chosen.trim()), log)
        })?;
        if let Some(folder) = folder
            && let Some(binary) = binary_of(&program)
        {
            let _ = folder.write(key, BINARY, &binary); // kept or not, the program is built
        }
        Ok(built(program))
    }

    /// What it was built from and for.
    pub fn key(&self) -> ProgramKey {
        self.key
    }

    /// One of its kernels.
    ///
    /// # Errors
    /// [`Error::Device`] if there is no such kernel.
    pub(super) fn kernel(&self, name: &str) -> Result<Handle<Kernel>> {
        let refused = failed(&self.device, "clCreateKernel");
        let Ok(name) = CString::new(name) else {
            return Err(refused(ClError(CL_INVALID_KERNEL_NAME)));
        };
        create_kernel(self.program.get(), &name)
            .map(|kernel| Handle::new(Kernel::new(kernel)))
            .map_err(|code| refused(ClError(code)))
    }
}

fn build(compute: &Compute, program: &RawProgram, flags: &CStr) -> std::result::Result<(), i32> {
    let devices = [compute.device.handle.id()];
    build_program(program.get(), &devices, flags, None, ptr::null_mut())
}

/// A program that was built before; `None` where the driver refuses it.
fn from_binary(compute: &Compute, binary: &[u8], flags: &CStr) -> Option<Handle<RawProgram>> {
    let (context, id) = (compute.context.get(), compute.device.handle.id());
    // SAFETY: the device belongs to the context.
    let created = unsafe { create_program_with_binary(context, &[id], &[binary]) };
    let program = Handle::new(RawProgram::new(created.ok()?));
    build(compute, &program, flags).ok()?;
    Some(program)
}

/// What the driver made of a program; `None` in a host's context of several devices, which has several.
fn binary_of(program: &RawProgram) -> Option<Vec<u8>> {
    let found = get_program_info(program.get(), CL_PROGRAM_BINARIES).ok()?;
    let mut binaries = Vec::<Vec<u8>>::from(found);
    let binary = binaries.pop().filter(|_| binaries.is_empty())?;
    (!binary.is_empty()).then_some(binary)
}

fn compiler_flags(lanes: u32, options: &BuildOptions) -> String {
    let sizes: String = layout::STRUCTS
        .iter()
        .map(|s| format!(" -D SIZEOF_{}={}", s.name.to_uppercase(), s.size))
        .collect();
    let environment = std::env::var(OPTIONS_VARIABLE).unwrap_or_default();
    let places = counts::definitions();
    let extra = &options.extra;
    let counting = match options.counts_nodes {
        true => "-D COUNT_NODES ",
        false => "",
    };
    format!(
        "-cl-std=CL1.2 -D LANES={lanes} -D CORE_FLOOR={CORE_FLOOR:e}f{sizes} {places} {counting}{extra} {environment}"
    )
    .trim()
    .to_owned()
}

/// What a kernel can be given: a device buffer, or one of the structs of [`layout`] by value.
pub trait Argument {
    /// Sets it.
    #[doc(hidden)]
    fn set(&self, kernel: &Kernel, index: u32) -> std::result::Result<(), ClError>;
}

impl<T: Pod> Argument for DeviceBuffer<T> {
    fn set(&self, kernel: &Kernel, index: u32) -> std::result::Result<(), ClError> {
        // SAFETY: the driver checks the index, and that the kernel expects a buffer; the buffer is alive.
        unsafe { kernel.set_arg(index, &self.handle()) }
    }
}

impl<T: Pod + PartialEq> Argument for Uploaded<T> {
    fn set(&self, kernel: &Kernel, index: u32) -> std::result::Result<(), ClError> {
        // SAFETY: as for DeviceBuffer; before the first upload the handle is null, which a kernel may get but not read.
        unsafe { kernel.set_arg(index, &self.handle()) }
    }
}

impl Argument for Depths {
    fn set(&self, kernel: &Kernel, index: u32) -> std::result::Result<(), ClError> {
        // SAFETY: as for Uploaded.
        unsafe { kernel.set_arg(index, &self.handle()) }
    }
}

impl Argument for Counts {
    fn set(&self, kernel: &Kernel, index: u32) -> std::result::Result<(), ClError> {
        // SAFETY: as for Uploaded.
        unsafe { kernel.set_arg(index, &self.handle()) }
    }
}

/// A buffer or an image by its handle, alive while it is an argument; null where the kernel does not touch it.
pub(super) struct RawMemory(pub cl_mem);

impl Argument for RawMemory {
    fn set(&self, kernel: &Kernel, index: u32) -> std::result::Result<(), ClError> {
        // SAFETY: as for Uploaded.
        unsafe { kernel.set_arg(index, &self.0) }
    }
}

impl<T: Pod> Argument for Option<DeviceBuffer<T>> {
    fn set(&self, kernel: &Kernel, index: u32) -> std::result::Result<(), ClError> {
        let handle = self.as_ref().map_or(ptr::null_mut(), DeviceBuffer::handle);
        // SAFETY: as for Uploaded.
        unsafe { kernel.set_arg(index, &handle) }
    }
}

macro_rules! by_value {
    ($($type:ty),*) => {$(
        impl Argument for $type {
            fn set(&self, kernel: &Kernel, index: u32) -> std::result::Result<(), ClError> {
                // SAFETY: the driver checks index and size against the kernel's own signature and copies the value.
                unsafe { kernel.set_arg(index, self) }
            }
        }
    )*};
}

by_value!(layout::View, layout::Launch, layout::TilePass);

/// Sets all arguments of a kernel, in order.
pub(super) fn set_arguments(
    compute: &Compute,
    kernel: &Kernel,
    arguments: &[&dyn Argument],
) -> Result<()> {
    for (index, argument) in arguments.iter().enumerate() {
        argument
            .set(kernel, index as u32)
            .map_err(failed(&compute.device.name, "clSetKernelArg"))?;
    }
    Ok(())
}

/// Enqueues `items` work-items in groups of `group`; the last group may be padded with work-items beyond `items`.
pub(super) fn enqueue(
    compute: &Compute,
    kernel: &Kernel,
    items: usize,
    group: usize,
) -> Result<Handle<Event>> {
    let global = items.div_ceil(group) * group;
    // SAFETY: all arguments are set by the caller; the kernels check their index against the count of work.
    unsafe {
        compute.queue.enqueue_nd_range_kernel(
            kernel.get(),
            1,
            std::ptr::null(),
            &raw const global,
            &raw const group,
            &[],
        )
    }
    .map(Handle::new)
    .map_err(failed(&compute.device.name, "clEnqueueNDRangeKernel"))
}

/// Waits for a launch: how long the device worked on it.
pub(super) fn run_time(compute: &Compute, event: &Event) -> Result<Duration> {
    let name = &compute.device.name;
    event.wait().map_err(failed(name, "clWaitForEvents"))?;
    let begun = event.profiling_command_start();
    let ended = event.profiling_command_end();
    let nanoseconds = begun
        .and_then(|begun| Ok(ended?.saturating_sub(begun)))
        .map_err(failed(name, "clGetEventProfilingInfo"))?;
    Ok(Duration::from_nanos(nanoseconds))
}

impl Program {
    /// Runs one of its kernels over `items` work-items, in groups of `group`, and waits for it: how long the device
    /// worked. For tests of single device functions and for comparisons.
    ///
    /// # Errors
    /// [`Error::Device`] if an argument or the launch is refused.
    pub fn run(
        &self,
        compute: &Compute,
        kernel: &str,
        arguments: &[&dyn Argument],
        items: usize,
        group: usize,
    ) -> Result<Duration> {
        let kernel = self.kernel(kernel)?;
        set_arguments(compute, &kernel, arguments)?;
        let event = enqueue(compute, &kernel, items, group)?;
        run_time(compute, &event)
    }
}
