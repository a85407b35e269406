//! The depth of every pixel, on the device.

use std::ptr;

use opencl3::types::cl_mem;

use super::copies::Copies;
use super::{Compute, DeviceBuffer};
use crate::error::Result;
use crate::image::DepthImage;

/// Uploaded when another image is given.
#[derive(Debug)]
pub(super) struct Depths {
    buffer: Option<DeviceBuffer<f32>>,
    image: Option<DepthImage>,
    copies: Copies<DepthImage>,
}

impl Depths {
    pub(super) fn new() -> Self {
        Self {
            buffer: None,
            image: None,
            copies: Copies::new(),
        }
    }

    /// Makes the device's depths equal to these before the next command of the queue begins; without an image, those
    /// there stay.
    pub(super) fn upload(&mut self, compute: &Compute, image: Option<&DepthImage>) -> Result<()> {
        if !self.copies.reap() {
            self.image = None;
        }
        let Some(image) = image else {
            return Ok(());
        };
        let is_there = |there: &DepthImage| there.shares_values(image);
        if self.image.as_ref().is_some_and(is_there) {
            return Ok(());
        }
        self.image = None;
        let len = image.as_slice().len();
        let buffer = match self.buffer.take() {
            Some(buffer) if buffer.len() >= len => buffer,
            _ => DeviceBuffer::new(compute, "the depth image", len)?,
        };
        let buffer = self.buffer.insert(buffer);
        // SAFETY: an image's values never change, and `copies` keeps them.
        let event = unsafe { buffer.begin_write(compute, image.as_slice()) }?;
        self.copies.keep(event, image.clone());
        self.image = Some(image.clone());
        Ok(())
    }

    /// Waits for copies under way. After one that failed, the next upload repeats it.
    pub(super) fn settle(&mut self, compute: &Compute) -> Result<()> {
        let outcome = self.copies.wait(compute);
        if outcome.is_err() {
            self.image = None;
        }
        outcome
    }

    /// The buffer's handle; null before the first upload.
    pub(super) fn handle(&self) -> cl_mem {
        self.buffer
            .as_ref()
            .map_or(ptr::null_mut(), DeviceBuffer::handle)
    }
}
