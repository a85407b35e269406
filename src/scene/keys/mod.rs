//! The keys of scene files: what a reader of files takes, told to a person and to an editor. Each table of keys stands
//! beside the type that is read; tests hold them against what serde reads.

#[cfg(feature = "json")]
mod schema;
mod tables;
#[cfg(all(test, feature = "json"))]
mod tests;

use std::ops::Bound;

#[cfg(feature = "json")]
pub use schema::json_schema;
pub use tables::{Count, KeyGroup, Table, table, tables, track_tables};

/// A key of a table of a scene file.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Key {
    /// What it is called, such as `fov_y`.
    pub name: &'static str,
    /// What its value may be.
    pub form: Form,
    /// The unit of its value, such as `degrees`; empty where it has none.
    pub unit: &'static str,
    /// What holds where it is left out.
    pub absent: Absent,
    /// What it is, in a line.
    pub help: &'static str,
}

/// What the value of a key may be.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Form {
    /// A number between two bounds.
    Number(Bound<f64>, Bound<f64>),
    /// A whole number, from the first to the second.
    Whole(u32, u32),
    /// A number, or the word `"nan"`.
    NumberOrNan,
    /// A number from one to another, or a word.
    NumberOr(f64, f64, &'static str),
    /// `true` or `false`.
    Flag,
    /// Any text.
    Text,
    /// The name of a file.
    File,
    /// One of these words.
    Word(&'static [&'static str]),
    /// Three numbers, linear RGB, or `"#rrggbb"`, sRGB.
    Color,
    /// A colour, or the name of a file.
    ColorOrFile,
    /// 16 numbers by rows, or 4 rows of 4.
    Matrix,
    /// So many numbers, at least and at most.
    Numbers(u32, Option<u32>),
    /// So many vectors of three numbers, at least and at most.
    Vectors(u32, Option<u32>),
    /// So many colours, at least.
    Colors(u32),
    /// What a track has values of: a number, or a list of numbers, vectors or colours.
    TrackValue,
    /// So many of such, at least.
    TrackValues(u32),
    /// A table of this name, such as `arc`.
    Table(&'static str),
    /// A list of tables of this name, such as `layers`.
    Tables(&'static str),
}

impl Form {
    /// Returns whether a track may stand in the place of such a value, or of a part of it.
    #[must_use]
    pub fn may_be_track(&self) -> bool {
        match self {
            Self::Number(..)
            | Self::NumberOrNan
            | Self::NumberOr(..)
            | Self::Color
            | Self::ColorOrFile
            | Self::Matrix
            | Self::Numbers(..)
            | Self::Vectors(..)
            | Self::Colors(_) => true,
            Self::Whole(..)
            | Self::Flag
            | Self::Text
            | Self::File
            | Self::Word(_)
            | Self::TrackValue
            | Self::TrackValues(_)
            | Self::Table(_)
            | Self::Tables(_) => false,
        }
    }
}

/// What holds where a key is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Absent {
    /// It must not be.
    Required,
    /// It must not be, unless this key is there.
    RequiredWithout(&'static str),
    /// As if this value stood there, in TOML.
    Value(&'static str),
    /// What these words say.
    Otherwise(&'static str),
}

/// Makes a key. What tables of keys are written with is in [`words`].
pub(crate) const fn key(
    name: &'static str,
    form: Form,
    unit: &'static str,
    absent: Absent,
    help: &'static str,
) -> Key {
    Key {
        name,
        form,
        unit,
        absent,
        help,
    }
}

/// What a table of keys is written with.
pub(crate) mod words {
    use std::ops::Bound::{Excluded, Included};

    pub(crate) use super::Absent::{Otherwise, Required, RequiredWithout, Value};
    pub(crate) use super::Form::{self, *};
    pub(crate) use super::key;
    #[allow(unused_imports, reason = "few tables need them")]
    pub(crate) use crate::scene::simulation::{LAST_FRAME, MOST_SPRITES};
    use crate::scene::values::{LARGEST, SMALLEST};

    pub(crate) const NONE: &str = "";
    pub(crate) const WORLD: &str = "world units";
    pub(crate) const DEGREES: &str = "degrees";
    pub(crate) const PIXELS: &str = "pixels";

    /// Three numbers.
    pub(crate) const VECTOR: Form = Numbers(3, Some(3));
    /// Two numbers.
    pub(crate) const PAIR: Form = Numbers(2, Some(2));
    /// A number of any size that a scene can have.
    pub(crate) const ANY: Form = from_to(-LARGEST, LARGEST);
    /// A number above 0.
    pub(crate) const POSITIVE: Form = from_to(SMALLEST, LARGEST);
    /// 0, or a number above it.
    pub(crate) const NOT_NEGATIVE: Form = from_to(0.0, LARGEST);
    /// The names of profiles.
    pub(crate) const PROFILE: Form = Word(&[
        "inverse",
        "inverse-square",
        "inverse-cube",
        "gaussian",
        "smeared",
        "convolution",
    ]);
    /// A whole number.
    pub(crate) const WHOLE: Form = Whole(0, u32::MAX);

    /// A number from one to another, both included.
    pub(crate) const fn from_to(least: f64, most: f64) -> Form {
        Number(Included(least), Included(most))
    }

    /// A number from one to below another.
    pub(crate) const fn from_to_below(least: f64, most: f64) -> Form {
        Number(Included(least), Excluded(most))
    }

    /// A number above one, up to another.
    pub(crate) const fn above_to(least: f64, most: f64) -> Form {
        Number(Excluded(least), Included(most))
    }

    /// A number between two, neither included.
    pub(crate) const fn between(least: f64, most: f64) -> Form {
        Number(Excluded(least), Excluded(most))
    }
}
