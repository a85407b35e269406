//! The image in the device's own buffer, mapped into host memory.

use std::ops::Deref;

use super::OpenClRenderer;

/// Linear RGBA by rows, readable until it is dropped; the renderer is borrowed as long.
#[derive(Debug)]
pub struct Mapped<'a> {
    pub(super) pointer: *const f32,
    pub(super) pixels: usize,
    pub(super) renderer: &'a mut OpenClRenderer,
}

impl Deref for Mapped<'_> {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        // SAFETY: the driver mapped 4 floats for each pixel here, for reading, until the guard is dropped.
        unsafe { std::slice::from_raw_parts(self.pointer, 4 * self.pixels) }
    }
}

impl Drop for Mapped<'_> {
    fn drop(&mut self) {
        let output = self.renderer.output.take();
        // A driver that refuses may have lost the device: the next call on it will say so. If it has not, the next image needs
        // a buffer of its own, since nothing may be written to one that is mapped.
        self.renderer.output =
            output.filter(|output| output.unmap(&self.renderer.compute, self.pointer).is_ok());
    }
}
