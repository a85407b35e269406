//! Image files: EXR (float32, linear) and PNG (8-bit sRGB), written beside the target and renamed, so that no
//! half-written file is ever left.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use image::codecs::openexr::OpenExrEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};
use tempfile::NamedTempFile;

use super::openexr::OpenExr;
use super::{Display, DisplayImage, RadianceImage};
use crate::error::{Error, Result};

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
    /// Chooses the format by the ending of a file's name.
    ///
    /// # Errors
    /// [`Error::OutputFormat`] for any other ending.
    pub fn of(path: &Path) -> Result<Self> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("exr") => Ok(Self::Exr),
            Some("png") => Ok(Self::Png),
            _ => Err(Error::OutputFormat(path.to_owned())),
        }
    }
}

/// An output that is known to be writable before anything is computed.
#[derive(Debug)]
pub struct ImageFile {
    path: PathBuf,
    format: ImageFormat,
    file: NamedTempFile,
}

impl ImageFile {
    /// Opens a temporary file beside `path`, through a symbolic link beside what it points to. It vanishes unless
    /// [`ImageFile::write`] succeeds.
    ///
    /// # Errors
    /// [`Error::OutputFormat`] for an unknown ending, [`Error::Output`] if the folder is missing or not writable.
    pub fn create(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let format = ImageFormat::of(path)?;
        let fail = |reason: String| Error::output(path, reason);
        let names_folder = path.as_os_str().as_encoded_bytes().ends_with(b"/");
        if path.is_dir() || names_folder {
            return Err(fail("it is a folder".to_owned()));
        }
        let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let folder = match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        if !folder.is_dir() {
            return Err(fail(format!(
                "there is no folder {}; create it first",
                folder.display()
            )));
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(".energywave-").suffix(".tmp");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666)); // less the user's umask
        }
        let file = builder.tempfile_in(folder).map_err(|error| {
            fail(format!("folder {}: {}", folder.display(), error.kind())).caused_by(error)
        })?;
        Ok(Self {
            path: target,
            format,
            file,
        })
    }

    /// Encodes the image, tone-mapped if the format is for screens, and moves the file to its place.
    ///
    /// # Errors
    /// [`Error::Output`] if the disk is full or the file cannot be moved; nothing is left behind then.
    pub fn write(self, image: &RadianceImage, display: &Display) -> Result<()> {
        match self.format {
            ImageFormat::Exr => self.finish(|writer| encode_exr(image, writer)),
            ImageFormat::Png => {
                let picture = image.tone_map(display);
                self.finish(|writer| encode_png(&picture, writer))
            }
        }
    }

    fn finish(
        self,
        encode: impl FnOnce(&mut BufWriter<&mut File>) -> std::result::Result<(), ImageError>,
    ) -> Result<()> {
        self.write_with(|writer| encode(writer).map_err(|error| io::Error::other(reason(&error))))
    }

    /// Lets `encode` write the file and moves it to its place.
    pub(super) fn write_with(
        mut self,
        encode: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
    ) -> Result<()> {
        let path = self.path;
        let fail = |error: io::Error| {
            Error::output(&path, format!("{error}; nothing was written")).caused_by(error)
        };
        let mut writer = BufWriter::new(self.file.as_file_mut());
        encode(&mut writer).map_err(fail)?;
        writer.flush().map_err(fail)?;
        drop(writer);
        self.file
            .persist(&path)
            .map_err(|error| fail(error.error))?;
        Ok(())
    }
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

fn encode_exr(
    image: &RadianceImage,
    writer: &mut BufWriter<&mut File>,
) -> std::result::Result<(), ImageError> {
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
    writer: &mut BufWriter<&mut File>,
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
        output.finish(|writer| encode_png(self, writer))
    }
}
