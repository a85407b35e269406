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
    channels: [&'static str; 3],
    #[serde(rename = "type")]
    kind: &'static str,
    /// World space.
    low: [f64; 3],
    high: [f64; 3],
    /// Edge, world units.
    cell: f64,
    greatest: f32,
    #[serde(flatten)]
    notes: BTreeMap<&'a str, &'a str>,
}

pub(super) fn json(volume: &Volume, notes: &[(String, String)]) -> String {
    let grid = volume.grid();
    let [low, high] = grid.bounds();
    let sheet = Sheet {
        cells: grid.cells(),
        order: "x fastest, then y, then z",
        channels: ["red", "green", "blue"],
        kind: "float32, little-endian",
        low: low.to_array(),
        high: high.to_array(),
        cell: grid.cell(),
        greatest: volume.greatest(),
        notes: notes
            .iter()
            .map(|(name, value)| (name.as_str(), value.as_str()))
            .collect(),
    };
    serde_json::to_string_pretty(&sheet).unwrap_or_default() + "\n"
}
