//! Scenes as JSON, where the library was built without the feature `json`.

use std::path::Path;

use super::{Adjust, Read};
use crate::error::{Error, Result};
use crate::scene::Scene;

pub(super) fn read(_: &str, _: &Path, _: Adjust<'_>) -> Result<Read> {
    Err(missing())
}

pub(super) fn write(_: &Scene) -> Result<String> {
    Err(missing())
}

fn missing() -> Error {
    let message = "a JSON scene: this library was built without the feature \"json\"; write TOML";
    Error::Unsupported(message.to_owned())
}
