//! Finds the tracks of a document: by the tables of keys, a table that stands where a number, a vector, a colour or a
//! list of such is read is a track.

use serde::Deserialize;

use super::scan::UNITS;
use super::tree::{At, Entries, Moment, Node};
use super::words::{Language, reworded};
use crate::error::SceneError;
use crate::scene::keys::{Count, Form, Table, tables};
use crate::scene::track::{Track, TrackTable};

/// Words by which a track is known.
const WORDS: [&str; 4] = ["times", "values", "value", "noise"];

/// Returns whether a text may have a track: a word of one stands before a sign that a key has behind it.
pub(super) fn may_have_tracks(text: &str) -> bool {
    WORDS.iter().any(|word| {
        text.match_indices(word).any(|(at, _)| {
            let rest = &text[at + word.len()..];
            let rest = rest.trim_start_matches(['"', '\'', ' ', '\t', '\n', '\r']);
            rest.starts_with(['=', ':', '.', ']'])
        })
    })
}

/// Where tracks are in a document.
#[derive(Debug, Default)]
pub(super) struct Found {
    /// Their keys.
    pub keys: Vec<String>,
    /// Whether any is in a table of which a scene has one, or few.
    pub in_single: bool,
    /// The kinds of sources, and groups, by their place in [`UNITS`], with the indices of those that have one.
    pub units: Vec<(usize, usize)>,
}

/// Turns all tables of a document that are tracks into tracks.
pub(super) fn find(document: &mut Node, language: Language) -> Result<Found, SceneError> {
    let tables = tables();
    let mut found = Found::default();
    let Node::Table(entries) = document else {
        return Ok(found);
    };
    for (key, value) in entries {
        let is_it = |table: &&Table| table.name == &**key && table.name != "time";
        let Some(table) = tables.iter().find(is_it) else {
            continue; // its reader says what is wrong
        };
        let mut finder = Finder {
            tables: &tables,
            language,
            key: key.to_string(),
            keys: &mut found.keys,
        };
        match (table.count, value) {
            (Count::Required | Count::Once, Node::Table(entries)) => {
                found.in_single |= finder.in_table(table, entries)?;
            }
            (Count::Many, Node::List(items)) => {
                let unit = UNITS.iter().position(|unit| *unit == table.name);
                for (index, item) in items.iter_mut().enumerate() {
                    let has_track = finder.within(&format!("[{index}]"), |finder| match item {
                        Node::Table(entries) => finder.in_table(table, entries),
                        _ => Ok(false),
                    })?;
                    match unit {
                        Some(unit) if has_track => found.units.push((unit, index)),
                        // What stands in the first piece, as tables of which there is one do.
                        _ => found.in_single |= has_track,
                    }
                }
            }
            _ => {}
        }
    }
    found.units.sort_unstable();
    Ok(found)
}

struct Finder<'a> {
    tables: &'a [Table],
    language: Language,
    /// Of the value at hand.
    key: String,
    keys: &'a mut Vec<String>,
}

impl<'a> Finder<'a> {
    fn within<T>(&mut self, part: &str, look: impl FnOnce(&mut Self) -> T) -> T {
        let length = self.key.len();
        self.key += part;
        let seen = look(self);
        self.key.truncate(length);
        seen
    }

    fn fault(&self, key: &str, message: impl Into<String>) -> SceneError {
        let dot = if key.is_empty() { "" } else { "." };
        SceneError::value(format!("{}{dot}{key}", self.key), message)
    }

    fn in_table(&mut self, table: &'a Table, entries: &mut Entries) -> Result<bool, SceneError> {
        let mut has_track = false;
        for (name, value) in entries {
            let known = table.keys().find(|key| key.name == &**name);
            let form = match known {
                Some(key) => key.form,
                None if is_word(name) => {
                    let message = "a track stands in the place of a number, a vector, a colour or a list of such, \
                         not of a whole table; each key of the table may have its own";
                    return Err(self.fault(name, message));
                }
                None => continue,
            };
            has_track |= self.within(&format!(".{name}"), |finder| finder.in_value(form, value))?;
        }
        Ok(has_track)
    }

    fn in_value(&mut self, form: Form, value: &mut Node) -> Result<bool, SceneError> {
        let table = |name: &str| self.tables.iter().find(|table| table.name == name);
        match (form, value) {
            (Form::Table(name), Node::Table(entries)) => match table(name) {
                Some(table) => self.in_table(table, entries),
                None => Ok(false),
            },
            (Form::Tables(name), Node::List(items)) => {
                let Some(table) = table(name) else {
                    return Ok(false);
                };
                let mut has_track = false;
                for (index, item) in items.iter_mut().enumerate() {
                    if let Node::Table(entries) = item {
                        let part = format!("[{index}]");
                        has_track |=
                            self.within(&part, |finder| finder.in_table(table, entries))?;
                    }
                }
                Ok(has_track)
            }
            (Form::Tables(_), Node::Table(_)) => Ok(false), // its reader asks for a list
            (form, value) if form.may_be_track() => self.in_number(value),
            (_, value) if value.looks_like_track() => {
                let message = "this stays as it is over time: a track is of numbers, vectors, colours and lists \
                     of such, not of whole numbers, words, flags and files";
                Err(self.fault("", message))
            }
            _ => Ok(false),
        }
    }

    /// Looks at what is a number, or made of numbers.
    fn in_number(&mut self, value: &mut Node) -> Result<bool, SceneError> {
        match value {
            Node::Track(_) => {
                self.keys.push(self.key.clone());
                Ok(true)
            }
            Node::Table(_) => {
                *value = Node::Track(Box::new(self.track(value)?));
                self.keys.push(self.key.clone());
                Ok(true)
            }
            Node::List(items) => {
                let mut has_track = false;
                for (index, item) in items.iter_mut().enumerate() {
                    if matches!(item, Node::Table(_) | Node::List(_) | Node::Track(_)) {
                        has_track |= self.within(&format!("[{index}]"), |it| it.in_number(item))?;
                    }
                }
                Ok(has_track)
            }
            _ => Ok(false),
        }
    }

    fn track(&self, value: &Node) -> Result<Track, SceneError> {
        let now = Moment {
            time: 0.0,
            period: None,
        };
        let table: TrackTable =
            read(value, now, self.language).map_err(|(key, message)| self.fault(&key, message))?;
        table
            .track()
            .map_err(|fault| self.fault(fault.key(), fault.message()))
    }
}

impl Node {
    fn looks_like_track(&self) -> bool {
        match self {
            Self::Track(_) => true,
            Self::Table(entries) => entries.iter().any(|(name, _)| is_word(name)),
            _ => false,
        }
    }
}

fn is_word(name: &str) -> bool {
    WORDS.contains(&name)
}

/// Reads a document as it is at a moment; a fault is a key and what is wrong.
pub(super) fn read<'de, T: Deserialize<'de>>(
    node: &Node,
    moment: Moment,
    language: Language,
) -> Result<T, (String, String)> {
    // Where all is right, as nearly always, nobody notes which key is read.
    T::deserialize(At(node, moment)).or_else(|_| {
        serde_path_to_error::deserialize(At(node, moment)).map_err(|error| {
            let key = error.path().to_string();
            let key = key.trim_end_matches(['?', '.']).to_owned();
            reworded(language, key, &error.inner().to_string())
        })
    })
}
