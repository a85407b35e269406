//! Reads Wavefront OBJ: `v` with x, y and z, and `f` with the numbers of vertices, from 1 on, or back from the last
//! one. A face of more corners is cut into a fan of triangles. All else, such as materials, is passed over.

use glam::DVec3;

use super::file::Read;
use super::list::MOST;
use crate::shown::shown;

pub(super) fn read(bytes: &[u8]) -> Read {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let mut face = Vec::new();
    let mut lines = bytes.split(|byte| *byte == b'\n').enumerate();
    while let Some((number, line)) = lines.next() {
        // Names and remarks may be in any encoding.
        let mut line = String::from_utf8_lossy(line).into_owned();
        while let Some(begun) = line.trim_end().strip_suffix('\\').map(str::len) {
            line.truncate(begun);
            line.push(' ');
            let more = lines.next().map_or(&[][..], |(_, it)| it);
            line.push_str(&String::from_utf8_lossy(more));
        }
        let mut words = line.split_whitespace();
        let added = match words.next() {
            Some("v") => vertex(words).map(|vertex| vertices.push(vertex)),
            Some("f") => {
                face.clear();
                corners(words, vertices.len(), &mut face).map(|()| {
                    let rest = face.windows(2).skip(1);
                    triangles.extend(rest.map(|pair| [face[0], pair[0], pair[1]]));
                })
            }
            _ => Ok(()),
        };
        added.map_err(|message| format!(":{}: {message}", number + 1))?;
        if vertices.len().max(triangles.len()) > MOST {
            return Err(format!(": more than {MOST} vertices or triangles"));
        }
    }
    Ok((vertices, triangles))
}

/// Reads three coordinates; a weight or a colour behind them is passed over.
fn vertex<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<DVec3, String> {
    let mut place = [0.0; 3];
    for coordinate in &mut place {
        let word = words.next().ok_or("a vertex has x, y and z")?;
        let number = word.parse();
        *coordinate = number.map_err(|_| format!("\"{}\" is no number", shown(word)))?;
    }
    Ok(place.into())
}

/// Reads the corners of a face, each `vertex`, `vertex/texture`, `vertex//normal` or `vertex/texture/normal`.
fn corners<'a>(
    words: impl Iterator<Item = &'a str>,
    count: usize,
    face: &mut Vec<u32>,
) -> Result<(), String> {
    for word in words.take_while(|word| !word.starts_with('#')) {
        let number: i64 = word
            .split('/')
            .next()
            .and_then(|number| number.parse().ok())
            .ok_or_else(|| format!("\"{}\" is no corner of a face", shown(word)))?;
        let index = match number {
            1.. => number - 1,
            _ => (count as i64).saturating_add(number),
        };
        if number == 0 || index < 0 || index >= count as i64 {
            return Err(format!(
                "a face names vertex {number}, and there are {count} before it"
            ));
        }
        face.push(index as u32);
    }
    match face.len() {
        3.. => Ok(()),
        found => Err(format!("a face of {found} corners; it has 3 or more")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_cut_into_triangles_and_what_else_stands_there_is_passed_over() {
        let text =
            b"mtllib x.mtl\no square\nv 0 0 0 1.0\nv 1 0 0\r\nv 1 1 \\\n 0\nv 0 1e0 0\nvn 0 0 1\n\
            usemtl \xff\nf 1/1/1 2//1 3/4 4 # all\nf -4 -3 -2\n";
        let (vertices, triangles) = read(text).unwrap();
        assert_eq!(vertices.len(), 4);
        assert_eq!(vertices[2], DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    }

    #[test]
    fn broken_lines_are_named() {
        for (text, words) in [
            ("v 0 0\n", ":1: a vertex has x, y and z"),
            ("v 0 0 0\nv 0 zero 0\n", ":2: \"zero\" is no number"),
            (
                "v 0 0 0\nf 1 1 2\n",
                ":2: a face names vertex 2, and there are 1",
            ),
            ("v 0 0 0\nf 1 1 0\n", ":2: a face names vertex 0"),
            ("v 0 0 0\nf 1 1 -2\n", ":2: a face names vertex -2"),
            ("v 0 0 0\nf 1 1\n", ":2: a face of 2 corners"),
            ("v 0 0 0\nf 1 1 one\n", ":2: \"one\" is no corner"),
            (
                "v 0 0 0\nf 9223372036854775807 -9223372036854775808 1\n",
                ":2: a face names",
            ),
        ] {
            let fault = read(text.as_bytes()).unwrap_err();
            assert!(fault.starts_with(words), "{text}: {fault}");
        }
        assert!(read(b"").unwrap().0.is_empty());
    }
}
