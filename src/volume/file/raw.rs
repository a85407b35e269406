//! What a JSON says of the numbers beside it.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::volume::Volume;

#[derive(Serialize)]
struct Sheet<'a> {
    /// Cells along x, y, z.
    cells: [u32; 3],
    /// Which of them lie side by side in the file.
    order: &'static str,
    channels: &'static [&'static str],
    #[serde(rename = "type")]
    kind: &'static str,
    /// World space.
    low: [f64; 3],
    high: [f64; 3],
    /// Edge, world units.
    cell: f64,
    greatest: f32,
    /// Layers side by side, and below each other.
    #[serde(skip_serializing_if = "Option::is_none")]
    layers: Option<[u32; 2]>,
    #[serde(flatten)]
    notes: BTreeMap<&'a str, &'a str>,
}

pub(super) fn json(
    volume: &Volume,
    (layers, channels): (Option<[u32; 2]>, usize),
    notes: &[(String, String)],
) -> String {
    let grid = volume.grid();
    let [low, high] = grid.bounds();
    let sheet = Sheet {
        cells: grid.cells(),
        order: match layers {
            Some(_) => "a layer of x and y for each z, the first on the top left",
            None => "x fastest, then y, then z",
        },
        channels: match layers {
            Some(_) => &["red", "green", "blue", "alpha: the largest of them"],
            None => match channels {
                1 => &["density"],
                2 => &["density", "rest"],
                3 => &["red", "green", "blue"],
                _ => &[
                    "red",
                    "green",
                    "blue",
                    "rest red",
                    "rest green",
                    "rest blue",
                ],
            },
        },
        kind: match layers {
            Some(_) => "OpenEXR",
            None => "float32, little-endian",
        },
        low: low.to_array(),
        high: high.to_array(),
        cell: grid.cell(),
        greatest: volume.greatest(),
        layers,
        notes: notes
            .iter()
            .map(|(name, value)| (name.as_str(), value.as_str()))
            .collect(),
    };
    serde_json::to_string_pretty(&sheet).unwrap_or_default() + "\n"
}
