//! Images: depth, linear radiance, the picture made of it, what is behind it, files, and comparison.

#[cfg(feature = "files")]
mod animation;
mod background;
mod bloom;
mod clip;
mod compare;
mod depth;
#[cfg(feature = "files")]
mod depth_channel;
#[cfg(feature = "files")]
mod depth_file;
#[cfg(feature = "files")]
mod depth_source;
mod display;
#[cfg(feature = "files")]
mod encode;
mod exposure;
#[cfg(feature = "files")]
mod file;
#[cfg(feature = "files")]
mod flipbook;
#[cfg(feature = "files")]
mod format;
#[cfg(feature = "files")]
mod frame_rate;
#[cfg(feature = "files")]
mod openexr;
#[cfg(feature = "files")]
mod picture_file;
#[cfg(feature = "files")]
mod png_file;
mod size;
mod srgb;
mod tone_map;

#[cfg(feature = "files")]
pub use animation::{AnimationFile, AnimationFormat, Playback};
pub use background::{Background, BackgroundImage};
pub use bloom::Bloom;
pub(crate) use bloom::{Axis, spread_light};
pub use clip::{ClipDepth, ClipRange};
pub(crate) use clip::{axis_of, check_matrix, rows};
pub use compare::{Difference, compare, relative_errors};
pub use depth::{DepthAlong, DepthImage, DepthOptions};
pub use display::{Alpha, Display};
pub use exposure::Exposure;
#[cfg(feature = "files")]
pub use file::ImageFile;
#[cfg(feature = "files")]
pub use flipbook::{Flipbook, FlipbookLayout};
#[cfg(feature = "files")]
pub use format::ImageFormat;
#[cfg(feature = "files")]
pub use frame_rate::FrameRate;
#[cfg(feature = "files")]
pub use openexr::DECODER_THREAD;
pub use size::ImageSize;
pub use tone_map::ToneMap;

use crate::error::{Error, Result};
use crate::memory;

/// Linear radiance: RGBA in float32, alpha 1, by rows from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct RadianceImage {
    size: ImageSize,
    data: Vec<f32>,
    /// That its light has already.
    bloom: Option<Bloom>,
}

impl RadianceImage {
    /// Makes a black, transparent image.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`] if the host has too little memory for it.
    pub fn new(size: ImageSize) -> Result<Self> {
        Self::beside(size, 0)
    }

    /// Makes it where so many bytes more will be needed beside it.
    pub(crate) fn beside(size: ImageSize, other_bytes: u64) -> Result<Self> {
        let values = 4 * size.pixels();
        // The radiance, and the picture that is made of it.
        let bytes = values * size_of::<f32>() + 3 * size.pixels();
        let too_large = |why: String| {
            Error::OutOfMemory(format!(
                "image of {}x{} pixels: {why}; make the image smaller",
                size.width, size.height
            ))
        };
        if let Some(shortage) = memory::shortage(bytes as u64 + other_bytes) {
            return Err(too_large(shortage));
        }
        let mut data = Vec::new();
        data.try_reserve_exact(values).map_err(|_| {
            too_large(format!(
                "{} MiB needed, more than the system grants",
                bytes >> 20
            ))
        })?;
        data.resize(values, 0.0);
        Ok(Self {
            size,
            data,
            bloom: None,
        })
    }

    /// Says which bloom its light has.
    pub(crate) fn mark_bloomed(&mut self, bloom: Option<Bloom>) {
        self.bloom = bloom;
    }

    /// Returns width and height in pixels.
    #[must_use]
    pub fn size(&self) -> ImageSize {
        self.size
    }

    /// Returns the RGBA values, 4 for every pixel, by rows from the top left.
    #[must_use]
    pub fn as_slice(&self) -> &[f32] {
        &self.data
    }

    /// Returns the same values, to be changed.
    pub fn as_mut_slice(&mut self) -> &mut [f32] {
        &mut self.data
    }

    /// Returns the linear RGBA of a pixel; `None` outside the image.
    #[must_use]
    pub fn pixel(&self, column: u32, row: u32) -> Option<[f32; 4]> {
        if column >= self.size.width || row >= self.size.height {
            return None;
        }
        let begin = 4 * (row as usize * self.size.width as usize + column as usize);
        self.data.get(begin..begin + 4)?.try_into().ok()
    }
}

/// Returns the image that is kept from frame to frame, made anew if another size is wanted.
pub(crate) fn kept_image(
    image: &mut Option<RadianceImage>,
    size: ImageSize,
) -> Result<&mut RadianceImage> {
    let kept = image.take().filter(|image| image.size() == size);
    Ok(image.insert(match kept {
        Some(image) => image,
        None => RadianceImage::new(size)?,
    }))
}

/// A picture for screens: sRGB-encoded RGB, or RGBA of straight alpha, by rows from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DisplayImage {
    size: ImageSize,
    channels: usize,
    bits: u32,
    data: Vec<u8>,
}

impl DisplayImage {
    /// Makes a picture of 8-bit sRGB, three bytes a pixel by rows from the top left; `None` if there are more or fewer.
    #[must_use]
    pub fn from_rgb(size: ImageSize, data: Vec<u8>) -> Option<Self> {
        (data.len() == 3 * size.pixels()).then_some(Self {
            size,
            channels: 3,
            bits: 8,
            data,
        })
    }

    /// Returns width and height in pixels.
    #[must_use]
    pub fn size(&self) -> ImageSize {
        self.size
    }

    /// Returns how many channels a pixel has: 3, or 4 with alpha.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Returns how many bits a channel has: 8, or 16.
    #[must_use]
    pub fn bits(&self) -> u32 {
        self.bits
    }

    /// Returns the bytes, one for each channel of every pixel; of 16 bits two, in the order of this machine.
    #[must_use]
    pub fn as_slice(&self) -> &[u8] {
        &self.data
    }
}
