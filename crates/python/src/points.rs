//! Points of light that are given with a frame: arrays of NumPy, or buffers of pyopencl's.

use std::ffi::c_void;
use std::sync::Arc;

use energywave::glam::DVec3;
use energywave::scene::{PointList, Points, Profile, Scene};
use energywave::{Error, HostPoints};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::failure::{exception, misuse};
use crate::opencl::handle;
use crate::overrides::word;

/// Points in buffers, by their handles.
#[derive(Debug)]
pub struct BufferPoints {
    positions: usize,
    lights: Option<usize>,
    previous: Option<usize>,
    count: usize,
    look: Look,
}

/// What is said of all points of an `energywave.HostPoints`.
#[derive(Debug)]
struct Look {
    coefficient: f64,
    color: DVec3,
    profile: Profile,
    radius: f64,
}

impl Look {
    fn of(place: &str, given: &Bound<'_, PyAny>) -> PyResult<Self> {
        let wrong = |name: &str, reason: &str, remedy: &str| {
            misuse(given.py(), &format!("{place}.{name}"), reason, remedy)
        };
        let number = |name: &str| {
            let number = given.getattr(name)?.extract::<f64>();
            number.map_err(|_| wrong(name, "it is no number", "give a number"))
        };
        let components = given.getattr("color")?.extract::<[f64; 3]>();
        let profiles = [
            ("inverse", Profile::Inverse),
            ("inverse-square", Profile::InverseSquare),
            ("smeared", Profile::Smeared),
        ];
        Ok(Self {
            coefficient: number("coefficient")?,
            color: DVec3::from_array(components.map_err(|_| {
                let remedy = "give red, green and blue, linear";
                wrong("color", "it is no colour", remedy)
            })?),
            profile: word(
                &format!("{place}.profile"),
                &given.getattr("profile")?,
                &profiles,
            )?,
            radius: number("radius")?,
        })
    }
}

impl BufferPoints {
    fn of(place: &str, given: &Bound<'_, PyAny>, look: Look) -> PyResult<Self> {
        let optional = |name: &str| {
            let buffer = given.getattr(name)?;
            let buffer = (!buffer.is_none()).then(|| handle(&buffer, &format!("{place}.{name}")));
            buffer.transpose()
        };
        let count = given.getattr("count")?.extract::<usize>().map_err(|_| {
            let (place, reason) = (format!("{place}.count"), "it is no number of points");
            misuse(given.py(), &place, reason, "give a whole number, or None")
        })?;
        Ok(Self {
            positions: handle(&given.getattr("positions")?, &format!("{place}.positions"))?,
            lights: optional("lights")?,
            previous: optional("previous")?,
            count,
            look,
        })
    }

    /// Returns what the library is told.
    pub fn of_host(&self) -> HostPoints {
        let mut points = HostPoints::new(self.positions as *mut c_void, self.count);
        points.lights = self.lights.map(|lights| lights as *mut c_void);
        points.previous = self.previous.map(|previous| previous as *mut c_void);
        (points.coefficient, points.color) = (self.look.coefficient, self.look.color);
        (points.profile, points.radius) = (self.look.profile, self.look.radius);
        points
    }
}

/// Returns what a function makes of the first three numbers of each row: the package has made rows of four of an array.
fn of_rows<T>(array: &Bound<'_, PyAny>, made: fn([f32; 3]) -> T) -> PyResult<Vec<T>> {
    let array: PyReadonlyArray2<'_, f32> = array.extract()?;
    let rows: &[[f32; 4]] = array.as_slice()?.as_chunks().0;
    Ok(rows.iter().map(|[x, y, z, _]| made([*x, *y, *z])).collect())
}

/// Makes points of arrays.
fn listed(place: &str, given: &Bound<'_, PyAny>, look: Look) -> PyResult<Points> {
    let vector = |row: [f32; 3]| DVec3::from_array(row.map(f64::from));
    let positions = of_rows(&given.getattr("positions")?, vector)?;
    let (lights, previous) = (given.getattr("lights")?, given.getattr("previous")?);
    let list = match lights.is_none() {
        true => PointList::new(positions),
        false => PointList::with_lights(positions, of_rows(&lights, |row| row)?),
    };
    let list = match previous.is_none() {
        true => list,
        false => {
            let previous = of_rows(&previous, vector)?;
            list.and_then(|list| list.with_previous(previous))
        }
    };
    let list = list.map_err(|mut error| {
        if let Error::Scene(fault) = &mut error {
            place.clone_into(&mut fault.key);
        }
        exception(given.py(), &error)
    })?;
    let mut points = Points::new(list);
    (points.coefficient, points.color) = (look.coefficient, look.color);
    (points.profile, points.radius) = (look.profile, look.radius);
    Ok(points)
}

/// Adds points of arrays to a scene, and returns those that are in buffers; all are `energywave.HostPoints`.
pub fn with_rows(
    scene: Arc<Scene>,
    points: &[Bound<'_, PyAny>],
) -> PyResult<(Arc<Scene>, Vec<BufferPoints>)> {
    if points.is_empty() {
        return Ok((scene, Vec::new()));
    }
    let (mut with_points, mut in_buffers) = (Scene::clone(&scene), Vec::new());
    for (index, given) in points.iter().enumerate() {
        let place = format!("points[{index}]");
        let look = Look::of(&place, given)?;
        match given.getattr("is_buffer")?.extract()? {
            true => in_buffers.push(BufferPoints::of(&place, given, look)?),
            false => with_points.points.push(listed(&place, given, look)?),
        }
    }
    Ok((Arc::new(with_points), in_buffers))
}

/// Adds points of arrays to a scene; there may be no others.
pub fn with_rows_alone(
    py: Python<'_>,
    scene: Arc<Scene>,
    points: &[Bound<'_, PyAny>],
) -> PyResult<Arc<Scene>> {
    match with_rows(scene, points)? {
        (scene, in_buffers) if in_buffers.is_empty() => Ok(scene),
        _ => {
            let reason = "some are in buffers of pyopencl's";
            let remedy = "give arrays, or draw by enqueue on a renderer with their queue";
            Err(misuse(py, "points", reason, remedy))
        }
    }
}
