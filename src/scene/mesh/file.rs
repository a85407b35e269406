//! Reads meshes from files. Every fault says the file.

use std::fs;
use std::path::Path;

use glam::DVec3;

use super::{TriangleList, gltf, obj};
use crate::error::SceneError;
use crate::shown::shown;

/// Corners and triangles of a file; or what is wrong, from behind the file's name on.
pub(super) type Read = std::result::Result<(Vec<DVec3>, Vec<[u32; 3]>), String>;

/// What files there are.
const ENDINGS: &str = ".obj, .gltf or .glb";

pub(super) fn open(path: &Path) -> std::result::Result<TriangleList, SceneError> {
    let name = path.display().to_string();
    let name = shown(&name);
    let fault = |message: String| SceneError::value("file", format!("{name}{message}"));
    let ending = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    let folder = path.parent().unwrap_or(Path::new(""));
    if !["obj", "gltf", "glb"].contains(&ending.as_str()) {
        return Err(fault(format!(
            ": meshes are in files that end in {ENDINGS}"
        )));
    }
    let bytes = fs::read(path).map_err(|error| fault(format!(": cannot read: {error}")))?;
    let read = match ending.as_str() {
        "obj" => obj::read(&bytes),
        _ => gltf::read(&bytes, folder),
    };
    let (vertices, triangles) = read.map_err(fault)?;
    let list = TriangleList::checked(vertices, triangles)
        .map_err(|wrong| fault(format!(": {}", wrong.message)))?;
    let full = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    Ok(list.of_file(full))
}
