//! Reads points of light from files: positions, and what each has of its own of a colour, a coefficient and a radius.
//! Every fault says the file, and the row and column.

use std::fs;
use std::path::Path;

use glam::DVec3;

use super::{MOST_POINTS, Origin, PointList, PointSize, npy, ply};
use crate::error::SceneError;
use crate::scene::values::LARGEST;
use crate::shown::shown;

/// What a column may be called, in the order that files without names have.
const NAMES: [&str; 8] = ["x", "y", "z", "r", "g", "b", "coefficient", "radius"];

/// Rows of such values, 1 where a file has none, and which columns it has.
type Rows = (Vec<[f64; 8]>, [bool; 8]);

pub(super) fn open(path: &Path) -> Result<PointList, SceneError> {
    let name = path.display().to_string();
    let name = shown(&name);
    let fault = |message: String| SceneError::value("file", format!("{name}{message}"));
    let ending = path.extension().unwrap_or_default();
    let read: fn(&[u8]) -> Result<Rows, String> =
        match ending.to_string_lossy().to_lowercase().as_str() {
            "csv" => read_csv,
            "npy" => read_npy,
            "ply" => ply::read_lit,
            _ => {
                return Err(fault(
                    ": points of light are in files that end in .csv, .npy or .ply".to_owned(),
                ));
            }
        };
    let bytes = fs::read(path).map_err(|error| fault(format!(": cannot read: {error}")))?;
    let rows = read(&bytes).map_err(fault)?;
    let full = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    list(&rows, Origin::File(full)).map_err(fault)
}

/// Makes the list of what was read.
fn list((rows, has): &Rows, origin: Origin) -> Result<PointList, String> {
    for (index, row) in rows.iter().enumerate() {
        let is_right = |value: &f64| value.abs() <= LARGEST;
        if let Some(column) = row.iter().position(|it| !is_right(it)) {
            let (name, value) = (NAMES[column], row[column]);
            return Err(format!(
                ": {name} of point {index}, column {}, is {value}; numbers are finite, up to {LARGEST:e}",
                column + 1
            ));
        }
    }
    let positions = rows.iter().map(|it| DVec3::new(it[0], it[1], it[2]));
    let lights = has[3..7].contains(&true).then(|| {
        let light = |it: &[f64; 8]| [3, 4, 5].map(|k| (it[k] * it[6]) as f32);
        rows.iter().map(light).collect()
    });
    let sizes = has[7].then(|| {
        let size = |it: &[f64; 8]| PointSize {
            radius: it[7],
            weight: 1.0,
        };
        rows.iter().map(size).collect()
    });
    PointList::checked(positions.collect(), (sizes, lights), origin)
        .map_err(|wrong| format!(": {}", wrong.message))
}

/// Returns which columns a file without names has.
fn unnamed(count: usize) -> Option<&'static [usize]> {
    Some(match count {
        3 => &[0, 1, 2],
        4 => &[0, 1, 2, 6],
        5 => &[0, 1, 2, 6, 7],
        6 => &[0, 1, 2, 3, 4, 5],
        7 => &[0, 1, 2, 3, 4, 5, 6],
        8 => &[0, 1, 2, 3, 4, 5, 6, 7],
        _ => return None,
    })
}

fn read_npy(bytes: &[u8]) -> Result<Rows, String> {
    let (numbers, across) = npy::numbers(bytes, 3..=8, "(n, 3) to (n, 8)")?;
    let columns = unnamed(across).unwrap_or_default();
    let rows = numbers.chunks_exact(across).map(|it| row(columns, it));
    Ok((rows.collect(), has(columns)))
}

fn has(columns: &[usize]) -> [bool; 8] {
    std::array::from_fn(|column| columns.contains(&column))
}

fn row(columns: &[usize], numbers: &[f64]) -> [f64; 8] {
    let mut row = [1.0; 8];
    for (column, number) in columns.iter().zip(numbers) {
        row[*column] = *number;
    }
    row
}

/// Reads lines of numbers, all of one length; what begins with `#` is a remark, and words in the first line are names
/// of columns.
fn read_csv(bytes: &[u8]) -> Result<Rows, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| ": it is no text (UTF-8)".to_owned())?;
    let text = text.trim_start_matches('\u{feff}');
    let mut rows = Vec::new();
    let mut columns: Option<Vec<usize>> = None;
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let fields: Vec<&str> = match line.contains([',', ';']) {
            true => line.split([',', ';']).map(str::trim).collect(),
            false => line.split_whitespace().collect(),
        };
        let at = |message: String| format!(":{}: {message}", index + 1);
        let Some(known) = &columns else {
            let (found, is_named) = columns_of(&fields).map_err(at)?;
            if !is_named {
                rows.push(numbers(&fields, &found).map_err(at)?);
            }
            columns = Some(found);
            continue;
        };
        if rows.len() == MOST_POINTS {
            return Err(at(format!("there may be {MOST_POINTS} points")));
        }
        rows.push(numbers(&fields, known).map_err(at)?);
    }
    let columns = columns.unwrap_or_default();
    Ok((rows, has(&columns)))
}

/// Returns the columns that the first line names or has, and whether it names them.
fn columns_of(fields: &[&str]) -> Result<(Vec<usize>, bool), String> {
    let is_number = |field: &&str| field.parse::<f64>().is_ok();
    if fields.iter().any(is_number) {
        let columns = unnamed(fields.len()).ok_or_else(|| {
            let found = fields.len();
            format!(
                "{found} columns; without names there are 3 to 8: {}",
                NAMES.join(", ")
            )
        })?;
        return Ok((columns.to_vec(), false));
    }
    let mut columns = Vec::new();
    for (place, field) in fields.iter().enumerate() {
        let name = field.trim_matches('"').to_lowercase();
        let column = NAMES.iter().position(|it| *it == name).ok_or_else(|| {
            let known = NAMES.join(", ");
            format!(
                "column {} is called \"{}\"; columns are {known}",
                place + 1,
                shown(field)
            )
        })?;
        if columns.contains(&column) {
            return Err(format!("column {} is the second {name}", place + 1));
        }
        columns.push(column);
    }
    match (0..3).find(|it| !columns.contains(it)) {
        Some(missing) => Err(format!("no column is called {}", NAMES[missing])),
        None => Ok((columns, true)),
    }
}

fn numbers(fields: &[&str], columns: &[usize]) -> Result<[f64; 8], String> {
    if fields.len() != columns.len() {
        let (found, expected) = (fields.len(), columns.len());
        return Err(format!("{found} columns, the lines before have {expected}"));
    }
    let mut row = [1.0; 8];
    for (place, (field, column)) in fields.iter().zip(columns).enumerate() {
        let value: Option<f64> = field.parse().ok();
        row[*column] = value.filter(|it| it.is_finite()).ok_or_else(|| {
            let name = NAMES[*column];
            format!(
                "column {}, {name}: \"{}\" is no number",
                place + 1,
                shown(field)
            )
        })?;
    }
    Ok(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_named_or_in_order_and_broken_rows_are_named() {
        let (rows, has) = read_csv(b"r,g,b,z,y,x\n1,2,3,4,5,6\n").unwrap();
        assert_eq!(rows, [[6.0, 5.0, 4.0, 1.0, 2.0, 3.0, 1.0, 1.0]]);
        assert_eq!(has, [true, true, true, true, true, true, false, false]);
        let (rows, _) = read_csv(b"# x y z c\n1 2 3 0.5\n\n4 5 6 -2\n").unwrap();
        assert_eq!((rows.len(), rows[1][6]), (2, -2.0));
        for (text, words) in [
            ("x,y,z,w\n1,2,3,4\n", ":1: column 4 is called \"w\""),
            ("x,y,r\n1,2,3\n", ":1: no column is called z"),
            ("x,y,z,x\n", ":1: column 4 is the second x"),
            ("1,2\n", ":1: 2 columns; without names"),
            (
                "x,y,z\n1,2,3\n1,2\n",
                ":3: 2 columns, the lines before have 3",
            ),
            ("1,2,3\n4,NaN,6\n", ":2: column 2, y: \"NaN\" is no number"),
            (
                "1,2,3\n4,five,6\n",
                ":2: column 2, y: \"five\" is no number",
            ),
        ] {
            let fault = read_csv(text.as_bytes()).unwrap_err();
            assert!(fault.contains(words), "{text}: {fault}");
        }
    }

    #[test]
    fn vertices_have_colours_of_bytes_or_floats() {
        let head = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
            property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
        let mut bytes = head.as_bytes().to_vec();
        for value in [1.0_f32, 2.0, 3.0] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend([255, 0, 188]);
        let (rows, has) = ply::read_lit(&bytes).unwrap();
        assert_eq!(rows[0][..5], [1.0, 2.0, 3.0, 1.0, 0.0]);
        assert!((rows[0][5] - 0.502_886).abs() < 1e-5 && has[5] && !has[6]);
        let cut = ply::read_lit(&bytes[..bytes.len() - 1]).unwrap_err();
        assert!(cut.contains("ends within vertex 0 of 1"), "{cut}");
        let many = head.replace("vertex 1", "vertex 2147483648");
        let many = ply::read_lit(many.as_bytes()).unwrap_err();
        assert!(many.contains("2147483648 vertices; there may be"), "{many}");
    }

    #[test]
    fn what_is_no_number_is_told_with_row_and_column() {
        let rows = (
            vec![[0.0; 8], [0.0, 0.0, 0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0]],
            [true; 8],
        );
        let fault = list(&rows, Origin::Given).unwrap_err();
        assert!(fault.contains("g of point 1, column 5, is NaN"), "{fault}");
    }
}
