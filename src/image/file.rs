//! Image files: EXR (float32, linear) and PNG (8-bit sRGB).

use std::io;
use std::path::Path;

use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};

use super::openexr::OpenExr;
use super::{Display, DisplayImage, RadianceImage};
use crate::error::{Error, Result};
use crate::output::{Output, Sink, is_stream};

/// A file format, chosen by the ending of a file's name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImageFormat {
    /// 32-bit float, linear, before exposure and tone mapping.
    Exr,
    /// 8-bit sRGB, after both, dithered.
    Png,
}

impl ImageFormat {
    /// Chooses the format by the ending of a file's name; PNG for a pipe or a device without a known one.
    ///
    /// # Errors
    /// [`Error::OutputFormat`] for any other ending.
    pub fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            _ if is_stream(path) => Ok(Self::Png),
            _ => Err(Error::OutputFormat(path.to_owned())),
        }
    }
}

/// An output that is known to be writable before anything is computed.
#[derive(Debug)]
pub struct ImageFile {
    format: ImageFormat,
    output: Output,
}

impl ImageFile {
    /// Makes sure that `path` can be written, through symbolic links, and changes nothing yet. The format is that of
    /// [`ImageFormat::of`]. A pipe is waited for until somebody reads it.
    ///
    /// # Errors
    /// [`Error::OutputFormat`] for an unknown ending, [`Error::Output`] if the folder is missing or not writable, or
    /// the file that is there cannot be changed.
    pub fn create(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::create_as(path, ImageFormat::of(path)?)
    }

    /// Like [`ImageFile::create`], in a format that does not depend on the ending.
    ///
    /// # Errors
    /// [`Error::Output`] as there.
    pub fn create_as(path: impl AsRef<Path>, format: ImageFormat) -> Result<Self> {
        let output = Output::create(path.as_ref())?;
        Ok(Self { format, output })
    }

    /// Writes to standard output.
    #[must_use]
    pub fn stdout(format: ImageFormat) -> Self {
        let output = Output::stdout();
        Self { format, output }
    }

    /// Encodes the image, tone-mapped if the format is for screens, and puts the file in its place. A file that is
    /// there keeps its mode and its owner.
    ///
    /// # Errors
    /// [`Error::Output`] if the disk is full or nobody reads the pipe; nothing is left behind then.
    pub fn write(self, image: &RadianceImage, display: &Display) -> Result<()> {
        match self.format {
            ImageFormat::Exr => encoded(self.output, |writer| encode_exr(image, writer)),
            ImageFormat::Png => {
                let picture = image.tone_map(display);
                encoded(self.output, |writer| encode_png(&picture, writer))
            }
        }
    }
}

fn encoded(
    output: Output,
    encode: impl FnOnce(&mut dyn Sink) -> std::result::Result<(), ImageError>,
) -> Result<()> {
    output.write_with(|writer| encode(writer).map_err(|error| io::Error::other(reason(&error))))
}

/// Returns the system's own words, which the user can act on; encoders wrap them in words about images.
fn reason(error: &ImageError) -> String {
    let mut source: &(dyn std::error::Error + 'static) = error;
    loop {
        if let Some(io) = source.downcast_ref::<io::Error>() {
            return io.to_string();
        }
        match source.source() {
            Some(inner) => source = inner,
            None => return source.to_string(),
        }
    }
}

fn encode_exr(image: &RadianceImage, writer: &mut dyn Sink) -> std::result::Result<(), ImageError> {
    let size = image.size();
    let bytes = bytemuck::cast_slice(image.as_slice());
    OpenExrEncoder::new(writer).write_image(
        bytes,
        size.width,
        size.height,
        ExtendedColorType::Rgba32F,
    )
}

fn encode_png(
    picture: &DisplayImage,
    writer: &mut dyn Sink,
) -> std::result::Result<(), ImageError> {
    let size = picture.size();
    PngEncoder::new(writer).write_image(
        picture.as_slice(),
        size.width,
        size.height,
        ExtendedColorType::Rgb8,
    )
}

impl RadianceImage {
    /// Writes an `.exr` (linear) or a `.png` (tone-mapped for `display`); the ending chooses.
    ///
    /// # Errors
    /// [`Error::OutputFormat`] for another ending, [`Error::Output`] if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>, display: &Display) -> Result<()> {
        ImageFile::create(path)?.write(self, display)
    }

    /// Reads the colour of a linear `.exr`: its channels R, G and B, and A, which is 1 where there is none.
    ///
    /// # Errors
    /// [`Error::Input`] if the file cannot be read, is no OpenEXR image, or has not these channels.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let fail = |reason: String| Error::input(path, reason);
        let file = OpenExr::open(path)?;
        let all = file.channels();
        let of = |name: &str| all.iter().find(|channel| channel.name == name);
        let (Some(red), Some(green), Some(blue)) = (of("R"), of("G"), of("B")) else {
            return Err(fail("it has no channels R, G and B".to_owned()));
        };
        let mut ids = vec![red.id, green.id, blue.id];
        ids.extend(of("A").map(|alpha| alpha.id));
        let planes = file.planes(&ids).map_err(fail)?;
        let mut image = Self::new(file.display())?;
        let mut opaque = image.data.iter_mut().skip(3).step_by(4);
        opaque.by_ref().for_each(|alpha| *alpha = 1.0);
        for (channel, plane) in planes.iter().enumerate() {
            plane.place(file.display(), |pixel, value| {
                image.data[4 * pixel + channel] = value;
            });
        }
        Ok(image)
    }
}

impl DisplayImage {
    /// Writes a `.png`.
    ///
    /// # Errors
    /// [`Error::OutputFormat`] for another ending, [`Error::Output`] if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let output = ImageFile::create(path)?;
        if output.format != ImageFormat::Png {
            return Err(Error::OutputFormat(path.to_owned()));
        }
        encoded(output.output, |writer| encode_png(self, writer))
    }
}
