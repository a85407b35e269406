//! Scenes as JSON, where the library was built without the feature `json`.

use super::SceneFile;
use super::moving::Moving;
use super::words::Language;
use crate::error::{Error, Result};
use crate::scene::Scene;

/// Stands for JSON, of which nothing is read.
pub(super) const LANGUAGE: Language = Language::Toml;

pub(super) fn read(_: &str) -> Result<(SceneFile, Moving)> {
    Err(missing())
}

pub(super) fn write(_: &Scene) -> Result<String> {
    Err(missing())
}

fn missing() -> Error {
    let message = "a JSON scene: this library was built without the feature \"json\"; write TOML";
    Error::Unsupported(message.to_owned())
}
