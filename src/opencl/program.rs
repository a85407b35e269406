//! Builds programs for a device, with readable logs.

use std::ffi::{CStr, CString};
use std::ptr;

use opencl3::error_codes::{CL_INVALID_KERNEL_NAME, ClError};
use opencl3::kernel::{Kernel as ClKernel, create_kernel};
use opencl3::program::{
    CL_PROGRAM_BINARIES, CL_PROGRAM_BUILD_LOG, build_program, create_program_with_binary,
    create_program_with_source, get_program_build_info, get_program_info,
};

use super::failure::{code_name, failed, fault};
use super::handle::{Handle, RawProgram};
use super::kernel::Kernel;
use super::record::Record;
use super::source::parameters;
use super::{Compute, RendererOptions, pocl};
use crate::error::{Error, Result};

/// Environment variable with further options for the kernels' compiler, such as `-D NAME` or `-cl-opt-disable`.
const OPTIONS_VARIABLE: &str = "ENERGYWAVE_BUILD_OPTIONS";

/// A built program.
#[derive(Debug)]
pub struct Program {
    program: Handle<RawProgram>,
    device: String,
    /// What it was built from, to find the names of its kernels' parameters.
    text: String,
    has_image: bool,
    record: Record,
    /// Lanes it was built for.
    pub lanes: u32,
}

impl Program {
    /// Builds a resolved text (see [`super::Sources`]) with definitions such as ` -D NAME=1`, which come before those
    /// of the options and of the environment.
    ///
    /// # Errors
    /// [`Error::Build`] with the compiler's log, places as `cl/FILE:LINE`.
    pub(crate) fn build(
        compute: &Compute,
        text: String,
        definitions: &str,
        options: &RendererOptions,
    ) -> Result<Self> {
        let device = &compute.device;
        let lanes = options.lanes.unwrap_or(device.lanes);
        let chosen = &options.compiler_options;
        let environment = std::env::var(OPTIONS_VARIABLE).unwrap_or_default();
        let flags = format!("{} {chosen} {environment}", flags_for(lanes, definitions));
        let flags = flags.trim();
        let record = Record::new(device, &text, flags, options);
        let has_image = ["-D IMAGE", "-D HALVES"]
            .iter()
            .any(|it| flags.contains(it));
        let refused = |code: String, log: String| Error::Build {
            device: device.name.clone(),
            code,
            log,
        };
        let Ok(flags) = CString::new(flags) else {
            let fault = "options contain a NUL byte".to_owned();
            return Err(refused(fault, String::new()));
        };
        let kept = record.binary();
        let kept = kept.and_then(|binary| from_binary(compute, &binary, &flags));
        let program = match kept {
            Some(program) => program,
            None => {
                pocl::check_linker(device)?;
                let program = create_program_with_source(compute.context.get(), &[&text])
                    .map(|program| Handle::new(RawProgram::new(program)))
                    .map_err(ClError)
                    .map_err(failed(&device.name, "clCreateProgramWithSource"))?;
                build_for(compute, &program, &flags).map_err(|code| {
                    let id = device.handle.id();
                    let log = get_program_build_info(program.get(), id, CL_PROGRAM_BUILD_LOG);
                    let mut log = log.map(String::from).unwrap_or_default();
                    if let (pocl::PLATFORM, Some(fault)) =
                        (device.platform.as_str(), pocl::cache_fault())
                    {
                        log = format!("PoCL's cache: {fault}\n{log}");
                    }
                    let chosen = format!("LANES={lanes} {chosen}");
                    refused(format!("{}, {}", code_name(code), chosen.trim()), log)
                })?;
                record.keep_binary(|| binary_of(&program));
                program
            }
        };
        Ok(Self {
            program,
            device: device.name.clone(),
            text,
            has_image,
            record,
            lanes,
        })
    }

    /// Returns whether its kernels have shown before, on this device, that they compute correctly.
    pub(crate) fn was_tested(&self) -> bool {
        self.record.was_tested()
    }

    /// Remembers that they have.
    pub(crate) fn mark_tested(&self) {
        self.record.mark_tested();
    }

    /// Makes one of its kernels.
    ///
    /// # Errors
    /// [`Error::Device`] if there is no such kernel.
    pub(crate) fn kernel(&self, name: &str) -> Result<Kernel> {
        let refused = failed(&self.device, "clCreateKernel");
        let Ok(c_name) = CString::new(name) else {
            return Err(refused(ClError(CL_INVALID_KERNEL_NAME)));
        };
        let kernel = create_kernel(self.program.get(), &c_name)
            .map(ClKernel::new)
            .map_err(|code| refused(ClError(code)))?;
        let names = parameters(&self.text, name, self.has_image);
        let count = kernel
            .num_args()
            .map_err(failed(&self.device, "clGetKernelInfo"))?;
        if names.len() != count as usize {
            let what = format!("{name} has {count} parameters, the text names {names:?}");
            return Err(fault(&self.device, "clGetKernelInfo", what));
        }
        Ok(Kernel::new(kernel, names))
    }
}

/// Returns what every program is built with, before the options of a caller and of the environment.
pub(crate) fn flags_for(lanes: u32, definitions: &str) -> String {
    format!("-cl-std=CL1.2 -D LANES={lanes}{definitions}")
}

fn build_for(
    compute: &Compute,
    program: &RawProgram,
    flags: &CStr,
) -> std::result::Result<(), i32> {
    let devices = [compute.device.handle.id()];
    build_program(program.get(), &devices, flags, None, ptr::null_mut())
}

/// Makes a program of a binary that was built before; `None` where the driver refuses it.
fn from_binary(compute: &Compute, binary: &[u8], flags: &CStr) -> Option<Handle<RawProgram>> {
    let (context, id) = (compute.context.get(), compute.device.handle.id());
    // SAFETY: the device belongs to the context.
    let created = unsafe { create_program_with_binary(context, &[id], &[binary]) };
    let program = Handle::new(RawProgram::new(created.ok()?));
    build_for(compute, &program, flags).ok()?;
    Some(program)
}

/// Returns what the driver made of a program; `None` in a host's context of several devices, which has several
/// binaries.
fn binary_of(program: &RawProgram) -> Option<Vec<u8>> {
    let found = get_program_info(program.get(), CL_PROGRAM_BINARIES).ok()?;
    let mut binaries = Vec::<Vec<u8>>::from(found);
    let binary = binaries.pop().filter(|_| binaries.is_empty())?;
    (!binary.is_empty()).then_some(binary)
}
