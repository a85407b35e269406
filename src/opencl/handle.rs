//! OpenCL objects whose release may fail silently: on a lost device it does, where opencl3 would panic.

use std::mem::ManuallyDrop;
use std::ops::{Deref, DerefMut};

use opencl3::command_queue::{CommandQueue, release_command_queue};
use opencl3::context::{Context, context::release_context};
use opencl3::device::{SubDevice, release_device};
use opencl3::event::{Event, release_event};
use opencl3::kernel::{Kernel, release_kernel};
use opencl3::memory::{Buffer, ClMem, Image, release_mem_object};
use opencl3::program::release_program;
use opencl3::types::cl_program;

/// An object of opencl3, released as opencl3 does but without the panic. Whatever else the object owns is never freed;
/// a context that is made without a list of devices owns nothing else.
#[derive(Debug)]
pub struct Handle<T: Release>(ManuallyDrop<T>);

/// What is released by a call of OpenCL.
pub trait Release {
    /// Gives the reference back.
    ///
    /// # Safety
    /// The object must not be used afterwards.
    unsafe fn release(&self);
}

impl<T: Release> Handle<T> {
    pub(super) fn new(object: T) -> Self {
        Self(ManuallyDrop::new(object))
    }
}

impl<T: Release> Deref for Handle<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0
    }
}

impl<T: Release> DerefMut for Handle<T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.0
    }
}

impl<T: Release> Drop for Handle<T> {
    fn drop(&mut self) {
        // SAFETY: nobody else drops the object, and it is not used again.
        unsafe { self.0.release() };
    }
}

/// A program. That of opencl3 owns a list of its kernels.
#[derive(Debug)]
pub struct RawProgram(cl_program);

// SAFETY: OpenCL's functions on programs may be called from any thread.
unsafe impl Send for RawProgram {}

impl RawProgram {
    pub(super) fn new(program: cl_program) -> Self {
        Self(program)
    }

    pub(super) fn get(&self) -> cl_program {
        self.0
    }
}

macro_rules! released_by {
    ($([$($generic:ident)?] $type:ty: $release:path),* $(,)?) => {$(
        impl$(<$generic>)? Release for $type {
            unsafe fn release(&self) {
                // SAFETY: the caller owns the reference. A driver that refuses has lost the device: nothing is left to
                // do.
                let _ = unsafe { $release(self.get()) };
            }
        }
    )*};
}

released_by!(
    [] Context: release_context,
    [] CommandQueue: release_command_queue,
    [] RawProgram: release_program,
    [] Kernel: release_kernel,
    [] Event: release_event,
    [] Image: release_mem_object,
    [T] Buffer<T>: release_mem_object,
);

impl Release for SubDevice {
    unsafe fn release(&self) {
        // SAFETY: as above.
        let _ = unsafe { release_device(self.id()) };
    }
}
