//! The buffers of a glTF file, and the numbers in them. Files lie: every length and offset is held against what there
//! is before anything is read.

use std::borrow::Cow;
use std::fs;
use std::path::Path;

use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::buffer::Source;
use ::gltf::{Accessor, Document};
use glam::Vec3;

use crate::shown::shown;

/// What a text begins with that stands in the place of a file.
pub(super) const DATA: &str = "data:";

/// The bytes of all buffers.
pub(super) struct Buffers<'a>(Vec<Cow<'a, [u8]>>);

impl Buffers<'_> {
    /// Reads the buffers of a document; `blob` is what a binary file has, and others lie in the folder.
    pub(super) fn open(
        document: &Document,
        mut blob: Option<Vec<u8>>,
        folder: &Path,
    ) -> Result<Self, String> {
        let mut buffers = Vec::new();
        for buffer in document.buffers() {
            let name = format!(": buffer {}", buffer.index());
            let bytes = match buffer.source() {
                Source::Bin => blob
                    .take()
                    .ok_or_else(|| format!("{name}: the file has no binary part"))?,
                Source::Uri(uri) if uri.starts_with(DATA) => {
                    let text = uri.split_once(";base64,").map(|(_, text)| text);
                    let bytes = text.and_then(|text| base64(text.as_bytes()));
                    bytes.ok_or_else(|| format!("{name}: it is no base64"))?
                }
                Source::Uri(uri) => {
                    let path = folder.join(plain(uri));
                    let shown_name = shown(uri);
                    fs::read(&path)
                        .map_err(|error| format!("{name}: cannot read {shown_name}: {error}"))?
                }
            };
            if bytes.len() < buffer.length() {
                let (found, wanted) = (bytes.len(), buffer.length());
                return Err(format!(
                    "{name} has {found} bytes, and should have {wanted}"
                ));
            }
            buffers.push(Cow::Owned(bytes));
        }
        Ok(Self(buffers))
    }

    /// Returns the values of an accessor: where each begins, all of them as long as one.
    fn values(&self, accessor: &Accessor<'_>) -> Result<impl Iterator<Item = &[u8]>, String> {
        let name = format!("accessor {}", accessor.index());
        if accessor.sparse().is_some() {
            return Err(format!(
                "{name} is sparse, which is not read; export it otherwise"
            ));
        }
        let Some(view) = accessor.view() else {
            return Err(format!("{name} has no buffer"));
        };
        let size = accessor.size();
        let stride = view.stride().unwrap_or(size).max(1);
        if stride < size {
            return Err(format!("{name} has values that lie in each other"));
        }
        let cut = |bytes: &'_ [u8]| -> Option<(usize, usize)> {
            let begin = view.offset().checked_add(accessor.offset())?;
            let end = view.offset().checked_add(view.length())?.min(bytes.len());
            let last = accessor.count().checked_sub(1)?.checked_mul(stride)?;
            let needed = begin.checked_add(last)?.checked_add(size)?;
            (needed <= end).then_some((begin, needed))
        };
        let bytes = self.0.get(view.buffer().index()).map_or(&[][..], |it| it);
        let (begin, end) = cut(bytes)
            .ok_or_else(|| format!("{name} reaches beyond its buffer, or has nothing"))?;
        let values = bytes[begin..end].chunks(stride);
        Ok(values.map(move |value| &value[..size.min(value.len())]))
    }

    /// Reads float32 vectors.
    pub(super) fn positions(&self, accessor: &Accessor<'_>) -> Result<Vec<Vec3>, String> {
        if (accessor.data_type(), accessor.dimensions()) != (DataType::F32, Dimensions::Vec3) {
            return Err("its positions are no vectors of three float32".to_owned());
        }
        let float = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let vector = |it: &[u8]| Vec3::new(float(&it[..4]), float(&it[4..8]), float(&it[8..12]));
        Ok(self.values(accessor)?.map(vector).collect())
    }

    /// Reads whole numbers of 8, 16 or 32 bits.
    pub(super) fn indices(&self, accessor: &Accessor<'_>) -> Result<Vec<u32>, String> {
        let is_whole = matches!(
            accessor.data_type(),
            DataType::U8 | DataType::U16 | DataType::U32
        );
        if !is_whole || accessor.dimensions() != Dimensions::Scalar {
            return Err("its indices are no whole numbers".to_owned());
        }
        let number = |bytes: &[u8]| {
            let digits = bytes.iter().rev();
            digits.fold(0, |sum, digit| sum << 8 | u32::from(*digit))
        };
        Ok(self.values(accessor)?.map(number).collect())
    }
}

/// Returns a name with `%20` and the like as the characters that they stand for.
pub(super) fn plain(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        let code = after.get(..2).and_then(|it| std::str::from_utf8(it).ok());
        let code = code.and_then(|it| u8::from_str_radix(it, 16).ok());
        match (first, code) {
            (b'%', Some(byte)) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            _ => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Reads base64 (RFC 4648); `None` if it is none.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let text = text
        .strip_suffix(b"==")
        .or_else(|| text.strip_suffix(b"="))
        .unwrap_or(text);
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut bits = 0_u32;
        for letter in group {
            let value = match letter {
                b'A'..=b'Z' => letter - b'A',
                b'a'..=b'z' => letter - b'a' + 26,
                b'0'..=b'9' => letter - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                _ => return None,
            };
            bits = bits << 6 | u32::from(value);
        }
        let found = match group.len() {
            1 => return None,
            len => len * 6 / 8,
        };
        bits <<= 24 - 6 * group.len() as u32;
        bytes.extend_from_slice(&bits.to_be_bytes()[1..=found]);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_and_names_with_codes_are_read() {
        for (text, bytes) in [
            ("", &b""[..]),
            ("TQ==", b"M"),
            ("TWE=", b"Ma"),
            ("TWFu", b"Man"),
            ("TWFuTWE", b"ManMa"),
        ] {
            assert_eq!(base64(text.as_bytes()).unwrap(), bytes, "{text}");
        }
        assert!(base64(b"TWF!").is_none() && base64(b"T").is_none());
        assert_eq!(plain("a%20b%C3%A9.bin%2"), "a b\u{e9}.bin%2");
    }
}
