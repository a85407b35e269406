//! What can be said of a TOML text without reading it: where its tables begin, and which key stands at a place. It
//! walks over tokens, so that brackets in strings and comments are none, and takes broken texts too.

use std::collections::HashMap;
use std::ops::Range;

use toml_parser::Source;
use toml_parser::lexer::TokenKind;

use crate::scene::kinds::{KIND_COUNT, KINDS};

/// What stands in tables of which there may be very many: sources of all kinds, and groups.
pub(super) const UNIT_COUNT: usize = KIND_COUNT + 1;
pub(super) const UNITS: [&str; UNIT_COUNT] = {
    let mut units = ["group"; UNIT_COUNT];
    let mut kind = 0;
    while kind < KIND_COUNT {
        units[kind] = KINDS[kind];
        kind += 1;
    }
    units
};

/// A table's header, such as `[camera]` or `[[torus]]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Header {
    /// Where its line begins.
    pub at: usize,
    /// The kind of source, by its place in the table of kinds, or the group, if it is `[[KIND]]` or `[[group]]`.
    pub kind: Option<usize>,
}

/// The headers of a text, in order, and which kinds of source it also names in other ways than by `[[KIND]]`, such as
/// by `[torus]`. Tables within one of a kind, such as `[[torus.layers]]` behind `[[torus]]`, belong to it and are not
/// listed.
#[derive(Debug, Default)]
pub(super) struct Headers {
    pub list: Vec<Header>,
    pub is_named_otherwise: [bool; UNIT_COUNT],
}

impl Headers {
    pub(super) fn of(text: &str) -> Self {
        let mut found = Self::default();
        walk(text, &mut |part, range| {
            if part == Part::Header {
                found.add(range.start, &text[range]);
            }
            true
        });
        found
    }

    /// Adds a header, and notes what it names in another way than its kind's.
    fn add(&mut self, at: usize, header: &str) {
        let inside = |open, close| Some(header.strip_prefix(open)?.strip_suffix(close)?.trim());
        let plain = inside("[[", "]]").and_then(|name| UNITS.iter().position(|it| *it == name));
        if plain.is_none() {
            let (first, is_within) = match header.split_once('.') {
                Some((first, _)) => (first, true),
                None => (header, false),
            };
            let first = first.trim_matches(['[', ']', '"', '\'', ' ', '\t']);
            let unit = UNITS.iter().position(|it| *it == first);
            let last = self.list.last().and_then(|header| header.kind);
            if unit.is_some() && is_within && last == unit && !header.contains('\\') {
                return;
            }
            for (index, is_named) in self.is_named_otherwise.iter_mut().enumerate() {
                *is_named |= header.contains('\\') || unit == Some(index);
            }
        }
        self.list.push(Header { at, kind: plain });
    }
}

/// Returns the key whose value stands at this place, such as `torus[1].axis`, also in a text that cannot be read; empty
/// where there is none. Items of lists in brackets are not counted.
pub(super) fn key_at(text: &str, place: usize) -> String {
    let mut table = String::new();
    let mut key = String::new();
    let mut counts: HashMap<String, usize> = HashMap::new();
    walk(text, &mut |part, range| {
        if range.start > place || (part == Part::Line && range.start == place) {
            return false;
        }
        let raw = &text[range];
        match part {
            Part::Header => {
                let names: Vec<&str> = raw.trim_matches(['[', ']', ' ', '\t']).split('.').collect();
                table.clear();
                for (index, name) in names.iter().enumerate() {
                    let dot = if index > 0 { "." } else { "" };
                    table += &format!("{dot}{}", unquoted(name.trim()));
                    let is_new = index + 1 == names.len() && raw.starts_with("[[");
                    if is_new {
                        *counts.entry(table.clone()).or_default() += 1;
                    }
                    // A name on the way stands for the last of its tables.
                    if let Some(count) = counts.get(&table) {
                        table += &format!("[{}]", count - 1);
                    }
                }
                key.clear();
            }
            Part::Key => key = unquoted(raw.trim()),
            Part::Value => {}
            Part::Line => key.clear(),
        }
        true
    });
    match (table.as_str(), key.as_str()) {
        (_, "") => String::new(),
        ("", key) => key.to_owned(),
        (table, key) => format!("{table}.{key}"),
    }
}

/// Returns the text of the value that stands at this place, up to the end of its line or a comment; `None` where there
/// is none.
pub(super) fn value_at(text: &str, place: usize) -> Option<&str> {
    let mut value = None;
    walk(text, &mut |part, range| {
        match part {
            Part::Value => value = Some(range.start),
            Part::Line if range.start >= place => return false,
            Part::Line => value = None,
            Part::Header | Part::Key => {}
        }
        range.start <= place
    });
    let rest = &text[value.filter(|begin| *begin <= place)?..];
    Some(rest.split(['\n', '#']).next().unwrap_or(rest).trim())
}

/// The parts that a text is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    /// `[camera]` or `[[torus]]`.
    Header,
    /// What stands before `=`.
    Key,
    /// The first token behind it.
    Value,
    /// The end of a line outside of brackets.
    Line,
}

/// Hands every part of a text, with its place, to `visit`, until that returns false.
fn walk(text: &str, visit: &mut dyn FnMut(Part, Range<usize>) -> bool) {
    enum State {
        LineBegins,
        Header(usize),
        Key(usize),
        ValueBegins,
        Value { depth: usize },
    }
    let mut state = State::LineBegins;
    for token in Source::new(text).lex() {
        let (kind, start) = (token.kind(), token.span().start());
        let ends_line = matches!(kind, TokenKind::Newline | TokenKind::Eof);
        let depth_change = match kind {
            TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket => 1,
            TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket => -1,
            _ => 0,
        };
        let goes_on = match state {
            State::LineBegins => {
                state = match kind {
                    _ if ends_line => State::LineBegins,
                    TokenKind::Whitespace | TokenKind::Comment => State::LineBegins,
                    TokenKind::LeftSquareBracket => State::Header(start),
                    _ => State::Key(start),
                };
                true
            }
            State::Header(begin) if ends_line || kind == TokenKind::Comment => {
                state = match ends_line {
                    true => State::LineBegins,
                    false => State::Value { depth: 0 },
                };
                let header = begin + text[begin..start].trim_end().len();
                visit(Part::Header, begin..header)
            }
            State::Header(_) => true,
            State::Key(begin) if kind == TokenKind::Equals => {
                state = State::ValueBegins;
                visit(Part::Key, begin..start)
            }
            State::Key(_) | State::ValueBegins | State::Value { depth: 0 } if ends_line => {
                state = State::LineBegins;
                visit(Part::Line, start..start)
            }
            State::Key(_) => true,
            State::ValueBegins if kind == TokenKind::Whitespace => true,
            State::ValueBegins => {
                let depth = usize::from(depth_change == 1);
                state = State::Value { depth };
                visit(Part::Value, start..token.span().end())
            }
            State::Value { depth } => {
                let depth = depth.saturating_add_signed(depth_change);
                state = State::Value { depth };
                true
            }
        };
        if !goes_on {
            return;
        }
    }
}

/// Returns a key without the quotes around it.
fn unquoted(key: &str) -> String {
    let quoted = |quote| key.strip_prefix(quote)?.strip_suffix(quote);
    quoted('"')
        .or_else(|| quoted('\''))
        .unwrap_or(key)
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
a = 1 # [[torus]]
[camera] # eye
eye = [0,
  [[torus]], .5]
\"key\" = '''
[[sphere]]
'''
[[torus]]
  [[torus]]  
axis = .5
b = { c = [ 1 ] }
";

    #[test]
    fn headers_are_those_that_stand_in_no_string_comment_or_list() {
        let headers = Headers::of(TEXT);
        let lines: Vec<&str> = headers
            .list
            .iter()
            .map(|it| TEXT[it.at..].lines().next().unwrap())
            .collect();
        assert_eq!(lines, ["[camera] # eye", "[[torus]]", "[[torus]]  "]);
        let torus = KINDS.iter().position(|kind| *kind == "torus");
        assert_eq!(
            headers.list.iter().map(|it| it.kind).collect::<Vec<_>>(),
            [None, torus, torus]
        );
        assert_eq!(headers.is_named_otherwise, [false; UNIT_COUNT]);
        let named = |text: &str| {
            Headers::of(text)
                .is_named_otherwise
                .iter()
                .filter(|it| **it)
                .count()
        };
        assert_eq!(
            (
                named("[torus]"),
                named("[[torus.x]]"),
                named("[ torus . x ]")
            ),
            (1, 1, 1)
        );
        assert_eq!(
            (
                named("[[\"torus\"]]"),
                named("[[ torus ]]"),
                named("[[toruss]]")
            ),
            (1, 0, 0)
        );
        assert_eq!(
            (
                named("[\"t\\u006frus\"]"),
                named("['torus'.x]"),
                named("[\"camera\"]")
            ),
            (UNIT_COUNT, 1, 0)
        );
    }

    #[test]
    fn tables_within_a_source_or_a_group_belong_to_it() {
        let found = |text: &str| {
            let headers = Headers::of(text);
            let named = headers.is_named_otherwise.iter().filter(|it| **it).count();
            (headers.list.len(), named)
        };
        assert_eq!(
            found("[[torus]]\n[[torus.layers]]\n[torus . x]\n[[torus]]"),
            (2, 0)
        );
        assert_eq!(
            found("[[group]]\n[group.rotate]\n[[group.torus]]\n[[torus]]"),
            (2, 0)
        );
        assert_eq!(found("[[torus]]\n[[sphere]]\n[[torus.layers]]"), (3, 1));
        assert_eq!(found("[[group]]\n[camera]\n[[group.torus]]"), (3, 1));
        assert_eq!(found("[[group]]\n[group]"), (2, 1));
        let text = "[[group]]\n[[group]]\n[[group.torus]]\n[[group.torus]]\naxis = .5\n[group.rotate]\nangle = .6\n";
        let at = |words: &str| key_at(text, text.find(words).unwrap());
        assert_eq!(at(".5"), "group[1].torus[1].axis");
        assert_eq!(at(".6"), "group[1].rotate.angle");
    }

    #[test]
    fn the_key_of_a_place_is_known_in_broken_texts_too() {
        let at = |words: &str| key_at(TEXT, TEXT.find(words).unwrap());
        assert_eq!(at("1 # "), "a");
        assert_eq!(at(", .5]"), "camera.eye");
        assert_eq!(at("[[sphere]]"), "camera.key");
        assert_eq!(at(".5\nb"), "torus[1].axis");
        assert_eq!(at("1 ] }"), "torus[1].b");
        assert_eq!(at("[camera]"), "");
        assert_eq!(value_at(TEXT, TEXT.find(".5\nb").unwrap()), Some(".5"));
        assert_eq!(value_at(TEXT, TEXT.find("[camera]").unwrap()), None);
        assert_eq!(
            (key_at("x = 5.\n", 6), value_at("x = 5.\n", 6)),
            ("x".to_owned(), Some("5."))
        );
        assert_eq!(
            (key_at("x = \n", 4), value_at("x = \n", 4)),
            ("x".to_owned(), None)
        );
        assert_eq!(value_at("x = 1,5 # five\ny = 2", 6), Some("1,5"));
    }
}
