//! Reads the vertices of PLY files (Turk 1994): a header that names elements and the types of their properties, then
//! the elements, as text or binary. Of the vertices x, y and z are read, and where they have them radius and weight.

use glam::DVec3;

use super::file::Read;
use super::{MOST_POINTS, PointSize};
use crate::scene::colors::decoded;
use crate::shown::shown;

/// What is read of a vertex; the first three it must have.
const NAMES: [&str; COUNT] = [
    "x",
    "y",
    "z",
    "radius",
    "weight",
    "red",
    "green",
    "blue",
    "coefficient",
];
const COUNT: usize = 9;

/// Without them.
const ABSENT: [f64; COUNT] = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0];

#[derive(Debug, Clone, Copy, PartialEq)]
enum Format {
    Text,
    LittleEndian,
    BigEndian,
}

/// The type of a number: its bytes, and whether it is signed or a float.
#[derive(Debug, Clone, Copy)]
struct Number {
    size: usize,
    is_float: bool,
    is_signed: bool,
}

struct Header {
    format: Format,
    /// How many vertices there are, and their properties in order: which of the names each is, and its type.
    count: usize,
    properties: Vec<(Option<usize>, Number)>,
}

pub(super) fn read(bytes: &[u8]) -> Read {
    let (header, body) = parts(bytes)?;
    let has = |name: usize| header.properties.iter().any(|(it, _)| *it == Some(name));
    if !(0..3).all(has) {
        return Err(": its vertices have no x, y and z".to_owned());
    }
    let (mut positions, mut sizes) = (Vec::new(), Vec::new());
    let mut add = |values: &[f64; COUNT]| {
        positions.push(DVec3::new(values[0], values[1], values[2]));
        sizes.push(PointSize {
            radius: values[3],
            weight: values[4],
        });
    };
    match header.format {
        Format::Text => read_text(&header, body, &mut add)?,
        _ => read_binary(&header, body, &mut add)?,
    }
    if has(4) && !has(3) {
        return Err(
            ": its vertices have a weight but no radius; both are read, or the radius".to_owned(),
        );
    }
    Ok((positions, has(3).then_some(sizes)))
}

/// Reads points of light: position, red, green, blue, coefficient and radius of each, and which the file has.
pub(super) fn read_lit(bytes: &[u8]) -> Result<(Vec<[f64; 8]>, [bool; 8]), String> {
    const ORDER: [usize; 8] = [0, 1, 2, 5, 6, 7, 8, 3];
    let (header, body) = parts(bytes)?;
    let has = |name: usize| header.properties.iter().any(|(it, _)| *it == Some(name));
    if !(0..3).all(has) {
        return Err(": its vertices have no x, y and z".to_owned());
    }
    if header.count > MOST_POINTS {
        return Err(format!(
            ": {} vertices; there may be {MOST_POINTS}",
            header.count
        ));
    }
    let is_byte =
        |name: usize, (it, number): &(Option<usize>, Number)| *it == Some(name) && number.size == 1;
    let are_bytes = [5, 6, 7].map(|name| header.properties.iter().any(|it| is_byte(name, it)));
    let mut rows = Vec::new();
    let mut add = |values: &[f64; COUNT]| {
        let mut row = ORDER.map(|name| values[name]);
        for (value, is_byte) in row[3..6].iter_mut().zip(are_bytes) {
            if is_byte {
                *value = decoded(*value / 255.0);
            }
        }
        rows.push(row);
    };
    match header.format {
        Format::Text => read_text(&header, body, &mut add)?,
        _ => read_binary(&header, body, &mut add)?,
    }
    Ok((rows, ORDER.map(has)))
}

fn read_text(
    header: &Header,
    body: &[u8],
    add: &mut dyn FnMut(&[f64; COUNT]),
) -> Result<(), String> {
    let text = std::str::from_utf8(body).map_err(|_| ": it is no text (UTF-8)".to_owned())?;
    let mut words = text.split_whitespace();
    for vertex in 0..header.count {
        let mut values = ABSENT;
        for (name, _) in &header.properties {
            let word = words.next().ok_or_else(|| cut_off(vertex, header))?;
            let value = word
                .parse()
                .map_err(|_| format!(": \"{}\" is no number, of vertex {vertex}", shown(word)))?;
            if let Some(name) = name {
                values[*name] = value;
            }
        }
        add(&values);
    }
    Ok(())
}

fn read_binary(
    header: &Header,
    body: &[u8],
    add: &mut dyn FnMut(&[f64; COUNT]),
) -> Result<(), String> {
    let record: usize = header
        .properties
        .iter()
        .map(|(_, number)| number.size)
        .sum();
    for vertex in 0..header.count {
        let at = vertex * record;
        let bytes = body
            .get(at..at + record)
            .ok_or_else(|| cut_off(vertex, header))?;
        let mut values = ABSENT;
        let mut at = 0;
        for (name, number) in &header.properties {
            if let Some(name) = name {
                values[*name] = number.value(&bytes[at..at + number.size], header.format);
            }
            at += number.size;
        }
        add(&values);
    }
    Ok(())
}

fn cut_off(vertex: usize, header: &Header) -> String {
    format!(
        ": it ends within vertex {vertex} of {}; the file is cut off",
        header.count
    )
}

impl Number {
    fn named(name: &str) -> Option<Self> {
        let number = |size, is_float, is_signed| {
            Some(Self {
                size,
                is_float,
                is_signed,
            })
        };
        match name {
            "char" | "int8" => number(1, false, true),
            "uchar" | "uint8" => number(1, false, false),
            "short" | "int16" => number(2, false, true),
            "ushort" | "uint16" => number(2, false, false),
            "int" | "int32" => number(4, false, true),
            "uint" | "uint32" => number(4, false, false),
            "float" | "float32" => number(4, true, true),
            "double" | "float64" => number(8, true, true),
            _ => None,
        }
    }

    fn value(self, bytes: &[u8], format: Format) -> f64 {
        let mut word = [0; 8];
        for (to, from) in word.iter_mut().zip(bytes) {
            *to = *from;
        }
        if format == Format::BigEndian {
            word[..self.size].reverse();
        }
        let bits = u64::from_le_bytes(word);
        match (self.is_float, self.is_signed, self.size) {
            (true, _, 4) => f64::from(f32::from_bits(bits as u32)),
            (true, ..) => f64::from_bits(bits),
            (false, true, size) => {
                let unused = 64 - 8 * size as u32;
                ((bits << unused) as i64 >> unused) as f64
            }
            _ => bits as f64,
        }
    }
}

/// Takes a file apart: what its header says, and the bytes behind it.
fn parts(bytes: &[u8]) -> Result<(Header, &[u8]), String> {
    const END: &[u8] = b"end_header";
    let is_end = |window: &[u8]| window == END;
    let end = bytes.windows(END.len()).position(is_end);
    let (Some(end), true) = (end, bytes.starts_with(b"ply")) else {
        return Err(": it does not begin as a PLY file does".to_owned());
    };
    let text = String::from_utf8_lossy(&bytes[..end]);
    let rest = &bytes[end + END.len()..];
    let rest = rest.strip_prefix(b"\r").unwrap_or(rest);
    let body = rest.strip_prefix(b"\n").unwrap_or(rest);
    let mut header = Header {
        format: Format::Text,
        count: 0,
        properties: Vec::new(),
    };
    let mut element = None;
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            ["format", name, ..] => {
                header.format = match *name {
                    "ascii" => Format::Text,
                    "binary_little_endian" => Format::LittleEndian,
                    "binary_big_endian" => Format::BigEndian,
                    other => return Err(format!(": format {} is unknown", shown(other))),
                }
            }
            ["element", "vertex", count] if element.is_none() => {
                header.count = count
                    .parse()
                    .map_err(|_| ": the number of its vertices is none".to_owned())?;
                element = Some("vertex");
            }
            ["element", ..] if element.is_none() => {
                return Err(
                    ": something stands before its vertices, which must come first".to_owned(),
                );
            }
            ["element", ..] => element = Some("other"),
            ["property", kind, name] if element == Some("vertex") => {
                let number = Number::named(kind)
                    .ok_or_else(|| format!(": type {} is unknown", shown(kind)))?;
                header
                    .properties
                    .push((NAMES.iter().position(|it| it == name), number));
            }
            ["property", "list", ..] if element == Some("vertex") => {
                return Err(": its vertices have a list, which particles have not".to_owned());
            }
            _ => {}
        }
    }
    Ok((header, body))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 2\nproperty float x\n\
        property float y\nproperty uchar red\nproperty float z\nelement face 0\n\
        property list uchar int vertex_indices\nend_header\n1 2 255 3\n4 5 0 6.5\n";

    #[test]
    fn vertices_are_read_as_text_and_binary() {
        let expected = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.5)];
        assert_eq!(read(TEXT.as_bytes()).unwrap().0, expected);
        for (format, is_big) in [("binary_little_endian", false), ("binary_big_endian", true)] {
            let head = TEXT
                .split("1 2 255")
                .next()
                .unwrap()
                .replace("ascii", format);
            let mut bytes = head.into_bytes();
            for position in expected {
                for (axis, value) in position.to_array().into_iter().enumerate() {
                    if axis == 2 {
                        bytes.push(255);
                    }
                    let value = value as f32;
                    bytes.extend(if is_big {
                        value.to_be_bytes()
                    } else {
                        value.to_le_bytes()
                    });
                }
            }
            assert_eq!(read(&bytes).unwrap().0, expected);
            let fault = read(&bytes[..bytes.len() - 1]).unwrap_err();
            assert!(fault.contains("ends within vertex 1 of 2"), "{fault}");
        }
        let sized = TEXT
            .replace("uchar red", "float radius")
            .replace("255", "0.5")
            .replace(" 0 6.5", " 0.25 6.5");
        assert_eq!(read(sized.as_bytes()).unwrap().1.unwrap()[1].radius, 0.25);
        for (from, to, words) in [
            ("float z", "float w", "no x, y and z"),
            ("ply", "pli", "does not begin"),
            ("6.5", "six", "is no number, of vertex 1"),
            ("uchar red", "list uchar int red", "have a list"),
        ] {
            let fault = read(TEXT.replacen(from, to, 1).as_bytes()).unwrap_err();
            assert!(fault.contains(words), "{from}: {fault}");
        }
        let number = |kind: &str, bytes: &[u8]| {
            Number::named(kind)
                .unwrap()
                .value(bytes, Format::LittleEndian)
        };
        assert_eq!(
            (number("char", &[0xff]), number("uchar", &[0xff])),
            (-1.0, 255.0)
        );
    }
}
