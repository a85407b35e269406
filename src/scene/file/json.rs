//! Scenes as JSON, of the same structure as the TOML. Faults of values have a key in place of line and column.

use serde::de::DeserializeOwned;

use super::moving::Moving;
use super::numbers::around;
use super::tracks::may_have_tracks;
use super::words::{Language, no_value, reworded};
use super::{SceneFile, TRACKS_FACTOR, check_memory, empty_file};
use crate::error::{Error, Result, SceneError};
use crate::scene::Scene;

/// What a JSON scene is written in.
pub(super) const LANGUAGE: Language = Language::Json;

/// Bytes that reading takes for each byte of a text, at most.
const MEMORY_FACTOR: u64 = 12;

/// Reads a scene, and what of it changes.
pub(super) fn read(text: &str) -> Result<(SceneFile, Moving)> {
    let text = text.trim_start_matches('\u{feff}');
    if text.trim().is_empty() {
        return Err(empty_file().into());
    }
    if !may_have_tracks(text) {
        check_memory("the scene", text.len(), MEMORY_FACTOR)?;
        return Ok((parsed(text)?, Moving::default()));
    }
    check_memory("the scene", text.len(), MEMORY_FACTOR + TRACKS_FACTOR)?;
    match Moving::read_document(parsed(text)?, Language::Json)? {
        Some(read) => Ok(read),
        None => Ok((parsed(text)?, Moving::default())),
    }
}

/// Reads a text as what is asked for.
fn parsed<T: DeserializeOwned>(text: &str) -> Result<T> {
    let mut reader = serde_json::Deserializer::from_str(text);
    let read = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let key = error.path().to_string();
        let key = key.trim_end_matches(['?', '.']).to_owned();
        let inner = error.inner();
        let words = inner.to_string();
        let words = without_position(&words);
        let (key, message) = match bad_value(text, inner, &key) {
            Some(message) => (key, message),
            None => reworded(Language::Json, key, words),
        };
        SceneError {
            path: None,
            position: (inner.line() > 0).then(|| (inner.line(), inner.column())),
            key,
            message,
        }
    })?;
    reader.end().map_err(|error| SceneError {
        path: None,
        position: Some((error.line(), error.column())),
        key: String::new(),
        message: without_position(&error.to_string()).to_owned(),
    })?;
    Ok(read)
}

/// Writes a scene.
pub(super) fn write(scene: &Scene) -> Result<String> {
    serde_json::to_string_pretty(scene).map_err(|error| Error::Unsupported(error.to_string()))
}

/// Cuts off the position with which serde_json ends its messages: ours stands at the front.
fn without_position(message: &str) -> &str {
    message.split(" at line ").next().unwrap_or(message)
}

/// Returns the message of something in the place of a value, such as `.5` or a word without quotes; `None` where the
/// fault is another.
fn bad_value(text: &str, error: &serde_json::Error, key: &str) -> Option<String> {
    let words = error.to_string();
    let words = without_position(&words);
    let is_of_value = ["expected value", "invalid number", "expected ident"].contains(&words);
    let is_behind = ["key must be a string", "expected `,` or `}`"].contains(&words);
    if !error.is_syntax() || !(is_of_value || is_behind) {
        return None;
    }
    let line = text.lines().nth(error.line().checked_sub(1)?)?;
    // A column is the place behind the character at fault.
    let raw = around(line, error.column().saturating_sub(1), is_behind);
    let raw = raw.trim_end_matches(',');
    let is_second =
        is_behind && !raw.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    (!raw.is_empty() && !is_second).then(|| no_value(Language::Json, key, raw))
}
