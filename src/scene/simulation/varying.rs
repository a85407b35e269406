//! Values of a simulation that change while it runs. Tracks of scenes are resolved before there is a scene; these stay,
//! because what a particle does depends on all that was before.

use std::fmt;
use std::marker::PhantomData;

use glam::DVec3;
use serde::de::{Error, MapAccess, SeqAccess, Unexpected, Visitor, value::MapAccessDeserializer};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::scene::track::{Interpolation, Track, TrackTable, TrackValue};
use crate::scene::values::{Checked, Fault, named, vector};

/// The name by which the reader of a document knows that a track is to stay one.
pub(in crate::scene) const KEPT_TRACK: &str = "$energywave::scene::Varying";

/// A number or a vector that may change while a simulation runs.
///
/// ```
/// use energywave::scene::{Track, Varying};
///
/// let rate = Varying::<f64>::from(Track::new([(0.0, 20.0), (1.0, 0.0)]));
/// assert_eq!(rate.at(0.25), 15.0);
/// assert_eq!(Varying::from(20.0).at(0.25), 20.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Varying<T> {
    /// It stays as it is.
    Constant(T),
    /// It changes over the seconds of the simulation, whatever `[time]` says of the scene.
    Track(Track),
    /// Each of its numbers does what it does.
    Parts(Vec<Varying<f64>>),
}

/// What may vary.
pub trait Varied: Copy + Serialize + sealed::Varied {}
impl<T: Copy + Serialize + sealed::Varied> Varied for T {}

mod sealed {
    use super::{DVec3, TrackValue};

    pub trait Varied: Sized {
        /// What a reader expects.
        const EXPECTED: &'static str;
        /// What stands for a value of another shape.
        const NONE: Self;

        /// Makes it of a track's value; `None` where that has another shape.
        fn of(value: &TrackValue) -> Option<Self>;

        /// Returns its numbers, and zeros for those that it lacks.
        fn numbers(self) -> DVec3;
    }

    impl Varied for f64 {
        const EXPECTED: &'static str = "a number";
        const NONE: Self = Self::NAN;

        fn of(value: &TrackValue) -> Option<Self> {
            match value {
                TrackValue::Number(number) => Some(*number),
                TrackValue::List(_) => None,
            }
        }

        fn numbers(self) -> DVec3 {
            DVec3::new(self, 0.0, 0.0)
        }
    }

    impl Varied for DVec3 {
        const EXPECTED: &'static str = "a sequence";
        const NONE: Self = Self::NAN;

        fn of(value: &TrackValue) -> Option<Self> {
            match value {
                TrackValue::List(items) => match items.as_slice() {
                    [x, y, z] => Some(Self::new(f64::of(x)?, f64::of(y)?, f64::of(z)?)),
                    _ => None,
                },
                TrackValue::Number(_) => None,
            }
        }

        fn numbers(self) -> DVec3 {
            self
        }
    }
}

impl<T> From<T> for Varying<T> {
    fn from(value: T) -> Self {
        Self::Constant(value)
    }
}

impl<T: Varied> From<Track> for Varying<T> {
    /// Keeps a track; one that never changes becomes its value.
    fn from(track: Track) -> Self {
        let first = track.values.first();
        let stays = track.values.iter().all(|value| Some(value) == first)
            && track.interpolation != Interpolation::Cubic
            && track
                .noise
                .as_ref()
                .is_none_or(|noise| noise.amplitude.all(&|it| it == 0.0));
        match first.and_then(T::of) {
            Some(value) if stays => Self::Constant(value),
            _ => Self::Track(track),
        }
    }
}

impl<T: Varied> Varying<T> {
    /// Returns the value at so many seconds of the simulation; of what is not valid, no number.
    #[must_use]
    pub fn at(&self, seconds: f64) -> T {
        match self {
            Self::Constant(value) => *value,
            Self::Track(track) => T::of(&track.at(seconds)).unwrap_or(T::NONE),
            Self::Parts(parts) => {
                let numbers = parts.iter().map(|part| part.at(seconds));
                T::of(&numbers.collect::<Vec<f64>>().into()).unwrap_or(T::NONE)
            }
        }
    }

    /// Checks all its values, besides by a check of a single one.
    pub(super) fn check(&self, key: &'static str, check: &dyn Fn(T) -> Checked) -> Checked {
        match self {
            Self::Constant(value) => {
                vector(key, value.numbers())?;
                check(*value)
            }
            Self::Track(track) => {
                track
                    .check()
                    .map_err(|fault| Fault::new(key, fault.message()))?;
                track.values.iter().try_for_each(|value| {
                    let message = "the values of its track have another shape";
                    check(T::of(value).ok_or_else(|| Fault::new(key, message))?)
                })
            }
            Self::Parts(parts) => {
                parts
                    .iter()
                    .try_for_each(|part| part.check(key, &|_| Ok(())))?;
                check(self.at(0.0))
            }
        }
    }
}

impl<T: Varied> Serialize for Varying<T> {
    fn serialize<S: Serializer>(&self, writer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Constant(value) => value.serialize(writer),
            Self::Track(track) => TrackTable::from(track).serialize(writer),
            Self::Parts(parts) => parts.serialize(writer),
        }
    }
}

impl<'de, T: Varied> Deserialize<'de> for Varying<T> {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        reader.deserialize_newtype_struct(KEPT_TRACK, VaryingVisitor(PhantomData))
    }
}

struct VaryingVisitor<T>(PhantomData<T>);

impl<T: Varied> VaryingVisitor<T> {
    fn number<E: Error>(&self, number: f64) -> Result<Varying<T>, E> {
        let value = T::of(&TrackValue::Number(number));
        let wrong = || E::invalid_type(Unexpected::Float(number), self);
        value.map(Varying::Constant).ok_or_else(wrong)
    }
}

#[allow(clippy::cast_precision_loss)] // whole numbers are read as others are
impl<'de, T: Varied> Visitor<'de> for VaryingVisitor<T> {
    type Value = Varying<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(T::EXPECTED)
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, reader: D) -> Result<Varying<T>, D::Error> {
        reader.deserialize_any(self)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Varying<T>, E> {
        self.number(number)
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Varying<T>, E> {
        self.number(number as f64)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<Varying<T>, E> {
        self.number(number as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Varying<T>, A::Error> {
        let mut parts: Vec<Varying<f64>> = Vec::new();
        while let Some(part) = list.next_element()? {
            parts.push(part);
        }
        let found = parts.len();
        let changes = parts
            .iter()
            .any(|part| !matches!(part, Varying::Constant(_)));
        let varying = Varying::<T>::Parts(parts);
        let numbers: Vec<f64> = match &varying {
            Varying::Parts(parts) => parts.iter().map(|part| part.at(0.0)).collect(),
            _ => Vec::new(),
        };
        match T::of(&numbers.into()) {
            Some(_) if changes => Ok(varying),
            Some(value) => Ok(Varying::Constant(value)),
            None if T::of(&0.0.into()).is_some() => {
                Err(A::Error::invalid_type(Unexpected::Seq, &self))
            }
            None => Err(A::Error::custom(format!(
                "expected three numbers, found {found}"
            ))),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<Varying<T>, A::Error> {
        let table = TrackTable::deserialize(MapAccessDeserializer::new(table))?;
        let track = table
            .track()
            .map_err(|fault| A::Error::custom(named(fault.key(), fault.message())))?;
        match track.values.iter().all(|value| T::of(value).is_some()) {
            true => Ok(track.into()),
            false => Err(A::Error::custom(format!(
                "the values of its track have another shape; expected {}",
                T::EXPECTED.replace("a sequence", "three numbers each")
            ))),
        }
    }
}
