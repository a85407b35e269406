//! OpenEXR files, read with distrust. The decoder believes sizes that a file claims and panics on some faults, so what
//! a file claims is held against its own length and the memory that there is before anything is made of it, only the
//! channels that are asked for are decoded, and a panic ends in an error ([`guard`]).

mod chunks;
mod dwa;
mod guard;

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use exr::math::Vec2;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::Compression;

use super::ImageSize;
pub use guard::DECODER_THREAD;

use crate::error::{Error, Result};
use crate::memory;

/// What an OpenEXR file can be packed by and still be read.
const READ: &str = "none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA or DWAB";
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// More than any renderer writes; some decoders take the square of their number.
const MOST_CHANNELS: usize = 1024;

/// Why a file cannot be read.
type Reason = String;
type Outcome<T> = std::result::Result<T, Reason>;

/// Where a channel stands in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ChannelId {
    pub(super) part: usize,
    channel: usize,
}

#[cfg(test)]
impl ChannelId {
    pub(super) fn new(part: usize, channel: usize) -> Self {
        Self { part, channel }
    }
}

/// A channel's name, and that of its part; empty where the part has none.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ChannelName {
    pub(super) id: ChannelId,
    pub(super) part: String,
    pub(super) name: String,
}

/// The values of a channel by rows from the top left of its part's data window.
pub(super) struct Plane {
    /// The column and row of the display window at which the data window begins.
    first: (i64, i64),
    size: (usize, usize),
    pub(super) values: Vec<f32>,
}

impl Plane {
    /// Calls `put` with every value that stands in the display window, and its pixel there.
    pub(super) fn place(&self, display: ImageSize, mut put: impl FnMut(usize, f32)) {
        let inside =
            |at: i64, limit: u32| (0..i64::from(limit)).contains(&at).then_some(at as usize);
        for (row, values) in self.values.chunks(self.size.0.max(1)).enumerate() {
            let Some(row) = inside(self.first.1 + row as i64, display.height) else {
                continue;
            };
            for (column, value) in values.iter().enumerate() {
                if let Some(column) = inside(self.first.0 + column as i64, display.width) {
                    put(row * display.width as usize + column, *value);
                }
            }
        }
    }
}

/// A file whose headers are read and whose pixels are not.
pub(super) struct OpenExr {
    bytes: Vec<u8>,
    meta: MetaData,
    /// Where the tables of chunks begin, bytes.
    tables: usize,
}

impl OpenExr {
    /// Reads the file, and what its headers say.
    pub(super) fn open(path: &Path) -> Result<Self> {
        let fail = |reason: Reason| Error::input(path, reason);
        let bytes = read(path)
            .map_err(|error| fail(format!("cannot read: {error}")).caused_by(error))?
            .ok_or_else(|| {
                fail(
                    "not an OpenEXR image: it does not begin as one; write it as OpenEXR"
                        .to_owned(),
                )
            })?;
        let headers = guard::guarded(|| {
            let mut cursor = Cursor::new(bytes.as_slice());
            let meta = MetaData::read_from_buffered(&mut cursor, false).map_err(|e| e.to_string());
            meta.map(|meta| (meta, cursor.position() as usize))
        });
        let (meta, tables) =
            headers.map_err(|reason| fail(format!("its header cannot be read: {reason}")))?;
        let file = Self {
            bytes,
            meta,
            tables,
        };
        file.check_display().map_err(fail)?;
        Ok(file)
    }

    /// Returns the size of the display window, pixels.
    pub(super) fn display(&self) -> ImageSize {
        let size = self.meta.headers[0].shared_attributes.display_window.size;
        ImageSize {
            width: size.0 as u32,
            height: size.1 as u32,
        }
    }

    /// Returns what its first part says in comments, if all chunks of that are there.
    pub(super) fn comments_of_whole(&self) -> Option<String> {
        let comments = self
            .meta
            .headers
            .first()?
            .own_attributes
            .comments
            .as_ref()?;
        let comments = text(comments.as_slice());
        guard::guarded(|| chunks::check_all(self, 0).map(|()| comments)).ok()
    }

    /// Returns all channels, by parts.
    pub(super) fn channels(&self) -> Vec<ChannelName> {
        let mut all = Vec::new();
        for (part, header) in self.meta.headers.iter().enumerate() {
            let part_name = match (&header.own_attributes.layer_name, self.meta.headers.len()) {
                (Some(name), 2..) => text(name.as_slice()),
                (None, 2..) => format!("{}", part + 1),
                _ => String::new(),
            };
            let named = header.channels.list.iter().enumerate();
            all.extend(named.map(|(channel, of)| ChannelName {
                id: ChannelId { part, channel },
                part: part_name.clone(),
                name: text(of.name.as_slice()),
            }));
        }
        all
    }

    /// Returns the value of the file's own type of numbers that is nearest to `value`.
    pub(super) fn as_stored(&self, id: ChannelId, value: f64) -> f32 {
        chunks::as_stored(&self.meta.headers[id.part].channels.list[id.channel], value)
    }

    /// Decodes channels of one part.
    pub(super) fn planes(&self, ids: &[ChannelId]) -> Outcome<Vec<Plane>> {
        let Some(part) = ids.first().map(|id| id.part) else {
            return Ok(Vec::new());
        };
        let header = &self.meta.headers[part];
        check_part(header)?;
        let channels: Vec<usize> = ids.iter().map(|id| id.channel).collect();
        guard::guarded(|| {
            header
                .validate(self.meta.headers.len() > 1, &mut false, false)
                .map_err(|error| format!("damaged: {error}"))?;
            chunks::decode(self, part, &channels)
        })
    }

    fn check_display(&self) -> Outcome<()> {
        match self.meta.headers.first() {
            Some(header) => check_window(header.shared_attributes.display_window.size),
            None => Err("not an OpenEXR image: it has no part".to_owned()),
        }
    }
}

/// Returns the file's bytes; none if it does not begin as an OpenEXR file.
fn read(path: &Path) -> std::io::Result<Option<Vec<u8>>> {
    let mut file = File::open(path)?;
    let mut bytes = Vec::new();
    file.by_ref().take(4).read_to_end(&mut bytes)?;
    if bytes != MAGIC {
        return Ok(None);
    }
    let most = memory::available_bytes().unwrap_or(u64::MAX);
    if let Ok(length) = file.metadata().map(|meta| meta.len())
        && length <= most
    {
        let reserved = bytes.try_reserve_exact(length as usize);
        reserved.map_err(|_| std::io::ErrorKind::OutOfMemory)?;
    }
    if file.take(most).read_to_end(&mut bytes)? as u64 == most {
        return Err(std::io::ErrorKind::OutOfMemory.into());
    }
    Ok(Some(bytes))
}

/// Checks what a part claims: a kind of pixels that can be read, and sizes that an image may have.
fn check_part(header: &Header) -> Outcome<()> {
    if header.deep {
        let message = "its pixels are deep (several samples each), which cannot be read; flatten it, so that each \
                       pixel has one depth";
        return Err(message.to_owned());
    }
    if matches!(
        header.compression,
        Compression::HTJ2K32 | Compression::HTJ2K256
    ) {
        return Err(format!(
            "it is compressed by HTJ2K, which cannot be read; write it with another compression: {READ}"
        ));
    }
    check_window(header.layer_size)?;
    if let BlockDescription::Tiles(tiles) = header.blocks
        && tiles.tile_size.area() == 0
    {
        return Err("damaged: its tiles have no pixels".to_owned());
    }
    let channels = &header.channels.list;
    if channels.len() > MOST_CHANNELS {
        return Err(format!(
            "{} channels in one part; at most {MOST_CHANNELS} are read",
            channels.len()
        ));
    }
    if channels.iter().any(|c| c.sampling != Vec2(1, 1)) {
        return Err("a channel has not one sample for each pixel".to_owned());
    }
    Ok(())
}

fn check_window(size: Vec2<usize>) -> Outcome<()> {
    const LIMIT: usize = ImageSize::LIMIT as usize;
    if size.0.max(size.1) > LIMIT {
        return Err(format!(
            "{}x{} pixels; an image is at most {LIMIT}x{LIMIT}",
            size.0, size.1
        ));
    }
    Ok(())
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
