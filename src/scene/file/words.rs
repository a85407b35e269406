//! Puts the words of the readers of TOML and JSON into those of a scene's author.

use super::numbers::{is_whole, meant};
use super::scan::UNITS;
use crate::nearest;
use crate::scene::keys::{Table, tables};
use crate::scene::values::unnamed;
use crate::shown::shown;

/// The language of a scene file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Language {
    Toml,
    #[cfg(feature = "json")]
    Json,
}

/// Tables of which a scene has one.
const SINGLE: [&str; 10] = [
    "camera",
    "image",
    "decay",
    "absorption",
    "integration",
    "display",
    "depth",
    "time",
    "simulation",
    "lighting",
];

/// Tables of which a scene has some, besides sources and groups, and lists within tables.
const SEVERAL: [&str; 7] = [
    "wave",
    "collider",
    "mesh",
    "metaballs",
    "particles",
    "points",
    "volume",
];
const LISTS: [&str; 3] = ["layers", "control", "mixture"];

/// Puts a reader's message about a value, or a table without a key, into plain words; gives the key at fault, too.
pub(super) fn reworded(language: Language, key: String, words: &str) -> (String, String) {
    if let Some((field, message)) = unnamed(words) {
        return (format!("{key}.{field}"), message.to_owned());
    }
    let (key, words) = plain(language, key, words);
    name_missing(key, words)
}

/// Puts a message about the value of `key` into plain words, and says what to write; gives the key at fault, too.
/// Serde speaks of Rust types, an author thinks of numbers.
pub(super) fn plain(language: Language, key: String, message: &str) -> (String, String) {
    let message = message.trim();
    if let Some((table, _)) = key.split_once('[')
        && SINGLE.contains(&table)
    {
        return (table.to_owned(), one_only(language, table));
    }
    let last = key.rsplit('.').next().unwrap_or_default();
    let is_unit = UNITS.contains(&last) || SEVERAL.contains(&&*key);
    if is_unit && message.contains("invalid type") && message.ends_with("expected a sequence") {
        let words = several(language, &key, last);
        return (key, words);
    }
    if LISTS.contains(&last) && message.ends_with("expected a sequence") {
        let begin = "there may be several: write a list of them, also of one";
        let words = match language {
            Language::Toml => format!("{begin}: {last} = [{{ }}]"),
            #[cfg(feature = "json")]
            Language::Json => format!("{begin}: \"{last}\": [{{ }}]"),
        };
        return (key, words);
    }
    let (found, expected) = match message.rsplit_once(", expected ") {
        Some((found, expected)) => (found, expected),
        None => return (key, one_line(&shortened(message))),
    };
    let expected = expected
        .replace("f64", "a number")
        .replace("u32", "a whole number from 0 to 4294967295")
        .replace("a sequence", "a list, such as [0.0, 0.0, 1.0]")
        .replace("struct ", "the table of ");
    let advice = match unknown_name(found) {
        Some(name) => meant_name(name, &expected),
        None => instead(&key, found, &expected),
    };
    let found = shortened(found)
        .replace("floating point `", "number `")
        .replace("invalid type: map", "invalid type: a table")
        .replace("invalid type: sequence", "invalid type: a list");
    (
        key,
        one_line(&format!("{found}, expected {expected}{advice}")),
    )
}

/// Says how several sources of a kind, or groups, are written; `name` is the last part of their key.
#[cfg_attr(not(feature = "json"), allow(unused_variables))] // JSON repeats the name
fn several(language: Language, key: &str, name: &str) -> String {
    match language {
        Language::Toml => {
            let table = without_indices(key);
            format!("there may be several: write double brackets, [[{table}]]")
        }
        #[cfg(feature = "json")]
        Language::Json => {
            format!("there may be several: write a list of them, also of one: \"{name}\": [{{ }}]")
        }
    }
}

/// Returns a key as a TOML header names it, such as `group.torus` for `group[3].torus`.
fn without_indices(key: &str) -> String {
    let names = key
        .split('.')
        .map(|name| name.split('[').next().unwrap_or(name));
    names.collect::<Vec<_>>().join(".")
}

/// Says how a table is written of which there is one.
fn one_only(language: Language, table: &str) -> String {
    match language {
        Language::Toml => {
            format!("a scene has one: write single brackets, [{table}], and its keys")
        }
        #[cfg(feature = "json")]
        Language::Json => format!("a scene has one, no list of them: write \"{table}\": {{ }}"),
    }
}

/// Returns the key or the word that a reader does not know.
fn unknown_name(found: &str) -> Option<&str> {
    let kinds = ["unknown field `", "unknown variant `"];
    let name = kinds.iter().find_map(|kind| found.strip_prefix(kind))?;
    name.strip_suffix('`')
}

/// Says which of the names that are expected was likely meant, or which table has a key of this name.
fn meant_name(name: &str, expected: &str) -> String {
    let names = expected.split('`').skip(1).step_by(2);
    if let Some(nearest) = nearest(&name.to_lowercase().replace('-', "_"), names.clone()) {
        return format!("; did you mean `{nearest}`?");
    }
    let tables = tables();
    let has = |table: &&Table| table.keys().any(|key| key.name == name);
    let mut having = tables.iter().filter(has);
    match (having.next(), having.next()) {
        (Some(only), None) => format!("; {} has a key of this name", only.header()),
        _ => String::new(),
    }
}

/// Says what to write in place of a string or a number of the wrong sort.
fn instead(key: &str, found: &str, expected: &str) -> String {
    let is_number = expected.starts_with("a number") || expected.starts_with("a whole number");
    let sorts = ["string \"", "floating point `", "integer `"];
    let quoted = sorts.iter().find_map(|sort| {
        let value = found.strip_prefix("invalid type: ")?.strip_prefix(sort)?;
        value.rsplit_once(['"', '`']).map(|(value, _)| value)
    });
    match quoted.filter(|_| is_number) {
        Some(value) => match meant(value, is_whole(key)) {
            Some(number) if !expected.starts_with("a whole") || !number.contains('.') => {
                format!("; write {number}")
            }
            _ => String::new(),
        },
        None => String::new(),
    }
}

/// Shortens what a message repeats of a file: what stands between its first and its last quote.
fn shortened(found: &str) -> String {
    let quotes = ['`', '"'];
    match (found.find(quotes), found.rfind(quotes)) {
        (Some(begin), Some(end)) if begin + 1 < end => {
            let inside = shown(&found[begin + 1..end]);
            format!("{}{inside}{}", &found[..=begin], &found[end..])
        }
        _ => found.to_owned(),
    }
}

fn one_line(message: &str) -> String {
    message.replace('\n', "; ")
}

/// Says how to write what stands in the place of a value, and is none.
pub(super) fn no_value(language: Language, key: &str, raw: &str) -> String {
    if raw.is_empty() {
        return "there is no value".to_owned();
    }
    let raw_shown = shown(raw);
    let is_word = raw
        .chars()
        .all(|c| c.is_alphanumeric() || c == '-' || c == '_');
    let name = match language {
        Language::Toml => "TOML",
        #[cfg(feature = "json")]
        Language::Json => "JSON",
    };
    match meant(raw, is_whole(key)) {
        Some(number) => format!("`{raw_shown}` is no number of {name}; write {number}"),
        None if raw.starts_with(|c: char| c.is_ascii_digit()) => {
            format!("`{raw_shown}` is no number of {name}; write one such as 0.5 or 1e-3")
        }
        None if is_not_finite(raw) => {
            format!(
                "`{raw_shown}` is no number that a scene can have; write a finite one, such as 0.5"
            )
        }
        None if is_word => {
            format!(
                "`{raw_shown}` is no value; write words in quotes, \"{raw_shown}\", and numbers as 0.5 or 1e-3"
            )
        }
        None => format!(
            "`{raw_shown}` is no value; numbers are written as 0.5 or 1e-3, words in quotes"
        ),
    }
}

/// Returns whether a word is a language's for infinity or no number.
fn is_not_finite(raw: &str) -> bool {
    let word = raw.trim_start_matches(['+', '-']).to_ascii_lowercase();
    ["nan", "inf", "infinity"].contains(&word.as_str())
}

/// Turns "missing field `x`" in table `key` into a fault of `key.x`.
pub(super) fn name_missing(key: String, message: String) -> (String, String) {
    let field = message
        .strip_prefix("missing field `")
        .and_then(|rest| rest.strip_suffix('`'));
    let key = match field {
        // Only [camera] is required at the top, which has no key of its own.
        Some("camera") => "camera".to_owned(),
        Some(field) => format!("{key}.{field}"),
        None => return (key, message),
    };
    (key, "required, but missing".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(key: &str, message: &str) -> String {
        let (key, message) = plain(Language::Toml, key.to_owned(), message);
        format!("{key}: {message}")
    }

    #[test]
    fn readers_words_become_an_authors() {
        for (key, message, expected) in [
            (
                "torus",
                "invalid type: map, expected a sequence",
                "torus: there may be several: write double brackets, [[torus]]",
            ),
            (
                "image[0]",
                "invalid type: map, expected u32",
                "image: a scene has one: write single brackets, [image], and its keys",
            ),
            (
                "image.width",
                "invalid type: floating point `5.0`, expected u32",
                "image.width: invalid type: number `5.0`, expected a whole number from 0 to 4294967295; write 5",
            ),
            (
                "image.width",
                "invalid type: floating point `5.5`, expected u32",
                "image.width: invalid type: number `5.5`, expected a whole number from 0 to 4294967295",
            ),
            (
                "torus[0].coefficient",
                "invalid type: string \"0,5\", expected f64",
                "torus[0].coefficient: invalid type: string \"0,5\", expected a number; write 0.5",
            ),
            (
                "camera.up",
                "invalid type: map, expected a sequence",
                "camera.up: invalid type: a table, expected a list, such as [0.0, 0.0, 1.0]",
            ),
        ] {
            assert_eq!(words(key, message), expected);
        }
    }

    #[test]
    fn a_name_that_was_likely_meant_is_told() {
        for (message, expected) in [
            (
                "unknown field `traget`, expected one of `eye`, `target`",
                "; did you mean `target`?",
            ),
            (
                "unknown field `fov-y`, expected one of `eye`, `fov_y`",
                "; did you mean `fov_y`?",
            ),
            (
                "unknown variant `exakt`, expected one of `simpson`, `exact`",
                "; did you mean `exact`?",
            ),
            (
                "unknown field `tone_map`, expected `width` or `height`",
                "; [display] has a key of this name",
            ),
            ("unknown field `zzz`, expected `kappa`", "expected `kappa`"),
        ] {
            let found = words("camera", message);
            assert!(found.ends_with(expected), "{found}");
        }
    }

    #[test]
    fn what_a_message_repeats_of_a_file_is_short() {
        let long = "`, expected ".repeat(10_000);
        for message in [
            format!("unknown field `{long}`, expected one of `eye`, `target`"),
            format!("duplicate key `{long}`"),
            format!("invalid type: string \"{long}\", expected f64"),
        ] {
            let found = words("camera", &message);
            assert!(found.len() < 250, "{found}");
        }
        let (_, found) = plain(
            Language::Toml,
            String::new(),
            "unknown field `zoom`, expected one of `eye`",
        );
        assert_eq!(found, "unknown field `zoom`, expected one of `eye`");
        assert_eq!(
            no_value(Language::Toml, "", &"x".repeat(100_000))
                .matches('x')
                .count(),
            2 * 79
        );
    }
}
