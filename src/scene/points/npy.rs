//! Reads NumPy's `.npy`: a magic word, the version, the length of a header, the header as a Python dictionary, then the
//! numbers (NEP 1, "A simple file format for NumPy arrays"). Arrays of shape (n, 3), float32 or float64, are positions.

use std::ops::RangeInclusive;

use super::file::{Read, vectors};

const MAGIC: &[u8] = b"\x93NUMPY";

pub(super) fn read(bytes: &[u8]) -> Read {
    let (numbers, _) = numbers(bytes, 3..=3, "(n, 3)")?;
    Ok((vectors(numbers), None))
}

/// Reads an array of two dimensions, by rows; gives the numbers, and how many columns there are.
pub(super) fn numbers(
    bytes: &[u8],
    columns: RangeInclusive<usize>,
    shapes: &str,
) -> Result<(Vec<f64>, usize), String> {
    let (header, numbers) = parts(bytes).ok_or_else(|| {
        ": it does not begin as a .npy of NumPy does; numpy.save writes such files".to_owned()
    })?;
    let wrong = |what: String| {
        format!(": {what}; particles are an array of shape {shapes}, float32 or float64, by rows")
    };
    if value(header, "fortran_order") != Some("False") {
        return Err(wrong("the array is not by rows (fortran_order)".to_owned()));
    }
    let shape = value(header, "shape").unwrap_or_default();
    let sizes = shape.trim_matches(['(', ')']).split(',').map(str::trim);
    let sizes: Vec<&str> = sizes.filter(|it| !it.is_empty()).collect();
    let is_shape = |it: &str| it.parse().ok().filter(|it| columns.contains(it));
    let (count, across) = match sizes.as_slice() {
        [count, across] => (*count, is_shape(across)),
        _ => ("", None),
    };
    let Some(across) = across else {
        return Err(wrong(format!(
            "its shape is {}",
            crate::shown::shown(shape)
        )));
    };
    let kind = value(header, "descr")
        .unwrap_or_default()
        .trim_matches(['\'', '"']);
    let size = match kind {
        "<f4" => 4,
        "<f8" => 8,
        other => return Err(wrong(format!("its type is {}", crate::shown::shown(other)))),
    };
    let needed = count
        .parse::<usize>()
        .ok()
        .and_then(|count| count.checked_mul(across * size));
    if needed != Some(numbers.len()) {
        return Err(wrong(format!(
            "{} bytes of numbers are not of shape {shape}",
            numbers.len()
        )));
    }
    let values = match size {
        4 => {
            let (numbers, _) = numbers.as_chunks();
            let value = |it: &[u8; 4]| f64::from(f32::from_le_bytes(*it));
            numbers.iter().map(value).collect()
        }
        _ => {
            let (numbers, _) = numbers.as_chunks();
            let value = |it: &[u8; 8]| f64::from_le_bytes(*it);
            numbers.iter().map(value).collect()
        }
    };
    Ok((values, across))
}

/// Takes a file apart: its header, and the bytes of the numbers.
fn parts(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (length, rest) = match rest {
        [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
        [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        _ => return None,
    };
    let (header, numbers) = rest.split_at_checked(length)?;
    Some((std::str::from_utf8(header).ok()?, numbers))
}

/// Returns the text of a value of the header.
fn value<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let begin = header.find(&format!("'{key}'"))? + key.len() + 2;
    let rest = header[begin..].trim_start().strip_prefix(':')?.trim_start();
    let end = match rest.starts_with('(') {
        true => rest.find(')')? + 1,
        false => rest.find([',', '}'])?,
    };
    Some(rest[..end].trim())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn array(header: &str, numbers: &[u8]) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.bytes());
        bytes.extend(numbers);
        bytes
    }

    #[test]
    fn arrays_of_three_columns_are_positions_and_others_are_told() {
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }  \n";
        let numbers: Vec<u8> = (0..6).flat_map(|k| (k as f32).to_le_bytes()).collect();
        let found = read(&array(header, &numbers)).unwrap().0;
        assert_eq!(
            found,
            [DVec3::new(0.0, 1.0, 2.0), DVec3::new(3.0, 4.0, 5.0)]
        );
        let doubles: Vec<u8> = (0..6).flat_map(|k| f64::from(k).to_le_bytes()).collect();
        let of_f8 = array(&header.replace("<f4", "<f8"), &doubles);
        assert_eq!(read(&of_f8).unwrap().0, found);
        for (from, to, words) in [
            ("(2, 3)", "(6,)", "its shape is (6,)"),
            ("(2, 3)", "(3, 3)", "24 bytes of numbers"),
            ("<f4", "<i4", "its type is <i4"),
            ("False", "True", "not by rows"),
        ] {
            let fault = read(&array(&header.replace(from, to), &numbers)).unwrap_err();
            assert!(fault.contains(words), "{fault}");
        }
        assert!(
            read(b"\x93NUMPY\x01")
                .unwrap_err()
                .contains("does not begin")
        );
    }
}
