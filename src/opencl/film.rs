//! The film: where light goes, linear RGBA by rows from the top left. Every engine draws into it in the same way, and
//! does not know whose memory it is.
//!
//! Light is gathered in a buffer of float32. Where finished pixels are wanted as half floats or in an image, the last
//! launch of a pixel stores it there instead (`cl/film.h`).

use std::ops::Range;

use opencl3::memory::{CL_FLOAT, CL_HALF_FLOAT, CL_RGBA, ClMem, Image};
use opencl3::types::cl_mem;

use super::half::half_to_float;
use super::handle::Handle;
use super::image::{create_image, read_image};
use super::kernel::{Argument, RawMemory, by_value};
use super::layout::device_struct;
use super::{Compute, DeviceBuffer, Pixel};
use crate::error::{Error, Result};

device_struct! {
    /// Which pixels a launch draws, and where they go.
    FilmPart [24] {
        first: u32 = 0,
        count: u32 = 4,
        slot: u32 = 8,
        width: u32 = 12,
        adds: u32 = 16,
        is_last: u32 = 20,
    }
}

by_value!(FilmPart);

/// What finished pixels are stored as. Kernels are built for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FilmFormat {
    /// A buffer of float32.
    Floats,
    /// A buffer of half floats.
    Halves,
    /// An image, with channels of half floats or of float32.
    Image {
        /// Whether they are half floats.
        has_halves: bool,
    },
}

impl FilmFormat {
    /// Returns what the kernels' compiler is told.
    pub fn definitions(self) -> &'static str {
        match self {
            Self::Floats => "",
            Self::Halves => " -D HALVES -D HALF_RANGE",
            Self::Image { has_halves: true } => " -D IMAGE -D HALF_RANGE",
            Self::Image { has_halves: false } => " -D IMAGE",
        }
    }
}

/// Whose memory finished pixels go to.
#[derive(Debug)]
enum Target {
    /// The film's own buffer.
    Own,
    /// A buffer of someone else, for all pixels.
    Buffer(cl_mem),
    /// A buffer of half floats of someone else, for all pixels.
    Halves(cl_mem),
    /// An image of someone else, for all pixels.
    Image {
        image: cl_mem,
        has_halves: bool,
    },
    /// The film's own, for tests of what hosts have.
    OwnHalves(DeviceBuffer<u16>),
    OwnImage(Handle<Image>),
}

/// Where light goes.
#[derive(Debug)]
pub struct Film {
    /// Float32 pixels, if any were needed.
    pub(super) pixels: Option<DeviceBuffer<Pixel>>,
    target: Target,
    /// Width and height of a target of its own, which takes no other.
    size: Option<(u32, u32)>,
    /// Number of the pixel in the buffer's first place.
    origin: u32,
    /// Whether the next engine adds its light to what is there.
    adds: bool,
    /// Whether another engine will add to what this one draws.
    is_unfinished: bool,
}

// SAFETY: OpenCL's functions on memory objects may be called from any thread.
unsafe impl Send for Film {}

/// A larger buffer would gain nothing; 8192x8192 pixels fit.
const MOST_BYTES: u64 = 1 << 30;

impl Film {
    /// Makes a film with memory of its own, which is allocated when it is first needed.
    pub fn new() -> Self {
        Self {
            pixels: None,
            target: Target::Own,
            size: None,
            origin: 0,
            adds: false,
            is_unfinished: false,
        }
    }

    /// Makes a film with memory of its own in another format, for an image of this size.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Device`].
    pub fn in_format(
        compute: &Compute,
        format: FilmFormat,
        width: u32,
        height: u32,
    ) -> Result<Self> {
        let channels = 4 * width as usize * height as usize;
        let target = match format {
            FilmFormat::Floats => Target::Own,
            FilmFormat::Halves => {
                Target::OwnHalves(DeviceBuffer::new(compute, "the half floats", channels)?)
            }
            FilmFormat::Image { .. } => Target::OwnImage(create_image(compute, width, height)?),
        };
        Ok(Self {
            size: (format != FilmFormat::Floats).then_some((width, height)),
            target,
            ..Self::new()
        })
    }

    /// Returns what kernels that draw into it are built for.
    pub fn format(&self) -> FilmFormat {
        match &self.target {
            Target::Own | Target::Buffer(_) => FilmFormat::Floats,
            Target::Halves(_) | Target::OwnHalves(_) => FilmFormat::Halves,
            Target::Image { has_halves, .. } => FilmFormat::Image {
                has_halves: *has_halves,
            },
            Target::OwnImage(_) => FilmFormat::Image { has_halves: false },
        }
    }

    /// Lets the next launches add light to what is there, if `adds`; else they replace it.
    pub fn add_to_what_is_there(&mut self, adds: bool) {
        self.adds = adds;
    }

    /// Says whether another engine will add to what is drawn now: then pixels are not finished yet.
    pub fn leave_unfinished(&mut self, is_unfinished: bool) {
        self.is_unfinished = is_unfinished;
    }

    /// Makes sure that there is a buffer for `pixels` pixels, or for as many as the device's limits allow, a multiple
    /// of `grain`, and returns how many it is for.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Device`].
    pub fn reserve_band(&mut self, compute: &Compute, pixels: usize, grain: u32) -> Result<usize> {
        let grain = grain as usize;
        let grains = (most_bytes(compute) as usize / size_of::<Pixel>() / grain).max(1);
        let wanted = pixels.min(grains * grain);
        self.reserve(compute, wanted)?;
        Ok(wanted.max(1))
    }

    /// Returns how much of the host's memory a buffer for so many pixels takes that is not there yet, bytes; 0 where a
    /// device has its own.
    pub(crate) fn missing_bytes(&self, compute: &Compute, pixels: usize) -> u64 {
        if !compute.device().shares_host_memory {
            return 0;
        }
        let bytes = |pixels: usize| (pixels * size_of::<Pixel>()) as u64;
        let there = self.pixels.as_ref().map_or(0, DeviceBuffer::len);
        let wanted = bytes(pixels).min(most_bytes(compute));
        wanted.saturating_sub(bytes(there))
    }

    fn reserve(&mut self, compute: &Compute, pixels: usize) -> Result<()> {
        let is_short = |buffer: &DeviceBuffer<Pixel>| buffer.len() < pixels;
        if self.pixels.as_ref().is_none_or(is_short) {
            self.pixels = None;
            self.pixels = Some(DeviceBuffer::image(compute, "the image", pixels)?);
        }
        Ok(())
    }

    /// Lets the next launches begin at this pixel, which goes to the buffer's first place.
    pub fn begin_at(&mut self, pixel: u32) {
        self.origin = pixel;
    }

    /// Returns the arguments of a launch on some pixels of an image of this size, which may be the first or the last
    /// launch of an engine on them.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`] if light must be gathered and there is no memory for it; [`Error::Unsupported`] if a film
    /// of its own is of another size.
    pub(crate) fn arguments(
        &mut self,
        compute: &Compute,
        pixels: &Range<u32>,
        (width, height): (u32, u32),
        is_first: bool,
        is_last: bool,
    ) -> Result<FilmArguments> {
        if let Some((own_width, own_height)) = self.size
            && (own_width, own_height) != (width, height)
        {
            return Err(Error::Unsupported(format!(
                "the film has {own_width}x{own_height} pixels, the image {width}x{height}"
            )));
        }
        let part = FilmPart {
            first: pixels.start,
            count: pixels.end - pixels.start,
            slot: pixels.start - self.origin,
            width,
            adds: u32::from(self.adds || !is_first),
            is_last: u32::from(is_last && !self.is_unfinished),
        };
        let is_whole = part.adds == 0 && part.is_last == 1;
        let gathered = match self.target {
            Target::Buffer(buffer) => buffer,
            Target::Own => self.pixels()?.handle(),
            _ if is_whole => std::ptr::null_mut(),
            _ => {
                self.reserve(compute, width as usize * height as usize)?;
                self.pixels()?.handle()
            }
        };
        let image = match &self.target {
            Target::Own | Target::Buffer(_) => None,
            Target::Halves(memory) | Target::Image { image: memory, .. } => Some(*memory),
            Target::OwnHalves(halves) => Some(halves.handle()),
            Target::OwnImage(image) => Some(image.get()),
        };
        Ok(FilmArguments {
            part,
            pixels: RawMemory(gathered),
            image: image.map(RawMemory),
        })
    }

    /// Returns the arguments of a launch on all pixels of an image, which finds there what engines have drawn and
    /// finishes it.
    ///
    /// # Errors
    /// As [`Film::arguments`].
    pub(crate) fn drawn(&mut self, compute: &Compute, size: (u32, u32)) -> Result<FilmArguments> {
        self.origin = 0;
        self.arguments(compute, &(0..size.0 * size.1), size, false, true)
    }

    pub(super) fn pixels(&self) -> Result<&DeviceBuffer<Pixel>> {
        self.pixels
            .as_ref()
            .ok_or_else(|| Error::OutOfMemory("the film has no buffer".to_owned()))
    }

    /// Copies the first pixels of the buffer to `target`, after all earlier commands of the queue, and waits for it.
    ///
    /// # Errors
    /// [`Error::Device`].
    pub fn read(&self, compute: &Compute, target: &mut [Pixel]) -> Result<()> {
        match &self.target {
            Target::OwnHalves(halves) => {
                let mut values = vec![0_u16; 4 * target.len()];
                halves.read(compute, &mut values)?;
                for (channel, bits) in target.as_flattened_mut().iter_mut().zip(values) {
                    *channel = half_to_float(bits);
                }
                Ok(())
            }
            Target::OwnImage(image) => read_image(compute, image, target),
            _ => self.pixels()?.read(compute, target),
        }
    }

    /// Copies pixels of the host to the beginning of the buffer, and waits for it.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`] if the buffer is shorter, [`Error::Device`].
    pub fn write(&mut self, compute: &Compute, source: &[Pixel]) -> Result<()> {
        self.reserve(compute, source.len())?;
        match &mut self.pixels {
            Some(pixels) => pixels.write(compute, source),
            None => Ok(()),
        }
    }

    /// Copies this many pixels, in rows of `row` values that begin `stride` values apart.
    pub(crate) fn read_rows(
        &self,
        compute: &Compute,
        pixels: usize,
        row: usize,
        target: &mut [f32],
        stride: usize,
    ) -> Result<()> {
        let buffer = self.pixels()?;
        buffer.read_rows(compute, pixels, row, target, stride)
    }

    /// Aims the film at someone else's buffer of float32, for all pixels.
    pub(super) fn aim_at_buffer(&mut self, buffer: cl_mem) {
        self.target = Target::Buffer(buffer);
    }

    pub(super) fn aim_at_halves(&mut self, buffer: cl_mem) {
        self.target = Target::Halves(buffer);
    }

    pub(super) fn aim_at_image(&mut self, image: cl_mem, has_halves: bool) {
        self.target = Target::Image { image, has_halves };
    }

    /// Aims the film at its own buffer again.
    pub(crate) fn aim_at_own(&mut self) {
        self.target = Target::Own;
    }
}

impl Default for Film {
    fn default() -> Self {
        Self::new()
    }
}

/// Of the film's own buffer.
pub(super) fn most_bytes(compute: &Compute) -> u64 {
    let device = compute.device();
    // A quarter of the memory leaves room for the sources and for everyone else.
    let bytes = device.max_allocation_bytes.min(device.memory_bytes / 4);
    bytes.min(MOST_BYTES)
}

/// What a kernel is told of the film.
#[derive(Debug)]
pub(crate) struct FilmArguments {
    pub part: FilmPart,
    pixels: RawMemory,
    image: Option<RawMemory>,
}

impl FilmArguments {
    /// By the names that they have in `cl/film.h`.
    pub(crate) fn named(&self) -> Vec<(&'static str, &dyn Argument)> {
        let mut named: Vec<(&str, &dyn Argument)> =
            vec![("part", &self.part), ("pixels", &self.pixels)];
        if let Some(image) = &self.image {
            named.push(("image", image));
        }
        named
    }
}

/// Returns whether an image's channels are half floats or float32; `None`: neither, or not RGBA.
pub(super) fn halves_of(order: u32, channel_type: u32) -> Option<bool> {
    match (order, channel_type) {
        (CL_RGBA, CL_FLOAT) => Some(false),
        (CL_RGBA, CL_HALF_FLOAT) => Some(true),
        _ => None,
    }
}
