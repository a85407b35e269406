//! Text files.

use std::path::Path;

use super::Output;
use crate::error::Result;

/// A text file that is known to be writable before the work.
#[derive(Debug)]
pub struct TextFile(Output);

impl TextFile {
    /// Makes sure that `path` can be written, and changes nothing yet.
    ///
    /// # Errors
    /// [`Error::Output`](crate::Error::Output) if it is a folder, its folder is missing, or it cannot be written.
    pub fn create(path: impl AsRef<Path>) -> Result<Self> {
        Output::create(path.as_ref()).map(Self)
    }

    /// Writes all, and puts the file in its place.
    ///
    /// # Errors
    /// [`Error::Output`](crate::Error::Output) if it cannot be written; nothing is left behind then.
    pub fn write(self, text: &str) -> Result<()> {
        self.write_bytes(text.as_bytes())
    }

    /// Writes what is no text, and puts the file in its place.
    ///
    /// # Errors
    /// As [`TextFile::write`].
    pub fn write_bytes(self, bytes: &[u8]) -> Result<()> {
        self.0.write_with(|writer| writer.write_all(bytes))
    }
}
