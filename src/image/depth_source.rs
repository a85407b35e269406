//! What a depth file holds, as it is stored: OpenEXR, 16-bit PNG, or float32 without a header.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use image::codecs::png::PngDecoder;
use image::{ColorType, ImageDecoder};

use super::depth_channel::{Choice, choose, listed, named};
use super::openexr::{ChannelId, ChannelName, OpenExr, Plane};
use super::{DepthOptions, ImageSize};
use crate::error::Error;

/// The numbers of a depth file, of which 16-bit ones reach from 0 to 1.
pub(super) struct Stored {
    pub(super) size: ImageSize,
    /// Of every pixel; infinite where the file has none.
    pub(super) values: Vec<f32>,
    /// The channel's name, with its part's.
    pub(super) channel: Option<String>,
    /// All channels, where the name of this one left a doubt.
    pub(super) doubt: Option<String>,
    /// The value that means that nothing is there, as the file holds it.
    pub(super) none: Option<f32>,
}

type Outcome<T> = std::result::Result<T, String>;

/// A file that cannot be read: an error of its own, or a reason.
pub(super) enum Unread {
    Error(Error),
    Reason(String),
}

impl From<String> for Unread {
    fn from(reason: String) -> Self {
        Self::Reason(reason)
    }
}

impl Stored {
    /// Reads a file; the ending chooses: `.png` is PNG, `.raw` and `.f32` are float32, everything else OpenEXR.
    pub(super) fn open(path: &Path, options: &DepthOptions) -> std::result::Result<Self, Unread> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        let stored = match ending.to_str() {
            Some("png") => Self::of_png(path, options)?,
            Some("raw" | "f32") => Self::of_floats(path, options)?,
            _ => return Self::of_exr(path, options),
        };
        match &options.channel {
            None => Ok(stored),
            Some(name) => Err(Unread::Reason(format!(
                "no channel `{}`: only OpenEXR files have channels; leave it out",
                crate::shown::shown(name)
            ))),
        }
    }

    fn of_exr(path: &Path, options: &DepthOptions) -> std::result::Result<Self, Unread> {
        let file = OpenExr::open(path).map_err(Unread::Error)?;
        let all = file.channels();
        let (channel, plane, is_guess) = find(&file, &all, options)?;
        let size = file.display();
        let mut values = room_for(size)?;
        values.resize(size.pixels(), f32::INFINITY);
        plane.place(size, |pixel, value| values[pixel] = value);
        Ok(Self {
            size,
            values,
            channel: Some(channel.full()),
            doubt: is_guess.then(|| listed(&all)),
            none: options.none.map(|none| file.as_stored(channel.id, none)),
        })
    }

    fn of_png(path: &Path, options: &DepthOptions) -> Outcome<Self> {
        let file = File::open(path).map_err(|error| format!("cannot read: {error}"))?;
        let fail = |error: image::ImageError| format!("no PNG image that can be read: {error}");
        let decoder = PngDecoder::new(BufReader::new(file)).map_err(fail)?;
        let (width, height) = decoder.dimensions();
        let size = ImageSize { width, height };
        let limit = ImageSize::LIMIT;
        if width > limit || height > limit {
            return Err(format!(
                "{width}x{height} pixels; an image has at most {limit}x{limit}"
            ));
        }
        if decoder.color_type() != ColorType::L16 {
            return Err(format!(
                "its pixels are {:?}; depths are 16-bit grey (L16): with 8 bits surfaces would lie in steps",
                decoder.color_type()
            ));
        }
        let mut values = room_for(size)?;
        let mut numbers: Vec<u16> = Vec::new();
        numbers
            .try_reserve_exact(size.pixels())
            .map_err(|_| no_room(size))?;
        numbers.resize(size.pixels(), 0);
        decoder
            .read_image(bytemuck::cast_slice_mut(&mut numbers))
            .map_err(fail)?;
        let share = |number: f64| (number / f64::from(u16::MAX)) as f32;
        values.extend(numbers.iter().map(|number| share(f64::from(*number))));
        Ok(Self {
            size,
            values,
            channel: None,
            doubt: None,
            none: options.none.map(share),
        })
    }

    fn of_floats(path: &Path, options: &DepthOptions) -> Outcome<Self> {
        let Some(size) = options.size else {
            let reason = "float32 without a header does not say its size: give the image's (`DepthOptions::size`)";
            return Err(reason.to_owned());
        };
        let fail = |error: std::io::Error| format!("cannot read: {error}");
        let found = std::fs::metadata(path).map_err(fail)?.len();
        let needed = 4 * size.pixels() as u64;
        let wrong = |found: u64| {
            format!(
                "{found} bytes; {}x{} pixels of float32, little endian by rows from the top left, are {needed}, or \
             4, 9 and so on times that where depths are finer",
                size.width, size.height
            )
        };
        // A scene's depths may be finer than its pixels, by a whole number.
        let across = (found / needed.max(1)).isqrt().max(1);
        let size = ImageSize {
            width: size.width.saturating_mul(across as u32),
            height: size.height.saturating_mul(across as u32),
        };
        if found != needed * across * across || size.width.max(size.height) > ImageSize::LIMIT {
            return Err(wrong(found));
        }
        let mut values = room_for(size)?;
        let bytes = std::fs::read(path).map_err(fail)?;
        let numbers = bytes
            .chunks_exact(4)
            .filter_map(|four| four.try_into().ok());
        values.extend(numbers.map(f32::from_le_bytes));
        if values.len() != size.pixels() {
            return Err(wrong(bytes.len() as u64));
        }
        Ok(Self {
            size,
            values,
            channel: None,
            doubt: None,
            none: options.none.map(|none| none as f32),
        })
    }

    /// Returns whether a value means that nothing is there.
    pub(super) fn is_none(&self, value: f32) -> bool {
        let is = |none: f32| value == none || (value.is_nan() && none.is_nan());
        value == f32::INFINITY || self.none.is_some_and(is)
    }
}

fn no_room(size: ImageSize) -> String {
    format!(
        "{} MiB needed, more than the system grants",
        size.pixels() >> 18
    )
}

/// Makes room for a value for each pixel.
pub(super) fn room_for(size: ImageSize) -> Outcome<Vec<f32>> {
    let mut values = Vec::new();
    let granted = values.try_reserve_exact(size.pixels());
    granted.map(|()| values).map_err(|_| no_room(size))
}

/// Finds and decodes the channel; says whether its name left a doubt.
fn find<'a>(
    file: &OpenExr,
    all: &'a [ChannelName],
    options: &DepthOptions,
) -> std::result::Result<(&'a ChannelName, Plane, bool), String> {
    let one = |id: ChannelId| {
        let plane = file.planes(&[id])?.pop();
        plane.ok_or_else(|| "it has no pixels".to_owned())
    };
    let choice = match &options.channel {
        Some(name) => Choice::Sure(named(all, name)?),
        None => choose(all)?,
    };
    match choice {
        Choice::Sure(channel) => Ok((channel, one(channel.id)?, false)),
        Choice::Guess(channel) => Ok((channel, one(channel.id)?, true)),
        Choice::IfEqual(rgb) => {
            let mut planes = file.planes(&rgb.map(|channel| channel.id))?;
            let [red, green, blue] = planes.as_slice() else {
                return Err("it has no pixels".to_owned());
            };
            let is_equal = |(a, b): (&f32, &f32)| a == b || (a.is_nan() && b.is_nan());
            let others = [green, blue];
            if others
                .iter()
                .all(|other| red.values.iter().zip(&other.values).all(is_equal))
            {
                return Ok((rgb[0], planes.swap_remove(0), true));
            }
            Err(format!(
                "red, green and blue differ, so none is depth: name the right channel as the depth's `channel`; {}",
                listed(all)
            ))
        }
    }
}
