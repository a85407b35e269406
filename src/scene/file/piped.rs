//! Scenes from pipes: what has no ending and no folder.

use std::io::Read;
use std::path::Path;

use super::{Document, MethodKeys, text_of};
use crate::error::{Error, Result, SceneError};
use crate::scene::Scene;

impl Scene {
    /// Like [`Scene::from_file_with`], of what a pipe brings: JSON if it begins with `{`, else TOML; a depth image's
    /// path is from the working folder. Errors call it `name`.
    ///
    /// # Errors
    /// As [`Scene::from_file_with`].
    pub fn from_reader_with(
        reader: impl Read,
        name: impl AsRef<Path>,
        adjust: impl FnMut(&mut Self, &MethodKeys) -> Result<()>,
    ) -> Result<Self> {
        Ok(Self::from_reader_with_warnings(reader, name, adjust)?.0)
    }

    /// Like [`Scene::from_reader_with`]; also gives [`Scene::warnings`], as [`Scene::from_file_with_warnings`] does.
    ///
    /// # Errors
    /// As [`Scene::from_file_with`].
    pub fn from_reader_with_warnings(
        reader: impl Read,
        name: impl AsRef<Path>,
        mut adjust: impl FnMut(&mut Self, &MethodKeys) -> Result<()>,
    ) -> Result<(Self, Vec<SceneError>)> {
        open(reader, name.as_ref())?.into_frame(0.0, &mut adjust)
    }
}

/// Returns whether a path is a pipe, or one that the system has for a file that is open already: it says neither a
/// folder nor a format.
pub(super) fn is_piped(path: &Path) -> bool {
    let is_descriptor = ["/dev", "/proc"].iter().any(|root| path.starts_with(root));
    cfg!(unix) && (is_descriptor || std::fs::metadata(path).is_ok_and(|meta| !meta.is_file()))
}

/// Opens what a pipe brings.
pub(super) fn open(mut reader: impl Read, name: &Path) -> Result<Document<'static>> {
    let mut bytes = Vec::new();
    reader
        .read_to_end(&mut bytes)
        .map_err(|error| Error::input(name, format!("cannot read: {error}")).caused_by(error))?;
    self::read(name, bytes)
}

/// Reads a scene.
pub(super) fn read(name: &Path, bytes: Vec<u8>) -> Result<Document<'static>> {
    let text = text_of(name, bytes)?;
    Document::read(looks_like_json(&text), text, Some(name), Path::new(""))
}

/// Returns whether a text without an ending is JSON.
pub(super) fn looks_like_json(text: &str) -> bool {
    text.trim_start_matches('\u{feff}')
        .trim_start()
        .starts_with('{')
}
