//! Frames for a host that owns its OpenCL: its context, its queue, its buffer or its image.
//!
//! Kernels run on a queue of our own in the host's context, tied to the host's at both ends by events. So launches are
//! timed even where the host's queue has no profiling, an out-of-order queue needs no barriers, and nothing but two
//! markers is put on the host's queue.

use std::fmt::Display;
use std::sync::Arc;

use opencl3::command_queue::{CommandQueue, retain_command_queue};
use opencl3::context::{Context, context::retain_context};
use opencl3::device::{SubDevice, retain_device};
use opencl3::error_codes::ClError;
use opencl3::event::{CL_COMPLETE, Event, retain_event};
use opencl3::memory::{
    Buffer, CL_FLOAT, CL_HALF_FLOAT, CL_MEM_OBJECT_BUFFER, CL_MEM_OBJECT_IMAGE2D, CL_MEM_READ_ONLY,
    CL_MEM_WRITE_ONLY, CL_RGBA, ClMem, Image, retain_mem_object,
};
use opencl3::types::{cl_command_queue, cl_context, cl_event, cl_mem};

use super::Compute;
use super::copies::state;
use super::discover::device_of;
use super::failure::{asked, failed};
use super::film::{Film, FilmFormat, halves_of};
use super::handle::Handle;
use super::host_image::{ImageCopy, ImageInPlace};
use crate::error::{Error, Result};

/// A host's memory that a frame is drawn into: linear radiance, RGBA by rows from the top left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum HostTarget {
    /// A buffer of at least `16 * width * height` bytes, float32, made with `CL_MEM_READ_WRITE`. A place in a larger
    /// buffer is a sub-buffer (`clCreateSubBuffer`).
    Buffer(cl_mem),
    /// A 2D image of the scene's size with channels `CL_RGBA` of type `CL_FLOAT` or `CL_HALF_FLOAT`, which kernels may
    /// write. What `clCreateFromGLTexture` or an extension for external memory makes of a texture will do, too.
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

const MARKER: &str = "clEnqueueMarkerWithWaitList";

/// Makes the error of something of the host's that does not fit.
pub(crate) fn unfit(object: &'static str, reason: impl Display) -> Error {
    Error::Host {
        object,
        reason: reason.to_string(),
    }
}

/// A host's queue, tied to our own.
#[derive(Debug)]
pub(crate) struct HostLink {
    queue: Handle<CommandQueue>,
    /// It may be a part of a device.
    _device: Handle<SubDevice>,
    /// Commands that nobody waited for: PoCL 3.1 aborts when an event fails that was released before it was over.
    pub(super) held: Vec<Handle<Event>>,
    /// Whether the driver built no kernels that write images.
    copies_images: bool,
    /// The buffer that was copied to an image last.
    copy: Option<ImageCopy>,
    /// Where the host's points are read.
    pub(super) reading: Option<Arc<Compute>>,
}

/// A frame for a host that has begun.
#[derive(Debug)]
pub(crate) struct HostFrame {
    memory: Handle<Image>,
    size: (u32, u32),
    in_place: Option<ImageInPlace>,
    is_copied: bool,
}

impl HostLink {
    /// Takes the host's context and the device of its queue. Both are retained.
    ///
    /// # Safety
    /// Both are alive.
    pub(crate) unsafe fn open(
        context: cl_context,
        queue: cl_command_queue,
    ) -> Result<(Compute, Self)> {
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
        let id = device.handle.id();
        // SAFETY: the queue has the device.
        unsafe { asked("queue", retain_device(id).map_err(ClError)) }?;
        let retained = Handle::new(SubDevice::new(id));
        let link = Self {
            queue,
            _device: retained,
            held: Vec::new(),
            copies_images: false,
            copy: None,
            reading: None,
        };
        Ok((Compute::in_context(context, &device)?, link))
    }

    /// Checks what [`HostLink::begin`] does, and enqueues nothing.
    ///
    /// # Safety
    /// As there.
    pub(crate) unsafe fn check(
        compute: &Compute,
        target: HostTarget,
        size: (u32, u32),
        wait_list: &[cl_event],
    ) -> Result<()> {
        // SAFETY: the caller's promise.
        unsafe {
            checked(compute, target, size)?;
            check_events(compute, wait_list)
        }
    }

    /// Begins a frame of this size: what follows on our queue waits for `wait_list` and for the commands before it on
    /// the host's queue, and the film goes to the target. Nothing here waits.
    ///
    /// # Safety
    /// Target and events are alive, and nothing else uses the target until the frame's event is over.
    pub(crate) unsafe fn begin(
        &mut self,
        compute: &Compute,
        film: &mut Film,
        target: HostTarget,
        size: (u32, u32),
        wait_list: &[cl_event],
    ) -> Result<HostFrame> {
        // SAFETY: the caller's promise.
        let (memory, has_halves) = unsafe { checked(compute, target, size) }?;
        // SAFETY: the same.
        unsafe { check_events(compute, wait_list) }?;
        self.held.retain(|event| matches!(state(event), Ok(false)));
        // SAFETY: the same.
        unsafe { self.begin_after(compute, wait_list) }?;
        let in_place = match target {
            HostTarget::Image(_) => {
                let held = &mut self.held;
                ImageInPlace::map(compute, &memory, has_halves, size, held)?
            }
            HostTarget::Buffer(_) => None,
        };
        match (target, &in_place) {
            (HostTarget::Buffer(buffer), _) => film.aim_at_buffer(buffer),
            (HostTarget::Image(_), Some(image)) => image.aim(film),
            (HostTarget::Image(image), None) => film.aim_at_image(image, has_halves),
        }
        film.begin_at(0);
        let mut frame = HostFrame {
            memory,
            size,
            in_place,
            is_copied: false,
        };
        if self.copies_images {
            self.copies_instead(compute, film, &mut frame)?;
        }
        Ok(frame)
    }

    /// Aims the film at a buffer that is copied to the image in the end, in this frame and later ones: PoCL 7 builds no
    /// kernels of OpenCL C 1.2 that write images. Returns whether the film was aimed at an image.
    pub(crate) fn copies_instead(
        &mut self,
        compute: &Compute,
        film: &mut Film,
        frame: &mut HostFrame,
    ) -> Result<bool> {
        let FilmFormat::Image { has_halves } = film.format() else {
            return Ok(false);
        };
        self.copies_images = true;
        let kept = self
            .copy
            .take()
            .filter(|copy| copy.fits(has_halves, frame.size));
        let copy = match kept {
            Some(copy) => copy,
            None => ImageCopy::new(compute, has_halves, frame.size)?,
        };
        self.copy.insert(copy).aim(film);
        frame.is_copied = true;
        Ok(true)
    }

    /// Ends a frame: what follows on the host's queue waits for it. Returns the event of that, a marker on the host's
    /// queue.
    pub(crate) fn end(
        &mut self,
        compute: &Compute,
        film: &mut Film,
        frame: HostFrame,
        drawn: Result<()>,
    ) -> Result<Event> {
        film.aim_at_own();
        let HostFrame { memory, size, .. } = frame;
        let unmapped = match (frame.in_place, &self.copy) {
            (Some(image), _) => image.unmap(compute, &memory, &mut self.held),
            (None, Some(copy)) if frame.is_copied && drawn.is_ok() => {
                copy.copy_to(compute, &memory, size, &mut self.held)
            }
            _ => Ok(()),
        };
        // What was launched before a failure draws into the target, too: what follows on the host's queue waits for it.
        let ended = self.end_before(compute);
        match drawn.and(unmapped) {
            Ok(()) => ended,
            Err(error) => {
                self.held.extend(ended.map(Handle::new));
                Err(error)
            }
        }
    }

    /// Makes what follows on our queue wait for what is on the host's, and for the list.
    ///
    /// # Safety
    /// The events are alive.
    pub(crate) unsafe fn begin_after(
        &mut self,
        compute: &Compute,
        wait_list: &[cl_event],
    ) -> Result<()> {
        let name = &compute.device.name;
        let host = &self.queue;
        // With a list, it would wait for the list alone on an out-of-order queue.
        // SAFETY: nothing is waited for but what is on the queue.
        let begin = unsafe { host.enqueue_marker_with_wait_list(&[]) }
            .map(Handle::new)
            .map_err(failed(name, MARKER))?;
        // A queue waits for another's event only once that has been flushed.
        host.flush().map_err(failed(name, "clFlush"))?;
        let events = [&[begin.get()], wait_list].concat();
        // No barrier: PoCL 3.1 never lets go of a queue's last one.
        // SAFETY: the events are alive, by the caller's promise.
        let all = unsafe { compute.queue.enqueue_marker_with_wait_list(&events) }
            .map(Handle::new)
            .map_err(failed(name, MARKER))?;
        self.held.extend([begin, all]);
        Ok(())
    }

    /// Makes what follows on the host's queue wait for ours, and returns the event of that.
    fn end_before(&mut self, compute: &Compute) -> Result<Event> {
        let name = &compute.device.name;
        let queue = &compute.queue;
        // SAFETY: nothing is waited for but what is on the queue.
        let last = unsafe { queue.enqueue_marker_with_wait_list(&[]) }
            .map(Handle::new)
            .map_err(failed(name, MARKER))?;
        queue.flush().map_err(failed(name, "clFlush"))?;
        let host = &self.queue;
        // SAFETY: the event is alive.
        let end = unsafe { host.enqueue_marker_with_wait_list(&[last.get()]) }
            .map_err(failed(name, MARKER))?;
        // For whoever waits on another queue. If it fails, the host's next flush makes up for it.
        let _ = host.flush();
        self.held.push(last);
        Ok(end)
    }
}

/// Returns the target, retained, if a frame of this size can go there, and whether it has half floats.
///
/// # Safety
/// The memory object is alive.
unsafe fn checked(
    compute: &Compute,
    target: HostTarget,
    size: (u32, u32),
) -> Result<(Handle<Image>, bool)> {
    let (object, handle, wanted) = match target {
        HostTarget::Buffer(buffer) => ("buffer", buffer, CL_MEM_OBJECT_BUFFER),
        HostTarget::Image(image) => ("image", image, CL_MEM_OBJECT_IMAGE2D),
    };
    // SAFETY: the caller's promise.
    let memory = unsafe { retained(compute, object, handle, wanted) }?;
    let flags = asked(object, memory.flags())?;
    if flags & CL_MEM_READ_ONLY != 0 {
        let reason = "kernels may not write it (CL_MEM_READ_ONLY); use CL_MEM_READ_WRITE";
        return Err(unfit(object, reason));
    }
    let has_halves = match target {
        HostTarget::Buffer(_) => check_buffer(&memory, flags, size).map(|()| false),
        HostTarget::Image(_) => check_image(&memory, size),
    }?;
    Ok((memory, has_halves))
}

/// Returns a host's memory object, retained, if it is of the kind that is wanted and belongs to the context.
///
/// # Safety
/// The memory object is alive.
pub(super) unsafe fn retained(
    compute: &Compute,
    object: &'static str,
    handle: cl_mem,
    wanted: u32,
) -> Result<Handle<Image>> {
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
    if asked(object, memory.context())? != compute.context.get() {
        return Err(unfit(object, "it belongs to another context"));
    }
    Ok(memory)
}

/// # Safety
/// The events are alive.
unsafe fn check_events(compute: &Compute, wait_list: &[cl_event]) -> Result<()> {
    for event in wait_list {
        if event.is_null() {
            return Err(unfit("wait list", "it has a null event"));
        }
        // SAFETY: the caller's promise; the handle gives the reference back.
        let event = unsafe {
            asked("wait list", retain_event(*event).map_err(ClError))?;
            Handle::new(Event::new(*event))
        };
        let fault = if asked("wait list", event.context())? != compute.context.get() {
            "an event of it belongs to another context"
        } else if asked("wait list", event.command_execution_status())?.0 < CL_COMPLETE {
            "an event of it has failed"
        } else {
            continue;
        };
        return Err(unfit("wait list", fault));
    }
    Ok(())
}

fn check_buffer(buffer: &Image, flags: u64, (width, height): (u32, u32)) -> Result<()> {
    let bytes = asked("buffer", ClMem::size(buffer))?;
    let needed = 16 * width as usize * height as usize;
    if bytes < needed {
        let reason = format!("{bytes} bytes; {width}x{height} float32 RGBA pixels need {needed}");
        return Err(unfit("buffer", reason));
    }
    // For a part of a larger buffer, this is where the part begins.
    let pointer = asked("buffer", buffer.host_ptr())? as usize;
    if !pointer.is_multiple_of(16) {
        return Err(unfit("buffer", "its host pointer is no multiple of 16"));
    }
    if flags & CL_MEM_WRITE_ONLY != 0 {
        // Where a frame takes several launches, each adds to what is there.
        let reason = "kernels may not read it (CL_MEM_WRITE_ONLY); use CL_MEM_READ_WRITE";
        return Err(unfit("buffer", reason));
    }
    Ok(())
}

/// Returns whether the image has half floats.
fn check_image(image: &Image, size: (u32, u32)) -> Result<bool> {
    let width = asked("image", image.width())?;
    let height = asked("image", image.height())?;
    if (width, height) != (size.0 as usize, size.1 as usize) {
        let reason = format!(
            "{width}x{height} pixels, the scene has {}x{}",
            size.0, size.1
        );
        return Err(unfit("image", reason));
    }
    let format = asked("image", image.format())?;
    let [format] = format.as_slice() else {
        return Err(unfit("image", "OpenCL does not tell its format"));
    };
    let (order, kind) = (format.image_channel_order, format.image_channel_data_type);
    halves_of(order, kind).ok_or_else(|| {
        let reason = format!(
            "channels of order {order:#x} and type {kind:#x}; they must be CL_RGBA ({CL_RGBA:#x}) of CL_FLOAT \
             ({CL_FLOAT:#x}) or CL_HALF_FLOAT ({CL_HALF_FLOAT:#x})"
        );
        unfit("image", reason)
    })
}
