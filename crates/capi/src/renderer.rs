//! Renderers: on devices that are chosen, or on a host's OpenCL.

use std::ffi::c_char;
use std::sync::{Arc, Mutex};

use energywave::{KernelCache, Renderer, RendererOptions};

use crate::border::{self, Versioned};
use crate::device::chosen;
use crate::registry;
use crate::status::{Outcome, Status, bad_argument, guarded};

/// A renderer.
#[allow(dead_code, reason = "C knows it by its name alone")]
pub struct RendererHandle;

/// OpenCL's context, `cl_context` without its `*`.
#[allow(dead_code, reason = "C knows it by its name alone")]
pub struct ClContext;

/// OpenCL's queue, `cl_command_queue` without its `*`.
#[allow(dead_code, reason = "C knows it by its name alone")]
pub struct ClQueue;

/// Choices of a renderer; what is 0 suits the device.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Options {
    /// `sizeof` of this struct.
    pub struct_size: usize,
    /// Rays that a work-item carries side by side: 1, 4, 8 or 16.
    pub lanes: u32,
    /// Work-items that share a tile: 1, 2, 4, 8, 16 or 32.
    pub tile_workers: u32,
    /// 1: samples are counted for energywave_renderer_cost.
    pub counts_samples: u32,
    /// 1: kernels draw without having shown that they compute right.
    pub skips_self_test: u32,
    /// 1: frames have the bloom of their scene. Tell energywave_tone_map and energywave_save so.
    pub spreads_bloom: u32,
    /// Kernels on disk; 0: for drivers that keep none, 1: always, 2: never.
    pub kernel_cache: u32,
}

// SAFETY: it begins with its size, and its fields are numbers.
unsafe impl Versioned for Options {}

/// What a frame cost.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Cost {
    /// `sizeof` of this struct, set by the caller.
    pub struct_size: usize,
    /// Time that the device worked on kernels, seconds.
    pub kernel_seconds: f64,
    /// Pairs of a ray and a source.
    pub integrals: u64,
    /// Samples of fields; 0 where they were not counted.
    pub samples: u64,
    /// Launches of kernels.
    pub launches: u64,
}

// SAFETY: it begins with its size, and its fields are numbers.
unsafe impl Versioned for Cost {}

/// Takes a flag of a struct.
pub fn flag(value: u32, name: &str) -> Outcome<bool> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        other => Err(bad_argument(name, &format!("{other}; it must be 0 or 1"))),
    }
}

/// Returns the options, and whether the bloom is spread.
///
/// # Safety
/// `options` is NULL, or points to as many bytes as it says.
unsafe fn read_options(options: *const Options) -> Outcome<(RendererOptions, bool)> {
    let mut read = RendererOptions::default();
    if options.is_null() {
        return Ok((read, false));
    }
    // SAFETY: the caller's promise.
    let given = unsafe { border::read_struct(options, "options") }?;
    read.lanes = (given.lanes != 0).then_some(given.lanes);
    read.tile_workers = (given.tile_workers != 0).then_some(given.tile_workers);
    read.counts_samples = flag(given.counts_samples, "options.counts_samples")?;
    read.skips_self_test = flag(given.skips_self_test, "options.skips_self_test")?;
    read.cache = match given.kernel_cache {
        0 => KernelCache::WhereMissing,
        1 => KernelCache::Always,
        2 => KernelCache::Never,
        other => {
            let reason = format!("{other}; it must be 0, 1 or 2");
            return Err(bad_argument("options.kernel_cache", &reason));
        }
    };
    Ok((read, flag(given.spreads_bloom, "options.spreads_bloom")?))
}

/// Opens a device: `choice` is an index, `gpu`, `cpu`, `reference`, or a part of a device's name; several with commas
/// between, or `all`, share every frame. NULL: the best OpenCL device, and an error where there is none. `options` may
/// be NULL. `*renderer` is freed by energywave_renderer_free; where the call fails, it stays as it was.
///
/// # Safety
/// `choice` is NULL or ends with a 0; `options` is NULL or points to as many bytes as it says; `renderer` points to a
/// place for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_renderer_new(
    choice: *const c_char,
    options: *const Options,
    renderer: *mut *mut RendererHandle,
) -> Status {
    guarded(|| {
        // SAFETY: the caller's promise, three times.
        let (choice, renderer) = unsafe {
            let choice = border::optional_text(choice, "choice")?;
            (choice, border::out(renderer, "renderer")?)
        };
        // SAFETY: the same.
        let (options, spreads_bloom) = unsafe { read_options(options) }?;
        let mut made = Renderer::on_devices(&chosen(choice)?, &options)?;
        made.spread_bloom(spreads_bloom);
        renderer.set(registry::keep(made));
        Ok(())
    })
}

/// Makes a renderer on a host's OpenCL, for the device of the host's queue; it keeps a reference to both. `*renderer`
/// is as of energywave_renderer_new.
///
/// # Safety
/// `context` and `queue` are a `cl_context` and a `cl_command_queue` that are alive, or NULL, which is an error; the
/// rest is as of energywave_renderer_new.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_renderer_on_host(
    context: *mut ClContext,
    queue: *mut ClQueue,
    options: *const Options,
    renderer: *mut *mut RendererHandle,
) -> Status {
    guarded(|| {
        // SAFETY: the caller's promise, twice.
        let (renderer, (options, spreads_bloom)) =
            unsafe { (border::out(renderer, "renderer")?, read_options(options)?) };
        let (context, queue) = (context.cast(), queue.cast());
        // SAFETY: the same.
        let mut made = unsafe { Renderer::on_raw_host(context, queue, &options) }?;
        made.spread_bloom(spreads_bloom);
        renderer.set(registry::keep(made));
        Ok(())
    })
}

/// Frees a renderer; NULL is none. Waits until its device has read what was uploaded. Calls of other threads that use
/// it come to their end.
#[unsafe(no_mangle)]
pub extern "C" fn energywave_renderer_free(renderer: *mut RendererHandle) -> Status {
    guarded(|| registry::free::<Renderer, _>(renderer))
}

/// Tells what the last frame cost. `cost` has its `struct_size` set.
///
/// # Safety
/// `cost` points to as many bytes as it says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_renderer_cost(
    renderer: *const RendererHandle,
    cost: *mut Cost,
) -> Status {
    guarded(|| {
        let kept: Arc<Mutex<Renderer>> = registry::find(renderer)?;
        let last = registry::lock(&kept)?.last_cost();
        let told = Cost {
            struct_size: 0,
            kernel_seconds: last.kernel.as_secs_f64(),
            integrals: last.integrals,
            samples: last.samples,
            launches: last.launches.into(),
        };
        // SAFETY: the caller's promise.
        unsafe { border::write_struct(cost, "cost", told) }
    })
}
