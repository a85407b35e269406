//! What a track has values of: a number, or a list of numbers, vectors or colours. All is done number by number.

use std::fmt;

use glam::DVec3;
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::scene::colors::from_hex;

/// A value of a [`Track`](super::Track): a number, a vector, a colour in linear RGB, or a list of such.
#[derive(Debug, Clone, PartialEq)]
pub enum TrackValue {
    /// A number.
    Number(f64),
    /// A vector, a colour, or a list of numbers, vectors or colours.
    List(Vec<TrackValue>),
}

impl From<f64> for TrackValue {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<DVec3> for TrackValue {
    fn from(vector: DVec3) -> Self {
        vector.to_array().into()
    }
}

impl<T: Into<TrackValue>, const COUNT: usize> From<[T; COUNT]> for TrackValue {
    fn from(items: [T; COUNT]) -> Self {
        Self::List(items.into_iter().map(Into::into).collect())
    }
}

impl<T: Into<TrackValue>> From<Vec<T>> for TrackValue {
    fn from(items: Vec<T>) -> Self {
        Self::List(items.into_iter().map(Into::into).collect())
    }
}

impl TrackValue {
    /// Makes a value of such a shape of the numbers that stand at the same place in each of some values of one shape.
    pub(super) fn of<const COUNT: usize>(
        values: [&Self; COUNT],
        make: &mut impl FnMut([f64; COUNT]) -> f64,
    ) -> Self {
        let Self::List(first) = values[0] else {
            return Self::Number(make(values.map(Self::number)));
        };
        let item = |index: usize| values.map(|value| value.item(index));
        let items = 0..first.len();
        Self::List(items.map(|index| Self::of(item(index), make)).collect())
    }

    /// Returns the number; where values have one shape, it is asked of numbers alone.
    fn number(&self) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::List(_) => f64::NAN,
        }
    }

    /// Returns an item of a list; a number stands for a list of it.
    fn item(&self, index: usize) -> &Self {
        match self {
            Self::Number(_) => self,
            Self::List(items) => items.get(index).unwrap_or(self),
        }
    }

    /// Returns whether both have the same lists of the same lengths.
    pub(super) fn is_shaped_as(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Number(_), Self::Number(_)) => true,
            (Self::List(these), Self::List(those)) => {
                let mut pairs = these.iter().zip(those);
                these.len() == those.len() && pairs.all(|(this, that)| this.is_shaped_as(that))
            }
            _ => false,
        }
    }

    /// Returns whether it has no number, or a list in it has none.
    pub(super) fn is_empty(&self) -> bool {
        match self {
            Self::Number(_) => false,
            Self::List(items) => items.is_empty() || items.iter().any(Self::is_empty),
        }
    }

    /// Returns whether such is true of all its numbers.
    pub(in crate::scene) fn all(&self, is_such: &impl Fn(f64) -> bool) -> bool {
        match self {
            Self::Number(number) => is_such(*number),
            Self::List(items) => items.iter().all(|item| item.all(is_such)),
        }
    }

    /// Says what it is.
    pub(super) fn shape(&self) -> String {
        match self {
            Self::Number(_) => "a number".to_owned(),
            Self::List(items) => match items.first() {
                Some(first @ Self::List(_)) => {
                    format!("a list of {}, each {}", items.len(), first.shape())
                }
                _ => format!("a list of {}", items.len()),
            },
        }
    }
}

impl Serialize for TrackValue {
    fn serialize<S: Serializer>(&self, writer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(number) => writer.serialize_f64(*number),
            Self::List(items) => items.serialize(writer),
        }
    }
}

impl<'de> Deserialize<'de> for TrackValue {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        reader.deserialize_any(ValueVisitor)
    }
}

struct ValueVisitor;

#[allow(clippy::cast_precision_loss)] // whole numbers are read as others are
impl<'de> Visitor<'de> for ValueVisitor {
    type Value = TrackValue;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, a list of numbers, or a colour such as \"#ff8800\"")
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<TrackValue, E> {
        Ok(number.into())
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<TrackValue, E> {
        Ok((number as f64).into())
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<TrackValue, E> {
        let color = from_hex(text);
        color.map(TrackValue::from).ok_or_else(|| {
            E::custom(
                "a track has values that change by and by: numbers, lists of them, and colours such as \
                 \"#ff8800\"",
            )
        })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<TrackValue, A::Error> {
        let mut items: Vec<TrackValue> = Vec::new();
        while let Some(item) = list.next_element()? {
            items.push(item);
        }
        Ok(TrackValue::List(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, _: A) -> Result<TrackValue, A::Error> {
        let message = "a track stands in no track, and has values that are no tables";
        Err(A::Error::custom(message))
    }
}
