//! Reads particles from files. Every fault says the file, and of a text the line.

use std::fs;
use std::path::Path;

use glam::DVec3;

use super::{Origin, PointList, PointSize, npy, ply};
use crate::error::SceneError;
use crate::shown::shown;

/// Positions, and sizes where the file has them.
pub(super) type Read = std::result::Result<(Vec<DVec3>, Option<Vec<PointSize>>), String>;

/// What files there are.
const ENDINGS: &str =
    ".csv (x, y, z, and if wanted radius and weight), .f32 (raw float32), .npy or .ply";

pub(super) fn open(path: &Path) -> std::result::Result<PointList, SceneError> {
    let name = path.display().to_string();
    let name = shown(&name);
    let fault = |message: String| SceneError::value("file", format!("{name}{message}"));
    let ending = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    let read: fn(&[u8]) -> Read = match ending.as_str() {
        "csv" => read_csv,
        "f32" => read_raw,
        "npy" => npy::read,
        "ply" => ply::read,
        _ => {
            return Err(fault(format!(
                ": particles are in files that end in {ENDINGS}"
            )));
        }
    };
    let bytes = fs::read(path).map_err(|error| fault(format!(": cannot read: {error}")))?;
    let (positions, sizes) = read(&bytes).map_err(fault)?;
    let full = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    PointList::checked(positions, (sizes, None), Origin::File(full))
        .map_err(|wrong| fault(format!(": {}", wrong.message)))
}

/// Returns a position of three numbers, which float32 files repeat without end.
pub(super) fn vectors(numbers: impl IntoIterator<Item = f64>) -> Vec<DVec3> {
    let mut numbers = numbers.into_iter();
    let mut vectors = Vec::with_capacity(numbers.size_hint().0 / 3);
    while let (Some(x), Some(y), Some(z)) = (numbers.next(), numbers.next(), numbers.next()) {
        vectors.push(DVec3::new(x, y, z));
    }
    vectors
}

/// Reads float32 without a header.
fn read_raw(bytes: &[u8]) -> Read {
    const RECORD: usize = 3 * size_of::<f32>();
    if !bytes.len().is_multiple_of(RECORD) {
        return Err(format!(
            ": {} bytes are no multiple of {RECORD}, three float32 for each particle; the file is cut off, or of \
             another kind",
            bytes.len()
        ));
    }
    let (numbers, _) = bytes.as_chunks::<4>();
    Ok((
        vectors(numbers.iter().map(|it| f64::from(f32::from_le_bytes(*it)))),
        None,
    ))
}

/// Reads lines of 3 to 5 numbers, all of one length; what begins with `#` is a remark, and words in the first line are
/// names of columns.
fn read_csv(bytes: &[u8]) -> Read {
    let text = std::str::from_utf8(bytes).map_err(|_| ": it is no text (UTF-8)".to_owned())?;
    let text = text.trim_start_matches('\u{feff}');
    let (mut positions, mut sizes) = (Vec::new(), Vec::new());
    let mut columns = None;
    let mut may_be_names = true;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let is_between = |c: char| c == ',' || c == ';' || c.is_whitespace();
        let fields: Vec<&str> = match line.contains([',', ';']) {
            true => line.split([',', ';']).map(str::trim).collect(),
            false => line
                .split(is_between)
                .filter(|field| !field.is_empty())
                .collect(),
        };
        if std::mem::take(&mut may_be_names)
            && fields.iter().all(|field| field.parse::<f64>().is_err())
        {
            continue;
        }
        let numbers =
            numbers_of(&fields, columns).map_err(|message| format!(":{}: {message}", index + 1))?;
        columns = Some(numbers.len());
        positions.push(DVec3::new(numbers[0], numbers[1], numbers[2]));
        if let Some(&radius) = numbers.get(3) {
            let weight = numbers.get(4).copied().unwrap_or(1.0);
            sizes.push(PointSize { radius, weight });
        }
    }
    Ok((positions, (!sizes.is_empty()).then_some(sizes)))
}

fn numbers_of(fields: &[&str], columns: Option<usize>) -> std::result::Result<Vec<f64>, String> {
    let found = fields.len();
    match columns {
        None if !(3..=5).contains(&found) => {
            return Err(format!(
                "{found} numbers; a line has x, y, z, and if wanted a radius and a weight"
            ));
        }
        Some(columns) if columns != found => {
            return Err(format!("{found} numbers, the lines before have {columns}"));
        }
        _ => {}
    }
    let number = |field: &&str| {
        let value: std::result::Result<f64, _> = field.parse();
        value.map_err(|_| format!("\"{}\" is no number", shown(field)))
    };
    fields.iter().map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_numbers_are_read_and_broken_ones_named() {
        let (positions, sizes) = read_csv(b"x,y,z\n# a remark\n1, 2,3\n\n-1,0.5,1e2\n").unwrap();
        assert_eq!(
            positions,
            [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-1.0, 0.5, 100.0)]
        );
        assert_eq!(sizes, None);
        let (positions, sizes) = read_csv(b"1 2 3  0.5\n4 5 6 0.25\n").unwrap();
        assert_eq!((positions.len(), sizes.unwrap()[1].radius), (2, 0.25));
        let (_, sizes) = read_csv(b"1;2;3;0.5;2\n").unwrap();
        assert_eq!(sizes.unwrap()[0].weight, 2.0);
        for (text, words) in [
            ("1,2\n", ":1: 2 numbers; a line has"),
            ("1,2,3\n1,2,3,4\n", ":2: 4 numbers, the lines before have 3"),
            ("1,2,3\n1,two,3\n", ":2: \"two\" is no number"),
            ("1,2,3\n1,,3\n", ":2: \"\" is no number"),
            ("1,2,3,4,5,6\n", ":1: 6 numbers"),
        ] {
            let fault = read_csv(text.as_bytes()).unwrap_err();
            assert!(fault.starts_with(words), "{text}: {fault}");
        }
        assert!(read_csv(b"").unwrap().0.is_empty());
    }

    #[test]
    fn raw_numbers_come_in_threes() {
        let bytes: Vec<u8> = [1.0_f32, -2.0, 0.5]
            .iter()
            .flat_map(|it| it.to_le_bytes())
            .collect();
        assert_eq!(read_raw(&bytes).unwrap().0, [DVec3::new(1.0, -2.0, 0.5)]);
        assert!(
            read_raw(&bytes[1..])
                .unwrap_err()
                .contains("11 bytes are no multiple of 12")
        );
    }
}
