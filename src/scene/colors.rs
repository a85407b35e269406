//! Reads colours: three numbers, linear RGB, or `"#rrggbb"`, sRGB.

use std::fmt;

use glam::DVec3;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// A colour as a file writes it.
struct Color(DVec3);

impl<'de> Deserialize<'de> for Color {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        reader.deserialize_any(ColorVisitor).map(Self)
    }
}

struct ColorVisitor;

impl<'de> Visitor<'de> for ColorVisitor {
    type Value = DVec3;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("three numbers, linear RGB, or \"#rrggbb\"")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<DVec3, A::Error> {
        let mut numbers = Vec::new();
        while let Some(number) = list.next_element::<f64>()? {
            numbers.push(number);
        }
        let found = numbers.len();
        let numbers: [f64; 3] = numbers
            .try_into()
            .map_err(|_| A::Error::custom(format!("expected three numbers, found {found}")))?;
        Ok(numbers.into())
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<DVec3, E> {
        from_hex(text).ok_or_else(|| {
            E::custom("a colour is three numbers, linear RGB, or six digits such as \"#ff8800\"")
        })
    }
}

/// Returns the linear value of an sRGB one (IEC 61966-2-1).
pub(super) fn decoded(encoded: f64) -> f64 {
    match encoded <= 0.04045 {
        true => encoded / 12.92,
        false => ((encoded + 0.055) / 1.055).powf(2.4),
    }
}

/// Returns the linear RGB of an sRGB colour `#rrggbb`.
pub(super) fn from_hex(text: &str) -> Option<DVec3> {
    let digits = text.strip_prefix('#')?;
    if digits.len() != 6 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let channel = |k: usize| {
        let byte = u8::from_str_radix(digits.get(2 * k..2 * k + 2)?, 16).ok()?;
        Some(decoded(f64::from(byte) / 255.0))
    };
    Some(DVec3::new(channel(0)?, channel(1)?, channel(2)?))
}

/// Reads a colour.
pub(crate) fn read_color<'de, D: Deserializer<'de>>(reader: D) -> Result<DVec3, D::Error> {
    Color::deserialize(reader).map(|color| color.0)
}

/// Reads a colour for a key that may be absent.
pub(crate) fn read_some_color<'de, D: Deserializer<'de>>(
    reader: D,
) -> Result<Option<DVec3>, D::Error> {
    read_color(reader).map(Some)
}

/// Reads a list of colours for a key that may be absent.
pub(crate) fn read_some_colors<'de, D: Deserializer<'de>>(
    reader: D,
) -> Result<Option<Vec<DVec3>>, D::Error> {
    let colors = Vec::<Color>::deserialize(reader)?;
    Ok(Some(colors.into_iter().map(|color| color.0).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hexadecimal_colours_are_decoded_and_others_are_none() {
        assert_eq!(from_hex("#ffffff"), Some(DVec3::ONE));
        assert_eq!(from_hex("#000000"), Some(DVec3::ZERO));
        let orange = from_hex("#FF8000").unwrap();
        assert!((orange.y - 0.215_860_5).abs() < 1e-6 && orange.x == 1.0 && orange.z == 0.0);
        for wrong in ["ff8000", "#ff80", "#ff80000", "#gg8000", "#+f8000", ""] {
            assert_eq!(from_hex(wrong), None, "{wrong}");
        }
    }
}
