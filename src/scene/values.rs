//! The checks of single values, and the reading of vectors. A check that passes allocates no string.

use std::borrow::Cow;

use glam::DVec3;
use serde::{Deserialize, Deserializer};

use crate::error::SceneError;

/// Largest magnitude of any number, smallest of a positive one: squares and cubes of what lies between stay finite and
/// normal in the devices' float32.
pub(super) const LARGEST: f64 = 1e9;
pub(super) const SMALLEST: f64 = 1e-9;

pub(crate) type Checked = Result<(), Fault>;

/// A value at fault in a table: its key there, and what is wrong with it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fault {
    key: Cow<'static, str>,
    message: String,
}

impl Fault {
    pub(crate) fn new(key: impl Into<Cow<'static, str>>, message: impl Into<String>) -> Self {
        Self {
            key: key.into(),
            message: message.into(),
        }
    }

    /// Returns its key in the table.
    pub(super) fn key(&self) -> &str {
        &self.key
    }

    /// Says what is wrong.
    pub(super) fn message(&self) -> &str {
        &self.message
    }

    /// Moves the fault into a table of its table, such as `control[1]`.
    pub(super) fn within(self, table: &str) -> Self {
        let key = format!("{table}.{}", self.key);
        self.at(key.into())
    }

    /// Moves the fault to another key.
    pub(crate) fn at(self, key: Cow<'static, str>) -> Self {
        Self { key, ..self }
    }

    /// Makes it the fault of a table of the scene, such as `camera` or `torus[1]`.
    pub(super) fn of(self, table: &str) -> SceneError {
        match table {
            "" => SceneError::value(self.key, self.message),
            table if self.key.is_empty() => SceneError::value(table, self.message),
            table => SceneError::value(format!("{table}.{}", self.key), self.message),
        }
    }
}

pub(crate) fn finite(key: &'static str, value: f64) -> Checked {
    if !value.is_finite() {
        return Err(Fault::new(key, format!("{value} is not a finite number")));
    }
    if value.abs() > LARGEST {
        return Err(Fault::new(
            key,
            format!("{value:e} is beyond {LARGEST:e}, what float32 devices can integrate"),
        ));
    }
    Ok(())
}

pub(crate) fn positive(key: &'static str, value: f64) -> Checked {
    finite(key, value)?;
    if value <= 0.0 {
        return Err(Fault::new(key, format!("must be positive, found {value}")));
    }
    if value < SMALLEST {
        return Err(Fault::new(
            key,
            format!("{value:e} is below {SMALLEST:e}, what float32 devices can integrate"),
        ));
    }
    Ok(())
}

pub(crate) fn vector(key: &'static str, value: DVec3) -> Checked {
    let mut values = value.to_array().into_iter();
    values.try_for_each(|v| finite(key, v))
}

pub(crate) fn direction(key: &'static str, value: DVec3) -> Checked {
    vector(key, value)?;
    if value.length() < SMALLEST {
        return Err(Fault::new(
            key,
            format!(
                "a vector shorter than {SMALLEST:e}, such as the zero vector, has no direction; give one such as \
                 [0.0, 0.0, 1.0]"
            ),
        ));
    }
    Ok(())
}

/// Reads exactly three numbers; some formats would let a fourth pass unread.
pub(crate) fn read_vector<'de, D: Deserializer<'de>>(reader: D) -> Result<DVec3, D::Error> {
    read_numbers(reader, "three").map(|numbers: [f64; 3]| numbers.into())
}

/// Reads exactly two numbers.
pub(crate) fn read_pair<'de, D: Deserializer<'de>>(reader: D) -> Result<[f64; 2], D::Error> {
    read_numbers(reader, "two")
}

/// Reads two numbers for a key that may be absent.
pub(crate) fn read_some_pair<'de, D: Deserializer<'de>>(
    reader: D,
) -> Result<Option<[f64; 2]>, D::Error> {
    read_pair(reader).map(Some)
}

fn read_numbers<'de, D: Deserializer<'de>, const COUNT: usize>(
    reader: D,
    count: &str,
) -> Result<[f64; COUNT], D::Error> {
    let numbers = Vec::<f64>::deserialize(reader)?;
    let found = numbers.len();
    numbers
        .try_into()
        .map_err(|_| serde::de::Error::custom(format!("expected {count} numbers, found {found}")))
}

/// Reads a list of vectors.
pub(crate) fn read_vectors<'de, D: Deserializer<'de>>(reader: D) -> Result<Vec<DVec3>, D::Error> {
    #[derive(Deserialize)]
    struct Vector(#[serde(deserialize_with = "read_vector")] DVec3);
    let vectors = Vec::<Vector>::deserialize(reader)?;
    Ok(vectors.into_iter().map(|vector| vector.0).collect())
}

/// Reads three numbers for a key that may be absent.
pub(crate) fn read_some_vector<'de, D: Deserializer<'de>>(
    reader: D,
) -> Result<Option<DVec3>, D::Error> {
    read_vector(reader).map(Some)
}

/// Makes a reader's message about a key of the table that it reads; [`unnamed`] takes it apart again.
pub(crate) fn named(key: &str, message: &str) -> String {
    format!("key `{key}`: {message}")
}

/// Returns the key that a message of [`named`] is about, and the message.
#[cfg(feature = "files")]
pub(super) fn unnamed(message: &str) -> Option<(&str, &str)> {
    message.strip_prefix("key `")?.split_once("`: ")
}
