//! Numbers that a JSON beside them describes, as `file/raw.rs` writes it.

use std::fs;
use std::path::Path;

use glam::DVec3;
use serde::Deserialize;

use super::bytes::Number;
use super::{Dense, Read, check_size, color_of, storage_of};

#[derive(Deserialize)]
struct Sheet {
    cells: [u32; 3],
    #[serde(default)]
    channels: Vec<String>,
    #[serde(default)]
    low: Option<[f64; 3]>,
    #[serde(default)]
    cell: Option<f64>,
    #[serde(default)]
    layers: Option<[u32; 2]>,
    #[serde(default)]
    storage: Option<String>,
    #[serde(default)]
    power: Option<String>,
    #[serde(default)]
    color: Option<String>,
}

pub(super) fn read(path: &Path, bytes: &[u8]) -> Read<Dense> {
    let json = fs::read_to_string(path.with_extension("json"))
        .map_err(|error| format!(": the .json beside it cannot be read: {error}"))?;
    let sheet: Sheet = serde_json::from_str(&json)
        .map_err(|error| format!(": the .json beside it is not that of a volume: {error}"))?;
    if sheet.layers.is_some() {
        return Err(": the .json beside it is that of layers in an image".into());
    }
    let channels = match sheet.channels.len() {
        0 | 1 => 1,
        channels @ (2..=4 | 6) => channels,
        other => return Err(format!(": {other} channels; 1 to 4 or 6 are read").into()),
    };
    let number = Number::Float;
    let data = check_size(sheet.cells, channels * number.bytes(), bytes)?;
    if data.len() != bytes.len() {
        let message = format!(
            ": {} bytes; {} are those of its cells, float32",
            bytes.len(),
            data.len()
        );
        return Err(message.into());
    }
    let place = sheet.low.zip(sheet.cell);
    let is_good = |[x, y, z]: [f64; 3], cell: f64| [x, y, z, cell].iter().all(|it| it.is_finite());
    if place.is_some_and(|(low, cell)| !is_good(low, cell) || cell <= 0.0) {
        return Err(": the .json beside it says no place that a volume has".into());
    }
    Ok(Dense {
        cells: sheet.cells,
        channels,
        values: number.read(data, false),
        place: place.map(|(low, cell)| [DVec3::from(low), DVec3::splat(cell)]),
        storage: storage_of(sheet.storage.as_deref(), sheet.power.as_deref())?,
        color: color_of(sheet.color.as_deref())?,
    })
}
