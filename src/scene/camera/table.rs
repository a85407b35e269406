//! `[camera]` as files have it: eye and target, or view and projection.

use std::fmt;

use glam::{DMat4, DVec2, DVec3};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Camera, CameraMatrices, ClipY, default_fov_y, plus_z};
use crate::image::ClipRange;
use crate::scene::values::{named, read_some_vector};

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_some_vector"
    )]
    eye: Option<DVec3>,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_some_vector"
    )]
    target: Option<DVec3>,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_some_vector"
    )]
    up: Option<DVec3>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fov_y: Option<f64>,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_matrix",
        serialize_with = "write_matrix"
    )]
    view: Option<DMat4>,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_matrix",
        serialize_with = "write_matrix"
    )]
    projection: Option<DMat4>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    range: Option<ClipRange>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    y: Option<ClipY>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    near: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ray_length: Option<f64>,
    #[serde(
        default,
        skip_serializing_if = "is_zero",
        deserialize_with = "read_jitter"
    )]
    jitter: DVec2,
}

// What is read of `[camera]`.
keys! { pub(in crate::scene) CAMERA_KEYS;
    eye: VECTOR, WORLD, RequiredWithout("view"), "position of the eye";
    target: VECTOR, WORLD, RequiredWithout("view"), "the point looked at, in the middle of the image";
    up: VECTOR, NONE, Value("[0, 0, 1]"), "up in the image; need not be perpendicular to the view";
    fov_y: from_to(0.001, 179.9), DEGREES, Value("45"), "full vertical angle of view";
    near: POSITIVE, WORLD, Otherwise("1, or projection"),
        "from the eye to the projection plane, where rays begin";
    ray_length: POSITIVE, WORLD, Otherwise("past all sources"), "the length of every ray";
    jitter: PAIR, PIXELS, Value("[0, 0]"), "moves rays right and down within their pixels";
    view: Matrix, NONE, Otherwise("eye and target"), "an engine's matrix from the world to the eye";
    projection: Matrix, NONE, Otherwise("fov_y"), "an engine's matrix from the eye to clip space";
    range: Word(&["0..1", "-1..1"]), NONE, Otherwise("by the projection"), "the depths of clip space";
    y: Word(&["up", "down"]), NONE, Otherwise("by the projection"), "where y of clip space goes in the image";
}

impl TryFrom<CameraTable> for Camera {
    type Error = String;

    fn try_from(table: CameraTable) -> Result<Self, String> {
        let missing = |key: &str| format!("missing field `{key}`");
        let mut camera = match (table.view, table.projection) {
            (None, None) => {
                for (key, is_there) in [("range", table.range.is_some()), ("y", table.y.is_some())]
                {
                    if is_there {
                        let message = "it belongs to `view` and `projection`, which are not there";
                        return Err(named(key, message));
                    }
                }
                let eye = table.eye.ok_or_else(|| missing("eye"))?;
                let target = table.target.ok_or_else(|| missing("target"))?;
                Self {
                    up: table.up.unwrap_or_else(plus_z),
                    fov_y: table.fov_y.unwrap_or_else(default_fov_y),
                    ..Self::new(eye, target)
                }
            }
            (Some(view), Some(projection)) => {
                for (key, is_there) in [
                    ("eye", table.eye.is_some()),
                    ("target", table.target.is_some()),
                    ("up", table.up.is_some()),
                    ("fov_y", table.fov_y.is_some()),
                ] {
                    if is_there {
                        let message = "there are `view` and `projection`, which say it: leave one or the other out";
                        return Err(named(key, message));
                    }
                }
                Self::projecting(CameraMatrices {
                    range: table.range,
                    y: table.y,
                    ..CameraMatrices::new(view, projection)
                })
            }
            (Some(_), None) => {
                let message = "it needs a `projection` beside it: both matrices, or eye and target";
                return Err(named("view", message));
            }
            (None, Some(_)) => {
                let message = "it needs a `view` beside it: both matrices, or eye and target";
                return Err(named("projection", message));
            }
        };
        camera.near = table.near.unwrap_or(camera.near);
        camera.ray_length = table.ray_length;
        camera.jitter = table.jitter;
        Ok(camera)
    }
}

impl From<Camera> for CameraTable {
    fn from(camera: Camera) -> Self {
        let looks = camera.matrices.is_none();
        let matrices = camera.matrices;
        Self {
            eye: looks.then_some(camera.eye),
            target: looks.then_some(camera.target),
            up: looks.then_some(camera.up),
            fov_y: looks.then_some(camera.fov_y),
            view: matrices.map(|it| it.view),
            projection: matrices.map(|it| it.projection),
            range: matrices.and_then(|it| it.range),
            y: matrices.and_then(|it| it.y),
            near: Some(camera.near),
            ray_length: camera.ray_length,
            jitter: camera.jitter,
        }
    }
}

#[allow(clippy::trivially_copy_pass_by_ref)] // as serde calls it
fn is_zero(jitter: &DVec2) -> bool {
    *jitter == DVec2::ZERO
}

fn read_jitter<'de, D: Deserializer<'de>>(reader: D) -> Result<DVec2, D::Error> {
    let numbers = Vec::<f64>::deserialize(reader)?;
    let found = numbers.len();
    let numbers: [f64; 2] = numbers
        .try_into()
        .map_err(|_| D::Error::custom(format!("expected two numbers, found {found}")))?;
    Ok(numbers.into())
}

/// A number of a matrix, or one of its rows.
enum Item {
    Number(f64),
    Row(Vec<f64>),
}

impl<'de> Deserialize<'de> for Item {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        reader.deserialize_any(ItemVisitor)
    }
}

struct ItemVisitor;

impl<'de> Visitor<'de> for ItemVisitor {
    type Value = Item;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a row of 4")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Item, E> {
        Ok(Item::Number(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Item, E> {
        Ok(Item::Number(value as f64))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Item, E> {
        Ok(Item::Number(value as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut numbers: A) -> Result<Item, A::Error> {
        let mut row = Vec::with_capacity(4);
        while let Some(number) = numbers.next_element()? {
            row.push(number);
        }
        Ok(Item::Row(row))
    }
}

/// Reads 16 numbers by rows, or 4 rows of 4.
pub(in crate::scene) fn read_matrix<'de, D: Deserializer<'de>>(
    reader: D,
) -> Result<Option<DMat4>, D::Error> {
    let items = Vec::<Item>::deserialize(reader)?;
    let mut numbers = Vec::with_capacity(16);
    let mut found = format!("{} numbers", items.len());
    let has_rows = items.iter().any(|item| matches!(item, Item::Row(_)));
    for item in &items {
        match item {
            Item::Number(number) if !has_rows => numbers.push(*number),
            Item::Row(row) if row.len() == 4 => numbers.extend(row),
            Item::Row(row) => found = format!("a row of {}", row.len()),
            Item::Number(_) => found = "a number beside rows".to_owned(),
        }
    }
    if has_rows && numbers.len() == 4 * items.len() {
        found = format!("{} rows", items.len());
    }
    let numbers: [f64; 16] = numbers.try_into().map_err(|_| {
        D::Error::custom(format!(
            "expected 16 numbers by rows, or 4 rows of 4, found {found}"
        ))
    })?;
    Ok(Some(DMat4::from_cols_array(&numbers).transpose()))
}

/// Writes 4 rows of 4.
pub(in crate::scene) fn write_matrix<S: Serializer>(
    matrix: &Option<DMat4>,
    writer: S,
) -> Result<S::Ok, S::Error> {
    let rows = matrix.map(|matrix| matrix.transpose().to_cols_array_2d());
    rows.serialize(writer)
}
