//! Lengths of a host's depths. A kernel (`cl/depth.cl`) makes them in a buffer of our own, which is kept from frame to
//! frame; nothing of them comes to the host.
//!
//! An image is copied to a buffer first, as it is stored. So no kernel reads images: those of `CL_DEPTH` ask for an
//! extension, and some drivers build no kernels with images.

use std::ptr;

use bytemuck::Zeroable;
use opencl3::command_queue::enqueue_copy_image_to_buffer;
use opencl3::error_codes::ClError;
use opencl3::event::Event;
use opencl3::memory::ClMem;

use super::copies::state;
use super::failure::failed;
use super::handle::Handle;
use super::host_depth::{HeldDepths, Stored};
use super::kernel::{Argument, Kernel, RawMemory, by_value};
use super::layout::{DeviceStruct, device_struct};
use super::source::{SHARED, Sources};
use super::{Compute, DeviceBuffer, Program, RendererOptions};
use crate::error::{Error, Result};

device_struct! {
    /// How depths are stored, and what they mean.
    StoredDepths [96] {
        scale: [f32; 4] = 0,
        a: [f32; 4] = 16,
        b: [f32; 4] = 32,
        first: u32 = 48,
        row: u32 = 52,
        column: u32 = 56,
        width: u32 = 60,
        height: u32 = 64,
        is_bottom_up: u32 = 68,
        format: u32 = 72,
        meaning: u32 = 76,
        begin: f32 = 80,
        span: f32 = 84,
        low: f32 = 88,
        is_reversed: u32 = 92,
    }
}

by_value!(StoredDepths);

/// What values are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
enum Meaning {
    Lengths,
    Perspective,
    Orthographic,
}

/// What the values of a host's memory say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DepthValues {
    /// What they are multiplied with.
    pub scale: f64,
    /// Whether the first row is the lowest.
    pub is_bottom_up: bool,
    /// `None`: they are lengths.
    pub clip: Option<ClipValues>,
}

/// Depths of clip space: `a + b / d` (perspective) or `a + b d`, d the length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ClipValues {
    pub a: f64,
    pub b: f64,
    pub is_orthographic: bool,
    pub is_reversed: bool,
    /// The least depth; the greatest is 1.
    pub low: f64,
    /// Whether values go from 0 to 1 where depths go from `low` to 1.
    pub is_share: bool,
}

/// Says how depths lie in memory, and what they mean.
fn form_of(depths: &HeldDepths, values: &DepthValues) -> StoredDepths {
    let (width, height) = depths.size;
    StoredDepths {
        first: depths.first,
        row: depths.row,
        column: depths.column,
        width,
        height,
        format: depths.stored as u32,
        ..meaning_of(values)
    }
}

/// Says what float32 values mean, wherever they lie.
fn meaning_of(values: &DepthValues) -> StoredDepths {
    let clip = values.clip;
    let share = clip.filter(|clip| clip.is_share);
    StoredDepths {
        scale: parts(values.scale),
        a: parts(clip.map_or(0.0, |clip| clip.a)),
        b: parts(clip.map_or(1.0, |clip| clip.b)),
        is_bottom_up: u32::from(values.is_bottom_up),
        format: Stored::Float as u32,
        meaning: match clip {
            None => Meaning::Lengths,
            Some(clip) if clip.is_orthographic => Meaning::Orthographic,
            Some(_) => Meaning::Perspective,
        } as u32,
        begin: share.map_or(0.0, |clip| clip.low as f32),
        span: share.map_or(1.0, |clip| (1.0 - clip.low) as f32),
        low: clip.map_or(0.0, |clip| clip.low as f32),
        is_reversed: u32::from(clip.is_some_and(|clip| clip.is_reversed)),
        ..Zeroable::zeroed()
    }
}

/// Returns a number in three of float32, whose sum it is.
fn parts(number: f64) -> [f32; 4] {
    let first = number as f32;
    let second = (number - f64::from(first)) as f32;
    let third = (number - f64::from(first) - f64::from(second)) as f32;
    [first, second, third, 0.0]
}

/// What turns a host's depths into lengths on the device; kept from frame to frame.
#[derive(Debug)]
pub(crate) struct HostDepths {
    options: RendererOptions,
    kernel: Option<Kernel>,
    /// An image, as it is stored.
    copied: Option<DeviceBuffer<u8>>,
    lengths: Option<DeviceBuffer<f32>>,
    /// Commands that nobody waited for: PoCL 3.1 aborts when an event fails that was released before it was over.
    held: Vec<Handle<Event>>,
}

impl HostDepths {
    pub(crate) fn new(options: &RendererOptions) -> Self {
        Self {
            // A value has no lanes.
            options: RendererOptions {
                lanes: Some(1),
                ..options.clone()
            },
            kernel: None,
            copied: None,
            lengths: None,
            held: Vec::new(),
        }
    }

    /// Makes sure that the kernel is built, and returns its program if it was built now.
    pub(crate) fn prepare(&mut self, compute: &Compute) -> Result<Option<Program>> {
        if self.kernel.is_some() {
            return Ok(None);
        }
        let sources = Sources {
            files: SHARED.to_vec(),
            kinds: Vec::new(),
        };
        let text = sources.resolve("depth.cl");
        let program = Program::build(compute, text, &definitions(), &self.options)?;
        self.kernel = Some(program.kernel("lengths_of_depths")?);
        Ok(Some(program))
    }

    pub(crate) fn skips_self_test(&self) -> bool {
        self.options.skips_self_test
    }

    /// Forgets the kernel.
    pub(crate) fn forget(&mut self) {
        self.kernel = None;
    }

    /// Enqueues what makes lengths of a host's depths, by the kernel that was prepared, and returns where they will be.
    pub(crate) fn enqueue(
        &mut self,
        compute: &Compute,
        depths: &HeldDepths,
        values: &DepthValues,
    ) -> Result<RawMemory> {
        self.held.retain(|event| matches!(state(event), Ok(false)));
        let pixels = depths.pixels();
        let stored = match depths.is_image {
            true => self.copy(compute, depths)?,
            false => RawMemory(depths.memory.get()),
        };
        let lengths = grown(&mut self.lengths, compute, "the host's depths", pixels)?;
        let kernel = self.kernel.as_ref().ok_or_else(unbuilt)?;
        let form = form_of(depths, values);
        self.held
            .push(launch(compute, kernel, &form, &stored, lengths)?);
        Ok(RawMemory(lengths.handle()))
    }

    /// Reads the lengths that were enqueued last, of so many pixels, and waits for them.
    pub(crate) fn read(&self, compute: &Compute, pixels: usize) -> Result<Vec<f32>> {
        let mut found = vec![0.0; pixels];
        if let Some(lengths) = &self.lengths {
            lengths.read(compute, &mut found)?;
        }
        Ok(found)
    }

    /// Returns the lengths of values by the kernel that was prepared, and waits for them: to see whether it is right.
    pub(crate) fn lengths_of(
        &self,
        compute: &Compute,
        stored: &[f32],
        values: &DepthValues,
    ) -> Result<Vec<f32>> {
        let count = stored.len();
        let mut buffer = DeviceBuffer::new(compute, "test values", count)?;
        buffer.write(compute, stored)?;
        let form = StoredDepths {
            row: count as u32,
            column: 1,
            width: count as u32,
            height: 1,
            ..meaning_of(values)
        };
        let lengths = DeviceBuffer::new(compute, "test lengths", count)?;
        let kernel = self.kernel.as_ref().ok_or_else(unbuilt)?;
        launch(compute, kernel, &form, &buffer, &lengths)?;
        let mut found = vec![0.0; count];
        lengths.read(compute, &mut found)?;
        Ok(found)
    }

    /// Copies an image to a buffer, as it is stored.
    fn copy(&mut self, compute: &Compute, depths: &HeldDepths) -> Result<RawMemory> {
        let bytes = depths.stored.bytes() * depths.column as usize * depths.pixels();
        let what = "a copy of the host's depth image";
        let copied = grown(&mut self.copied, compute, what, bytes)?;
        let event = copied_to(compute, depths, copied)?;
        self.held.push(event);
        Ok(RawMemory(copied.handle()))
    }
}

/// Launches the kernel over all pixels.
fn launch(
    compute: &Compute,
    kernel: &Kernel,
    form: &StoredDepths,
    stored: &dyn Argument,
    lengths: &DeviceBuffer<f32>,
) -> Result<Handle<Event>> {
    let arguments = [
        ("form", form as &dyn Argument),
        ("values", stored),
        ("lengths", lengths),
    ];
    let group = kernel.group(compute, 64)?;
    let pixels = form.width as usize * form.height as usize;
    kernel.launch(compute, &arguments, pixels, group)
}

fn unbuilt() -> Error {
    Error::Unsupported("a kernel that was never built was launched".to_owned())
}

/// Makes sure that a buffer has so many elements at least.
fn grown<'a, T: bytemuck::Pod>(
    buffer: &'a mut Option<DeviceBuffer<T>>,
    compute: &Compute,
    what: &str,
    len: usize,
) -> Result<&'a DeviceBuffer<T>> {
    let large = match buffer.take() {
        Some(there) if there.len() >= len => there,
        _ => DeviceBuffer::new(compute, what, len)?,
    };
    Ok(buffer.insert(large))
}

/// Copies an image to a buffer that is large enough, after what was enqueued.
fn copied_to(
    compute: &Compute,
    depths: &HeldDepths,
    buffer: &DeviceBuffer<u8>,
) -> Result<Handle<Event>> {
    let (width, height) = depths.size;
    let (origin, region) = ([0; 3], [width as usize, height as usize, 1]);
    let (origin, region) = (origin.as_ptr(), region.as_ptr());
    let (queue, name) = (compute.queue.get(), &compute.device.name);
    // SAFETY: the image has the region, the buffer room for it; both are retained until the command is over.
    let event = unsafe {
        let (from, to) = (depths.memory.get(), buffer.handle());
        enqueue_copy_image_to_buffer(queue, from, to, origin, region, 0, 0, ptr::null())
    };
    event
        .map(|event| Handle::new(Event::new(event)))
        .map_err(ClError)
        .map_err(failed(name, "clEnqueueCopyImageToBuffer"))
}

/// Returns what the kernel is built with: the host owns these numbers.
pub fn definitions() -> String {
    let layout = StoredDepths::LAYOUT;
    let stored = [
        ("STORED_FLOAT", Stored::Float as u32),
        ("STORED_HALF", Stored::Half as u32),
        ("STORED_SHORT", Stored::Short as u32),
        ("LENGTHS", Meaning::Lengths as u32),
        ("PERSPECTIVE", Meaning::Perspective as u32),
        ("ORTHOGRAPHIC", Meaning::Orthographic as u32),
    ];
    let numbers = stored.map(|(name, number)| format!(" -D {name}={number}u"));
    let size = format!(" -D SIZEOF_{}={}", layout.name.to_uppercase(), layout.size);
    numbers.concat() + &size
}
