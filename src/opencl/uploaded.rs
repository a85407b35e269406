//! Lists on the device that are uploaded only when they changed.

use std::ptr;
use std::sync::Arc;

use bytemuck::Pod;
use opencl3::memory::CL_MEM_READ_ONLY;
use opencl3::types::cl_mem;

use super::copies::Copies;
use super::{Argument, Compute, DeviceBuffer};
use crate::error::Result;

/// A read-only list on the device that is uploaded only when it changed, and grows when it must.
#[derive(Debug)]
pub struct Uploaded<T> {
    what: &'static str,
    buffer: Option<DeviceBuffer<T>>,
    /// What the device has, or is about to have.
    contents: Arc<Vec<T>>,
    copies: Copies<Arc<Vec<T>>>,
    /// Whether the device has `contents`, or a copy of them is under way.
    is_valid: bool,
}

impl<T: Pod + PartialEq> Uploaded<T> {
    /// Makes an empty list; `what` names the contents in errors.
    pub fn new(what: &'static str) -> Self {
        Self {
            what,
            buffer: None,
            contents: Arc::default(),
            copies: Copies::new(),
            is_valid: false,
        }
    }

    /// Makes the device's list equal to `data`, before the next command of the queue begins. It does not wait for that
    /// (a wait costs a frame 45 us on PoCL 3.1): [`Uploaded::settle`] tells whether it went well.
    ///
    /// # Errors
    /// As [`DeviceBuffer::new`] and [`DeviceBuffer::write`].
    pub fn upload(&mut self, compute: &Compute, data: &[T]) -> Result<()> {
        if self.is_there() && *self.contents == data {
            return Ok(());
        }
        match Arc::get_mut(&mut self.contents) {
            Some(contents) => {
                contents.clear();
                contents.extend_from_slice(data);
            }
            None => self.contents = Arc::new(data.to_vec()), // the old ones are still being copied
        }
        self.write(compute)
    }

    /// Copies the contents to the device.
    fn write(&mut self, compute: &Compute) -> Result<()> {
        self.is_valid = false;
        let data = self.contents.as_slice();
        let buffer = match self.buffer.take() {
            Some(buffer) if buffer.len() >= data.len() => buffer,
            _ => DeviceBuffer::with_flags(compute, self.what, data.len(), CL_MEM_READ_ONLY)?,
        };
        let buffer = self.buffer.insert(buffer);
        if !data.is_empty() {
            // SAFETY: the contents are neither changed nor freed while `copies` holds them.
            let event = unsafe { buffer.begin_write(compute, &self.contents) }?;
            self.copies.keep(event, Arc::clone(&self.contents));
        }
        self.is_valid = true;
        Ok(())
    }

    /// Returns whether the device has what was uploaded last, or is about to have it.
    pub(crate) fn is_there(&mut self) -> bool {
        self.is_valid &= self.copies.reap();
        self.is_valid
    }

    /// Uploads values that the device has not, as [`Uploaded::upload`] does, without a copy on the host: others take
    /// their place in `data`.
    ///
    /// # Errors
    /// As [`Uploaded::upload`].
    pub(crate) fn upload_taken(&mut self, compute: &Compute, data: &mut Vec<T>) -> Result<()> {
        self.copies.reap(); // of copies that are over, the values can be taken back
        match Arc::get_mut(&mut self.contents) {
            Some(contents) => std::mem::swap(contents, data),
            None => self.contents = Arc::new(std::mem::take(data)), // the old ones are still being copied
        }
        self.write(compute)
    }

    /// Uploads `data`, unless the caller knows that they are what was uploaded last.
    ///
    /// # Errors
    /// As [`Uploaded::upload`].
    pub(crate) fn upload_unless(
        &mut self,
        is_known: bool,
        compute: &Compute,
        data: &[T],
    ) -> Result<()> {
        match self.is_there() && is_known {
            true => Ok(()),
            false => self.upload(compute, data),
        }
    }

    /// Waits for copies under way.
    ///
    /// # Errors
    /// [`Error::Device`] if a copy failed; the next upload repeats it.
    pub fn settle(&mut self, compute: &Compute) -> Result<()> {
        let outcome = self.copies.wait(compute);
        self.is_valid &= outcome.is_ok();
        outcome
    }

    /// Returns the buffer's handle; null before the first upload.
    pub(super) fn handle(&self) -> cl_mem {
        self.buffer
            .as_ref()
            .map_or(ptr::null_mut(), DeviceBuffer::handle)
    }
}

/// Values that are shared and never change, on the device; uploaded when others are given.
#[derive(Debug)]
pub struct UploadedShared<T> {
    what: &'static str,
    buffer: Option<DeviceBuffer<T>>,
    /// What the device has, or is about to have.
    contents: Option<Arc<Vec<T>>>,
    copies: Copies<Arc<Vec<T>>>,
}

impl<T: Pod> UploadedShared<T> {
    /// Makes a place without values; `what` names them in errors.
    pub(crate) fn new(what: &'static str) -> Self {
        Self {
            what,
            buffer: None,
            contents: None,
            copies: Copies::new(),
        }
    }

    /// Makes the device's values these before the next command of the queue begins; with `None`, those there stay.
    pub(crate) fn upload(&mut self, compute: &Compute, values: Option<&Arc<Vec<T>>>) -> Result<()> {
        if !self.copies.reap() {
            self.contents = None;
        }
        match values {
            Some(values) => self.upload_made(compute, values, || Arc::clone(values)),
            None => Ok(()),
        }
    }

    /// Makes the device's values those that are made of shared ones, unless it has those of them.
    pub(crate) fn upload_made(
        &mut self,
        compute: &Compute,
        of: &Arc<Vec<T>>,
        make: impl FnOnce() -> Arc<Vec<T>>,
    ) -> Result<()> {
        if !self.copies.reap() {
            self.contents = None;
        }
        let is_there = |there: &Arc<Vec<T>>| Arc::ptr_eq(there, of);
        if self.contents.as_ref().is_some_and(is_there) {
            return Ok(());
        }
        self.contents = None;
        let values = make();
        let buffer = match self.buffer.take() {
            Some(buffer) if buffer.len() >= values.len() => buffer,
            _ => DeviceBuffer::new(compute, self.what, values.len())?,
        };
        let buffer = self.buffer.insert(buffer);
        // SAFETY: shared values never change, and `copies` keeps them.
        let event = unsafe { buffer.begin_write(compute, &values) }?;
        self.copies.keep(event, values);
        self.contents = Some(Arc::clone(of));
        Ok(())
    }

    /// Waits for copies under way. After one that failed, the next upload repeats it.
    pub(crate) fn settle(&mut self, compute: &Compute) -> Result<()> {
        let outcome = self.copies.wait(compute);
        if outcome.is_err() {
            self.contents = None;
        }
        outcome
    }

    /// Returns how much memory they take on the device.
    pub(crate) fn bytes(&self) -> usize {
        let len = self.buffer.as_ref().map_or(0, DeviceBuffer::len);
        len * size_of::<T>()
    }

    /// Returns the values, for kernels; null before the first upload.
    pub(crate) fn argument(&self) -> &dyn Argument {
        &self.buffer
    }
}
