//! PNG: pictures with a fingerprint, and pictures that move.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError, Filter};

use super::{DisplayImage, FrameRate, ImageSize};
use crate::output::Sink;

/// The keyword of the text chunk that holds the fingerprint.
const KEYWORD: &str = "energywave-fingerprint";

/// What every whole file ends with: the chunk IEND.
const END: [u8; 12] = *b"\0\0\0\0IEND\xae\x42\x60\x82";

/// Encodes a picture, with a fingerprint if it has one.
pub(super) fn write(
    picture: &DisplayImage,
    fingerprint: Option<&str>,
    writer: &mut dyn Sink,
) -> Result<(), EncodingError> {
    let mut encoder = encoder(picture.size, picture.channels, picture.bits, writer);
    encoder.set_compression(Compression::Fast);
    if let Some(text) = fingerprint {
        encoder.add_text_chunk(KEYWORD.to_owned(), text.to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&stored(picture))?;
    writer.finish()
}

/// Encodes pictures of one kind that follow each other, an APNG; programs that know none show the first.
pub(super) fn write_animation<E: From<EncodingError>>(
    count: u32,
    rate: FrameRate,
    loops: bool,
    mut pictures: impl Iterator<Item = Result<DisplayImage, E>>,
    writer: &mut dyn Sink,
) -> Result<(), E> {
    let Some(first) = pictures.next().transpose()? else {
        return Ok(());
    };
    let mut encoder = encoder(first.size, first.channels, first.bits, writer);
    encoder.set_compression(Compression::Balanced);
    encoder.set_animated(count, u32::from(!loops))?;
    let (numerator, denominator) = rate.parts();
    let part = |number: u32| number.min(u16::MAX.into()) as u16; // asked for before
    encoder.set_frame_delay(part(denominator), part(numerator))?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&stored(&first))?;
    for picture in pictures {
        writer.write_image_data(&stored(&picture?))?;
    }
    Ok(writer.finish()?)
}

/// Returns whether the format can say how long a frame lasts.
pub(super) fn holds_rate(rate: FrameRate) -> bool {
    let (numerator, denominator) = rate.parts();
    numerator.max(denominator) <= u16::MAX.into()
}

fn encoder(
    size: ImageSize,
    channels: usize,
    bits: u32,
    writer: &mut dyn Sink,
) -> Encoder<'static, &mut dyn Sink> {
    let mut encoder = Encoder::new(writer, size.width, size.height);
    encoder.set_color(match channels {
        3 => ColorType::Rgb,
        _ => ColorType::Rgba,
    });
    encoder.set_depth(match bits {
        8 => BitDepth::Eight,
        _ => BitDepth::Sixteen,
    });
    encoder.set_filter(Filter::Adaptive);
    encoder
}

/// Returns the bytes as the format has them: of 16 bits the higher ones first.
fn stored(picture: &DisplayImage) -> std::borrow::Cow<'_, [u8]> {
    let data = picture.as_slice();
    if picture.bits == 8 || cfg!(target_endian = "big") {
        return data.into();
    }
    let (pairs, _) = data.as_chunks::<2>();
    let swapped = pairs.iter().flat_map(|[low, high]| [*high, *low]);
    swapped.collect::<Vec<u8>>().into()
}

/// Returns the fingerprint of a file that has one and is whole.
pub(super) fn fingerprint(path: &Path) -> Option<String> {
    let mut file = File::open(path).ok()?;
    let mut end = [0; END.len()];
    file.seek(SeekFrom::End(-(END.len() as i64))).ok()?;
    file.read_exact(&mut end).ok()?;
    file.rewind().ok()?;
    let reader = png::Decoder::new(BufReader::new(file)).read_info().ok()?;
    let texts = &reader.info().uncompressed_latin1_text;
    let text = texts.iter().find(|text| text.keyword == KEYWORD)?;
    (end == END).then(|| text.text.clone())
}
