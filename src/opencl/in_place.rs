//! A frame that a CPU device writes where the caller wants it: nothing is copied.

use std::ops::{ControlFlow, Range};

use super::job::Job;
use super::renderer::Pixel;
use super::{Compute, DeviceBuffer, OpenClRenderer};
use crate::device::DeviceType;
use crate::error::Result;

/// The renderer while its output buffer is the caller's memory; dropped when nothing uses that any more.
struct InPlace<'a> {
    renderer: &'a mut OpenClRenderer,
    own: Option<DeviceBuffer<Pixel>>,
}

impl OpenClRenderer {
    /// Whether the device is to write there, and can: its memory is the host's, and pixels begin as kernels want them.
    pub(super) fn reaches(&self, target: &[Pixel]) -> bool {
        let device = self.device();
        !target.is_empty()
            && self.writes_in_place
            && device.device_type == DeviceType::Cpu
            && device.shares_host_memory
            && target.as_ptr().addr().is_multiple_of(size_of::<Pixel>())
            && size_of_val(target) as u64 <= self.most_output_bytes()
    }

    /// Renders these pixels into the target, as long.
    pub(super) fn run_in_place(
        &mut self,
        job: &Job,
        pixels: Range<usize>,
        target: &mut [Pixel],
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        // SAFETY: the guard below drops the buffer before the borrow ends, when the device is done with it.
        let buffer = unsafe { DeviceBuffer::around(&self.compute, target) }?;
        let in_place = InPlace {
            own: self.output.replace(buffer),
            renderer: self,
        };
        // Only a mapping makes sure that the host sees what the device wrote.
        let mut see = |output: &DeviceBuffer<Pixel>, compute: &Compute, band: Range<usize>| {
            let pointer = output.map(compute, band.len())?;
            output.unmap(compute, pointer)
        };
        in_place.renderer.run(job, pixels, 1, &mut see, progress)
    }
}

impl Drop for InPlace<'_> {
    fn drop(&mut self) {
        // Also after an error, or a panic of `progress`, launches may be under way. A driver that refuses has lost the
        // device, and these with it.
        let _ = self.renderer.compute.queue.finish();
        self.renderer.output = self.own.take();
    }
}
