//! Depth images in files.

use std::path::Path;

use exr::image::{AnyChannel, FlatSamples, Layer};
use exr::prelude::{AnyChannels, Encoding, Image, LayerAttributes, WritableImage};

use super::depth::Origin;
use super::depth_source::{Stored, Unread, room_for};
use super::{ClipRange, DepthImage, DepthOptions, ImageFormat};
use crate::error::{Error, Result};
use crate::output::Output;
use crate::shown::shown;

impl DepthImage {
    /// Reads an image: OpenEXR; where the name ends in `.png` 16-bit grey, of which 65535 is 1; where it ends in `.raw`
    /// or `.f32` float32, little endian by rows from the top left, of the size in `options`. Where the data window of
    /// an OpenEXR file leaves a part of the display window out, nothing hides the light.
    ///
    /// Without a name in `options` the channel is the one called `Z`, else the one whose name, layer or part says
    /// depth, else R, V or Y if it is alone, else red where red, green and blue are equal everywhere. The Z of a layer
    /// of X, Y and Z is none.
    ///
    /// # Errors
    /// [`Error::Input`] if the file cannot be read, leaves the channel in doubt (then all are listed), or holds what
    /// [`DepthImage::new`] refuses.
    pub fn open(path: impl AsRef<Path>, options: impl Into<DepthOptions>) -> Result<Self> {
        let (path, options) = (path.as_ref(), options.into());
        let fail = |reason: String| Error::input(path, reason);
        if !options.scale.is_finite() || options.scale == 0.0 {
            let reason = format!("scale {}: it must be a number but 0", options.scale);
            return Err(fail(reason));
        }
        let stored = match Stored::open(path, &options) {
            Ok(stored) => stored,
            Err(Unread::Error(error)) => return Err(error),
            Err(Unread::Reason(reason)) => return Err(fail(reason)),
        };
        let size = stored.size;
        let mut values = room_for(size).map_err(fail)?;
        let scale = if options.along.is_length() {
            options.scale
        } else {
            1.0
        };
        values.extend(
            stored
                .values
                .iter()
                .map(|&value| match stored.is_none(value) {
                    true => f32::INFINITY,
                    false => (f64::from(value) * scale) as f32,
                }),
        );
        let made = match (options.along.is_length(), &options.clip) {
            (true, _) => Self::new(size, options.along, values),
            (false, Some(clip)) => {
                Self::from_scaled_clip(size, options.along, clip, options.scale, values)
            }
            (false, None) => {
                let reason = "its depths are of clip space, and neither the camera nor the depth has a `projection`";
                return Err(fail(reason.to_owned()));
            }
        };
        match made {
            Ok(image) => Ok(image.read_from(Origin {
                file: std::path::absolute(path).unwrap_or_else(|_| path.to_owned()),
                channel: stored.channel,
                doubt: stored.doubt,
                options,
            })),
            Err(Error::Scene(fault)) => Err(fail(refused(&fault.message, &stored, &options))),
            Err(other) => Err(other),
        }
    }

    /// Returns the file that the image was read from, by its full path; `None` for one that was made in code. A scene
    /// that is written to a file names it.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        self.origin().map(|origin| origin.file.as_path())
    }

    /// Returns how the file was read; `None` for an image that was made in code.
    #[must_use]
    pub fn options(&self) -> Option<&DepthOptions> {
        self.origin().map(|origin| &origin.options)
    }

    /// Returns the name of the file's channel, with its part's before it where there are several; `None` for an image
    /// that was made in code.
    #[must_use]
    pub fn channel(&self) -> Option<&str> {
        self.origin().and_then(|origin| origin.channel.as_deref())
    }

    /// Returns all channels of the file, as a list, where the name of the one that was read left a doubt.
    pub(crate) fn doubt(&self) -> Option<&str> {
        self.origin().and_then(|origin| origin.doubt.as_deref())
    }

    /// Writes an OpenEXR image whose channel Z holds the depths.
    ///
    /// # Errors
    /// [`Error::OutputFormat`] for another ending than `.exr`, [`Error::Output`] if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        if ImageFormat::of(path)? != ImageFormat::Exr {
            return Err(Error::OutputFormat(path.to_owned()));
        }
        let channel = AnyChannel::new("Z", FlatSamples::F32(self.as_slice().to_vec()));
        let layer = Layer::new(
            (self.size().width as usize, self.size().height as usize),
            LayerAttributes::default(),
            Encoding::SMALL_LOSSLESS,
            AnyChannels::sort([channel].into_iter().collect()),
        );
        let image = Image::from_layer(layer);
        Output::create(path)?.write_with(|writer| {
            let write = image.write().non_parallel();
            write.to_buffered(writer).map_err(|error| match error {
                exr::error::Error::Io(error) => error,
                other => std::io::Error::other(other),
            })
        })
    }
}

/// Says which channel holds what is no depth, and how to say what it means.
fn refused(fault: &str, stored: &Stored, options: &DepthOptions) -> String {
    let values = &stored.values;
    let has_nan = values.iter().any(|value| value.is_nan());
    let finite = || values.iter().filter(|value| value.is_finite());
    let negative = finite().filter(|value| **value < 0.0).count();
    let lowest = finite().fold(f32::INFINITY, |low, value| low.min(*value));
    let range = options.clip.map(|clip| clip.range());
    let advice = match (has_nan, options.along.is_length()) {
        (true, _) => "if NaN means that nothing is there, give `none = nan`".to_owned(),
        (false, false) if negative > 0 && range == Some(ClipRange::ZeroToOne) => {
            "if the projection is OpenGL's, give `range = \"-1..1\"`".to_owned()
        }
        (false, false) => {
            "if they are lengths, give `along = \"axis\"` or `along = \"ray\"`; if they are an integer's, give `scale`"
                .to_owned()
        }
        (false, true) if 2 * negative > finite().count() => {
            "if the depths are negative because they lie before the camera, give `scale = -1`; if they are another \
             pass, name the right channel as `channel`"
                .to_owned()
        }
        _ => format!("if {lowest} means that nothing is there, give `none = {lowest}`"),
    };
    match &stored.channel {
        Some(channel) => format!("channel {}: {fault}; {advice}", shown(channel)),
        None => format!("{fault}; {advice}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{DepthAlong, ImageSize};
    use exr::math::Vec2;
    use exr::prelude::SmallVec;

    const SIZE: ImageSize = ImageSize {
        width: 3,
        height: 2,
    };

    fn write(path: &Path, channels: &[(&str, f32)]) {
        let channel =
            |(name, value): &(&str, f32)| AnyChannel::new(*name, FlatSamples::F32(vec![*value; 6]));
        let list: SmallVec<[_; 4]> = channels.iter().map(channel).collect();
        let layer = Layer::new(
            (3, 2),
            LayerAttributes::default(),
            Encoding::SMALL_LOSSLESS,
            AnyChannels::sort(list),
        );
        Image::from_layer(layer).write().to_file(path).unwrap();
    }

    #[test]
    fn the_channel_is_the_one_that_is_named_or_says_depth() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("depth.exr");
        let opened = |channels: &[(&str, f32)], options: &DepthOptions| {
            write(&path, channels);
            DepthImage::open(&path, options.clone())
                .map(|image| (image.as_slice()[5], image.channel().unwrap().to_owned()))
                .map_err(|error| error.to_string())
        };
        let found = |value: f32, channel: &str| Ok((value, channel.to_owned()));
        let plain = DepthOptions::default();
        let color = [("R", 1.0), ("G", 2.0), ("B", 3.0)];
        let with_z = [&color[..], &[("Z", 4.0)]].concat();
        assert_eq!(opened(&with_z, &plain), found(4.0, "Z"));
        let pass = [("Main.Combined.R", 1.0), ("Main.Depth.Z", 5.0)];
        assert_eq!(opened(&pass, &plain), found(5.0, "Main.Depth.Z"));
        assert_eq!(opened(&[("distance", 6.0)], &plain), found(6.0, "distance"));
        let grey = [("R", 7.0), ("G", 7.0), ("B", 7.0)];
        assert_eq!(opened(&grey, &plain), found(7.0, "R"));
        let differs = opened(&color, &plain).unwrap_err();
        assert!(differs.contains("red, green and blue differ"), "{differs}");
        assert!(differs.contains("channels: B, G, R"), "{differs}");
        let unknown = opened(&[("a", 6.0), ("b", 7.0)], &plain).unwrap_err();
        assert!(unknown.contains("channels: a, b"), "{unknown}");
        let mut green = plain.clone();
        green.channel = Some("G".to_owned());
        assert_eq!(opened(&with_z, &green), found(2.0, "G"));
        let missing = opened(&[("Z", 6.0)], &green).unwrap_err();
        assert!(missing.contains("no channel `G`; channels: Z"), "{missing}");
    }

    #[test]
    fn values_are_scaled_and_what_means_nothing_is_infinite() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("depth.exr");
        let opened = |value: f32, scale: f64, none: Option<f64>| {
            write(&path, &[("Z", value)]);
            let mut options = DepthOptions::from(DepthAlong::Axis);
            (options.scale, options.none) = (scale, none);
            DepthImage::open(&path, options)
                .map(|image| image.as_slice()[0])
                .map_err(|error| error.to_string())
        };
        assert_eq!(opened(250.0, 0.01, None), Ok(2.5));
        assert_eq!(opened(-3.0, -1.0, None), Ok(3.0));
        for none in [0.0, -1.0, f64::NAN, 1e10] {
            assert_eq!(
                opened(none as f32, 0.5, Some(none)),
                Ok(f32::INFINITY),
                "{none}"
            );
            assert_eq!(opened(7.0, 0.5, Some(none)), Ok(3.5), "{none}");
        }
        assert_eq!(opened(f32::INFINITY, -1.0, None), Ok(f32::INFINITY));
        for (value, words) in [
            (f32::NAN, "channel Z: NaN at column 0, row 0"),
            (f32::NAN, "`none = nan`"),
            (-3.0, "channel Z: -3 at column 0, row 0"),
            (-3.0, "`scale = -1`"),
        ] {
            let refused = opened(value, 1.0, None).unwrap_err();
            assert!(refused.contains(words), "{refused}");
        }
        for scale in [0.0, f64::NAN, f64::INFINITY] {
            assert!(
                opened(1.0, scale, None).unwrap_err().contains("scale"),
                "{scale}"
            );
        }
    }

    #[test]
    fn windows_are_respected_and_impossible_sizes_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("depth.exr");
        let attributes = LayerAttributes {
            layer_position: Vec2(1, -1),
            ..LayerAttributes::default()
        };
        let values = vec![1.0, 2.0, 3.0, 4.0];
        let channel = AnyChannel::new("Z", FlatSamples::F32(values));
        let channels = AnyChannels::sort([channel].into_iter().collect());
        let layer = Layer::new((2, 2), attributes, Encoding::UNCOMPRESSED, channels);
        let mut image = Image::from_layer(layer);
        image.attributes.display_window.position = Vec2(0, 0);
        image.attributes.display_window.size = Vec2(3, 2);
        image.write().to_file(&path).unwrap();
        let opened = DepthImage::open(&path, DepthAlong::Ray).unwrap();
        let none = f32::INFINITY;
        assert_eq!(opened.size(), SIZE);
        assert_eq!(opened.as_slice(), [none, 3.0, 4.0, none, none, none]);

        let mut bytes = std::fs::read(&path).unwrap();
        let key = b"dataWindow\0box2i\0";
        let at = bytes
            .windows(key.len())
            .position(|part| part == key)
            .unwrap();
        let right = at + key.len() + 4 + 8;
        bytes[right..right + 4].copy_from_slice(&99_999_i32.to_le_bytes());
        std::fs::write(&path, bytes).unwrap();
        let refused = DepthImage::open(&path, DepthAlong::Ray)
            .unwrap_err()
            .to_string();
        assert!(refused.contains("at most 16384x16384"), "{refused}");
    }

    #[test]
    fn what_is_saved_is_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("depth.exr");
        let values = vec![0.0, 1.5, f32::INFINITY, 4.0, 5.0, 1e30];
        let image = DepthImage::new(SIZE, DepthAlong::Axis, values).unwrap();
        image.save(&path).unwrap();
        assert_eq!(DepthImage::open(&path, DepthAlong::Axis).unwrap(), image);
        let png = image.save(folder.path().join("depth.png")).unwrap_err();
        assert!(matches!(png, Error::OutputFormat(_)));
    }
}
