//! VTK image data (the VTK XML formats, docs.vtk.org): one array of cells or points, appended raw, uncompressed.

use glam::DVec3;

use super::bytes::Number;
use super::{Dense, Fault, Read, check_size, color_of, storage_of};
use crate::shown::shown;

pub(super) fn read(bytes: &[u8]) -> Read<Dense> {
    let appended =
        find(bytes, b"<AppendedData").ok_or(": no VTK image data with appended cells")?;
    let header = String::from_utf8_lossy(&bytes[..appended]);
    let file = tag(&header, "VTKFile")?;
    let image = tag(&header, "ImageData")?;
    let array = tag(&header, "DataArray")?;
    if attribute(file, "compressor").is_some() {
        return Err(": its cells are compressed; save them raw and appended".into());
    }
    if attribute(array, "format") != Some("appended") {
        return Err(": its cells are not appended; save them raw and appended".into());
    }
    let is_big = attribute(file, "byte_order") == Some("BigEndian");
    let number = match attribute(array, "type") {
        Some("Float32") => Number::Float,
        Some("Float64") => Number::Double,
        Some("UInt8") => Number::Byte,
        Some("UInt16") => Number::Short,
        other => {
            let other = shown(other.unwrap_or("none"));
            let message =
                format!(": cells of type \"{other}\"; Float32, Float64, UInt8 and UInt16 are read");
            return Err(message.into());
        }
    };
    let channels = match attribute(array, "NumberOfComponents").unwrap_or("1") {
        "1" => 1,
        "2" => 2,
        "3" => 3,
        "4" => 4,
        "6" => 6,
        other => return Err(format!(": {} channels; 1 to 4 or 6 are read", shown(other)).into()),
    };
    let is_of_points = header.contains("<PointData") && !header.contains("<CellData");
    let (cells, place) = place(image, is_of_points)?;
    let data = appended_data(&bytes[appended..], file, array)?;
    let data = check_size(cells, channels * number.bytes(), data)?;
    Ok(Dense {
        cells,
        channels,
        values: number.read(data, is_big),
        place: Some(place),
        storage: storage_of(note(&header, "storage"), note(&header, "power"))?,
        color: color_of(note(&header, "color"))?,
    })
}

/// Returns the cells, and the edges of one with the lowest corner; values of points are those of cells around them.
fn place(image: &str, is_of_points: bool) -> Read<([u32; 3], [DVec3; 2])> {
    let numbers = |name: &str| -> Option<Vec<f64>> {
        let text = attribute(image, name)?.split_whitespace();
        text.map(|it| it.parse().ok().filter(|it: &f64| it.is_finite()))
            .collect()
    };
    let extent = numbers("WholeExtent");
    let Some(&[x0, x1, y0, y1, z0, z1]) = extent.as_deref() else {
        return Err(": `WholeExtent` is to be six numbers".into());
    };
    let three = |name: &str, absent: f64| match numbers(name).as_deref() {
        Some(&[x, y, z]) => DVec3::new(x, y, z),
        _ => DVec3::splat(absent),
    };
    let (origin, cell) = (three("Origin", 0.0), three("Spacing", 1.0));
    let more = if is_of_points { 1.0 } else { 0.0 };
    let counts = [x1 - x0 + more, y1 - y0 + more, z1 - z0 + more];
    let is_count = |it: &f64| it.fract() == 0.0 && (0.0..=1e6).contains(it);
    if !counts.iter().all(is_count) || cell.min_element() <= 0.0 {
        return Err(": its extent or spacing is not one that a volume has".into());
    }
    let low = origin + cell * (DVec3::new(x0, y0, z0) - 0.5 * more);
    Ok((counts.map(|it| it as u32), [low, cell]))
}

/// Returns the bytes of the array: behind the underscore, its offset, and its length.
fn appended_data<'a>(bytes: &'a [u8], file: &str, array: &str) -> Read<&'a [u8]> {
    let cut = || Fault::from(": cut short, or damaged");
    let head = &bytes[..find(bytes, b">").ok_or_else(cut)?];
    if !String::from_utf8_lossy(head).contains("encoding=\"raw\"") {
        return Err(": its appended cells are not raw".into());
    }
    let begin = find(bytes, b"_").ok_or_else(cut)? + 1;
    let offset: usize = match attribute(array, "offset").unwrap_or("0").parse() {
        Ok(offset) => offset,
        Err(_) => return Err(cut()),
    };
    let length = match attribute(file, "header_type") {
        Some("UInt64") => 8,
        _ => 4,
    };
    let begin = begin
        .checked_add(offset)
        .and_then(|it| it.checked_add(length));
    begin.and_then(|begin| bytes.get(begin..)).ok_or_else(cut)
}

fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|window| window == what)
}

/// Returns what stands in the first tag of a name.
fn tag<'a>(header: &'a str, name: &str) -> Read<&'a str> {
    let from = header.find(&format!("<{name}"));
    let found = from.and_then(|from| header[from..].split_once('>'));
    found
        .map(|(tag, _)| tag)
        .ok_or_else(|| format!(": it has no {name}").into())
}

fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = tag.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}

/// Returns what a note in the comment says.
fn note<'a>(header: &'a str, name: &str) -> Option<&'a str> {
    let lines = header.lines();
    lines
        .filter_map(|line| line.strip_prefix(name)?.strip_prefix(": "))
        .next()
}
