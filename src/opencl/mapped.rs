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
        if let Some(output) = &self.renderer.output {
            // A driver that refuses has lost the device; the next call on it will say so.
            let _ = output.unmap(&self.renderer.compute, self.pointer);
        }
    }
}
