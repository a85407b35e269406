//! A device with its context and its queue.

use std::ptr;

use opencl3::command_queue::{CL_QUEUE_PROFILING_ENABLE, CommandQueue};
use opencl3::context::Context;
use opencl3::context::context::{create_context, retain_context};
use opencl3::error_codes::ClError;

use super::OpenClDevice;
use super::failure::failed;
use super::handle::Handle;
use crate::error::Result;

/// A device ready for work. Its queue runs commands in order.
#[derive(Debug)]
pub struct Compute {
    // Dropped in this order: a queue before its context.
    pub(super) queue: Handle<CommandQueue>,
    pub(super) context: Handle<Context>,
    pub(super) device: OpenClDevice,
}

impl Compute {
    /// Creates context and queue.
    ///
    /// # Errors
    /// [`crate::Error::Device`] if the driver refuses.
    pub fn new(device: &OpenClDevice) -> Result<Self> {
        let name = &device.name;
        let context = create_context(&[device.handle.id()], ptr::null(), None, ptr::null_mut())
            .map_err(ClError)
            .map_err(failed(name, "clCreateContext"))?;
        Self::in_context(Handle::new(Context::new(context, &[])), device)
    }

    /// Makes a queue of our own in a context that has the device.
    pub(super) fn in_context(context: Handle<Context>, device: &OpenClDevice) -> Result<Self> {
        let name = &device.name;
        // SAFETY: the device belongs to the context, which outlives the queue.
        let queue = unsafe {
            #[allow(deprecated)] // the form of OpenCL 1.2, which every driver has
            CommandQueue::create(&context, device.handle.id(), CL_QUEUE_PROFILING_ENABLE)
        }
        .map_err(failed(name, "clCreateCommandQueue"))?;
        Ok(Self {
            queue: Handle::new(queue),
            context,
            device: device.clone(),
        })
    }

    /// Makes another queue on the same device in the same context.
    pub(crate) fn sibling(&self) -> Result<Self> {
        let context = self.context.get();
        // SAFETY: the context is alive, and the reference taken is given back by the handle.
        let context = unsafe {
            retain_context(context)
                .map_err(ClError)
                .map_err(failed(&self.device.name, "clRetainContext"))?;
            Handle::new(Context::new(context, &[]))
        };
        Self::in_context(context, &self.device)
    }

    /// Returns the device's properties.
    pub fn device(&self) -> &OpenClDevice {
        &self.device
    }
}
