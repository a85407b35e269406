//! Depths in a host's own memory, a buffer or an image: which are taken, and how they lie there.

use opencl3::memory::{
    Buffer, CL_A, CL_BGRA, CL_DEPTH, CL_FLOAT, CL_HALF_FLOAT, CL_LUMINANCE, CL_MEM_OBJECT_BUFFER,
    CL_MEM_OBJECT_IMAGE2D, CL_MEM_WRITE_ONLY, CL_R, CL_RG, CL_RGBA, CL_SIGNED_INT8,
    CL_SIGNED_INT16, CL_SIGNED_INT32, CL_UNORM_INT8, CL_UNORM_INT16, CL_UNSIGNED_INT8,
    CL_UNSIGNED_INT16, CL_UNSIGNED_INT32, ClMem, Image,
};
use opencl3::types::cl_mem;

use super::Compute;
use super::failure::asked;
use super::handle::Handle;
use super::host::{HostTarget, retained, unfit};
use crate::error::Result;

/// A host's memory that holds a depth for every pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum HostDepthMemory {
    /// A buffer of float32 that kernels may read, one value a pixel, by rows.
    Buffer {
        /// The buffer.
        buffer: cl_mem,
        /// Where the first row begins, bytes; a multiple of 4.
        offset: usize,
        /// From the beginning of a row to that of the next, bytes; a multiple of 4. 0: rows follow each other without a
        /// gap.
        row_pitch: usize,
    },
    /// A 2D image of the scene's size that kernels may read, with channels `CL_R`, `CL_DEPTH` or `CL_RGBA`, of which
    /// the first is taken, of type `CL_FLOAT`, `CL_HALF_FLOAT` or `CL_UNORM_INT16`.
    Image(cl_mem),
}

impl<T> From<&Buffer<T>> for HostDepthMemory {
    fn from(buffer: &Buffer<T>) -> Self {
        Self::Buffer {
            buffer: buffer.get(),
            offset: 0,
            row_pitch: 0,
        }
    }
}

impl From<&Image> for HostDepthMemory {
    fn from(image: &Image) -> Self {
        Self::Image(image.get())
    }
}

/// What values are stored as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub(super) enum Stored {
    Float,
    Half,
    /// A share of 65535.
    Short,
}

impl Stored {
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::Float => 4,
            Self::Half | Self::Short => 2,
        }
    }
}

/// A host's depths that fit, retained.
#[derive(Debug)]
pub(crate) struct HeldDepths {
    pub(super) memory: Handle<Image>,
    pub(super) is_image: bool,
    pub(super) stored: Stored,
    /// In values: the place of the first, and the steps to the next row and to the next pixel.
    pub(super) first: u32,
    pub(super) row: u32,
    pub(super) column: u32,
    pub(super) size: (u32, u32),
}

impl HeldDepths {
    /// Takes a host's depths for an image of this size that is drawn into a target, if they fit.
    ///
    /// # Safety
    /// The memory object is alive.
    pub(crate) unsafe fn take(
        compute: &Compute,
        memory: HostDepthMemory,
        target: HostTarget,
        size: (u32, u32),
    ) -> Result<Self> {
        let (object, handle, wanted) = match memory {
            HostDepthMemory::Buffer { buffer, .. } => (BUFFER, buffer, CL_MEM_OBJECT_BUFFER),
            HostDepthMemory::Image(image) => (IMAGE, image, CL_MEM_OBJECT_IMAGE2D),
        };
        // SAFETY: the caller's promise.
        let held = unsafe { retained(compute, object, handle, wanted) }?;
        if asked(object, held.flags())? & CL_MEM_WRITE_ONLY != 0 {
            let reason = "kernels may not read it (CL_MEM_WRITE_ONLY); use CL_MEM_READ_ONLY or CL_MEM_READ_WRITE";
            return Err(unfit(object, reason));
        }
        let (HostTarget::Buffer(drawn) | HostTarget::Image(drawn)) = target;
        if held.get() == drawn {
            return Err(unfit(object, "the frame is drawn into the same memory"));
        }
        match memory {
            HostDepthMemory::Buffer {
                offset, row_pitch, ..
            } => Self::of_buffer(held, offset, row_pitch, size),
            HostDepthMemory::Image(_) => Self::of_image(held, size),
        }
    }

    fn of_buffer(
        memory: Handle<Image>,
        offset: usize,
        row_pitch: usize,
        (width, height): (u32, u32),
    ) -> Result<Self> {
        let wrong = |reason: String| Err(unfit(BUFFER, reason));
        let value = Stored::Float.bytes();
        let row = value * width as usize;
        let pitch = if row_pitch == 0 { row } else { row_pitch };
        if !(offset.is_multiple_of(value) && pitch.is_multiple_of(value)) {
            return wrong(format!(
                "an offset of {offset} and a row pitch of {row_pitch} bytes; both are multiples of {value}"
            ));
        }
        if pitch < row {
            return wrong(format!(
                "a row pitch of {pitch} bytes; {width} float32 values need {row}, 0 stands for that"
            ));
        }
        let bytes = asked(BUFFER, ClMem::size(&*memory))?;
        let before_last = pitch.checked_mul(height.saturating_sub(1) as usize);
        let needed = before_last.and_then(|bytes| bytes.checked_add(row)?.checked_add(offset));
        if needed.is_none_or(|needed| needed > bytes) {
            let needed = needed.map_or("more than there is".to_owned(), |bytes| bytes.to_string());
            return wrong(format!(
                "{bytes} bytes; {width}x{height} float32 values from byte {offset} on in rows of {pitch} bytes need \
                 {needed}"
            ));
        }
        let pointer = asked(BUFFER, memory.host_ptr())? as usize;
        if !pointer.is_multiple_of(value) {
            return wrong(format!("its host pointer is no multiple of {value}"));
        }
        let (Ok(first), Ok(row)) = ((offset / value).try_into(), (pitch / value).try_into()) else {
            return wrong(format!(
                "an offset of {offset} and a row pitch of {pitch} bytes; they end at 16 GiB; use a sub-buffer"
            ));
        };
        Ok(Self {
            memory,
            is_image: false,
            stored: Stored::Float,
            first,
            row,
            column: 1,
            size: (width, height),
        })
    }

    fn of_image(memory: Handle<Image>, size: (u32, u32)) -> Result<Self> {
        let width = asked(IMAGE, memory.width())?;
        let height = asked(IMAGE, memory.height())?;
        if (width, height) != (size.0 as usize, size.1 as usize) {
            let (wanted_width, wanted_height) = size;
            let reason =
                format!("{width}x{height} pixels, the scene has {wanted_width}x{wanted_height}");
            return Err(unfit(IMAGE, reason));
        }
        let format = asked(IMAGE, memory.format())?;
        let [format] = format.as_slice() else {
            return Err(unfit(IMAGE, "OpenCL does not tell its format"));
        };
        let (order, kind) = (format.image_channel_order, format.image_channel_data_type);
        let channels = match order {
            CL_R | CL_DEPTH => Some(1),
            CL_RGBA => Some(4),
            _ => None,
        };
        let stored = match kind {
            CL_FLOAT => Some(Stored::Float),
            CL_HALF_FLOAT => Some(Stored::Half),
            CL_UNORM_INT16 => Some(Stored::Short),
            _ => None,
        };
        let (Some(channels), Some(stored)) = (channels, stored) else {
            return Err(unfit(
                IMAGE,
                format_args!(
                    "channels of {} and {}; depths are CL_R, CL_DEPTH or CL_RGBA of CL_FLOAT, CL_HALF_FLOAT or \
                     CL_UNORM_INT16",
                    name_of(&ORDERS, order),
                    name_of(&TYPES, kind)
                ),
            ));
        };
        Ok(Self {
            memory,
            is_image: true,
            stored,
            first: 0,
            row: channels * size.0,
            column: channels,
            size,
        })
    }

    pub(super) fn pixels(&self) -> usize {
        self.size.0 as usize * self.size.1 as usize
    }
}

const BUFFER: &str = "depth buffer";
const IMAGE: &str = "depth image";

/// Names of what an image's channels are, to say which do not fit.
const ORDERS: [(u32, &str); 8] = [
    (CL_R, "CL_R"),
    (CL_A, "CL_A"),
    (CL_RG, "CL_RG"),
    (CL_RGBA, "CL_RGBA"),
    (CL_BGRA, "CL_BGRA"),
    (CL_LUMINANCE, "CL_LUMINANCE"),
    (CL_DEPTH, "CL_DEPTH"),
    (CL_DEPTH_STENCIL, "CL_DEPTH_STENCIL"),
];
const TYPES: [(u32, &str); 11] = [
    (CL_UNORM_INT8, "CL_UNORM_INT8"),
    (CL_UNORM_INT16, "CL_UNORM_INT16"),
    (CL_UNORM_INT24, "CL_UNORM_INT24"),
    (CL_SIGNED_INT8, "CL_SIGNED_INT8"),
    (CL_SIGNED_INT16, "CL_SIGNED_INT16"),
    (CL_SIGNED_INT32, "CL_SIGNED_INT32"),
    (CL_UNSIGNED_INT8, "CL_UNSIGNED_INT8"),
    (CL_UNSIGNED_INT16, "CL_UNSIGNED_INT16"),
    (CL_UNSIGNED_INT32, "CL_UNSIGNED_INT32"),
    (CL_HALF_FLOAT, "CL_HALF_FLOAT"),
    (CL_FLOAT, "CL_FLOAT"),
];

/// Of `cl_khr_gl_depth_images`, which opencl3 does not name. OpenCL copies no such image to a buffer.
const CL_DEPTH_STENCIL: u32 = 0x10BE;
const CL_UNORM_INT24: u32 = 0x10DF;

fn name_of(names: &[(u32, &str)], number: u32) -> String {
    let known = names.iter().find(|(known, _)| *known == number);
    known.map_or_else(|| format!("{number:#x}"), |(_, name)| (*name).to_owned())
}
