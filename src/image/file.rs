//! Image files: written when their output is known to be writable, and read.

use std::io;
use std::path::Path;

use super::encode::{self, Fault};
use super::openexr::{ChannelName, OpenExr};
use super::{Alpha, Display, DisplayImage, ImageFormat, RadianceImage, png_file};
use crate::error::{Error, Result};
use crate::output::{Output, Sink};

/// What a file says of how it was made: names and values.
type Notes = Vec<(&'static str, String)>;

/// What the line of a fingerprint begins with in an EXR's comments.
const FINGERPRINT: &str = "fingerprint: ";

/// An output that is known to be writable before anything is computed.
#[derive(Debug)]
pub struct ImageFile {
    format: ImageFormat,
    output: Output,
    notes: Notes,
    fingerprint: Option<String>,
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
        Ok(Self::of(format, Output::create(path.as_ref())?))
    }

    /// Writes to standard output.
    #[must_use]
    pub fn stdout(format: ImageFormat) -> Self {
        Self::of(format, Output::stdout())
    }

    fn of(format: ImageFormat, output: Output) -> Self {
        Self {
            format,
            output,
            notes: Notes::new(),
            fingerprint: None,
        }
    }

    /// Adds a line `name: value` to what an EXR says of how it was made, in its attribute `comments`; other formats
    /// leave it out. The name and the version of this crate are in `software` without.
    #[must_use]
    pub fn note(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.notes.push((name, value.into()));
        self
    }

    /// Writes a text into the file, a PNG or an EXR, by which [`ImageFile::fingerprint_of`] knows it again.
    #[must_use]
    pub fn fingerprint(mut self, text: impl Into<String>) -> Self {
        self.fingerprint = Some(text.into());
        self
    }

    /// Returns the text that [`ImageFile::fingerprint`] wrote into a file, if it is there, has one and is whole.
    #[must_use]
    pub fn fingerprint_of(path: impl AsRef<Path>) -> Option<String> {
        let path = path.as_ref();
        if !path.is_file() {
            return None; // a pipe has none, and would be waited for
        }
        png_file::fingerprint(path).or_else(|| {
            let comments = OpenExr::open(path).ok()?.comments_of_whole()?;
            let line = comments
                .lines()
                .find_map(|line| line.strip_prefix(FINGERPRINT));
            line.map(str::to_owned)
        })
    }

    /// Returns the format that it will have.
    #[must_use]
    pub fn format(&self) -> ImageFormat {
        self.format
    }

    /// Encodes a picture, and puts the file in its place as [`ImageFile::write`] does.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for an EXR, which holds light, [`Error::Scene`] if the format cannot hold the picture's
    /// alpha or its 16 bits, [`Error::Output`] as [`ImageFile::write`].
    pub fn write_picture(self, picture: &DisplayImage) -> Result<()> {
        if self.format == ImageFormat::Exr {
            let message = "an EXR holds linear light; a picture for screens is a PNG";
            return Err(Error::Unsupported(message.to_owned()));
        }
        self.format.check(&picture.display())?;
        self.write_checked(picture, None)
    }

    /// Encodes the image as `display` has it, tone-mapped if the format is for screens, and puts the file in its place.
    /// A file that is there keeps its mode and its owner.
    ///
    /// # Errors
    /// [`Error::Scene`] if the format cannot hold it ([`ImageFormat::check`]); [`Error::Output`] if the disk is full,
    /// nobody reads the pipe or the host has too little memory for the bloom of an EXR; nothing is left behind then.
    pub fn write(self, image: &RadianceImage, display: &Display) -> Result<()> {
        self.format.check(display)?;
        if self.format == ImageFormat::Exr {
            let lines = self.lines();
            return encoded(self.output, |writer| {
                encode::exr(image, display, &lines, writer)
            });
        }
        self.write_checked(&image.tone_map(display), display.quality)
    }

    /// Returns the lines of an EXR's comments.
    fn lines(&self) -> Vec<String> {
        let notes = self
            .notes
            .iter()
            .map(|(name, value)| format!("{name}: {value}"));
        let fingerprint = self.fingerprint.iter();
        let fingerprint = fingerprint.map(|text| format!("{FINGERPRINT}{text}"));
        notes.chain(fingerprint).collect()
    }

    /// Encodes a picture in a format for screens that holds it.
    fn write_checked(
        self,
        picture: &DisplayImage,
        #[cfg_attr(not(feature = "jpeg"), allow(unused_variables))] quality: Option<u32>,
    ) -> Result<()> {
        let (format, fingerprint) = (self.format, self.fingerprint.as_deref());
        encoded(self.output, |writer| match format {
            #[cfg(feature = "webp")]
            ImageFormat::WebP => Ok(encode::webp(picture, writer)?),
            #[cfg(feature = "jpeg")]
            ImageFormat::Jpeg => Ok(encode::jpeg(picture, quality, writer)?),
            _ => Ok(png_file::write(picture, fingerprint, writer)?),
        })
    }

    /// Writes an EXR as [`ImageFile::write`] does, with further layers: the light of groups of lights
    /// ([`Scene::of_light_group`](crate::Scene::of_light_group)), in channels such as `rings.R`. They have no alpha and
    /// no background.
    ///
    /// # Errors
    /// As [`ImageFile::write`]; [`Error::Unsupported`] if it is no EXR, a size differs, or a name stands twice, is
    /// empty or no ASCII.
    pub fn write_light_groups(
        self,
        image: &RadianceImage,
        groups: &[(String, RadianceImage)],
        display: &Display,
    ) -> Result<()> {
        self.format.check(display)?;
        if self.format != ImageFormat::Exr {
            let message = "layers of groups of lights need an EXR";
            return Err(Error::Unsupported(message.to_owned()));
        }
        for (index, (name, group)) in groups.iter().enumerate() {
            let is_double = groups[..index].iter().any(|(other, _)| other == name);
            if group.size() != image.size() || is_double || name.is_empty() || !name.is_ascii() {
                return Err(Error::Unsupported(format!(
                    "layer `{}`: layers have a name of their own, of ASCII, and the size of the image",
                    crate::shown::shown(name)
                )));
            }
        }
        let lines = self.lines();
        encoded(self.output, |writer| {
            encode::exr_of_groups(image, groups, display, &lines, writer)
        })
    }
}

fn encoded(
    output: Output,
    encode: impl FnOnce(&mut dyn Sink) -> std::result::Result<(), Fault>,
) -> Result<()> {
    output.write_with(|writer| encode(writer).map_err(|error| io::Error::other(reason(&*error))))
}

/// Returns the system's own words, which the user can act on; encoders wrap them in words about images.
fn reason(error: &(dyn std::error::Error + 'static)) -> String {
    let mut source = error;
    loop {
        if let Some(io) = source.downcast_ref::<io::Error>() {
            return io.to_string();
        }
        if let Some(exr::error::Error::Io(io)) = source.downcast_ref::<exr::error::Error>() {
            return io.to_string();
        }
        match source.source() {
            Some(inner) => source = inner,
            None => return source.to_string(),
        }
    }
}

impl RadianceImage {
    /// Writes an `.exr` (linear) or a picture such as a `.png` (tone-mapped for `display`); the ending chooses.
    ///
    /// # Errors
    /// [`Error::OutputFormat`] for another ending, [`Error::Scene`] and [`Error::Output`] as [`ImageFile::write`].
    pub fn save(&self, path: impl AsRef<Path>, display: &Display) -> Result<()> {
        ImageFile::create(path)?.write(self, display)
    }

    /// Reads the colour of a linear `.exr`: its channels R, G and B, and A, which is 1 where there is none.
    ///
    /// # Errors
    /// [`Error::Input`] if the file cannot be read, is no OpenEXR image, or has not these channels.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        Self::open_channels(path.as_ref(), "")
    }

    /// Reads a layer of a linear `.exr`, such as that of a group of lights: the channels `layer.R` and so on.
    ///
    /// # Errors
    /// As [`RadianceImage::open`].
    pub fn open_layer(path: impl AsRef<Path>, layer: &str) -> Result<Self> {
        Self::open_channels(path.as_ref(), &format!("{layer}."))
    }

    fn open_channels(path: &Path, prefix: &str) -> Result<Self> {
        let fail = |reason: String| Error::input(path, reason);
        let file = OpenExr::open(path)?;
        let all = file.channels();
        let of = |name: &str| {
            let is_it = |channel: &&ChannelName| channel.name.strip_prefix(prefix) == Some(name);
            all.iter().find(is_it)
        };
        let (Some(red), Some(green), Some(blue)) = (of("R"), of("G"), of("B")) else {
            let prefix = crate::shown::shown(prefix);
            return Err(fail(format!(
                "it has no channels {prefix}R, {prefix}G and {prefix}B"
            )));
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
    /// Writes a `.png`, or another format for screens; the ending chooses.
    ///
    /// # Errors
    /// [`Error::OutputFormat`] for another ending, [`Error::Scene`] if the format cannot hold its alpha or its 16 bits,
    /// [`Error::Output`] if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let file = ImageFile::create(path)?;
        if file.format == ImageFormat::Exr {
            return Err(Error::OutputFormat(path.to_owned()));
        }
        file.write_picture(self)
    }

    /// Returns what a format must be able to hold.
    fn display(&self) -> Display {
        Display {
            bits: Some(self.bits),
            alpha: match self.channels {
                4 => Alpha::Luminance,
                _ => Alpha::Opaque,
            },
            ..Display::default()
        }
    }
}
