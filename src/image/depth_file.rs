//! Depth images in OpenEXR files.

use std::path::Path;

use exr::image::{AnyChannel, FlatSamples, Layer};
use exr::math::Vec2;
use exr::meta::MetaData;
use exr::prelude::{
    AnyChannels, Encoding, Image, LayerAttributes, ReadChannels, ReadLayers, WritableImage, read,
};

use super::{DepthAlong, DepthImage, ImageFile, ImageFormat, ImageSize};
use crate::error::{Error, Result};
use crate::memory;

impl DepthImage {
    /// Reads an OpenEXR image: its channel Z or depth, else V, Y or R, or the only one there is. Where the data window
    /// leaves a part of the display window out, nothing hides the light.
    ///
    /// # Errors
    /// [`Error::Input`] if the file cannot be read, has no such channel, or holds what [`DepthImage::new`] refuses.
    pub fn open(path: impl AsRef<Path>, along: DepthAlong) -> Result<Self> {
        let path = path.as_ref();
        let fail = |reason: String| Error::input(path, reason);
        let faulty = |error| match error {
            exr::error::Error::Io(error) => fail(format!("cannot read: {error}")).caused_by(error),
            other => fail(format!("not an OpenEXR image: {other}")).caused_by(other),
        };
        let meta = MetaData::read_from_file(path, false).map_err(faulty)?;
        check_claims(&meta).map_err(fail)?;
        let image = read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .non_parallel()
            .from_file(path)
            .map_err(faulty)?;
        let (layer, channel) = depth_channel(&image.layer_data).map_err(fail)?;
        let shown = image.attributes.display_window;
        let size = ImageSize {
            width: shown.size.0 as u32,
            height: shown.size.1 as u32,
        };
        let first = layer.attributes.layer_position - shown.position;
        let mut values = vec![f32::INFINITY; size.pixels()];
        for (index, depth) in channel.sample_data.values_as_f32().enumerate() {
            let column = first.0 + (index % layer.size.0) as i32;
            let row = first.1 + (index / layer.size.0) as i32;
            if (0..size.width as i32).contains(&column) && (0..size.height as i32).contains(&row) {
                values[row as usize * shown.size.0 + column as usize] = depth;
            }
        }
        match Self::new(size, along, values) {
            Ok(image) => Ok(image.in_file(path)),
            Err(Error::Scene(fault)) => Err(fail(fault.message)),
            Err(other) => Err(other),
        }
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
        ImageFile::create(path)?.write_with(|file| {
            let write = image.write().non_parallel();
            write.to_buffered(file).map_err(|error| match error {
                exr::error::Error::Io(error) => error,
                other => std::io::Error::other(other),
            })
        })
    }
}

/// Checks the sizes that a file claims: nothing is allocated beyond what an image may have or the memory holds.
fn check_claims(meta: &MetaData) -> std::result::Result<(), String> {
    const LIMIT: usize = ImageSize::LIMIT as usize;
    let mut bytes = 0;
    for header in &meta.headers {
        for window in [
            header.layer_size,
            header.shared_attributes.display_window.size,
        ] {
            if window.0.max(window.1) > LIMIT {
                return Err(format!(
                    "{}x{} pixels; an image is at most {LIMIT}x{LIMIT}",
                    window.0, window.1
                ));
            }
        }
        if header
            .channels
            .list
            .iter()
            .any(|c| c.sampling != Vec2(1, 1))
        {
            return Err("a channel has not one sample for each pixel".to_owned());
        }
        bytes += header.layer_size.area() * header.channels.bytes_per_pixel;
    }
    match memory::available_bytes() {
        Some(available) if bytes as u64 > available => Err(format!(
            "{} MiB needed, {} MiB available",
            bytes >> 20,
            available >> 20
        )),
        _ => Ok(()),
    }
}

type FlatLayer = Layer<AnyChannels<FlatSamples>>;

/// Finds the channel that holds depth, with its layer.
fn depth_channel(
    layers: &[FlatLayer],
) -> std::result::Result<(&FlatLayer, &AnyChannel<FlatSamples>), String> {
    let of_layer = |layer| {
        let FlatLayer { channel_data, .. }: &FlatLayer = layer;
        channel_data
            .list
            .iter()
            .map(move |channel| (layer, channel))
    };
    let all: Vec<_> = layers.iter().flat_map(of_layer).collect();
    // Renderers put the name of a view layer or a pass before a channel's own.
    let is_named = |channel: &AnyChannel<FlatSamples>, wanted: &str| {
        let full = channel.name.to_string().to_lowercase();
        full.rsplit('.').next() == Some(wanted)
    };
    let wanted = ["z", "depth", "v", "y", "r"].iter();
    let named = wanted.flat_map(|wanted| all.iter().find(|(_, c)| is_named(c, wanted)));
    match (named.into_iter().next(), all.as_slice()) {
        (Some(found), _) | (None, [found]) => Ok(*found),
        _ => {
            let names: Vec<String> = all.iter().map(|(_, c)| c.name.to_string()).collect();
            Err(format!(
                "no channel named Z, depth, V, Y or R; there are: {}",
                names.join(", ")
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
    fn the_channel_of_depth_is_found_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("depth.exr");
        let opened = |channels: &[(&str, f32)]| {
            write(&path, channels);
            DepthImage::open(&path, DepthAlong::Axis).map(|image| image.as_slice()[5])
        };
        let color = [("R", 1.0), ("G", 2.0), ("B", 3.0)];
        assert_eq!(opened(&color).unwrap(), 1.0);
        assert_eq!(opened(&[&color[..], &[("Z", 4.0)]].concat()).unwrap(), 4.0);
        let pass = [("Main.Combined.R", 1.0), ("Main.Depth.Z", 5.0)];
        assert_eq!(opened(&pass).unwrap(), 5.0);
        assert_eq!(opened(&[("distance", 6.0)]).unwrap(), 6.0);
        let unknown = opened(&[("a", 6.0), ("b", 7.0)]).unwrap_err().to_string();
        assert!(unknown.contains("there are: a, b"), "{unknown}");
        let not_a_number = opened(&[("Z", f32::NAN)]).unwrap_err().to_string();
        assert!(
            not_a_number.contains("NaN at column 0, row 0"),
            "{not_a_number}"
        );
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
