//! Presets: scenes of effects to begin with, as files with comments. They are those of `scenes/presets/`.

use std::path::Path;

use crate::error::Result;
use crate::output::TextFile;

/// A scene of an effect to begin with: a TOML file whose comments say what to change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Preset {
    /// What it is called, such as `magic-circle`.
    pub name: &'static str,
    /// The file, as [`Scene::from_toml`](crate::Scene::from_toml) reads it.
    pub text: &'static str,
}

macro_rules! presets {
    ($($name:literal),*) => {
        &[$(Preset {
            name: $name,
            text: include_str!(concat!("../../scenes/presets/", $name, ".toml")),
        }),*]
    };
}

impl Preset {
    /// All presets, by their names.
    pub const ALL: &[Self] = presets!(
        "aura",
        "charge",
        "impact",
        "kamehameha",
        "laser",
        "laser-corridor",
        "lightning",
        "magic-circle",
        "meteor",
        "nova",
        "portal",
        "slash"
    );

    /// Returns the preset of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Self> {
        Self::ALL.iter().find(|preset| preset.name == name)
    }

    /// Says in a line what it shows: the comment that its file begins with.
    #[must_use]
    pub fn about(&self) -> &'static str {
        let first = self.text.lines().next().unwrap_or_default();
        first.trim_start_matches('#').trim()
    }

    /// Writes its file, in the place of one that is there.
    ///
    /// # Errors
    /// [`Error::Output`](crate::Error::Output) if it cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        TextFile::create(path)?.write(self.text)
    }
}
