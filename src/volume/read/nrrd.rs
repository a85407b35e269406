//! NRRD ("nearly raw raster data", teem.sourceforge.net/nrrd): a header of lines, an empty one, and raw cells.

use std::collections::HashMap;

use glam::DVec3;

use super::bytes::Number;
use super::{Dense, Read, check_size, color_of, storage_of};
use crate::shown::shown;

pub(super) fn read(bytes: &[u8]) -> Read<Dense> {
    if !bytes.starts_with(b"NRRD000") {
        return Err(": no NRRD: it does not begin with NRRD000".into());
    }
    let (header, data) = split(bytes).ok_or(": cut short: no empty line ends its header")?;
    let fields: HashMap<&str, &str> = header
        .lines()
        .skip(1)
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| line.split_once(":=").or_else(|| line.split_once(": ")))
        .map(|(name, value)| (name.trim(), value.trim()))
        .collect();
    let field = |name: &str| fields.get(name).copied();
    if let Some(file) = field("data file").or(field("datafile")) {
        let message = format!(
            ": its cells are in another file, {}; attach them",
            shown(file)
        );
        return Err(message.into());
    }
    match field("encoding") {
        Some("raw") => {}
        other => {
            let other = shown(other.unwrap_or("none"));
            return Err(format!(": encoding \"{other}\"; raw ones are read").into());
        }
    }
    let number = match field("type").unwrap_or_default() {
        "float" => Number::Float,
        "double" => Number::Double,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => Number::Byte,
        "ushort" | "unsigned short" | "uint16" | "uint16_t" => Number::Short,
        other => {
            let message = format!(
                ": cells of type \"{}\"; float, double, unsigned char and unsigned short are read",
                shown(other)
            );
            return Err(message.into());
        }
    };
    let sizes = field("sizes").unwrap_or_default().split_whitespace();
    let sizes: Option<Vec<u32>> = sizes.map(|it| it.parse().ok()).collect();
    let (channels, cells) = match sizes.as_deref() {
        Some(&[x, y, z]) => (1, [x, y, z]),
        Some(&[channels @ (1..=4 | 6), x, y, z]) => (channels as usize, [x, y, z]),
        _ => {
            return Err(
                ": `sizes` is to be three edges, or 1 to 4 or 6 channels and three edges".into(),
            );
        }
    };
    let data = check_size(cells, channels * number.bytes(), data)?;
    Ok(Dense {
        cells,
        channels,
        values: number.read(data, field("endian") == Some("big")),
        place: place(field("space directions"), field("space origin"))?,
        storage: storage_of(field("storage"), field("power"))?,
        color: color_of(field("color"))?,
    })
}

/// Parts a file behind the empty line.
fn split(bytes: &[u8]) -> Option<(String, &[u8])> {
    let mut from = 0;
    loop {
        let end = from + bytes[from..].iter().position(|byte| *byte == b'\n')?;
        let line = &bytes[from..end];
        if line.is_empty() || line == b"\r" {
            let header = String::from_utf8_lossy(&bytes[..from]).into_owned();
            return Some((header, &bytes[end + 1..]));
        }
        from = end + 1;
    }
}

/// Reads the edges of a cell, and the lowest corner: the origin is the middle of the first cell.
fn place(directions: Option<&str>, origin: Option<&str>) -> Read<Option<[DVec3; 2]>> {
    let (Some(directions), Some(origin)) = (directions, origin) else {
        return Ok(None);
    };
    let vectors = |text: &str| -> Option<Vec<DVec3>> {
        let parts = text.split(['(', ')']).map(str::trim);
        let parts = parts.filter(|part| !part.is_empty() && *part != "none");
        parts.map(vector).collect()
    };
    let directions = vectors(directions);
    let (Some(&[x, y, z]), Some(&[origin])) = (directions.as_deref(), vectors(origin).as_deref())
    else {
        return Err(": `space directions` and `space origin` are to be vectors of three".into());
    };
    let cell = DVec3::new(x.x, y.y, z.z);
    let is_along = x == DVec3::X * cell.x && y == DVec3::Y * cell.y && z == DVec3::Z * cell.z;
    if !is_along || cell.min_element() <= 0.0 || !(cell.is_finite() && origin.is_finite()) {
        return Err(": its axes are turned or mirrored; those along x, y and z are read".into());
    }
    Ok(Some([origin - 0.5 * cell, cell]))
}

fn vector(text: &str) -> Option<DVec3> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|it| it.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Some(DVec3::new(x, y, z)),
        _ => None,
    }
}
