//! Where a key of a TOML scene stands: from key path to line and column, and back.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Every key of a document with the place of its value.
pub(super) struct KeyMap {
    entries: Vec<Entry>,
}

struct Entry {
    path: String,
    key: Range<usize>,
    value: Range<usize>,
}

impl KeyMap {
    /// Maps a document; one that does not parse has no keys.
    pub(super) fn new(text: &str) -> Self {
        let mut entries = Vec::new();
        if let Ok(document) = DeTable::parse(text) {
            collect_table("", document.get_ref(), &mut entries);
        }
        Self { entries }
    }

    /// Returns the byte offset at which the value of `path` stands, or that of the nearest key that encloses it.
    pub(super) fn offset_of(&self, path: &str) -> Option<usize> {
        self.entries
            .iter()
            .filter(|entry| path.starts_with(&entry.path))
            .max_by_key(|entry| entry.path.len())
            .map(|entry| entry.value.start)
    }

    /// Returns the byte offset at which the name of `path` stands, or that of the nearest key that encloses it.
    pub(super) fn name_of(&self, path: &str) -> Option<usize> {
        let exact = self.entries.iter().find(|entry| entry.path == path);
        exact
            .map(|entry| entry.key.start)
            .or_else(|| self.offset_of(path))
    }

    /// Returns the innermost key that encloses a byte range, with its value or by its name.
    pub(super) fn path_at(&self, range: &Range<usize>) -> Option<&str> {
        let encloses =
            |outer: &Range<usize>| outer.contains(&range.start) && range.end <= outer.end;
        self.entries
            .iter()
            .filter(|entry| encloses(&entry.value) || encloses(&entry.key))
            .max_by_key(|entry| entry.path.len())
            .map(|entry| entry.path.as_str())
    }
}

fn collect_table(prefix: &str, table: &DeTable<'_>, entries: &mut Vec<Entry>) {
    for (key, value) in table {
        let path = match prefix {
            "" => key.get_ref().to_string(),
            prefix => format!("{prefix}.{}", key.get_ref()),
        };
        collect_value(path, key.span(), value, entries);
    }
}

fn collect_value(
    path: String,
    key: Range<usize>,
    value: &Spanned<DeValue<'_>>,
    entries: &mut Vec<Entry>,
) {
    match value.get_ref() {
        DeValue::Table(table) => collect_table(&path, table, entries),
        DeValue::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                collect_value(format!("{path}[{index}]"), item.span(), item, entries);
            }
        }
        _ => {}
    }
    entries.push(Entry {
        path,
        key,
        value: value.span(),
    });
}

/// Returns line and column of a byte offset, both counted from 1; columns count characters.
pub(super) fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.matches('\n').count() + 1;
    (line, before[line_start..].chars().count() + 1)
}
