//! Points in a host's own buffers: rows of four float32, mapped for reading while they are looked at. Where device and
//! host share their memory nothing is copied.

use std::ffi::c_void;
use std::ptr;
use std::sync::Arc;

use opencl3::memory::{
    Buffer, CL_MAP_READ, CL_MEM_HOST_NO_ACCESS, CL_MEM_HOST_WRITE_ONLY, CL_MEM_OBJECT_BUFFER,
    ClMem, Image,
};
use opencl3::types::{CL_TRUE, cl_event, cl_mem};

use super::Compute;
use super::copies::state;
use super::failure::{asked, failed};
use super::handle::Handle;
use super::host::{HostLink, retained, unfit};
use crate::error::Result;

const BYTES_OF_ROW: usize = size_of::<[f32; 4]>();

/// Rows of a host's buffer, mapped until this is dropped.
#[derive(Debug)]
pub(crate) struct HeldRows {
    compute: Arc<Compute>,
    memory: Handle<Image>,
    rows: *const [f32; 4],
    count: usize,
}

// SAFETY: the rows are only read, whoever does it; a queue may be used by any thread.
unsafe impl Send for HeldRows {}
// SAFETY: the same.
unsafe impl Sync for HeldRows {}

impl HostLink {
    /// Returns a queue of its own, on which what follows waits for what is on the host's, and for the list: what is
    /// read there waits for no frame.
    ///
    /// # Safety
    /// The events are alive.
    pub(crate) unsafe fn reading_queue(
        &mut self,
        compute: &Compute,
        wait_list: &[cl_event],
    ) -> Result<Arc<Compute>> {
        let reading = match self.reading.take() {
            Some(reading) => reading,
            None => Arc::new(compute.sibling()?),
        };
        let reading = self.reading.insert(reading).clone();
        self.held.retain(|event| matches!(state(event), Ok(false)));
        // SAFETY: the caller's promise.
        unsafe { self.begin_after(&reading, wait_list) }?;
        Ok(reading)
    }
}

impl HeldRows {
    /// Maps the first rows of a host's buffer, after what is on the queue, and waits for that.
    ///
    /// # Safety
    /// The memory object is alive, and until this is dropped nothing writes there.
    pub(crate) unsafe fn take(
        compute: &Arc<Compute>,
        object: &'static str,
        buffer: cl_mem,
        count: usize,
    ) -> Result<Self> {
        // SAFETY: the caller's promise.
        let memory = unsafe { Self::checked(compute, object, buffer, count) }?;
        let mut held = Self {
            compute: Arc::clone(compute),
            memory,
            rows: ptr::null(),
            count,
        };
        if count > 0 {
            held.map()?;
        }
        Ok(held)
    }

    /// Returns a host's buffer, retained, if it has so many rows that may be read.
    ///
    /// # Safety
    /// The memory object is alive.
    pub(crate) unsafe fn checked(
        compute: &Compute,
        object: &'static str,
        buffer: cl_mem,
        count: usize,
    ) -> Result<Handle<Image>> {
        // SAFETY: the caller's promise.
        let memory = unsafe { retained(compute, object, buffer, CL_MEM_OBJECT_BUFFER) }?;
        if asked(object, memory.flags())? & (CL_MEM_HOST_NO_ACCESS | CL_MEM_HOST_WRITE_ONLY) != 0 {
            let reason = "the host may not read it (CL_MEM_HOST_NO_ACCESS or CL_MEM_HOST_WRITE_ONLY); points are \
                          sorted there";
            return Err(unfit(object, reason));
        }
        let bytes = asked(object, ClMem::size(&*memory))?;
        if count.checked_mul(BYTES_OF_ROW).is_none_or(|it| it > bytes) {
            let reason = format!("{bytes} bytes; {count} points need {BYTES_OF_ROW} each");
            return Err(unfit(object, reason));
        }
        let pointer = asked(object, memory.host_ptr())? as usize;
        if !pointer.is_multiple_of(align_of::<f32>()) {
            return Err(unfit(object, "its host pointer is no multiple of 4"));
        }
        Ok(memory)
    }

    fn map(&mut self) -> Result<()> {
        let mut pointer = ptr::null_mut::<c_void>();
        let bytes = self.count * BYTES_OF_ROW;
        let buffer = Buffer::<f32>::new(self.memory.get());
        // SAFETY: the range lies within the buffer; the pointer is used only until it is unmapped.
        let mapped = unsafe {
            let queue = &self.compute.queue;
            queue.enqueue_map_buffer(&buffer, CL_TRUE, CL_MAP_READ, 0, bytes, &mut pointer, &[])
        };
        std::mem::forget(buffer); // the reference is another's
        let name = &self.compute.device.name;
        mapped
            .map(Handle::new)
            .map_err(failed(name, "clEnqueueMapBuffer"))?;
        self.rows = pointer.cast_const().cast();
        Ok(())
    }

    /// Returns the rows.
    pub(crate) fn rows(&self) -> &[[f32; 4]] {
        if self.rows.is_null() {
            return &[];
        }
        // SAFETY: so many are mapped, aligned as float32 are; nobody writes them while this is there.
        unsafe { std::slice::from_raw_parts(self.rows, self.count) }
    }
}

impl Drop for HeldRows {
    /// Ends the mapping, and waits for that: what the host enqueues afterwards may write there again.
    fn drop(&mut self) {
        if self.rows.is_null() {
            return;
        }
        let pointer = self.rows.cast_mut().cast::<c_void>();
        let queue = &self.compute.queue;
        // SAFETY: the pointer came from a mapping of this memory, and nobody reads through it any more.
        let unmapped = unsafe { queue.enqueue_unmap_mem_object(self.memory.get(), pointer, &[]) };
        // What fails here shows at the queue's next command.
        if let Ok(event) = unmapped.map(Handle::new) {
            let _ = event.wait();
        }
    }
}
