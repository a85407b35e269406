//! Keywords that replace values of a scene: the options of the program, as `energywave render` has them.

use energywave::image::{Display, Exposure, ImageSize};
use energywave::scene::{Antialias, Method, MethodKeys, Sampling, Scene};
use energywave::{Error, Result, nearest};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::misuse;

/// What replaces values of a scene; all keywords are [`NAMES`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Overrides {
    width: Option<u32>,
    height: Option<u32>,
    method: Option<MethodName>,
    divisions: Option<u32>,
    tolerance: Option<f64>,
    sampling: Option<Sampling>,
    antialias: Option<Antialias>,
    exposure: Option<Exposure>,
    /// Seconds.
    time: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum MethodName {
    Simpson,
    Jittered,
    Exact,
}

const NAMES: [&str; 10] = [
    "size",
    "width",
    "height",
    "method",
    "divisions",
    "tolerance",
    "sampling",
    "antialias",
    "exposure",
    "t",
];

impl Overrides {
    /// Reads keywords; those that are None are not there.
    pub fn of(keywords: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut read = Self::default();
        for (name, value) in keywords {
            let name: String = name.extract()?;
            if !value.is_none() {
                read.set(&name, &value)?;
            }
        }
        Ok(read)
    }

    fn set(&mut self, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let pixels = "give a whole number of pixels";
        match name {
            "size" => {
                let (width, height) = read(name, value, "give (width, height), pixels")?;
                (self.width, self.height) = (Some(width), Some(height));
            }
            "width" => self.width = Some(read(name, value, pixels)?),
            "height" => self.height = Some(read(name, value, pixels)?),
            "method" => {
                let words = [
                    ("exact", MethodName::Exact),
                    ("simpson", MethodName::Simpson),
                    ("jittered", MethodName::Jittered),
                ];
                self.method = Some(word(name, value, &words)?);
            }
            "divisions" => self.divisions = Some(read(name, value, "give a whole number")?),
            "tolerance" => self.tolerance = Some(read(name, value, "give a number")?),
            "sampling" => {
                let words = [("tiles", Sampling::Tiles), ("pixels", Sampling::Pixels)];
                self.sampling = Some(word(name, value, &words)?);
            }
            "antialias" => {
                let words = [
                    ("footprint", Antialias::Footprint),
                    ("none", Antialias::None),
                ];
                self.antialias = Some(word(name, value, &words)?);
            }
            "exposure" => {
                self.exposure = Some(match value.extract::<f64>() {
                    Ok(stops) => Exposure::Stops(stops),
                    Err(_) => word(name, value, &[("auto", Exposure::Auto)])?,
                });
            }
            "t" => self.time = read(name, value, "give seconds, a number")?,
            _ => return Err(unknown(name)),
        }
        Ok(())
    }

    /// Returns the time of the scene, seconds.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Returns the same at another time.
    pub fn at(&self, time: f64) -> Self {
        Self {
            time,
            ..self.clone()
        }
    }

    /// Replaces what was given. `keys` is what the scene says of all methods.
    pub fn apply(&self, scene: &mut Scene, keys: &MethodKeys) -> Result<()> {
        scene.image = ImageSize {
            width: self.width.unwrap_or(scene.image.width),
            height: self.height.unwrap_or(scene.image.height),
        };
        scene.integration.method = self.method(scene.integration.method, keys)?;
        let integration = &mut scene.integration;
        integration.antialias = self.antialias.unwrap_or(integration.antialias);
        scene.display.exposure = self.exposure.unwrap_or(scene.display.exposure);
        Ok(())
    }

    /// Returns the display where there is no scene.
    pub fn display(&self) -> Display {
        Display {
            exposure: self.exposure.unwrap_or_default(),
            ..Display::default()
        }
    }

    /// Naming divisions asks for a sum of so many, naming a tolerance or a sampling for the integral.
    fn method(&self, of_scene: Method, keys: &MethodKeys) -> Result<Method> {
        let asks_sum = self.divisions.is_some();
        let asks_exact = self.tolerance.is_some() || self.sampling.is_some();
        let of_scene = match of_scene {
            Method::Simpson { .. } => MethodName::Simpson,
            Method::Jittered { .. } => MethodName::Jittered,
            _ => MethodName::Exact,
        };
        let name = match self.method {
            Some(name) => name,
            None if asks_sum == asks_exact => of_scene,
            None if asks_exact => MethodName::Exact,
            None if of_scene == MethodName::Exact => MethodName::Simpson,
            None => of_scene,
        };
        let is_exact = matches!(name, MethodName::Exact);
        if !is_exact && matches!(self.sampling, Some(Sampling::Tiles)) {
            let message =
                "sampling=\"tiles\" is for the method \"exact\"; the others take every pixel";
            return Err(Error::Unsupported(message.to_owned()));
        }
        let divisions = self.divisions.unwrap_or(keys.divisions);
        Ok(match name {
            MethodName::Simpson => Method::Simpson { divisions },
            MethodName::Jittered => Method::Jittered {
                divisions,
                seed: keys.seed,
            },
            MethodName::Exact => Method::Exact {
                tolerance: self.tolerance.unwrap_or(keys.tolerance),
                sampling: self.sampling.unwrap_or(keys.sampling),
            },
        })
    }
}

/// Reads a value.
fn read<'py, T: FromPyObjectOwned<'py>>(
    name: &str,
    value: &Bound<'py, PyAny>,
    remedy: &str,
) -> PyResult<T> {
    value.extract().map_err(|_| unfit(name, value, remedy))
}

fn unfit(name: &str, value: &Bound<'_, PyAny>, remedy: &str) -> PyErr {
    let shown = value.repr().map(|repr| repr.to_string());
    let shown = shown.unwrap_or_else(|_| value.get_type().to_string());
    let reason = format!("{} is no value of it", energywave::shown(&shown));
    misuse(value.py(), name, &reason, remedy)
}

/// Reads a word that stands for something.
pub fn word<T: Copy>(name: &str, value: &Bound<'_, PyAny>, words: &[(&str, T)]) -> PyResult<T> {
    let given: Option<String> = value.extract().ok();
    let found = words
        .iter()
        .find(|(word, _)| Some(*word) == given.as_deref());
    found.map(|(_, meant)| *meant).ok_or_else(|| {
        let known: Vec<String> = words
            .iter()
            .map(|(word, _)| format!("\"{word}\""))
            .collect();
        let number = if name == "exposure" { "stops, or " } else { "" };
        unfit(name, value, &format!("use {number}{}", known.join(" or ")))
    })
}

fn unknown(name: &str) -> PyErr {
    let shown = energywave::shown(name);
    PyTypeError::new_err(match nearest(name, NAMES) {
        Some(meant) => format!("unknown keyword `{shown}`; did you mean `{meant}`?"),
        None => format!("unknown keyword `{shown}`; there are {}", NAMES.join(", ")),
    })
}
