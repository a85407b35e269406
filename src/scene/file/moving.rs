//! What changes of a document that was read.

use super::SceneFile;
use super::pieces::source_key;
use super::scan::{UNIT_COUNT, UNITS};
use super::tracks::{Found, find, read};
use super::tree::{Entries, Node};
use super::words::Language;
use crate::error::SceneError;

/// What a document has that changes.
#[derive(Debug, Clone, Default)]
pub(super) struct Moving {
    /// The keys of all tracks.
    pub keys: Vec<String>,
    /// The tables of which a scene has one, or few, if there is a track in any.
    pub singles: Option<Node>,
    /// The sources and groups that have one, as a document of their own.
    pub units: Node,
    /// Which of each kind they are in the whole document.
    pub indices: [Vec<usize>; UNIT_COUNT],
}

impl Moving {
    /// Reads a document if it has tracks, as it is at 0 s.
    pub(super) fn read_document(
        mut document: Node,
        language: Language,
    ) -> std::result::Result<Option<(SceneFile, Self)>, SceneError> {
        let mut moving = Self::default();
        let found = find(&mut document, language)?;
        if found.keys.is_empty() {
            return Ok(None);
        }
        let file = read(&document, document.start(), language)
            .map_err(|(key, message)| SceneError::value(key, message))?;
        moving.take(document, found, str::to_owned, &[0; UNIT_COUNT]);
        Ok(Some((file, moving)))
    }

    /// Takes out of a document what has tracks; `key` turns its keys into those of the whole, `before` tells how many
    /// of each kind stand before it.
    pub(super) fn take(
        &mut self,
        document: Node,
        found: Found,
        key: impl Fn(&str) -> String,
        before: &[usize; UNIT_COUNT],
    ) {
        self.keys.extend(found.keys.iter().map(|it| key(it)));
        let Node::Table(entries) = document else {
            return;
        };
        let mut singles = Entries::new();
        for (name, value) in entries {
            let Some(unit) = UNITS.iter().position(|unit| **unit == *name) else {
                singles.push((name, value));
                continue;
            };
            let Node::List(items) = value else { continue };
            let is_moving = |index: usize| found.units.binary_search(&(unit, index)).is_ok();
            for (index, item) in items.into_iter().enumerate() {
                if is_moving(index) {
                    self.indices[unit].push(index + before[unit]);
                    self.units.push(&name, item);
                }
            }
        }
        if found.in_single {
            self.singles = Some(Node::Table(singles));
        }
    }

    /// Turns a key of [`Moving::units`] into that of the whole document.
    pub(super) fn whole_key(&self, key: &str) -> String {
        match source_key(key) {
            Some((unit, index, rest)) => {
                let whole = self.indices[unit].get(index).copied().unwrap_or(index);
                format!("{}[{whole}]{rest}", UNITS[unit])
            }
            None => key.to_owned(),
        }
    }

    /// Returns whether nothing changes.
    pub(super) fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }
}
