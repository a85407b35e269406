//! A document whose values may be tracks, and the reading of it at a time: what reads scenes finds numbers where tracks
//! stand.

use std::fmt::{self, Write};

use serde::de::value::{MapDeserializer, SeqDeserializer, StrDeserializer};
use serde::de::{Error, IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, forward_to_deserialize_any};

use super::time::is_period;
use crate::scene::simulation::KEPT_TRACK;
use crate::scene::track::TrackTable;
use crate::scene::{Track, TrackValue};

/// A value of a document.
#[derive(Debug, Clone)]
pub(super) enum Node {
    Null,
    Flag(bool),
    Whole(i64),
    Number(f64),
    Text(Box<str>),
    List(Vec<Node>),
    Table(Entries),
    Track(Box<Track>),
}

/// The keys of a table with their values, in order.
pub(super) type Entries = Vec<(Box<str>, Node)>;

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        reader.deserialize_any(NodeVisitor)
    }
}

struct NodeVisitor;

#[allow(clippy::cast_precision_loss)] // whole numbers beyond all that a scene has
impl<'de> Visitor<'de> for NodeVisitor {
    type Value = Node;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_unit<E: Error>(self) -> Result<Node, E> {
        Ok(Node::Null)
    }

    fn visit_bool<E: Error>(self, flag: bool) -> Result<Node, E> {
        Ok(Node::Flag(flag))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Node, E> {
        Ok(Node::Whole(number))
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<Node, E> {
        Ok(match number.try_into() {
            Ok(whole) => Node::Whole(whole),
            Err(_) => Node::Number(number as f64),
        })
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Node, E> {
        Ok(Node::Number(number))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Node, E> {
        Ok(Node::Text(text.into()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Node, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = list.next_element()? {
            items.push(item);
        }
        Ok(Node::List(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> Result<Node, A::Error> {
        let mut entries = Entries::new();
        while let Some((key, value)) = table.next_entry::<Box<str>, Node>()? {
            if entries.iter().any(|(other, _)| *other == key) {
                return Err(A::Error::custom(format!("duplicate field `{key}`")));
            }
            entries.push((key, value));
        }
        Ok(Node::Table(entries))
    }
}

impl Default for Node {
    fn default() -> Self {
        Self::Table(Entries::new())
    }
}

impl Node {
    /// Returns the value of a key of a table.
    fn get(&self, name: &str) -> Option<&Self> {
        match self {
            Self::Table(entries) => entries
                .iter()
                .find(|(key, _)| &**key == name)
                .map(|it| &it.1),
            _ => None,
        }
    }

    /// Adds an item to a list of a table, which is made if it is not there.
    pub(super) fn push(&mut self, list: &str, item: Self) {
        let Self::Table(entries) = self else { return };
        match entries.iter_mut().find(|(key, _)| &**key == list) {
            Some((_, Self::List(items))) => items.push(item),
            _ => entries.push((list.into(), Self::List(vec![item]))),
        }
    }

    /// Shows all tracks in it, with their keys; `key` is that of the node, and in the end as it was.
    pub(super) fn for_each_track(&self, key: &mut String, visit: &mut impl FnMut(&str, &Track)) {
        let length = key.len();
        match self {
            Self::Track(track) => visit(key, track),
            Self::List(items) => {
                for (index, item) in items.iter().enumerate() {
                    let _ = write!(key, "[{index}]");
                    item.for_each_track(key, visit);
                    key.truncate(length);
                }
            }
            Self::Table(entries) => {
                for (name, value) in entries {
                    *key += if length == 0 { "" } else { "." };
                    *key += name;
                    value.for_each_track(key, visit);
                    key.truncate(length);
                }
            }
            _ => {}
        }
    }

    /// Sets a track in the place of the value of a key such as `torus[0].color`; `None` where there is no such place.
    pub(super) fn put(&mut self, key: &str, track: Track) -> Option<()> {
        let mut node = self;
        let parts = key.split(['.', '[']);
        for part in parts {
            node = match (node, part.strip_suffix(']')) {
                (Self::List(items), Some(index)) => items.get_mut(index.parse::<usize>().ok()?)?,
                (Self::Table(entries), None) => {
                    let at = entries.iter().position(|(key, _)| &**key == part);
                    let at = at.unwrap_or_else(|| {
                        entries.push((part.into(), Self::Null));
                        entries.len() - 1
                    });
                    &mut entries[at].1
                }
                _ => return None,
            };
        }
        *node = Self::Track(Box::new(track));
        Some(())
    }

    /// Makes a track's table, as a file has it.
    fn written(track: &Track) -> Result<Self, toml::de::Error> {
        let table = toml::Value::try_from(TrackTable::from(track));
        Self::deserialize(table.map_err(toml::de::Error::custom)?)
    }

    /// Returns the moment at which a document is read first.
    pub(super) fn start(&self) -> Moment {
        let period = match self.get("time").and_then(|table| table.get("loop")) {
            Some(Self::Number(seconds)) => Some(*seconds),
            Some(Self::Whole(seconds)) => Some(*seconds as f64),
            _ => None,
        };
        Moment::start(period.filter(|seconds| is_period(*seconds)))
    }
}

/// When a document is read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    /// Seconds.
    pub time: f64,
    /// After how many seconds the scene begins again.
    pub period: Option<f64>,
}

impl Moment {
    /// Makes that at 0 s.
    pub(super) fn start(period: Option<f64>) -> Self {
        Self { time: 0.0, period }
    }
}

/// A value at a moment.
#[derive(Clone, Copy)]
pub(super) struct At<'a>(pub &'a Node, pub Moment);

/// What is wrong with a value, in serde's words.
pub(super) type Words = serde::de::value::Error;

impl<'de> IntoDeserializer<'de, Words> for At<'_> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for At<'_> {
    type Error = Words;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Words> {
        match self.0 {
            Node::Null => visitor.visit_unit(),
            Node::Flag(flag) => visitor.visit_bool(*flag),
            Node::Whole(number) => visitor.visit_i64(*number),
            Node::Number(number) => visitor.visit_f64(*number),
            Node::Text(text) => visitor.visit_str(text),
            Node::List(items) => {
                let items = items.iter().map(|item| At(item, self.1));
                visitor.visit_seq(SeqDeserializer::new(items))
            }
            Node::Table(entries) => {
                let entries = entries
                    .iter()
                    .map(|(key, value)| (&**key, At(value, self.1)));
                visitor.visit_map(MapDeserializer::new(entries))
            }
            Node::Track(track) => {
                let value = track.at_in(self.1.time, self.1.period);
                Value(&value).deserialize_any(visitor)
            }
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Words> {
        match self.0 {
            Node::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Words> {
        match self.0 {
            Node::Track(track) if name == KEPT_TRACK => {
                let written = Node::written(track).map_err(Words::custom)?;
                At(&written, self.1).deserialize_any(visitor)
            }
            _ => visitor.visit_newtype_struct(self),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        words: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Words> {
        match self.0 {
            Node::Text(text) => {
                StrDeserializer::<Words>::new(text).deserialize_enum(name, words, visitor)
            }
            _ => self.deserialize_any(visitor),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf
        unit unit_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}

/// The value of a track.
struct Value<'a>(&'a TrackValue);

impl<'de> IntoDeserializer<'de, Words> for Value<'_> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for Value<'_> {
    type Error = Words;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Words> {
        match self.0 {
            TrackValue::Number(number) => visitor.visit_f64(*number),
            TrackValue::List(items) => {
                visitor.visit_seq(SeqDeserializer::new(items.iter().map(Value)))
            }
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Words> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Words> {
        visitor.visit_newtype_struct(self)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf enum
        unit unit_struct seq tuple tuple_struct map struct identifier ignored_any
    }
}
