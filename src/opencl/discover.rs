//! Which OpenCL devices there are, and what is missing where there are none.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use opencl3::device::{
    CL_DEVICE_TYPE_ALL, CL_DEVICE_TYPE_CPU, CL_DEVICE_TYPE_GPU, Device as ClDevice,
};
use opencl3::error_codes::{ClError, DLOPEN_FUNCTION_NOT_AVAILABLE, DLOPEN_RUNTIME_LOAD_FAILED};
use opencl3::platform::{Platform, get_platforms};
use opencl3::types::cl_device_id;
use serde::Serialize;

use super::{absent, pocl};

const CL_PLATFORM_NOT_FOUND_KHR: i32 = -1001;

/// Kind of a device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum DeviceType {
    /// Graphics processor.
    Gpu,
    /// Processor, through OpenCL.
    Cpu,
    /// Any other OpenCL device.
    Accelerator,
    /// The built-in float64 reference, without OpenCL.
    Reference,
}

impl std::fmt::Display for DeviceType {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Gpu => "gpu",
            Self::Cpu => "cpu",
            Self::Accelerator => "accelerator",
            Self::Reference => "reference",
        })
    }
}

/// How kernels are built for a device and launched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum DeviceForm {
    /// A ray for each work-item, groups whose work-items share a tile, launches of 40 ms.
    Gpu,
    /// Several rays side by side in the vectors of a work-item, a tile for each.
    Cpu,
}

impl std::fmt::Display for DeviceForm {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Gpu => "gpu",
            Self::Cpu => "cpu",
        })
    }
}

/// Environment variable with the form of all devices, `gpu` or `cpu`, instead of what suits each.
const FORM_VARIABLE: &str = "ENERGYWAVE_FORM";

/// Returns the form that the environment asks for.
fn forced_form() -> Result<Option<DeviceForm>, String> {
    let word = std::env::var_os(FORM_VARIABLE).unwrap_or_default();
    match word.to_str() {
        Some("") => Ok(None),
        Some("gpu") => Ok(Some(DeviceForm::Gpu)),
        Some("cpu") => Ok(Some(DeviceForm::Cpu)),
        _ => Err(format!(
            "{FORM_VARIABLE}={}: it must be gpu or cpu",
            word.display()
        )),
    }
}

/// Result of a search for OpenCL devices.
#[derive(Debug, Default)]
pub struct Discovery {
    /// Every usable device, GPUs first, else in the order of platform and name.
    pub devices: Vec<OpenClDevice>,
    /// Why there is none, and what to install.
    pub problem: Option<String>,
    /// Drivers that show no device that can draw, why, and what to do: one line each.
    pub absent: Vec<String>,
}

/// An OpenCL device and its properties.
#[derive(Debug, Clone)]
pub struct OpenClDevice {
    pub(super) handle: ClDevice,
    /// Its name.
    pub name: String,
    /// GPU, CPU or other.
    pub device_type: DeviceType,
    /// Name of its platform.
    pub platform: String,
    /// Version of its platform.
    pub platform_version: String,
    /// OpenCL version.
    pub version: String,
    /// Driver version.
    pub driver: String,
    /// Compute units.
    pub compute_units: u32,
    /// Global memory, bytes.
    pub memory_bytes: u64,
    /// Largest single buffer, bytes.
    pub max_allocation_bytes: u64,
    /// How kernels are built for it and launched.
    pub form: DeviceForm,
    /// Lanes of the kernels by default: 1 in the form of a GPU, the float vector width in that of a CPU.
    pub lanes: u32,
    /// Work-items of a group at most.
    pub most_workers: u32,
    /// Work-items that a GPU runs in step; 0 where the driver does not say, and on other devices.
    pub in_step: u32,
    /// Whether it works in the host's own memory.
    pub shares_host_memory: bool,
    /// Whether it is a simulator, which is never chosen by default.
    pub is_simulator: bool,
    /// Why its driver is known not to draw; then it is never chosen by default either.
    pub known_fault: Option<String>,
}

impl OpenClDevice {
    /// Says what is known against its driver, if anything is.
    fn fault_line(&self) -> Option<String> {
        let fault = self.known_fault.as_ref()?;
        Some(format!(
            "{} ({}, {}): {fault}",
            self.name, self.platform, self.driver
        ))
    }
}

/// Asks the OpenCL loader for every device of every platform.
pub fn discover() -> Discovery {
    // Drivers load at the first question. PoCL 3.1, asked by a second thread meanwhile, answers that it has no device.
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let form = match forced_form() {
        Ok(form) => form,
        Err(problem) => {
            return Discovery {
                devices: Vec::new(),
                problem: Some(problem),
                absent: Vec::new(),
            };
        }
    };
    let platforms = match get_platforms() {
        Ok(platforms) => platforms,
        Err(ClError(code)) => {
            let absent = absent::unloadable();
            let problem = [vec![missing(code)], absent.clone()].concat().join("; ");
            return Discovery {
                devices: Vec::new(),
                problem: Some(problem),
                absent,
            };
        }
    };
    let mut devices: Vec<OpenClDevice> = Vec::new();
    let mut absent = Vec::new();
    for platform in &platforms {
        let found = usable_devices(platform, form);
        if found.is_empty() {
            absent.push(absent::reason(&platform.name().unwrap_or_default()));
        }
        devices.extend(found);
    }
    let faulty = devices.iter().filter_map(OpenClDevice::fault_line);
    absent.extend(faulty.collect::<Vec<_>>());
    // Asked only where a driver is missed: loading takes time.
    if platforms.len() < absent::driver_files().len() {
        absent.extend(absent::unloadable());
    }
    devices.sort_by(|a, b| {
        let is_shunned = |d: &OpenClDevice| d.is_simulator || d.known_fault.is_some();
        let key = |d: &OpenClDevice| (is_shunned(d), d.device_type != DeviceType::Gpu);
        let names = |d: &OpenClDevice| (d.platform.clone(), d.name.clone());
        (key(a), names(a)).cmp(&(key(b), names(b)))
    });
    let names: Vec<String> = platforms.iter().filter_map(|p| p.name().ok()).collect();
    let problem = devices.is_empty().then(|| {
        format!(
            "the OpenCL driver is installed ({}) but offers no usable device: {}",
            names.join(", "),
            absent.join("; ")
        )
    });
    Discovery {
        devices,
        problem,
        absent,
    }
}

/// Returns the devices of a platform that can render; none of PoCL's where asking would end the process.
fn usable_devices(platform: &Platform, form: Option<DeviceForm>) -> Vec<OpenClDevice> {
    let is_pocl = platform.name().is_ok_and(|name| name == pocl::PLATFORM);
    if is_pocl && pocl::ends_process(Path::new("/")).is_some() {
        return Vec::new();
    }
    let ids = platform.get_devices(CL_DEVICE_TYPE_ALL).unwrap_or_default();
    ids.into_iter()
        .filter_map(|id| inspect(platform, id, form))
        .collect()
}

/// Reads the properties of a device that someone else found; `None` if it cannot render.
pub(super) fn device_of(id: cl_device_id) -> Option<OpenClDevice> {
    let platform = Platform::new(ClDevice::new(id).platform().ok()?);
    inspect(&platform, id, forced_form().ok()?)
}

/// Reads the properties of a device; `None` if it has no compiler or keeps a property to itself: it cannot render.
fn inspect(
    platform: &Platform,
    id: cl_device_id,
    form: Option<DeviceForm>,
) -> Option<OpenClDevice> {
    let handle = ClDevice::new(id);
    if !handle.available().ok()? || !handle.compiler_available().ok()? {
        return None;
    }
    let platform_version = platform.version().ok()?;
    let platform = platform.name().ok()?;
    let bits = handle.dev_type().ok()?;
    let device_type = match bits {
        bits if bits & CL_DEVICE_TYPE_GPU != 0 => DeviceType::Gpu,
        bits if bits & CL_DEVICE_TYPE_CPU != 0 => DeviceType::Cpu,
        _ => DeviceType::Accelerator,
    };
    let driver = handle.driver_version().ok()?.trim().to_owned();
    let is_simulator = platform.to_ascii_lowercase().contains("oclgrind");
    let width = match device_type {
        DeviceType::Cpu if !is_simulator => {
            supported_lanes(handle.native_vector_width_float().ok()?)
        }
        _ => 1,
    };
    // A processor without vectors in a work-item has them across work-items, as a GPU (Mesa's llvmpipe); but PoCL 3.1
    // compiles barriers for hours, and a simulator takes them one by one.
    let is_like_gpu = width == 1 && !is_simulator && !platform.contains("Portable Computing");
    let suitable = match device_type {
        DeviceType::Gpu => DeviceForm::Gpu,
        _ if is_like_gpu => DeviceForm::Gpu,
        _ => DeviceForm::Cpu,
    };
    let form = form.unwrap_or(suitable);
    Some(OpenClDevice {
        name: handle.name().ok()?.trim().to_owned(),
        device_type,
        version: handle.version().ok()?.trim().to_owned(),
        compute_units: handle.max_compute_units().ok()?,
        memory_bytes: handle.global_mem_size().ok()?,
        max_allocation_bytes: handle.max_mem_alloc_size().ok()?,
        lanes: match form {
            DeviceForm::Gpu => 1,
            DeviceForm::Cpu => width,
        },
        most_workers: u32::try_from(handle.max_work_group_size().ok()?).unwrap_or(u32::MAX),
        in_step: match device_type {
            DeviceType::Gpu => in_step(&handle),
            _ => 0,
        },
        form,
        known_fault: absent::known_fault(&platform, &driver),
        driver,
        shares_host_memory: handle.host_unified_memory().unwrap_or(false),
        is_simulator,
        platform,
        platform_version,
        handle,
    })
}

/// Returns the work-items that a GPU runs in step: OpenCL 3.0 has a question for it, drivers of 1.2 one of their own.
fn in_step(handle: &ClDevice) -> u32 {
    let multiple = handle.preferred_work_group_size_multiple().ok();
    let multiple = multiple.and_then(|multiple| u32::try_from(multiple).ok());
    let multiple = multiple.or_else(|| handle.wrap_size_nv().ok());
    multiple
        .or_else(|| handle.wavefront_width_amd().ok())
        .unwrap_or(0)
}

/// Returns the greatest lane width of the kernels that is no wider than the device's vectors.
fn supported_lanes(width: u32) -> u32 {
    match width {
        16.. => 16,
        8.. => 8,
        4.. => 4,
        _ => 1,
    }
}

/// Says what to install when the loader answers with `code` instead of platforms.
fn missing(code: i32) -> String {
    match code {
        DLOPEN_RUNTIME_LOAD_FAILED => {
            "no OpenCL loader (libOpenCL) on this machine; install ocl-icd-libopencl1 (Debian, Ubuntu) and a device's \
             driver, or pocl-opencl-icd for the CPU"
                .to_owned()
        }
        DLOPEN_FUNCTION_NOT_AVAILABLE => {
            "the OpenCL loader lacks a function of OpenCL 1.2: libOpenCL is too old or no OpenCL library; reinstall \
             ocl-icd-libopencl1 (Debian, Ubuntu)"
                .to_owned()
        }
        CL_PLATFORM_NOT_FOUND_KHR => {
            "the OpenCL loader finds no driver (no ICD); install pocl-opencl-icd (Debian, Ubuntu) for the CPU or your \
             GPU vendor's OpenCL driver, and check OCL_ICD_VENDORS if it is set"
                .to_owned()
        }
        code => format!(
            "the OpenCL loader failed ({}); check the installed OpenCL drivers",
            super::failure::code_name(code)
        ),
    }
}
