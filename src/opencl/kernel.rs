//! A kernel, its arguments by name, and its launches.

use std::time::Duration;

use bytemuck::Pod;
use opencl3::error_codes::ClError;
use opencl3::event::Event;
use opencl3::kernel::Kernel as ClKernel;
use opencl3::types::cl_mem;

use super::failure::{failed, fault};
use super::handle::Handle;
use super::{Compute, DeviceBuffer, Uploaded};
use crate::error::Result;

/// What a kernel can be given: memory of the device, or a struct by value.
pub trait Argument {
    /// Sets it.
    #[doc(hidden)]
    fn set(&self, kernel: &ClKernel, index: u32) -> std::result::Result<(), ClError>;
}

/// A buffer or an image by its handle, alive while it is an argument; null where the kernel does not touch it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RawMemory(pub(super) cl_mem);

impl Argument for RawMemory {
    fn set(&self, kernel: &ClKernel, index: u32) -> std::result::Result<(), ClError> {
        // SAFETY: the driver checks the index, and that the kernel expects memory; a kernel may get null but not read
        // it.
        unsafe { kernel.set_arg(index, &self.0) }
    }
}

impl<T: Pod> Argument for DeviceBuffer<T> {
    fn set(&self, kernel: &ClKernel, index: u32) -> std::result::Result<(), ClError> {
        RawMemory(self.handle()).set(kernel, index)
    }
}

impl<T: Pod> Argument for Option<DeviceBuffer<T>> {
    fn set(&self, kernel: &ClKernel, index: u32) -> std::result::Result<(), ClError> {
        let handle = self.as_ref().map(DeviceBuffer::handle);
        RawMemory(handle.unwrap_or(std::ptr::null_mut())).set(kernel, index)
    }
}

impl<T: Pod + PartialEq> Argument for Uploaded<T> {
    fn set(&self, kernel: &ClKernel, index: u32) -> std::result::Result<(), ClError> {
        RawMemory(self.handle()).set(kernel, index)
    }
}

/// Says of a struct that kernels take it by value.
macro_rules! by_value {
    ($($type:ty),* $(,)?) => {$(
        impl $crate::opencl::Argument for $type {
            fn set(
                &self,
                kernel: &opencl3::kernel::Kernel,
                index: u32,
            ) -> std::result::Result<(), opencl3::error_codes::ClError> {
                $crate::opencl::set_value(kernel, index, self)
            }
        }
    )*};
}
pub(crate) use by_value;

by_value!(u32, f32);

pub(crate) fn set_value<T: Pod>(
    kernel: &ClKernel,
    index: u32,
    value: &T,
) -> std::result::Result<(), ClError> {
    // SAFETY: the driver checks index and size against the kernel's own signature and copies the value.
    unsafe { kernel.set_arg(index, value) }
}

/// A kernel that knows the names of its parameters.
#[derive(Debug)]
pub struct Kernel {
    kernel: Handle<ClKernel>,
    parameters: Vec<String>,
}

impl Kernel {
    pub(super) fn new(kernel: ClKernel, parameters: Vec<String>) -> Self {
        Self {
            kernel: Handle::new(kernel),
            parameters,
        }
    }

    /// Returns how many work-items a group has that should have `wanted`, a power of two: half as many until the device
    /// can run it.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if the driver does not say.
    pub(crate) fn group(&self, compute: &Compute, wanted: usize) -> Result<usize> {
        let most = self
            .kernel
            .get_work_group_size(compute.device.handle.id())
            .map_err(failed(&compute.device.name, "clGetKernelWorkGroupInfo"))?;
        Ok(halved(wanted, most))
    }

    /// Sets every argument by its parameter's name and enqueues `items` work-items in groups of `group`; the last group
    /// may be padded with work-items beyond `items`.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if names and parameters do not match, or the driver refuses.
    pub(crate) fn launch(
        &self,
        compute: &Compute,
        arguments: &[(&str, &dyn Argument)],
        items: usize,
        group: usize,
    ) -> Result<Handle<Event>> {
        let device = &compute.device.name;
        if arguments.len() != self.parameters.len() {
            let message = format!("{} arguments for {:?}", arguments.len(), self.parameters);
            return Err(fault(device, "clSetKernelArg", message));
        }
        for (index, parameter) in self.parameters.iter().enumerate() {
            let named = arguments.iter().find(|(name, _)| name == parameter);
            let Some((_, argument)) = named else {
                let message = format!("no argument for the parameter {parameter}");
                return Err(fault(device, "clSetKernelArg", message));
            };
            argument
                .set(&self.kernel, index as u32)
                .map_err(failed(device, "clSetKernelArg"))?;
        }
        let global = items.div_ceil(group) * group;
        // SAFETY: all arguments are set; the kernels check their index against the count of work.
        unsafe {
            compute.queue.enqueue_nd_range_kernel(
                self.kernel.get(),
                1,
                std::ptr::null(),
                &raw const global,
                &raw const group,
                &[],
            )
        }
        .map(Handle::new)
        .map_err(failed(device, "clEnqueueNDRangeKernel"))
    }

    /// Returns its parameters' names, in order.
    pub fn parameters(&self) -> &[String] {
        &self.parameters
    }
}

/// Halves a number until it is no more than `most`, or 1.
pub(crate) fn halved(wanted: usize, most: usize) -> usize {
    let mut number = wanted;
    while number > most.max(1) {
        number /= 2;
    }
    number
}

/// Waits for a launch, and returns how long the device worked on it.
pub(crate) fn run_time(compute: &Compute, event: &Event) -> Result<Duration> {
    let name = &compute.device.name;
    event.wait().map_err(failed(name, "clWaitForEvents"))?;
    let begun = event.profiling_command_start();
    let ended = event.profiling_command_end();
    let nanoseconds = begun
        .and_then(|begun| Ok(ended?.saturating_sub(begun)))
        .map_err(failed(name, "clGetEventProfilingInfo"))?;
    Ok(Duration::from_nanos(nanoseconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_is_halved_until_the_device_can_run_it() {
        let cases = [(64, 1024), (64, 64), (64, 63), (64, 24), (16, 1), (16, 0)];
        assert_eq!(
            cases.map(|(wanted, most)| halved(wanted, most)),
            [64, 64, 32, 16, 1, 1]
        );
    }
}
