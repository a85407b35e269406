//! OpenVDB files, versions 222 to 224 (Museth 2013; `openvdb/io` of OpenVDB 10): grids of floats and of three of them,
//! whole or half, as they are or compressed by zip or Blosc. Their active cells become the cells of a box; all others
//! are dark. Light is that of the grid `density`, or of the first of single numbers, times the grid `color`.

mod blosc;
mod cursor;
mod tree;

use std::collections::BTreeMap;

use glam::DVec3;

use super::super::texture::{DARK, Storage, check_cells, check_room, count};
use super::{Dense, Fault, Read};
use crate::shown::shown;
use cursor::Cursor;
use tree::{Bounds, Piece, Tree};

const MAGIC: u64 = 0x5644_4220;
const VERSIONS: std::ops::RangeInclusive<u32> = 222..=224;

/// What the file's head says of a grid.
struct Entry {
    name: String,
    kind: String,
    parent: String,
    begin: u64,
}

impl Entry {
    fn channels(&self) -> Option<usize> {
        match self.kind.trim_end_matches("_HalfFloat") {
            "Tree_float_5_4_3" => Some(1),
            "Tree_vec3s_5_4_3" => Some(3),
            _ => None,
        }
    }

    fn is_half(&self) -> bool {
        self.kind.ends_with("_HalfFloat")
    }
}

/// A grid before its tree.
struct Grid<'a> {
    tree: Tree<'a>,
    /// The middle of cell (0,0,0) and the edges of a cell, world space.
    place: [DVec3; 2],
}

pub(super) fn read(bytes: &[u8]) -> Read<Dense> {
    let entries = entries(bytes)?;
    let first = |channels, name: &str| {
        let fits = |it: &&Entry| it.channels() == Some(channels);
        let named = entries.iter().filter(fits).find(|it| it.name == name);
        named.map(|it| (it, true)).or_else(|| {
            let first = entries.iter().find(fits);
            first.map(|it| (it, false))
        })
    };
    let has_density = entries.iter().any(|it| it.name == "density");
    let (lights, colors) = match (first(1, "density"), first(3, "color")) {
        (Some((density, _)), Some((color, true))) => (density, Some(color)),
        (Some((density, _)), _) => (density, None),
        (None, Some((color, _))) if !has_density => (color, None),
        (None, _) => {
            let kinds: Vec<&str> = entries.iter().map(|it| it.kind.as_str()).collect();
            let message = format!(
                ": no grid that is light; it has \"{}\", read are Tree_float_5_4_3 and Tree_vec3s_5_4_3",
                shown(&kinds.join(", "))
            );
            return Err(message.into());
        }
    };
    let light = open(bytes, lights)?;
    let mut bounds = Bounds::default();
    light
        .tree
        .clone()
        .topology(&mut |piece| bounds.take(piece))?;
    let (low, cells) = around(&bounds)?;
    let channels = light.tree.channels + colors.map_or(0, |_| 4);
    check_room(cells, channels as u64).map_err(Fault::Other)?;
    let mut values = filled(light.tree, low, cells)?;
    let mut channels = lights.channels().unwrap_or(1);
    let mut of_all = DVec3::ONE;
    if let Some(entry) = colors {
        let color = open(bytes, entry)?;
        if color.place != light.place {
            return Err(": its grids of density and colour are not in one place".into());
        }
        let colors = filled(color.tree, low, cells)?;
        match one_color(&values, &colors) {
            Some(color) => of_all = color,
            None => {
                channels = 3;
                let pairs = values.iter().zip(colors.as_chunks::<3>().0);
                values = pairs
                    .flat_map(|(value, color)| color.map(|it| it * value))
                    .collect();
            }
        }
    }
    let [middle, cell] = light.place;
    let low = middle + cell * (DVec3::from(low.map(|it| it as f64)) - 0.5);
    Ok(Dense {
        cells,
        channels,
        values,
        place: Some([low, cell]),
        storage: Storage::Emission,
        color: of_all,
    })
}

/// Returns the grids that the head of a file and the heads of its grids name.
fn entries(bytes: &[u8]) -> Read<Vec<Entry>> {
    let mut head = Cursor::new(bytes, "the head");
    if head.number::<8>().map(u64::from_le_bytes).unwrap_or(0) != MAGIC {
        return Err(": no OpenVDB file".into());
    }
    let version = head.word()?;
    if !VERSIONS.contains(&version) {
        let message = format!(": version {version} of OpenVDB's files; 222 to 224 are read");
        return Err(message.into());
    }
    head.take(8)?; // the library's version
    let [has_offsets] = head.number()?;
    if has_offsets == 0 {
        return Err(
            ": it does not say where its grids are; write it to a file, not to a stream".into(),
        );
    }
    head.take(36)?; // its name among all files
    head.metadata()?;
    let number = head.word()?;
    let mut entries = Vec::new();
    for _ in 0..number {
        let (name, kind, parent) = (head.text()?, head.text()?, head.text()?);
        let [begin, _, end] = [head.long()?, head.long()?, head.long()?];
        // Grids of one name are numbered behind it.
        let name = name.split('\x1e').next().unwrap_or_default().to_owned();
        entries.push(Entry {
            name,
            kind,
            parent,
            begin,
        });
        head.seek(end)?;
    }
    Ok(entries)
}

/// Reads the head of a grid.
fn open<'a>(bytes: &'a [u8], entry: &Entry) -> Read<Grid<'a>> {
    let mut cursor = Cursor::new(bytes, &entry.name);
    if !entry.parent.is_empty() {
        return Err(cursor.fault("it shares the cells of another grid; write it as one of its own"));
    }
    cursor.seek(entry.begin)?;
    let compression = cursor.word()?;
    if compression & !tree::KNOWN != 0 {
        return Err(cursor.fault(&format!("compression {compression:#x} is not known")));
    }
    let metadata = cursor.metadata()?;
    if metadata.get("class").is_some_and(|it| it == b"level set") {
        return Err(cursor.fault("a level set, which is no light; convert it to a fog volume"));
    }
    let place = place(&mut cursor)?;
    Ok(Grid {
        tree: Tree {
            compression,
            is_half: entry.is_half(),
            channels: entry.channels().unwrap_or(1),
            background: [0.0; 3],
            cursor,
        },
        place,
    })
}

/// Reads where cells are.
fn place(cursor: &mut Cursor<'_>) -> Read<[DVec3; 2]> {
    let map = cursor.text()?;
    let [translation, cell] = match map.as_str() {
        "UniformScaleMap" | "ScaleMap" => {
            let cell = cursor.vector()?;
            cursor.take(4 * 24)?; // what follows from it
            [DVec3::ZERO, cell]
        }
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let both = [cursor.vector()?, cursor.vector()?];
            cursor.take(4 * 24)?;
            both
        }
        "TranslationMap" => [cursor.vector()?, DVec3::ONE],
        "AffineMap" | "UnitaryMap" => {
            let mut rows = [DVec3::ZERO; 4];
            for row in &mut rows {
                *row = cursor.vector()?;
                cursor.take(8)?;
            }
            let cell = DVec3::new(rows[0].x, rows[1].y, rows[2].z);
            let [x, y, z, translation] = rows;
            if [x, y, z] != [DVec3::X * cell.x, DVec3::Y * cell.y, DVec3::Z * cell.z] {
                return Err(cursor.fault("its axes are turned; those along x, y and z are read"));
            }
            [translation, cell]
        }
        other => {
            let message = format!(
                "its cells lie as \"{}\" says, which is not read",
                shown(other)
            );
            return Err(cursor.fault(&message));
        }
    };
    let is_good = cell.min_element() > 0.0 && cell.is_finite() && translation.is_finite();
    match is_good {
        true => Ok([translation, cell]),
        false => Err(cursor.fault("its cells are mirrored, or have no size")),
    }
}

/// Returns the lowest cell and the numbers of cells of the box around what is active, with a dark cell before and
/// behind: what is interpolated ends as it does in the grid.
fn around(bounds: &Bounds) -> Read<([i64; 3], [u32; 3])> {
    let Some([low, high]) = bounds.found() else {
        return Err(": none of its cells is active".into());
    };
    let edges =
        [0, 1, 2].map(|axis| (high[axis] - low[axis] + 2).clamp(0, i64::from(u32::MAX)) as u32);
    check_cells(edges).map_err(|wrong| format!(": its active cells are too far apart: {wrong}"))?;
    Ok((low.map(|it| it - 1), edges))
}

/// Returns the values of all cells of a box, side by side for each; dark where none is active.
fn filled(mut tree: Tree<'_>, low: [i64; 3], cells: [u32; 3]) -> Read<Vec<f32>> {
    let channels = tree.channels;
    let mut values = vec![0.0_f32; channels * count(cells)];
    let mut put = |place: [i64; 3], value: &[f32]| {
        let at = [0, 1, 2].map(|axis| place[axis] - low[axis]);
        let is_in = (0..3).all(|axis| (0..i64::from(cells[axis])).contains(&at[axis]));
        if is_in {
            let [x, y, z] = at.map(|it| it as usize);
            let index = (z * cells[1] as usize + y) * cells[0] as usize + x;
            values[channels * index..][..channels].copy_from_slice(value);
        }
    };
    let mut leaves = Vec::new();
    tree.topology(&mut |piece| match piece {
        Piece::Leaf { origin, .. } => leaves.push(origin),
        Piece::Tile {
            origin,
            edge,
            value,
        } => {
            let range = |axis: usize| {
                let last = low[axis] + i64::from(cells[axis]);
                origin[axis].max(low[axis])..(origin[axis] + edge).min(last)
            };
            for z in range(2) {
                for y in range(1) {
                    range(0).for_each(|x| put([x, y, z], &value[..channels]));
                }
            }
        }
    })?;
    for origin in leaves {
        tree.leaf(&mut |[x, y, z], value| {
            put([origin[0] + x, origin[1] + y, origin[2] + z], value);
        })?;
    }
    Ok(values)
}

/// Returns the colour that all cells with light have, if it is one.
fn one_color(values: &[f32], colors: &[f32]) -> Option<DVec3> {
    let pairs = values.iter().zip(colors.as_chunks::<3>().0);
    let mut lit = pairs
        .filter(|(value, _)| **value != 0.0)
        .map(|(_, color)| color);
    let first = lit.next()?;
    let is_color = first.iter().all(|it| (0.0..=DARK).contains(it));
    (is_color && lit.all(|color| color == first)).then(|| DVec3::from(first.map(f64::from)))
}

/// Texts and numbers that a file or a grid says of itself.
type Metadata = BTreeMap<String, Vec<u8>>;
