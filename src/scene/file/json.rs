//! Scenes as JSON, of the same structure as the TOML. Faults of values have a key in place of line and column.

use std::path::Path;

use super::{Adjust, SceneFile, empty_file, name_missing, plain_words};
use crate::error::{Error, Result, SceneError};
use crate::scene::Scene;
use crate::scene::values::unnamed;

/// Reads and checks a scene.
pub(super) fn read(text: &str, folder: &Path, adjust: Adjust<'_>) -> Result<Scene> {
    let text = text.trim_start_matches('\u{feff}');
    if text.trim().is_empty() {
        return Err(empty_file().into());
    }
    let mut reader = serde_json::Deserializer::from_str(text);
    let file: SceneFile = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let key = match error.path().to_string() {
            unknown if unknown == "." || unknown == "?" => String::new(),
            key => key,
        };
        let inner = error.inner();
        let words = plain_words(without_position(&inner.to_string()));
        let (key, message) = match unnamed(&words) {
            Some((field, message)) => (format!("{key}.{field}"), message.to_owned()),
            None => name_missing(key, words),
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
        message: plain_words(without_position(&error.to_string())),
    })?;
    file.into_scene(folder, adjust)
}

/// Writes a scene.
pub(super) fn write(scene: &Scene) -> Result<String> {
    serde_json::to_string_pretty(scene).map_err(|error| Error::Unsupported(error.to_string()))
}

/// Cuts off the position with which serde_json ends its messages: ours stands at the front.
fn without_position(message: &str) -> &str {
    message.split(" at line ").next().unwrap_or(message)
}
