//! Light as pictures: tone-mapped arrays, and files.

use std::path::PathBuf;

use energywave::image::{Display, ImageFile, ImageSize};
use energywave::{DisplayImage, RadianceImage};
use numpy::{PyArray1, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::failure::{exception, misuse};
use crate::overrides::Overrides;
use crate::scene::OpenedScene;

/// Returns a picture's values, row after row, with their height, width and channels; uint16 of 16 bits.
#[pyfunction]
#[pyo3(signature = (radiance, scene, overrides))]
pub fn tone_map<'py>(
    py: Python<'py>,
    radiance: PyReadonlyArray3<'py, f32>,
    scene: Option<&OpenedScene>,
    overrides: &Bound<'py, pyo3::types::PyDict>,
) -> PyResult<(Bound<'py, PyAny>, [usize; 3])> {
    let display = display_of(py, scene, &Overrides::of(overrides)?)?;
    let image = image_of(py, &radiance)?;
    let picture: DisplayImage = py.detach(|| image.tone_map(&display));
    let size = picture.size();
    let shape = [
        size.height as usize,
        size.width as usize,
        picture.channels(),
    ];
    let bytes = picture.as_slice();
    let values = match picture.bits() {
        16 => {
            let pairs = bytes.chunks_exact(2);
            let values = pairs.map(|pair| u16::from_ne_bytes([pair[0], pair[1]]));
            PyArray1::from_vec(py, values.collect()).into_any()
        }
        _ => PyArray1::from_slice(py, bytes).into_any(),
    };
    Ok((values, shape))
}

/// Writes light to a file, whose ending chooses: `.exr` (linear), or a picture as `.png`.
#[pyfunction]
#[pyo3(signature = (path, radiance, scene, overrides))]
pub fn save<'py>(
    py: Python<'py>,
    path: PathBuf,
    radiance: PyReadonlyArray3<'py, f32>,
    scene: Option<&OpenedScene>,
    overrides: &Bound<'py, pyo3::types::PyDict>,
) -> PyResult<()> {
    let display = display_of(py, scene, &Overrides::of(overrides)?)?;
    let image = image_of(py, &radiance)?;
    py.detach(|| ImageFile::create(path)?.write(&image, &display))
        .map_err(|error| exception(py, &error))
}

fn display_of(
    py: Python<'_>,
    scene: Option<&OpenedScene>,
    overrides: &Overrides,
) -> PyResult<Display> {
    match scene {
        Some(scene) => Ok(scene.frame(py, overrides)?.display.clone()),
        None => overrides.display(py),
    }
}

fn image_of(py: Python<'_>, radiance: &PyReadonlyArray3<'_, f32>) -> PyResult<RadianceImage> {
    let shape = radiance.shape();
    let wrong = || {
        let reason = format!("an array of shape {shape:?}");
        misuse(
            py,
            "radiance",
            &reason,
            "light is (height, width, 4), as render gives it",
        )
    };
    let sizes = (u32::try_from(shape[0]), u32::try_from(shape[1]));
    let (Ok(height), Ok(width), 4) = (sizes.0, sizes.1, shape[2]) else {
        return Err(wrong());
    };
    if width.min(height) == 0 || width.max(height) > ImageSize::LIMIT {
        return Err(wrong());
    }
    let made = RadianceImage::new(ImageSize { width, height });
    let mut image = made.map_err(|error| exception(py, &error))?;
    match radiance.as_slice() {
        Ok(values) if radiance.is_c_contiguous() => image.as_mut_slice().copy_from_slice(values),
        _ => {
            let values = radiance.as_array();
            let pairs = image.as_mut_slice().iter_mut().zip(values.iter());
            pairs.for_each(|(to, from)| *to = *from);
        }
    }
    Ok(image)
}
