//! A film's pixels where the host can read them: mapped, or in the caller's own memory.

use std::ops::{Deref, DerefMut};

use super::film::{Film, most_bytes};
use super::{Compute, DeviceBuffer, DeviceType, Pixel};
use crate::error::Result;

impl Film {
    /// Maps the first pixels into host memory, after all earlier commands of the queue: on a CPU, nothing is copied.
    pub(crate) fn map<'a>(
        &'a mut self,
        compute: &'a Compute,
        pixels: usize,
    ) -> Result<MappedFilm<'a>> {
        Ok(MappedFilm {
            pointer: self.pixels()?.map(compute, pixels)?,
            pixels,
            film: self,
            compute,
        })
    }

    /// Returns whether the device itself can write these pixels of the caller: its memory is the host's, and they begin
    /// as kernels want them.
    pub(crate) fn reaches(compute: &Compute, target: &[Pixel]) -> bool {
        let device = compute.device();
        !target.is_empty()
            && device.device_type == DeviceType::Cpu
            && device.shares_host_memory
            && target.as_ptr().addr().is_multiple_of(size_of::<Pixel>())
            && size_of_val(target) as u64 <= most_bytes(compute)
    }

    /// Puts the caller's memory in the place of the buffer, as long as the guard lives.
    pub(crate) fn lend<'a>(
        &'a mut self,
        compute: &'a Compute,
        target: &'a mut [Pixel],
    ) -> Result<FilmInPlace<'a>> {
        // SAFETY: the guard drops the buffer before the borrow ends, when the device is done with it.
        let buffer = unsafe { DeviceBuffer::around(compute, target) }?;
        Ok(FilmInPlace {
            own: self.pixels.replace(buffer),
            film: self,
            compute,
        })
    }
}

/// A film's pixels in host memory, readable until it is dropped.
#[derive(Debug)]
pub(crate) struct MappedFilm<'a> {
    pointer: *const f32,
    pixels: usize,
    film: &'a mut Film,
    compute: &'a Compute,
}

impl Deref for MappedFilm<'_> {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        // SAFETY: the driver mapped 4 floats for each pixel here, for reading, until the guard is dropped.
        unsafe { std::slice::from_raw_parts(self.pointer, 4 * self.pixels) }
    }
}

impl Drop for MappedFilm<'_> {
    fn drop(&mut self) {
        let pixels = self.film.pixels.take();
        // A driver that refuses may have lost the device: the next call on it will say so. If it has not, the next
        // image needs a buffer of its own, since nothing may be written to one that is mapped.
        self.film.pixels = pixels.filter(|it| it.unmap(self.compute, self.pointer).is_ok());
    }
}

/// A film while its buffer is the caller's memory; dropped when nothing uses that any more.
#[derive(Debug)]
pub(crate) struct FilmInPlace<'a> {
    film: &'a mut Film,
    compute: &'a Compute,
    own: Option<DeviceBuffer<Pixel>>,
}

impl FilmInPlace<'_> {
    /// Lets the host see what the device wrote: only a mapping ensures that.
    pub(crate) fn show_host(&self, pixels: usize) -> Result<()> {
        let buffer = self.film.pixels()?;
        let pointer = buffer.map(self.compute, pixels)?;
        buffer.unmap(self.compute, pointer)
    }
}

impl Deref for FilmInPlace<'_> {
    type Target = Film;

    fn deref(&self) -> &Film {
        self.film
    }
}

impl DerefMut for FilmInPlace<'_> {
    fn deref_mut(&mut self) -> &mut Film {
        self.film
    }
}

impl Drop for FilmInPlace<'_> {
    fn drop(&mut self) {
        // Also after an error, or a panic of `progress`, launches may be under way. A driver that refuses has lost the
        // device, and these with it.
        let _ = self.compute.queue.finish();
        self.film.pixels = self.own.take();
    }
}
