//! Keywords that replace values of a scene: the options of the program, as `energywave render` has them.

use energywave::image::{Display, Exposure};
use energywave::nearest;
use energywave::scene::{Antialias, MethodName, Overrides as Values, Sampling};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString};

use crate::failure::{mistype, misuse};

/// What replaces values of a scene; all keywords are [`NAMES`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Overrides {
    /// What the scene has besides.
    pub values: Values,
    /// Seconds.
    pub time: f64,
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

/// Keywords that some functions have besides.
const OTHERS: [&str; 4] = ["device", "reference", "queue", "progress"];

const PIXELS: &str = "give a whole number of pixels";

impl Overrides {
    /// Reads keywords; those that are None are not there.
    pub fn of(keywords: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut read = Self::default();
        let is_there = |name| {
            let value = keywords.get_item(name);
            value.map(|it| it.is_some_and(|it| !it.is_none()))
        };
        for name in ["width", "height"] {
            if is_there("size")? && is_there(name)? {
                let remedy = "give one of them";
                return Err(misuse(keywords.py(), name, "`size` says it, too", remedy));
            }
        }
        for (name, value) in keywords {
            let name: String = name.extract()?;
            if !value.is_none() {
                read.set(&name, &value)?;
            }
        }
        Ok(read)
    }

    fn set(&mut self, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let values = &mut self.values;
        match name {
            "size" => {
                let (width, height) = size(value)?;
                (values.width, values.height) = (Some(width), Some(height));
            }
            "width" => values.width = Some(read(name, value, PIXELS)?),
            "height" => values.height = Some(read(name, value, PIXELS)?),
            "method" => values.method = Some(word(name, value, &MethodName::WORDS)?),
            "divisions" => values.divisions = Some(read(name, value, "give a whole number")?),
            "tolerance" => values.tolerance = Some(read(name, value, "give a number")?),
            "sampling" => values.sampling = Some(word(name, value, &Sampling::WORDS)?),
            "antialias" => values.antialias = Some(word(name, value, &Antialias::WORDS)?),
            "exposure" => {
                values.exposure = Some(match value.extract::<f64>() {
                    Ok(stops) => Exposure::Stops(stops),
                    Err(_) => word(name, value, &[("auto", Exposure::Auto)])?,
                });
            }
            "t" => {
                let remedy = "give seconds, a finite number";
                let time: f64 = read(name, value, remedy)?;
                if !time.is_finite() {
                    return Err(unfit(name, value, remedy));
                }
                self.time = time;
            }
            _ => return Err(unknown(value.py(), name)),
        }
        Ok(())
    }

    /// Returns the same at another time.
    pub fn at(&self, time: f64) -> Self {
        Self { time, ..*self }
    }

    /// Returns the display where there is no scene.
    pub fn display(&self, py: Python<'_>) -> PyResult<Display> {
        let exposure = self.values.exposure.unwrap_or_default();
        if let Exposure::Stops(stops) = exposure
            && !(-100.0..=100.0).contains(&stops)
        {
            let reason = format!("{stops} is no exposure");
            return Err(misuse(
                py,
                "exposure",
                &reason,
                "give stops, -100 to 100, or \"auto\"",
            ));
        }
        Ok(Display {
            exposure,
            ..Display::default()
        })
    }
}

/// Reads two whole numbers: a tuple, a list, an array.
fn size(value: &Bound<'_, PyAny>) -> PyResult<(u32, u32)> {
    let remedy = "give (width, height), whole numbers of pixels";
    let unfit = || unfit("size", value, remedy);
    if value.is_instance_of::<PyString>() {
        return Err(unfit());
    }
    let parts = value.try_iter().map_err(|_| unfit())?.take(3);
    let parts = parts.collect::<PyResult<Vec<_>>>().map_err(|_| unfit())?;
    let [width, height] = parts.as_slice() else {
        return Err(unfit());
    };
    let whole = |part: &Bound<'_, PyAny>| part.extract::<u32>().map_err(|_| unfit());
    Ok((whole(width)?, whole(height)?))
}

/// Reads a value.
fn read<'py, T: FromPyObjectOwned<'py>>(
    name: &str,
    value: &Bound<'py, PyAny>,
    remedy: &str,
) -> PyResult<T> {
    // To Python, True is 1.
    if value.is_instance_of::<PyBool>() {
        return Err(unfit(name, value, remedy));
    }
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

fn unknown(py: Python<'_>, name: &str) -> PyErr {
    let shown = energywave::shown(name);
    let remedy = match nearest(name, NAMES.into_iter().chain(OTHERS)) {
        Some(meant) if meant == name => {
            format!("a renderer is given one when it is made: Renderer({meant}=...)")
        }
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!("there are {}", NAMES.join(", ")),
    };
    mistype(py, name, &format!("unknown keyword `{shown}`"), &remedy)
}
