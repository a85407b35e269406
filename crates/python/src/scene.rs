//! Scenes that were read: as they are at a time, with some values replaced.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use energywave::scene::{AnimatedScene, Scene};
use energywave::{Error, Result, SceneError};
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::{exception, exception_of_object, warn};
use crate::overrides::Overrides;

/// What the library says of a scene without light.
const DARK: &str = "no source of light";

/// A scene that was read. It is the fastest to draw often: what it is at a time is worked out once.
#[pyclass(frozen, module = "energywave")]
#[derive(Debug)]
pub struct OpenedScene {
    scene: AnimatedScene,
    /// Whether it was no text: faults then have no line.
    is_object: bool,
    kept: Mutex<Option<(Overrides, Arc<Scene>)>>,
}

impl OpenedScene {
    fn new(py: Python<'_>, read: Result<AnimatedScene>, is_object: bool) -> PyResult<Self> {
        let scene = read.map_err(|error| failure(py, error, is_object))?;
        Ok(Self {
            scene,
            is_object,
            kept: Mutex::new(None),
        })
    }

    /// Returns the scene with values replaced, and at their time; warns of what was hardly meant in it.
    pub fn frame(&self, py: Python<'_>, overrides: &Overrides) -> PyResult<Arc<Scene>> {
        self.frame_beside(py, overrides, false)
    }

    /// Returns the same, where there may be other light, so that the scene needs none.
    pub fn frame_beside(
        &self,
        py: Python<'_>,
        overrides: &Overrides,
        is_lit: bool,
    ) -> PyResult<Arc<Scene>> {
        if let Some((of, scene)) = &*self.kept.lock().unwrap_or_else(PoisonError::into_inner)
            && of == overrides
        {
            return Ok(scene.clone());
        }
        let read = py.detach(|| {
            self.scene.at_with_warnings(overrides.time, |scene, keys| {
                overrides.values.apply(scene, keys)
            })
        });
        let (scene, warnings) = read.map_err(|error| failure(py, error, self.is_object))?;
        for warning in warnings {
            let words = self.words_of(warning);
            if !(is_lit && words.contains(DARK)) {
                warn(py, "SceneWarning", &words)?;
            }
        }
        let scene = Arc::new(scene);
        let kept = Some((*overrides, scene.clone()));
        *self.kept.lock().unwrap_or_else(PoisonError::into_inner) = kept;
        Ok(scene)
    }

    fn words_of(&self, mut warning: SceneError) -> String {
        if self.is_object {
            warning.position = None;
        }
        warning.to_string()
    }

    /// Returns the scene at a moment of a frame.
    pub fn at(&self, overrides: &Overrides) -> Result<Scene> {
        let adjust = |scene: &mut Scene, keys: &_| overrides.values.apply(scene, keys);
        self.scene.at_with(overrides.time, adjust)
    }

    /// Returns from when to when the shutter is open in a frame.
    pub fn open_at(&self, time: f64, rate: f64) -> std::ops::Range<f64> {
        self.scene.open_at(time, rate)
    }
}

fn failure(py: Python<'_>, error: Error, is_object: bool) -> PyErr {
    match is_object {
        true => exception_of_object(py, error),
        false => exception(py, &error),
    }
}

#[pymethods]
impl OpenedScene {
    /// Reads a scene file, TOML or (.json) JSON.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = py.detach(|| AnimatedScene::from_file(path));
        Self::new(py, read, false)
    }

    /// Reads a scene in TOML; files that it names are from the working folder.
    #[staticmethod]
    fn from_toml(py: Python<'_>, text: String) -> PyResult<Self> {
        let read = py.detach(|| AnimatedScene::from_toml(text));
        Self::new(py, read, false)
    }

    /// Reads a scene in JSON, which may be an object's; files that it names are from a folder, else the working one.
    #[staticmethod]
    #[pyo3(signature = (text, is_object = false, folder = None))]
    fn from_json(
        py: Python<'_>,
        text: String,
        is_object: bool,
        folder: Option<PathBuf>,
    ) -> PyResult<Self> {
        let folder = folder.unwrap_or_default();
        let read = py.detach(|| AnimatedScene::from_json_in(text, folder));
        Self::new(py, read, is_object)
    }

    /// Width and height of its image with these overrides, in pixels.
    #[pyo3(signature = (**overrides))]
    fn size(&self, py: Python<'_>, overrides: Option<&Bound<'_, PyDict>>) -> PyResult<(u32, u32)> {
        let overrides = overrides.map_or(Ok(Overrides::default()), Overrides::of)?;
        let image = self.frame(py, &overrides)?.image;
        Ok((image.width, image.height))
    }

    /// Where the rays through the centres of its pixels begin, and where they end: each (height, width, 3), world
    /// units.
    fn rays<'py>(
        &self,
        py: Python<'py>,
        overrides: &Bound<'py, PyDict>,
    ) -> PyResult<[Bound<'py, PyArray3<f64>>; 2]> {
        let scene = self.frame(py, &Overrides::of(overrides)?)?;
        let (plane, image) = (scene.view_plane(), scene.image);
        let (mut origins, mut ends) = (Vec::new(), Vec::new());
        for row in 0..image.height {
            for column in 0..image.width {
                let ray = plane.ray(column, row);
                origins.push(ray.origin.to_array());
                ends.push((ray.origin + ray.span).to_array());
            }
        }
        let shape = [image.height as usize, image.width as usize, 3];
        let shaped =
            |points: Vec<[f64; 3]>| PyArray1::from_vec(py, points.into_flattened()).reshape(shape);
        Ok([shaped(origins)?, shaped(ends)?])
    }

    /// Whether anything in it moves.
    #[getter]
    fn is_animated(&self) -> bool {
        self.scene.is_animated()
    }

    /// For how many seconds it moves, and whether it then begins again; None if it does not move, or without end.
    #[getter]
    fn span(&self) -> Option<(f64, bool)> {
        self.scene.span().map(|span| (span.seconds, span.loops))
    }

    /// The files that it names.
    #[getter]
    fn files(&self) -> Vec<PathBuf> {
        self.scene.files()
    }

    fn __repr__(&self) -> String {
        let image = self.scene.at(0.0).map(|scene| scene.image);
        let moves = if self.scene.is_animated() {
            ", animated"
        } else {
            ""
        };
        match image {
            Ok(image) => format!(
                "<energywave scene, {}x{}{moves}>",
                image.width, image.height
            ),
            Err(_) => format!("<energywave scene{moves}>"),
        }
    }
}
