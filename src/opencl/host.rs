//! Frames for a host that owns its OpenCL: its context, its queue, its buffer or its image.
//!
//! Kernels run on a queue of our own in the host's context, tied to the host's at both ends by events. So launches are
//! timed also where the host's queue has no profiling, a queue out of order needs no barriers, and two markers are all
//! that is put on the host's queue.

use std::fmt::Display;

use opencl3::command_queue::{CommandQueue, retain_command_queue};
use opencl3::context::{Context, context::retain_context};
use opencl3::error_codes::ClError;
use opencl3::event::{Event, retain_event};
use opencl3::memory::{
    Buffer, CL_FLOAT, CL_HALF_FLOAT, CL_MEM_OBJECT_BUFFER, CL_MEM_OBJECT_IMAGE2D, CL_MEM_READ_ONLY,
    CL_MEM_WRITE_ONLY, CL_RGBA, ClMem, Image, retain_mem_object,
};
use opencl3::types::{cl_command_queue, cl_context, cl_event, cl_mem};

use super::discover::device_of;
use super::failure::failed;
use super::handle::Handle;
use super::host_image::ImageInPlace;
use super::launch::Output;
use super::{BuildOptions, Compute, OpenClRenderer};
use crate::error::{Error, Result};
use crate::renderer::{Renderer, RendererBackend};
use crate::scene::{ImageSize, Scene};

/// Memory of a host's that a frame is drawn into: linear radiance, RGBA by rows from the top left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HostTarget {
    /// A buffer of at least `16 * width * height` bytes, float32, made with `CL_MEM_READ_WRITE`. A place in a larger buffer
    /// is a sub-buffer (`clCreateSubBuffer`).
    Buffer(cl_mem),
    /// A 2D image of the scene's size with channels `CL_RGBA` of type `CL_FLOAT` or `CL_HALF_FLOAT`, which kernels may
    /// write. Also what `clCreateFromGLTexture` or an extension for external memory makes of a texture.
    Image(cl_mem),
}

impl<T> From<&Buffer<T>> for HostTarget {
    fn from(buffer: &Buffer<T>) -> Self {
        Self::Buffer(buffer.get())
    }
}

impl From<&Image> for HostTarget {
    fn from(image: &Image) -> Self {
        Self::Image(image.get())
    }
}

impl Renderer {
    /// A renderer on a host's context, for the device of the host's queue: draws into the host's memory by
    /// [`Renderer::enqueue`], and into its own as any other. It keeps a reference to both.
    ///
    /// # Errors
    /// [`Error::Host`] if the queue belongs to another context, or its device cannot render; [`Error::Device`].
    pub fn on_host(context: &Context, queue: &CommandQueue) -> Result<Self> {
        // SAFETY: the borrows keep both alive.
        unsafe { Self::on_raw_host(context.get(), queue.get(), &BuildOptions::default()) }
    }

    /// Like [`Renderer::on_host`], for handles as C has them.
    ///
    /// # Safety
    /// Both are valid handles, which the caller holds a reference to.
    ///
    /// # Errors
    /// As [`Renderer::on_host`].
    pub unsafe fn on_raw_host(
        context: cl_context,
        queue: cl_command_queue,
        options: &BuildOptions,
    ) -> Result<Self> {
        // SAFETY: the caller's promise.
        let renderer = unsafe { OpenClRenderer::in_context(context, queue, options) }?;
        Ok(Self {
            backend: RendererBackend::OpenCl(Box::new(renderer)),
        })
    }

    /// Enqueues a frame that is drawn into a host's buffer or image, and gives the event of its end, a marker on the
    /// host's queue. The frame begins after `wait_list` and what is on the host's queue before it; what comes after it on
    /// an in-order queue waits for it.
    ///
    /// The host's queue is flushed, never finished, and nothing here waits for it (but for the compiler, the first time
    /// that a scene needs other kernels): what goes wrong on the device later shows at the event, and at the next call.
    /// Dropping the renderer waits until the device has read what was uploaded.
    ///
    /// # Safety
    /// Target and events are valid handles, which the caller holds a reference to. Until the event is over, nothing else
    /// uses the target.
    ///
    /// # Errors
    /// As [`Renderer::render`]; [`Error::Host`] if the renderer was made without a host, or target or events do not fit:
    /// all that is checked before anything is enqueued.
    pub unsafe fn enqueue(
        &mut self,
        scene: &Scene,
        target: HostTarget,
        wait_list: &[cl_event],
    ) -> Result<Event> {
        scene.validate()?;
        match &mut self.backend {
            // SAFETY: the caller's promise.
            RendererBackend::OpenCl(renderer) => unsafe {
                renderer.enqueue(scene, target, wait_list)
            },
            RendererBackend::Several(_) | RendererBackend::Reference { .. } => {
                Err(unfit("queue", NO_HOST))
            }
        }
    }
}

const NO_HOST: &str = "this renderer was made without one; make it with Renderer::on_host";

/// Something of the host's that does not fit.
fn unfit(object: &'static str, reason: impl Display) -> Error {
    Error::Host {
        object,
        reason: reason.to_string(),
    }
}

/// A call that asks about something of the host's.
fn asked<T>(object: &'static str, answer: std::result::Result<T, ClError>) -> Result<T> {
    answer.map_err(|ClError(code)| {
        let code = super::failure::code_name(code);
        unfit(object, format_args!("OpenCL does not know it ({code})"))
    })
}

impl OpenClRenderer {
    /// A renderer in the host's context, for the device of the host's queue. Both are retained.
    ///
    /// # Safety
    /// Both are alive.
    pub(crate) unsafe fn in_context(
        context: cl_context,
        queue: cl_command_queue,
        options: &BuildOptions,
    ) -> Result<Self> {
        if context.is_null() || queue.is_null() {
            return Err(unfit("context or queue", "null"));
        }
        // SAFETY: the caller's promise; each reference taken is given back by the handle.
        let (context, queue) = unsafe {
            asked("context", retain_context(context).map_err(ClError))?;
            let context = Handle::new(Context::new(context, &[]));
            asked("queue", retain_command_queue(queue).map_err(ClError))?;
            (context, Handle::new(CommandQueue::new(queue, 3)))
        };
        if asked("queue", queue.context())? != context.get() {
            return Err(unfit("queue", "it belongs to another context"));
        }
        let device = device_of(asked("queue", queue.device())?).ok_or_else(|| {
            let reason = "its device has no compiler or does not tell its properties";
            unfit("queue", reason)
        })?;
        let mut renderer = Self::with_compute(Compute::in_context(context, &device)?, options);
        renderer.host_queue = Some(queue);
        Ok(renderer)
    }

    /// Enqueues a frame of a valid scene: it begins after `wait_list` and after the commands before it on the host's queue;
    /// commands after it wait for it, on an in-order queue. Nothing here waits.
    ///
    /// # Safety
    /// As [`crate::Renderer::enqueue`].
    pub(crate) unsafe fn enqueue(
        &mut self,
        scene: &Scene,
        target: HostTarget,
        wait_list: &[cl_event],
    ) -> Result<Event> {
        self.host_queue()?;
        // SAFETY: the caller's promise.
        let memory = unsafe { self.checked(target, scene.image) }?;
        // SAFETY: the same.
        unsafe { self.check_events(wait_list) }?;
        self.begin_after(wait_list)?;
        let in_place = match target {
            HostTarget::Image(_) => ImageInPlace::map(&self.compute, &memory, scene.image)?,
            HostTarget::Buffer(_) => None,
        };
        let output = match (target, &in_place) {
            (HostTarget::Buffer(buffer), _) => Output::Buffer(buffer),
            (HostTarget::Image(_), Some(image)) => image.output(),
            (HostTarget::Image(image), None) => Output::Image(image),
        };
        let launched = self.launch_frame(scene, output);
        let unmapped = match in_place {
            Some(image) => image.unmap(&self.compute, &memory),
            None => Ok(()),
        };
        // Also what was launched before a failure draws into the target: what follows on the host's queue waits for it.
        let ended = self.end();
        match launched.and(unmapped) {
            Ok(()) => ended,
            Err(error) => {
                drop(ended.map(Handle::new)); // in silence
                Err(error)
            }
        }
    }

    /// The host's queue; an error for a renderer of its own.
    fn host_queue(&self) -> Result<&CommandQueue> {
        match &self.host_queue {
            Some(queue) => Ok(queue),
            None => Err(unfit("queue", NO_HOST)),
        }
    }

    /// What follows on our queue waits for the host's.
    fn begin_after(&self, wait_list: &[cl_event]) -> Result<()> {
        let name = &self.compute.device.name;
        let host = self.host_queue()?;
        // SAFETY: the events are alive, by the caller's promise.
        let begin = unsafe { host.enqueue_marker_with_wait_list(wait_list) }
            .map(Handle::new)
            .map_err(failed(name, "clEnqueueMarkerWithWaitList"))?;
        // A queue waits for another's event only once that has been flushed.
        host.flush().map_err(failed(name, "clFlush"))?;
        // No barrier: PoCL 3.1 never lets go of a queue's last one.
        // SAFETY: the event is alive.
        unsafe {
            self.compute
                .queue
                .enqueue_marker_with_wait_list(&[begin.get()])
        }
        .map(Handle::new)
        .map_err(failed(name, "clEnqueueMarkerWithWaitList"))?;
        Ok(())
    }

    /// What follows on the host's queue waits for ours: the event of that.
    fn end(&self) -> Result<Event> {
        let name = &self.compute.device.name;
        let call = "clEnqueueMarkerWithWaitList";
        let queue = &self.compute.queue;
        // SAFETY: nothing is waited for but what is on the queue.
        let last = unsafe { queue.enqueue_marker_with_wait_list(&[]) }
            .map(Handle::new)
            .map_err(failed(name, call))?;
        queue.flush().map_err(failed(name, "clFlush"))?;
        // SAFETY: the event is alive.
        unsafe {
            self.host_queue()?
                .enqueue_marker_with_wait_list(&[last.get()])
        }
        .map_err(failed(name, call))
    }

    /// The target, retained, if a frame of this size can go there.
    ///
    /// # Safety
    /// The memory object is alive.
    unsafe fn checked(&self, target: HostTarget, size: ImageSize) -> Result<Handle<Image>> {
        let (object, handle, wanted) = match target {
            HostTarget::Buffer(buffer) => ("buffer", buffer, CL_MEM_OBJECT_BUFFER),
            HostTarget::Image(image) => ("image", image, CL_MEM_OBJECT_IMAGE2D),
        };
        if handle.is_null() {
            return Err(unfit(object, "null"));
        }
        // SAFETY: the caller's promise; the reference is given back by the handle. Of `Image` only what all memory objects
        // have in common is used before the type is known.
        let memory = unsafe {
            asked(object, retain_mem_object(handle).map_err(ClError))?;
            Handle::new(Image::new(handle))
        };
        if asked(object, memory.mem_type())? != wanted {
            return Err(unfit(object, "it is another kind of memory object"));
        }
        if asked(object, memory.context())? != self.compute.context.get() {
            return Err(unfit(object, "it belongs to another context"));
        }
        let flags = asked(object, memory.flags())?;
        if flags & CL_MEM_READ_ONLY != 0 {
            let reason = "kernels may not write it (CL_MEM_READ_ONLY); use CL_MEM_READ_WRITE";
            return Err(unfit(object, reason));
        }
        match target {
            HostTarget::Buffer(_) => check_buffer(&memory, flags, size),
            HostTarget::Image(_) => check_image(&memory, size),
        }?;
        Ok(memory)
    }

    /// # Safety
    /// The events are alive.
    unsafe fn check_events(&self, wait_list: &[cl_event]) -> Result<()> {
        for event in wait_list {
            if event.is_null() {
                return Err(unfit("wait list", "it has a null event"));
            }
            // SAFETY: the caller's promise; the handle gives the reference back.
            let event = unsafe {
                asked("wait list", retain_event(*event).map_err(ClError))?;
                Handle::new(Event::new(*event))
            };
            if asked("wait list", event.context())? != self.compute.context.get() {
                return Err(unfit(
                    "wait list",
                    "an event of it belongs to another context",
                ));
            }
        }
        Ok(())
    }
}

fn check_buffer(buffer: &Image, flags: u64, size: ImageSize) -> Result<()> {
    let (bytes, needed) = (asked("buffer", ClMem::size(buffer))?, 16 * size.pixels());
    if bytes < needed {
        let (width, height) = (size.width, size.height);
        let reason = format!("{bytes} bytes; {width}x{height} float32 RGBA pixels need {needed}");
        return Err(unfit("buffer", reason));
    }
    if flags & CL_MEM_WRITE_ONLY != 0 {
        // Where a frame takes several launches, each adds to what is there.
        let reason = "kernels may not read it (CL_MEM_WRITE_ONLY); use CL_MEM_READ_WRITE";
        return Err(unfit("buffer", reason));
    }
    Ok(())
}

fn check_image(image: &Image, size: ImageSize) -> Result<()> {
    let width = asked("image", image.width())?;
    let height = asked("image", image.height())?;
    if (width, height) != (size.width as usize, size.height as usize) {
        let reason = format!(
            "{width}x{height} pixels, the scene has {}x{}",
            size.width, size.height
        );
        return Err(unfit("image", reason));
    }
    let format = asked("image", image.format())?;
    let [format] = format.as_slice() else {
        return Err(unfit("image", "OpenCL does not tell its format"));
    };
    let is_float = [CL_FLOAT, CL_HALF_FLOAT].contains(&format.image_channel_data_type);
    if format.image_channel_order != CL_RGBA || !is_float {
        let reason = format!(
            "channels of order {:#x} and type {:#x}; they must be CL_RGBA ({CL_RGBA:#x}) of CL_FLOAT ({CL_FLOAT:#x}) or \
             CL_HALF_FLOAT ({CL_HALF_FLOAT:#x})",
            format.image_channel_order, format.image_channel_data_type
        );
        return Err(unfit("image", reason));
    }
    Ok(())
}
