//! Writes a scene to TOML or JSON, so that reading what was written gives the same scene.

use std::path::Path;

use serde::{Serialize, Serializer};

use super::{
    DepthTable, DisplayTable, MetaballsTable, ParticlesTable, PointsTable, SceneFile, VolumeTable,
};
use crate::error::{Error, Result};
use crate::output::Output;
use crate::scene::Scene;

/// Why a scene cannot be written.
const NO_FILE: &str =
    "the depth image is in no file that the scene could name; save it as OpenEXR and open it again";
const NO_POINTS: &str = "particles with radii of their own are in no file that the scene could name; \
    write them as .csv and open that";
const NO_CELLS: &str = "the cells of a volume are in no file that the scene could name";
const NO_ELEMENTS: &str =
    "a scene file has no place for elements of light that are given one by one";
const NO_BACKGROUND: &str =
    "the background is in no file that the scene could name; save it and open it again";

impl Serialize for Scene {
    /// Writes the structure of scene files. A depth image and a background are named by the full
    /// paths of their files.
    fn serialize<S: Serializer>(&self, writer: S) -> std::result::Result<S::Ok, S::Error> {
        let depth = match &self.depth {
            None => None,
            Some(depth) => {
                Some(DepthTable::of(depth).ok_or_else(|| serde::ser::Error::custom(NO_FILE))?)
            }
        };
        let display = DisplayTable::of(&self.display);
        let display = display.ok_or_else(|| serde::ser::Error::custom(NO_BACKGROUND))?;
        let metaballs = self.metaballs.iter().map(MetaballsTable::of);
        let metaballs: Option<Vec<_>> = metaballs.collect();
        let metaballs = metaballs.ok_or_else(|| serde::ser::Error::custom(NO_POINTS))?;
        let particles = self.particles.iter().map(ParticlesTable::of);
        let particles: Option<Vec<_>> = particles.collect();
        let particles = particles.ok_or_else(|| serde::ser::Error::custom(NO_POINTS))?;
        let points: Option<Vec<_>> = self.points.iter().map(PointsTable::of).collect();
        let points = points.ok_or_else(|| serde::ser::Error::custom(NO_POINTS))?;
        let light = (particles, points);
        let volumes: Option<Vec<_>> = self.volumes.iter().map(VolumeTable::of).collect();
        let volumes = volumes.ok_or_else(|| serde::ser::Error::custom(NO_CELLS))?;
        if !self.light_elements.is_empty() {
            return Err(serde::ser::Error::custom(NO_ELEMENTS));
        }
        SceneFile::of(self, depth, display, metaballs, light, volumes).serialize(writer)
    }
}

impl Scene {
    /// Writes the scene as TOML.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if it has a depth image, or a background, that is in no file.
    pub fn to_toml(&self) -> Result<String> {
        toml::to_string(self).map_err(|error| Error::Unsupported(error.to_string()))
    }

    /// Writes the scene as JSON, of the same structure as the TOML.
    ///
    /// # Errors
    /// As [`Scene::to_toml`].
    #[cfg(feature = "json")]
    pub fn to_json(&self) -> Result<String> {
        super::json::write(self)
    }

    /// Writes a scene file; the ending chooses: `.json` is JSON, everything else TOML.
    ///
    /// # Errors
    /// As [`Scene::to_toml`], and [`Error::Output`] if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let text = match super::is_json(path) {
            true => super::json::write(self)?,
            false => self.to_toml()?,
        };
        Output::create(path)?.write_with(|writer| writer.write_all(text.as_bytes()))
    }
}
