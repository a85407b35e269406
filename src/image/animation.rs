//! Files that hold all frames of an animation: APNG, and Y4M for the encoders of videos.

use std::cell::Cell;
use std::io;
use std::path::Path;

use png::EncodingError;

use super::{Display, DisplayImage, FrameRate, ImageFormat, png_file};
use crate::error::{Error, Result, SceneError};
use crate::output::{Output, Sink};

/// A format that holds all frames of an animation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum AnimationFormat {
    /// PNG that moves: 8 or 16 bits, sRGB, lossless; alpha is straight.
    Apng,
    /// YUV4MPEG2, for encoders of videos: 8 bits, uncompressed, without alpha. Luma and chroma are of all pixels
    /// (4:4:4), by the matrix of BT.709, full range.
    Y4m,
}

impl AnimationFormat {
    /// Makes sure that the format can say how long a frame lasts.
    ///
    /// # Errors
    /// [`Error::Unsupported`].
    pub fn check_rate(self, rate: FrameRate) -> Result<()> {
        match self == Self::Apng && !png_file::holds_rate(rate) {
            false => Ok(()),
            true => Err(Error::Unsupported(format!(
                "{rate} frames a second: an APNG has rates that are fractions of numbers up to 65535"
            ))),
        }
    }

    /// Makes sure that the format can hold what `display` asks for.
    ///
    /// # Errors
    /// [`Error::Scene`] with the key: `display.alpha` or `display.bits`.
    pub fn check(self, display: &Display) -> Result<()> {
        let fault = |key: &str, message: String| Err(SceneError::value(key, message).into());
        match (self, display.bits) {
            (Self::Apng, _) => ImageFormat::Png.check(display),
            (Self::Y4m, Some(bits)) if bits != 8 => {
                fault("display.bits", format!("{bits} bits a channel; Y4M has 8"))
            }
            (Self::Y4m, _) if display.has_alpha() => {
                let message =
                    "Y4M has no alpha; name a background, or write frames as .png or .exr";
                fault("display.alpha", message.to_owned())
            }
            (Self::Y4m, _) => Ok(()),
        }
    }
}

/// An output of an animation, known to be writable before anything is computed.
#[derive(Debug)]
pub struct AnimationFile {
    format: AnimationFormat,
    output: Output,
}

/// How frames follow each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Playback {
    /// How many there are.
    pub count: u32,
    /// How many a second has.
    pub rate: FrameRate,
    /// Whether they begin again.
    pub loops: bool,
}

impl AnimationFile {
    /// Makes sure that `path` can be written, through symbolic links, and changes nothing yet. A pipe is waited for
    /// until somebody reads it.
    ///
    /// # Errors
    /// [`Error::Output`] if the folder is missing or not writable, or the file that is there cannot be changed.
    pub fn create_as(path: impl AsRef<Path>, format: AnimationFormat) -> Result<Self> {
        let output = Output::create(path.as_ref())?;
        Ok(Self { format, output })
    }

    /// Writes to standard output.
    #[must_use]
    pub fn stdout(format: AnimationFormat) -> Self {
        let output = Output::stdout();
        Self { format, output }
    }

    /// Encodes pictures of one size as they come, and puts the file in its place when it has all of them; pipes get
    /// each at once.
    ///
    /// # Errors
    /// The first one of the pictures; [`Error::Unsupported`] if the format cannot hold the rate or a picture, a picture
    /// is unlike the first or there are not as many as were said; [`Error::Output`] if the file cannot be written. A
    /// file is left as it was then.
    pub fn write(
        self,
        playback: Playback,
        pictures: impl Iterator<Item = Result<DisplayImage>>,
    ) -> Result<()> {
        let Self { format, output } = self;
        let unlike = |message: &str| Error::Unsupported(message.to_owned());
        format.check_rate(playback.rate)?;
        let (mut first, seen) = (None, Cell::new(0));
        let checked = pictures.map(|picture| {
            let picture = picture?;
            let kind = (picture.size, picture.channels, picture.bits);
            if *first.get_or_insert(kind) != kind {
                return Err(unlike(
                    "the pictures of an animation are of one size and kind",
                ));
            }
            if format == AnimationFormat::Y4m && (picture.channels, picture.bits) != (3, 8) {
                return Err(unlike("Y4M has pictures of 8 bits without alpha"));
            }
            seen.set(seen.get() + 1);
            Ok(picture)
        });
        let mut fault = None;
        let written = output.stream_with(|writer| {
            let written = match format {
                AnimationFormat::Apng => {
                    let Playback { count, rate, loops } = playback;
                    png_file::write_animation(count, rate, loops, checked.map(own), writer)
                }
                AnimationFormat::Y4m => write_y4m(playback.rate, checked.map(own), writer),
            };
            written
                .and_then(|()| match seen.get() == playback.count {
                    true => Ok(()),
                    false => Err(Stop::Own(unlike(
                        "an animation has as many pictures as were said",
                    ))),
                })
                .map_err(|stop| match stop {
                    Stop::Io(error) => error,
                    Stop::Own(error) => {
                        fault = Some(error);
                        io::ErrorKind::Other.into()
                    }
                })
        });
        match fault {
            Some(error) => Err(error),
            None => written,
        }
    }
}

/// Why an animation is not written: it cannot be, or there is a picture missing.
enum Stop {
    Io(io::Error),
    Own(Error),
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<EncodingError> for Stop {
    fn from(error: EncodingError) -> Self {
        Self::Io(error.into())
    }
}

fn own(picture: Result<DisplayImage>) -> std::result::Result<DisplayImage, Stop> {
    picture.map_err(Stop::Own)
}

/// Writes YUV4MPEG2: a line that says what follows, then planes of luma, Cb and Cr.
fn write_y4m(
    rate: FrameRate,
    pictures: impl Iterator<Item = std::result::Result<DisplayImage, Stop>>,
    writer: &mut dyn Sink,
) -> std::result::Result<(), Stop> {
    let mut planes = Vec::new();
    for (index, picture) in pictures.enumerate() {
        let picture = picture?;
        let (size, (numerator, denominator)) = (picture.size, rate.parts());
        if index == 0 {
            let (width, height) = (size.width, size.height);
            writeln!(
                writer,
                "YUV4MPEG2 W{width} H{height} F{numerator}:{denominator} Ip A1:1 C444 XCOLORRANGE=FULL"
            )?;
        }
        writer.write_all(b"FRAME\n")?;
        planes.clear();
        for plane in 0..3 {
            let pixels = picture.as_slice().chunks_exact(3);
            planes.extend(pixels.map(|pixel| ycbcr([pixel[0], pixel[1], pixel[2]])[plane]));
        }
        writer.write_all(&planes)?;
        writer.flush()?;
    }
    Ok(())
}

/// Returns luma, Cb and Cr of BT.709, full range, of encoded red, green and blue.
fn ycbcr(pixel: [u8; 3]) -> [u8; 3] {
    let [red, green, blue] = pixel.map(f32::from);
    let luma = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
    let chroma = |light: f32, most: f32| 128.0 + (light - luma) / most;
    let values = [luma, chroma(blue, 1.8556), chroma(red, 1.5748)];
    values.map(|value| value.round().clamp(0.0, 255.0) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::ImageSize;

    fn picture(width: u32, color: [u8; 3]) -> Result<DisplayImage> {
        let size = ImageSize { width, height: 2 };
        let data = color.repeat(size.pixels());
        DisplayImage::from_rgb(size, data).ok_or_else(|| Error::Unsupported("size".to_owned()))
    }

    fn playback(count: u32) -> Playback {
        Playback {
            count,
            rate: FrameRate::default(),
            loops: true,
        }
    }

    #[test]
    fn colours_become_those_of_bt_709() {
        assert_eq!(ycbcr([0; 3]), [0, 128, 128]);
        assert_eq!(ycbcr([255; 3]), [255, 128, 128]);
        assert_eq!(ycbcr([255, 0, 0]), [54, 99, 255]);
        assert_eq!(ycbcr([0, 0, 255]), [18, 255, 116]);
        assert_eq!(ycbcr([0, 255, 0]), [182, 30, 12]);
    }

    #[test]
    fn what_stops_before_its_end_or_changes_its_size_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        for (format, name) in [
            (AnimationFormat::Apng, "a.apng"),
            (AnimationFormat::Y4m, "a.y4m"),
        ] {
            let path = folder.path().join(name);
            let write = |count, pictures: Vec<Result<DisplayImage>>| {
                let file = AnimationFile::create_as(&path, format).unwrap();
                file.write(playback(count), pictures.into_iter())
            };
            let red = || picture(3, [255, 0, 0]);
            let interrupted = write(2, vec![red(), Err(Error::Interrupted)]).unwrap_err();
            assert_eq!(interrupted.kind(), crate::ErrorKind::Interrupted);
            assert!(write(2, vec![red(), picture(4, [0; 3])]).is_err());
            assert!(write(3, vec![red(), red()]).is_err());
            assert!(!path.exists(), "{name}");
            write(2, vec![red(), picture(3, [0; 3])]).unwrap();
            assert!(path.exists(), "{name}");
        }
        let y4m = std::fs::read(folder.path().join("a.y4m")).unwrap();
        let head = b"YUV4MPEG2 W3 H2 F30:1 Ip A1:1 C444 XCOLORRANGE=FULL\nFRAME\n";
        assert!(y4m.starts_with(head));
        let planes = [[54; 6], [99; 6], [255; 6]].concat();
        assert_eq!(y4m[head.len()..][..18], planes);
        assert_eq!(y4m.len(), head.len() + 18 + 6 + 18);
    }
}
