//! Typed, named device buffers that know their length.

use std::ffi::c_void;
use std::ptr;

use bytemuck::Pod;
use opencl3::event::Event;
use opencl3::memory::{
    Buffer, CL_MAP_READ, CL_MAP_WRITE_INVALIDATE_REGION, CL_MEM_ALLOC_HOST_PTR, CL_MEM_READ_WRITE,
    CL_MEM_USE_HOST_PTR, ClMem,
};
use opencl3::types::{CL_FALSE, CL_TRUE, cl_mem};

use super::Compute;
use super::failure::{failed, fault, refused};
use super::handle::Handle;
use crate::error::{Error, Result};

/// A pixel: linear RGBA.
pub type Pixel = [f32; 4];

/// A buffer of `T` in device memory.
#[derive(Debug)]
pub struct DeviceBuffer<T> {
    buffer: Handle<Buffer<T>>,
    len: usize,
}

impl<T: Pod> DeviceBuffer<T> {
    /// Allocates `len` elements (at least one), which kernels may read and write; `what` names the contents in errors.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`] beyond the device's limits, and if the driver refuses.
    pub fn new(compute: &Compute, what: &str, len: usize) -> Result<Self> {
        Self::with_flags(compute, what, len, CL_MEM_READ_WRITE)
    }

    /// Allocates as [`DeviceBuffer::new`], placed so that mapping it copies nothing where device and host share their
    /// memory.
    pub(super) fn image(compute: &Compute, what: &str, len: usize) -> Result<Self> {
        let shared = compute.device.shares_host_memory;
        let place = if shared { CL_MEM_ALLOC_HOST_PTR } else { 0 };
        Self::with_flags(compute, what, len, CL_MEM_READ_WRITE | place)
    }

    /// Maps the first `len` elements for reading, after all earlier commands of the queue, and waits for it.
    pub(super) fn map(&self, compute: &Compute, len: usize) -> Result<*const f32> {
        self.check_len(compute, "clEnqueueMapBuffer", len)?;
        let mut pointer = ptr::null_mut::<c_void>();
        // SAFETY: the range lies within the buffer; the pointer is used only until `unmap`.
        unsafe {
            compute.queue.enqueue_map_buffer(
                &self.buffer,
                CL_TRUE,
                CL_MAP_READ,
                0,
                len * size_of::<T>(),
                &mut pointer,
                &[],
            )
        }
        .map(Handle::new)
        .map_err(failed(&compute.device.name, "clEnqueueMapBuffer"))?;
        Ok(pointer.cast_const().cast())
    }

    /// Ends a mapping.
    pub(super) fn unmap(&self, compute: &Compute, pointer: *const f32) -> Result<()> {
        // SAFETY: the pointer came from `map`, and nobody reads through it any more.
        unsafe {
            compute.queue.enqueue_unmap_mem_object(
                self.buffer.get(),
                pointer.cast_mut().cast::<c_void>(),
                &[],
            )
        }
        .map(Handle::new)
        .map_err(failed(&compute.device.name, "clEnqueueUnmapMemObject"))?;
        Ok(())
    }

    /// Makes a buffer of the host's memory, for kernels to write.
    ///
    /// # Safety
    /// Until the buffer is dropped, and every command that uses it is over, nobody else uses the memory.
    pub(super) unsafe fn around(compute: &Compute, memory: &mut [T]) -> Result<Self> {
        let flags = CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR;
        let (pointer, len) = (memory.as_mut_ptr().cast::<c_void>(), memory.len());
        // SAFETY: the memory has this length, and the caller leaves it to the buffer.
        let buffer = unsafe { Buffer::create(&compute.context, flags, len, pointer) }
            .map_err(failed(&compute.device.name, "clCreateBuffer"))?;
        Ok(Self {
            buffer: Handle::new(buffer),
            len,
        })
    }

    pub(super) fn with_flags(
        compute: &Compute,
        what: &str,
        len: usize,
        flags: u64,
    ) -> Result<Self> {
        let device = &compute.device;
        let len = len.max(1);
        let bytes = (len * size_of::<T>()) as u64;
        // A driver may grant more than there is and fail later: its own limits are what can be relied on.
        if bytes > device.max_allocation_bytes || bytes > device.memory_bytes {
            return Err(Error::OutOfMemory(format!(
                "{}: {what} needs {} MiB in one buffer; the device allows {} MiB",
                device.name,
                bytes.div_ceil(1 << 20),
                device.max_allocation_bytes.min(device.memory_bytes) >> 20
            )));
        }
        // SAFETY: no host pointer is handed over; the context is alive.
        let buffer =
            unsafe { Buffer::create(&compute.context, flags, len, ptr::null_mut::<c_void>()) }
                .map_err(refused(&device.name, what, bytes))?;
        Ok(Self {
            buffer: Handle::new(buffer),
            len,
        })
    }

    /// Returns the number of elements.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns false: a buffer has at least one element.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Copies `data` to the first elements and waits for it.
    ///
    /// # Errors
    /// [`Error::Device`] if the copy fails or the data is longer than the buffer.
    pub fn write(&mut self, compute: &Compute, data: &[T]) -> Result<()> {
        self.check_len(compute, "clEnqueueWriteBuffer", data.len())?;
        if data.is_empty() {
            return Ok(());
        }
        // SAFETY: the data fits into the buffer, and the blocking call ends before the borrow does.
        unsafe {
            compute
                .queue
                .enqueue_write_buffer(&mut self.buffer, CL_TRUE, 0, data, &[])
        }
        .map(Handle::new)
        .map_err(failed(&compute.device.name, "clEnqueueWriteBuffer"))?;
        Ok(())
    }

    /// Has the first elements made where they are, of which nothing is left, after all earlier commands of the queue:
    /// nothing is copied where device and host share their memory.
    ///
    /// # Errors
    /// [`Error::Device`] if mapping fails or there are fewer elements.
    pub(crate) fn fill<R>(
        &mut self,
        compute: &Compute,
        len: usize,
        make: impl FnOnce(&mut [T]) -> R,
    ) -> Result<R> {
        self.check_len(compute, "clEnqueueMapBuffer", len)?;
        if len == 0 {
            return Ok(make(&mut []));
        }
        let mut pointer = ptr::null_mut::<c_void>();
        // SAFETY: the range lies within the buffer; the pointer is used only until it is unmapped.
        unsafe {
            compute.queue.enqueue_map_buffer(
                &self.buffer,
                CL_TRUE,
                CL_MAP_WRITE_INVALIDATE_REGION,
                0,
                len * size_of::<T>(),
                &mut pointer,
                &[],
            )
        }
        .map(Handle::new)
        .map_err(failed(&compute.device.name, "clEnqueueMapBuffer"))?;
        // SAFETY: the mapping is of so many elements, aligned as buffers are, and any bits are a value; nobody else has
        // it until it is unmapped.
        let made = make(unsafe { std::slice::from_raw_parts_mut(pointer.cast::<T>(), len) });
        self.unmap(compute, pointer.cast_const().cast())?;
        Ok(made)
    }

    /// Copies the first elements to `target` after all earlier commands of the queue, and waits for it.
    ///
    /// # Errors
    /// [`Error::Device`] if the copy fails or the target is longer than the buffer.
    pub fn read(&self, compute: &Compute, target: &mut [T]) -> Result<()> {
        self.check_len(compute, "clEnqueueReadBuffer", target.len())?;
        if target.is_empty() {
            return Ok(());
        }
        // SAFETY: the target is no longer than the buffer, and the blocking call ends before the borrow does.
        unsafe {
            compute
                .queue
                .enqueue_read_buffer(&self.buffer, CL_TRUE, 0, target, &[])
        }
        .map(Handle::new)
        .map_err(failed(&compute.device.name, "clEnqueueReadBuffer"))?;
        Ok(())
    }

    /// Copies as [`DeviceBuffer::read`], this many elements in rows of `row` values that begin `stride` values apart in
    /// `target`; what lies between them is left alone.
    pub(super) fn read_rows<V: Pod>(
        &self,
        compute: &Compute,
        len: usize,
        row: usize,
        target: &mut [V],
        stride: usize,
    ) -> Result<()> {
        let call = "clEnqueueReadBufferRect";
        self.check_len(compute, call, len)?;
        let values = len * (size_of::<T>() / size_of::<V>());
        let rows = values / row.max(1);
        if rows == 0 {
            return Ok(());
        }
        if target.len() < (rows - 1) * stride + row || stride < row {
            let what = format!("{} values for {rows} rows {stride} apart", target.len());
            return Err(fault(&compute.device.name, call, what));
        }
        let bytes = size_of::<V>();
        let (origin, region) = ([0_usize; 3], [row * bytes, rows, 1]);
        // SAFETY: buffer and target hold all rows, and the blocking call ends before the borrow does.
        unsafe {
            compute.queue.enqueue_read_buffer_rect(
                &self.buffer,
                CL_TRUE,
                origin.as_ptr(),
                origin.as_ptr(),
                region.as_ptr(),
                row * bytes,
                0,
                stride * bytes,
                0,
                target.as_mut_ptr().cast::<c_void>(),
                &[],
            )
        }
        .map(Handle::new)
        .map_err(failed(&compute.device.name, call))?;
        Ok(())
    }

    /// Copies `data` to the first elements before the next command of the queue begins, without waiting.
    ///
    /// # Safety
    /// Until the event is over, the data must neither be changed nor freed.
    pub(super) unsafe fn begin_write(
        &mut self,
        compute: &Compute,
        data: &[T],
    ) -> Result<Handle<Event>> {
        self.check_len(compute, "clEnqueueWriteBuffer", data.len())?;
        // SAFETY: the data fits into the buffer; the caller leaves it alone.
        unsafe {
            compute
                .queue
                .enqueue_write_buffer(&mut self.buffer, CL_FALSE, 0, data, &[])
        }
        .map(Handle::new)
        .map_err(failed(&compute.device.name, "clEnqueueWriteBuffer"))
    }

    /// Copies the first elements to `target` after all earlier commands of the queue, without waiting.
    ///
    /// # Safety
    /// Until the event is over, the target must neither be used nor freed.
    pub(super) unsafe fn begin_read(
        &self,
        compute: &Compute,
        target: &mut [T],
    ) -> Result<Handle<Event>> {
        self.check_len(compute, "clEnqueueReadBuffer", target.len())?;
        // SAFETY: the target is no longer than the buffer; the caller leaves it alone.
        unsafe {
            compute
                .queue
                .enqueue_read_buffer(&self.buffer, CL_FALSE, 0, target, &[])
        }
        .map(Handle::new)
        .map_err(failed(&compute.device.name, "clEnqueueReadBuffer"))
    }

    pub(super) fn handle(&self) -> cl_mem {
        self.buffer.get()
    }

    fn check_len(&self, compute: &Compute, call: &'static str, len: usize) -> Result<()> {
        if len <= self.len {
            return Ok(());
        }
        let what = format!("{len} elements, the buffer has {}", self.len);
        Err(fault(&compute.device.name, call, what))
    }
}
