//! The depth of every pixel, on the device.

use std::ptr;

use opencl3::types::cl_mem;

use super::{Compute, DeviceBuffer};
use crate::error::Result;
use crate::image::DepthImage;

/// Uploaded when another image is given.
#[derive(Debug, Default)]
pub(super) struct Depths {
    buffer: Option<DeviceBuffer<f32>>,
    image: Option<DepthImage>,
}

impl Depths {
    /// Makes the device's depths equal to these; without an image, those there stay.
    pub(super) fn upload(&mut self, compute: &Compute, image: Option<&DepthImage>) -> Result<()> {
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
        self.buffer
            .insert(buffer)
            .write(compute, image.as_slice())?;
        self.image = Some(image.clone());
        Ok(())
    }

    /// The buffer's handle; null before the first upload.
    pub(super) fn handle(&self) -> cl_mem {
        self.buffer
            .as_ref()
            .map_or(ptr::null_mut(), DeviceBuffer::handle)
    }
}
