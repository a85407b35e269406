//! Reads pictures for screens: PNG of 8 or 16 bits, sRGB.

use std::io::Cursor;
use std::path::Path;

use image::{ImageFormat, ImageReader, Limits};

use super::srgb::srgb_decode;
use super::{ImageSize, RadianceImage};
use crate::error::{Error, Result};

/// Reads a PNG as linear RGB over black.
///
/// # Errors
/// [`Error::Input`] if the file cannot be read or is no PNG, [`Error::OutOfMemory`].
pub(super) fn open(path: &Path) -> Result<RadianceImage> {
    let bytes = std::fs::read(path)
        .map_err(|error| Error::input(path, format!("cannot read: {error}")).caused_by(error))?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_image_width = Some(ImageSize::LIMIT);
    limits.max_image_height = Some(ImageSize::LIMIT);
    reader.limits(limits);
    let picture = reader.decode().map_err(|error| {
        let reason = format!("neither .exr nor a PNG that can be read: {error}");
        Error::input(path, reason).caused_by(error)
    })?;
    let (width, height) = (picture.width(), picture.height());
    let mut image = RadianceImage::new(ImageSize { width, height })?;
    let picture = picture.into_rgba16();
    for (pixel, stored) in image.data.chunks_exact_mut(4).zip(picture.pixels()) {
        let [red, green, blue, alpha] = stored.0.map(|value| f32::from(value) / 65535.0);
        let linear = [red, green, blue].map(|channel| alpha * srgb_decode(channel));
        pixel.copy_from_slice(&[linear[0], linear[1], linear[2], 1.0]);
    }
    Ok(image)
}

impl RadianceImage {
    /// Reads a PNG as linear RGB over black.
    ///
    /// # Errors
    /// [`Error::Input`] if the file cannot be read or is no PNG, [`Error::OutOfMemory`].
    pub(crate) fn open_picture(path: &Path) -> Result<Self> {
        open(path)
    }
}
