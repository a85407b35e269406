//! The text of a scene file: UTF-8 without null characters.

use std::path::Path;

use crate::error::{Error, Result};

/// Returns bytes of a file as text.
pub(super) fn text_of(path: &Path, bytes: Vec<u8>) -> Result<String> {
    let fail = |reason: String| Error::input(path, reason);
    let no_text = match String::from_utf8(bytes) {
        Ok(text) => match text.find('\0') {
            None => return Ok(text),
            Some(at) => at,
        },
        Err(error) => error.utf8_error().valid_up_to(),
    };
    Err(fail(format!(
        "not a text file (byte {no_text}); a scene is TOML or JSON in UTF-8"
    )))
}
