//! The buffers of a glTF file, and the numbers in them. Files lie: every length and offset is held against what there
//! is before anything is read.

use std::borrow::Cow;
use std::fs;
use std::path::Path;
use std::slice::Chunks;

use ::gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use ::gltf::json::validation::{Checked, USize64};
use ::gltf::json::{Index, Root};
use glam::Vec3;

use crate::shown::shown;

/// What a text begins with that stands in the place of a file.
pub(super) const DATA: &str = "data:";

/// The bytes of all buffers of a document.
pub(super) struct Buffers<'a> {
    document: &'a Root,
    bytes: Vec<Cow<'a, [u8]>>,
}

impl<'a> Buffers<'a> {
    /// Reads the buffers of a document; `binary` is what a binary file has, and others lie in the folder.
    pub(super) fn open(
        document: &'a Root,
        mut binary: Option<&'a [u8]>,
        folder: &Path,
    ) -> Result<Self, String> {
        let mut all = Vec::new();
        for (number, buffer) in document.buffers.iter().enumerate() {
            let name = format!(": buffer {number}");
            let bytes = match buffer.uri.as_deref() {
                None => {
                    let bytes = binary.take().map(Cow::Borrowed);
                    bytes.ok_or_else(|| format!("{name}: the file has no binary part"))?
                }
                Some(uri) if uri.starts_with(DATA) => {
                    let text = uri.split_once(";base64,").map(|(_, text)| text);
                    let bytes = text.and_then(|text| base64(text.as_bytes()));
                    Cow::Owned(bytes.ok_or_else(|| format!("{name}: it is no base64"))?)
                }
                Some(uri) => {
                    let bytes = fs::read(folder.join(plain(uri)));
                    let told = |error| format!("{name}: cannot read {}: {error}", shown(uri));
                    Cow::Owned(bytes.map_err(told)?)
                }
            };
            let (found, wanted) = (bytes.len() as u64, buffer.byte_length.0);
            if found < wanted {
                return Err(format!(
                    "{name} has {found} bytes, and should have {wanted}"
                ));
            }
            all.push(bytes);
        }
        Ok(Self {
            document,
            bytes: all,
        })
    }

    /// Returns the values of an accessor, each of `parts` numbers: their type, and the bytes of each.
    fn values(&self, number: usize, parts: Type) -> Result<Values<'_>, String> {
        let name = format!("accessor {number}");
        let accessor = self.document.accessors.get(number);
        let accessor = accessor.ok_or_else(|| format!("there is no {name}"))?;
        if accessor.sparse.is_some() {
            return Err(format!(
                "{name} is sparse, which is not read; export it otherwise"
            ));
        }
        let (Checked::Valid(GenericComponentType(component)), Checked::Valid(found)) =
            (accessor.component_type, accessor.type_)
        else {
            return Err(format!("{name} has no known type"));
        };
        if found != parts {
            return Err(format!("{name} has {found:?}, and should have {parts:?}"));
        }
        let view = accessor.buffer_view.as_ref().map(Index::value);
        let view = view.and_then(|view| self.document.buffer_views.get(view));
        let view = view.ok_or_else(|| format!("{name} has no buffer"))?;
        let bytes = self.bytes.get(view.buffer.value());
        let bytes = bytes.map_or(&[][..], |it| it);
        let size = component.size() * parts.multiplicity();
        let stride = view.byte_stride.map_or(size, |it| it.0);
        if stride < size {
            return Err(format!("{name} has values that lie in each other"));
        }
        let cut = || -> Option<&[u8]> {
            let place = |it: Option<USize64>| usize::try_from(it.map_or(0, |it| it.0)).ok();
            let (begin, length) = (place(view.byte_offset)?, place(Some(view.byte_length))?);
            let inside = bytes.get(begin..begin.checked_add(length)?)?;
            let last = place(Some(accessor.count))?.checked_sub(1)?;
            let begin = place(accessor.byte_offset)?;
            let end = begin.checked_add(last.checked_mul(stride)?)?;
            inside.get(begin..end.checked_add(size)?)
        };
        let values =
            cut().ok_or_else(|| format!("{name} reaches beyond its buffer, or has nothing"))?;
        Ok(Values {
            component,
            size,
            chunks: values.chunks(stride),
        })
    }

    /// Reads float32 vectors.
    pub(super) fn positions(&self, accessor: usize) -> Result<Vec<Vec3>, String> {
        let values = self.values(accessor, Type::Vec3)?;
        if values.component != ComponentType::F32 {
            return Err("its positions are no float32".to_owned());
        }
        let vector = |bytes: &[u8]| {
            let floats = bytes.as_chunks::<4>().0;
            Vec3::from_array([0, 1, 2].map(|axis| f32::from_le_bytes(floats[axis])))
        };
        Ok(values.each().map(vector).collect())
    }

    /// Reads whole numbers of 8, 16 or 32 bits.
    pub(super) fn indices(&self, accessor: usize) -> Result<Vec<u32>, String> {
        let values = self.values(accessor, Type::Scalar)?;
        let (small, large) = (ComponentType::U8, ComponentType::U32);
        if ![small, ComponentType::U16, large].contains(&values.component) {
            return Err("its indices are no whole numbers".to_owned());
        }
        let number = |bytes: &[u8]| {
            let digits = bytes.iter().rev();
            digits.fold(0, |sum, digit| sum << 8 | u32::from(*digit))
        };
        Ok(values.each().map(number).collect())
    }
}

/// The values of an accessor.
struct Values<'a> {
    component: ComponentType,
    size: usize,
    chunks: Chunks<'a, u8>,
}

impl<'a> Values<'a> {
    fn each(self) -> impl Iterator<Item = &'a [u8]> {
        self.chunks.map(move |chunk| &chunk[..self.size]) // the last one has no more
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
