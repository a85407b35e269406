//! Encodes images: EXR by the crate exr, which has its attributes, WebP and JPEG by the crate image.

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec,
    SpecificChannels, Text, Vec2, WritableImage, f16,
};
#[cfg(any(feature = "webp", feature = "jpeg"))]
use image::{ExtendedColorType, ImageEncoder, ImageError};

#[cfg(any(feature = "webp", feature = "jpeg"))]
use super::DisplayImage;
use super::display::Film;
use super::{Alpha, Display, RadianceImage};
use crate::output::Sink;

/// Why an encoder failed.
pub(super) type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Encodes linear light as `display` has it: its alpha, its background, floats of 16 or 32 bits.
pub(super) fn exr(
    image: &RadianceImage,
    display: &Display,
    lines: &[String],
    writer: &mut dyn Sink,
) -> Result<(), Fault> {
    let size = image.size();
    let film = Film::with_bloom(image, display)?;
    let extent = Vec2(size.width as usize, size.height as usize);
    let pixel = |place: Vec2<usize>| {
        let index = place.flat_index_for_size(extent);
        film.pixel(index)
    };
    let attributes = attributes(lines);
    match display.bits {
        Some(16) => {
            let channels = SpecificChannels::rgba(|place: Vec2<usize>| {
                let [red, green, blue, alpha] = pixel(place).map(half);
                (red, green, blue, alpha)
            });
            let layer = Layer::new(extent, attributes, Encoding::default(), channels);
            Image::from_layer(layer).write().to_buffered(writer)?;
        }
        _ => {
            let channels = SpecificChannels::rgba(|place: Vec2<usize>| pixel(place).into());
            let layer = Layer::new(extent, attributes, Encoding::default(), channels);
            Image::from_layer(layer).write().to_buffered(writer)?;
        }
    }
    Ok(())
}

/// Encodes linear light as [`exr`] does, and that of groups of lights, each in channels that begin with its name.
pub(super) fn exr_of_groups(
    image: &RadianceImage,
    groups: &[(String, RadianceImage)],
    display: &Display,
    lines: &[String],
    writer: &mut dyn Sink,
) -> Result<(), Fault> {
    let size = image.size();
    let samples = |film: &Film<'_>, channel: usize| {
        let values = (0..size.pixels()).map(|index| film.pixel(index)[channel]);
        match display.bits {
            Some(16) => FlatSamples::F16(values.map(half).collect()),
            _ => FlatSamples::F32(values.collect()),
        }
    };
    let mut channels = SmallVec::new();
    let mut add = |film: &Film<'_>, prefix: &str, names: &[&str]| {
        for (channel, name) in names.iter().enumerate() {
            let name = Text::new_or_panic(format!("{prefix}{name}"));
            channels.push(AnyChannel::new(name, samples(film, channel)));
        }
    };
    add(
        &Film::with_bloom(image, display)?,
        "",
        &["R", "G", "B", "A"],
    );
    // What they lie over is in the image, once.
    let alone = Display {
        background: None,
        alpha: Alpha::Opaque,
        ..display.clone()
    };
    for (name, image) in groups {
        add(
            &Film::with_bloom(image, &alone)?,
            &format!("{name}."),
            &["R", "G", "B"],
        );
    }
    let extent = Vec2(size.width as usize, size.height as usize);
    let channels = AnyChannels::sort(channels);
    let layer = Layer::new(extent, attributes(lines), Encoding::default(), channels);
    Image::from_layer(layer).write().to_buffered(writer)?;
    Ok(())
}

/// Rounds to a half float; light beyond their range is the brightest that they hold.
fn half(value: f32) -> f16 {
    f16::from_f32(value.clamp(-65504.0, 65504.0))
}

fn attributes(lines: &[String]) -> LayerAttributes {
    let text = |value: &str| {
        // Attributes hold the first 256 characters of Unicode.
        let known = value
            .chars()
            .map(|c| if (c as u32) < 256 { c } else { '?' });
        Text::new_or_none(known.collect::<String>())
    };
    // One attribute: the crate writes further ones in an order that changes from run to run.
    LayerAttributes {
        software_name: text(concat!("energywave ", env!("CARGO_PKG_VERSION"))),
        comments: text(&lines.join("\n")).filter(|_| !lines.is_empty()),
        ..LayerAttributes::default()
    }
}

/// Encodes a picture as WebP, lossless.
#[cfg(feature = "webp")]
pub(super) fn webp(picture: &DisplayImage, writer: &mut dyn Sink) -> Result<(), ImageError> {
    write(
        picture,
        image::codecs::webp::WebPEncoder::new_lossless(writer),
    )
}

/// Encodes a picture as JPEG, of a quality of 1 to 100; 90 where none is asked for.
#[cfg(feature = "jpeg")]
pub(super) fn jpeg(
    picture: &DisplayImage,
    quality: Option<u32>,
    writer: &mut dyn Sink,
) -> Result<(), ImageError> {
    let quality = quality.unwrap_or(90).clamp(1, 100) as u8;
    let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(writer, quality);
    write(picture, encoder)
}

#[cfg(any(feature = "webp", feature = "jpeg"))]
fn write(picture: &DisplayImage, encoder: impl ImageEncoder) -> Result<(), ImageError> {
    let color = match (picture.channels, picture.bits) {
        (3, 8) => ExtendedColorType::Rgb8,
        (3, _) => ExtendedColorType::Rgb16,
        (_, 8) => ExtendedColorType::Rgba8,
        _ => ExtendedColorType::Rgba16,
    };
    let size = picture.size();
    encoder.write_image(picture.as_slice(), size.width, size.height, color)
}
