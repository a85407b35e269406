//! The chunks of a part: found by its table, checked, decoded one after another.

use std::collections::HashSet;

use exr::block::UncompressedBlock;
use exr::block::chunk::{
    Chunk, CompressedBlock, CompressedScanLineBlock, CompressedTileBlock, TileCoordinates,
};
use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::attribute::{ChannelDescription, SampleType};
use exr::meta::header::Header;
use exr::prelude::{Compression, f16};

use super::{OpenExr, Outcome, Plane, dwa};
use crate::memory;

/// How many times the bytes of a chunk its decoder may take: packed, unpacked, halves and planes of it.
const COPIES: usize = 6;

/// Decodes channels of a part whose header was checked.
pub(super) fn decode(file: &OpenExr, part: usize, channels: &[usize]) -> Outcome<Vec<Plane>> {
    let header = &file.meta.headers[part];
    let table = table(file, part)?;
    let (width, height) = (header.layer_size.0, header.layer_size.1);
    let chunk_bytes = largest_chunk(header);
    let plane_bytes = 4 * width * height;
    let bytes = channels.len() * plane_bytes + COPIES * chunk_bytes;
    check_memory(bytes)?;
    let window = header.shared_attributes.display_window.position;
    let first = header.own_attributes.layer_position;
    let mut planes = Vec::new();
    for _ in channels {
        let mut values = Vec::new();
        values
            .try_reserve_exact(width * height)
            .map_err(|_| not_granted(bytes))?;
        values.resize(width * height, 0.0);
        planes.push(Plane {
            first: (
                i64::from(first.0) - i64::from(window.0),
                i64::from(first.1) - i64::from(window.1),
            ),
            size: (width, height),
            values,
        });
    }
    let mut found = HashSet::new();
    let mut pixels = 0;
    for place in table {
        // A chunk that is not there, counted below, or one of a smaller level.
        let Some(chunk) = chunk(file, part, place)? else {
            continue;
        };
        let index = header
            .get_block_data_indices(&chunk.compressed_block)
            .map_err(damaged)?;
        let bounds = header
            .get_absolute_block_pixel_coordinates(index)
            .map_err(damaged)?;
        if !found.insert((index.tile_index.0, index.tile_index.1)) {
            return Err("damaged: a chunk is there twice".to_owned());
        }
        pixels += bounds.size.area();
        check_chunk(header, &chunk, bounds.size)?;
        let block =
            UncompressedBlock::decompress_chunk(chunk, &file.meta, false).map_err(damaged)?;
        for (plane, &channel) in planes.iter_mut().zip(channels) {
            unpack(header, &block, channel, plane)?;
        }
    }
    if pixels != width * height {
        return Err("cut off, or never finished: some of its pixels are missing".to_owned());
    }
    Ok(planes)
}

/// Checks that all chunks of a part are in the file.
pub(super) fn check_all(file: &OpenExr, part: usize) -> Outcome<()> {
    for place in table(file, part)? {
        if place == 0 || chunk(file, part, place)?.is_none() {
            return Err("never finished: a chunk of pixels is missing".to_owned());
        }
    }
    Ok(())
}

/// Returns where the chunks of a part are, bytes; 0 for one that is not there.
fn table(file: &OpenExr, part: usize) -> Outcome<impl Iterator<Item = u64>> {
    let cut = || "cut off: it ends in its table of chunks".to_owned();
    let counts = file.meta.headers.iter().map(|header| header.chunk_count);
    let before = counts.take(part).try_fold(0_usize, usize::checked_add);
    let count = file.meta.headers[part].chunk_count;
    let begin = before
        .and_then(|before| before.checked_mul(8)?.checked_add(file.tables))
        .ok_or_else(cut)?;
    let length = count.checked_mul(8).ok_or_else(cut)?;
    let rest = file.bytes.get(begin..).ok_or_else(cut)?;
    let (places, _) = rest.get(..length).ok_or_else(cut)?.as_chunks::<8>();
    Ok(places.iter().map(|place| u64::from_le_bytes(*place)))
}

/// Reads the chunk at a place of the file; none if it is not there, or not of the largest level.
fn chunk(file: &OpenExr, part: usize, place: u64) -> Outcome<Option<Chunk>> {
    let cut = || "cut off: a chunk of pixels is missing".to_owned();
    let begin = usize::try_from(place).map_err(|_| cut())?;
    let mut rest = match begin {
        0 => return Ok(None),
        _ => file.bytes.get(begin..).ok_or_else(cut)?,
    };
    let mut number = || -> Outcome<i32> {
        let (bytes, after) = rest.split_first_chunk::<4>().ok_or_else(cut)?;
        rest = after;
        Ok(i32::from_le_bytes(*bytes))
    };
    if file.meta.requirements.has_multiple_layers && number()? != part as i32 {
        return Err("damaged: a chunk is of another part".to_owned());
    }
    let header = &file.meta.headers[part];
    let BlockDescription::Tiles(_) = header.blocks else {
        let y_coordinate = number()?;
        let size = number()?;
        let block = CompressedScanLineBlock {
            y_coordinate,
            compressed_pixels_le: data(rest, size).ok_or_else(cut)?,
        };
        return Ok(Some(Chunk {
            layer_index: part,
            compressed_block: CompressedBlock::ScanLine(block),
        }));
    };
    let numbers = [number()?, number()?, number()?, number()?];
    let size = number()?;
    if numbers.iter().any(|number| *number < 0) {
        return Err("damaged: a tile lies outside the image".to_owned());
    }
    let [x, y, level_x, level_y] = numbers.map(|number| number as usize);
    if (level_x, level_y) != (0, 0) {
        return Ok(None);
    }
    let block = CompressedTileBlock {
        coordinates: TileCoordinates {
            tile_index: Vec2(x, y),
            level_index: Vec2(0, 0),
        },
        compressed_pixels_le: data(rest, size).ok_or_else(cut)?,
    };
    Ok(Some(Chunk {
        layer_index: part,
        compressed_block: CompressedBlock::Tile(block),
    }))
}

/// Returns the packed pixels at the front of `rest`, if they are all there.
fn data(rest: &[u8], size: i32) -> Option<Vec<u8>> {
    let size = usize::try_from(size).ok()?;
    rest.get(..size).map(<[u8]>::to_vec)
}

/// Checks what a chunk claims before it is decoded.
fn check_chunk(header: &Header, chunk: &Chunk, size: Vec2<usize>) -> Outcome<()> {
    let (CompressedBlock::ScanLine(CompressedScanLineBlock {
        compressed_pixels_le: data,
        ..
    })
    | CompressedBlock::Tile(CompressedTileBlock {
        compressed_pixels_le: data,
        ..
    })) = &chunk.compressed_block
    else {
        return Err("its pixels are deep".to_owned());
    };
    let bytes = size.area() * header.channels.bytes_per_pixel;
    let is_packed = data.len() != bytes && !data.is_empty();
    match header.compression {
        Compression::DWAA(_) | Compression::DWAB(_) if is_packed => {
            dwa::check(data, (size.0, size.1), header.channels.list.len(), bytes)
        }
        _ => Ok(()),
    }
}

/// Copies the values of a channel from a block of all channels' bytes: by rows, in a row by channels.
fn unpack(
    header: &Header,
    block: &UncompressedBlock,
    channel: usize,
    plane: &mut Plane,
) -> Outcome<()> {
    let wrong = || "damaged: a chunk has not as many pixels as it should".to_owned();
    let width = block.index.pixel_size.0;
    let list = &header.channels.list;
    let of_pixel = |channels: &[ChannelDescription]| -> usize {
        let sizes = channels.iter().map(|c| c.sample_type.bytes_per_sample());
        sizes.sum()
    };
    let (before, whole) = (of_pixel(&list[..channel]), of_pixel(list));
    let kind = list[channel].sample_type;
    let (left, top) = (block.index.pixel_position.0, block.index.pixel_position.1);
    for row in 0..block.index.pixel_size.1 {
        let begin = width * (row * whole + before);
        let end = begin + width * kind.bytes_per_sample();
        let source = block.data.get(begin..end).ok_or_else(wrong)?;
        let at = (top + row) * plane.size.0 + left;
        let target = plane.values.get_mut(at..at + width).ok_or_else(wrong)?;
        match kind {
            SampleType::F16 => {
                let (halves, _) = source.as_chunks::<2>();
                let values = halves.iter().map(|half| f16::from_ne_bytes(*half).to_f32());
                target
                    .iter_mut()
                    .zip(values)
                    .for_each(|(to, from)| *to = from);
            }
            SampleType::F32 => {
                let (floats, _) = source.as_chunks::<4>();
                let values = floats.iter().map(|float| f32::from_ne_bytes(*float));
                target
                    .iter_mut()
                    .zip(values)
                    .for_each(|(to, from)| *to = from);
            }
            SampleType::U32 => {
                let (words, _) = source.as_chunks::<4>();
                let values = words.iter().map(|word| u32::from_ne_bytes(*word) as f32);
                target
                    .iter_mut()
                    .zip(values)
                    .for_each(|(to, from)| *to = from);
            }
        }
    }
    Ok(())
}

pub(super) fn as_stored(channel: &ChannelDescription, value: f64) -> f32 {
    match channel.sample_type {
        SampleType::F16 => f16::from_f64(value).to_f32(),
        SampleType::F32 | SampleType::U32 => value as f32,
    }
}

/// Returns the bytes of the largest chunk, unpacked.
fn largest_chunk(header: &Header) -> usize {
    let size = header.max_block_pixel_size();
    let pixels = size.0.min(header.layer_size.0) * size.1.min(header.layer_size.1);
    pixels * header.channels.bytes_per_pixel
}

/// Checks that the memory is there: what the decoder takes and does not get ends the process.
fn check_memory(bytes: usize) -> Outcome<()> {
    if let Some(shortage) = memory::shortage(bytes as u64) {
        return Err(shortage);
    }
    let reserved = Vec::<u8>::new().try_reserve_exact(bytes);
    reserved.map_err(|_| not_granted(bytes))
}

fn not_granted(bytes: usize) -> String {
    format!("{} MiB needed, more than the system grants", bytes >> 20)
}

fn damaged(error: exr::error::Error) -> String {
    format!("damaged: {error}")
}
