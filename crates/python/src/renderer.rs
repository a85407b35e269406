//! Renderers, which keep their kernels and buffers from frame to frame.

use std::borrow::Cow;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};

use energywave::glam::DVec3;
use energywave::scene::{Ray, Scene};
use energywave::{Device, RendererOptions, Result};
use numpy::{
    PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyReadwriteArray3, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::devices::{choose, record};
use crate::failure::{exception, misuse};
use crate::overrides::Overrides;
use crate::points::{with_rows, with_rows_alone};
use crate::scene::OpenedScene;
use crate::watch::{Progress, watched};

/// Draws scenes on a device, or on several at once; one thread at a time, the others wait.
#[pyclass(frozen, module = "energywave._energywave", subclass)]
#[derive(Debug)]
pub struct Renderer {
    renderer: Mutex<energywave::Renderer>,
    devices: Vec<Device>,
    /// Who draws.
    drawer: Mutex<Option<ThreadId>>,
}

/// Who draws is nobody again.
struct Turn<'a> {
    renderer: MutexGuard<'a, energywave::Renderer>,
    drawer: &'a Mutex<Option<ThreadId>>,
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        *locked(self.drawer) = None;
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Renderer {
    pub fn with(renderer: energywave::Renderer, devices: Vec<Device>) -> Self {
        Self {
            renderer: Mutex::new(renderer),
            devices,
            drawer: Mutex::new(None),
        }
    }

    /// Works without Python's lock, when nobody else draws.
    pub fn work<T: Send>(
        &self,
        py: Python<'_>,
        progress: Option<Py<PyAny>>,
        work: impl FnOnce(&mut energywave::Renderer, &mut Progress<'_>) -> Result<T> + Send,
    ) -> PyResult<T> {
        if *locked(&self.drawer) == Some(thread::current().id()) {
            return Err(misuse(
                py,
                "renderer",
                "it draws just now",
                "a progress function draws by another renderer, if at all",
            ));
        }
        watched(py, progress, |progress| {
            let renderer = locked(&self.renderer);
            *locked(&self.drawer) = Some(thread::current().id());
            let mut turn = Turn {
                renderer,
                drawer: &self.drawer,
            };
            work(&mut turn.renderer, progress)
        })
    }
}

/// Returns the scene and the array's values, if the array is the scene's image.
fn check_target(py: Python<'_>, shape: &[usize], scene: &Scene) -> PyResult<()> {
    let wanted = [scene.image.height as usize, scene.image.width as usize, 4];
    match shape == wanted {
        true => Ok(()),
        false => {
            let reason = format!("an array of shape {shape:?}, the scene's image is {wanted:?}");
            let remedy = "give numpy.empty((height, width, 4), numpy.float32)";
            Err(misuse(py, "array", &reason, remedy))
        }
    }
}

/// Returns rows of three numbers, copied unless they lie one behind the other. (An array in Fortran's order, such as
/// `numpy.array([x, y, z]).T`, has a slice, too: of columns.)
fn points<'a>(
    py: Python<'_>,
    place: &str,
    array: &'a PyReadonlyArray2<'_, f64>,
) -> PyResult<Cow<'a, [[f64; 3]]>> {
    if array.shape()[1] != 3 {
        let reason = format!("an array of shape {:?}", array.shape());
        return Err(misuse(py, place, &reason, "give one of (n, 3)"));
    }
    Ok(match array.as_slice() {
        Ok(values) if array.is_c_contiguous() => Cow::Borrowed(values.as_chunks().0),
        _ => {
            let rows = array.as_array();
            let rows = rows.rows().into_iter();
            rows.map(|row| [row[0], row[1], row[2]]).collect()
        }
    })
}

fn check_pairs(py: Python<'_>, names: (&str, &str), counts: (usize, usize)) -> PyResult<()> {
    match counts.0 == counts.1 {
        true => Ok(()),
        false => {
            let reason = format!("{} {}, and {} {}", counts.0, names.0, counts.1, names.1);
            Err(misuse(py, names.1, &reason, "give as many of both"))
        }
    }
}

#[pymethods]
impl Renderer {
    #[new]
    #[pyo3(signature = (device = None, self_test = true))]
    fn new(py: Python<'_>, device: Option<&str>, self_test: bool) -> PyResult<Self> {
        let devices = choose(py, device)?;
        let mut options = RendererOptions::default();
        options.skips_self_test = !self_test;
        let opened = py.detach(|| energywave::Renderer::on_devices(&devices, &options));
        let renderer = opened.map_err(|error| exception(py, &error))?;
        Ok(Self::with(renderer, devices))
    }

    /// Makes a renderer on the context and the device of a queue of pyopencl's.
    #[staticmethod]
    fn on_queue(py: Python<'_>, queue: &Bound<'_, PyAny>) -> PyResult<Self> {
        let renderer = crate::opencl::renderer_on(py, queue)?;
        Ok(Self::with(renderer, Vec::new()))
    }

    #[pyo3(signature = (scene, overrides, progress = None, points = Vec::new()))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        scene: &OpenedScene,
        overrides: &Bound<'py, PyDict>,
        progress: Option<Py<PyAny>>,
        points: Vec<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let scene = scene.frame_beside(py, &Overrides::of(overrides)?, !points.is_empty())?;
        let scene = with_rows_alone(py, scene, &points)?;
        let shape = [scene.image.height as usize, scene.image.width as usize, 4];
        let image = PyArray3::zeros(py, shape, false);
        {
            let mut target = image.readwrite();
            let target = target.as_slice_mut()?;
            self.work(py, progress, |renderer, progress| {
                renderer.render_into_with_progress(&scene, target, progress)
            })?;
        }
        Ok(image)
    }

    #[pyo3(signature = (scene, array, overrides, progress = None, points = Vec::new()))]
    fn render_into<'py>(
        &self,
        py: Python<'py>,
        scene: &OpenedScene,
        mut array: PyReadwriteArray3<'py, f32>,
        overrides: &Bound<'py, PyDict>,
        progress: Option<Py<PyAny>>,
        points: Vec<Bound<'py, PyAny>>,
    ) -> PyResult<()> {
        let scene = scene.frame_beside(py, &Overrides::of(overrides)?, !points.is_empty())?;
        let scene = with_rows_alone(py, scene, &points)?;
        check_target(py, array.shape(), &scene)?;
        let is_in_order = array.is_c_contiguous();
        let (true, Ok(target)) = (is_in_order, array.as_slice_mut()) else {
            let reason = "its values do not lie one behind the other, row by row";
            let remedy =
                "give a whole array in C's order, or copy a part of one (numpy.ascontiguousarray)";
            return Err(misuse(py, "array", reason, remedy));
        };
        self.work(py, progress, |renderer, progress| {
            renderer.render_into_with_progress(&scene, target, progress)
        })
    }

    /// Draws the frame that begins at a time, of `rate` a second, with the shutter of the scene.
    #[pyo3(signature = (scene, rate, overrides, progress = None))]
    fn render_frame<'py>(
        &self,
        py: Python<'py>,
        scene: &OpenedScene,
        rate: f64,
        overrides: &Bound<'py, PyDict>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let read = Overrides::of(overrides)?;
        let open = scene.open_at(read.time, rate);
        if open.is_empty() {
            return self.render(py, scene, overrides, progress, Vec::new());
        }
        let mean = self.work(py, progress, |renderer, progress| {
            let mut scene_at = |time| scene.at(&read.at(time));
            renderer.render_mean_with_progress(open, &mut scene_at, progress)
        })?;
        let size = mean.size();
        let shape = [size.height as usize, size.width as usize, 4];
        let image = PyArray3::zeros(py, shape, false);
        image
            .readwrite()
            .as_slice_mut()?
            .copy_from_slice(mean.as_slice());
        Ok(image)
    }

    #[pyo3(signature = (scene, origins, ends, overrides, progress = None))]
    fn integrate<'py>(
        &self,
        py: Python<'py>,
        scene: &OpenedScene,
        origins: PyReadonlyArray2<'py, f64>,
        ends: PyReadonlyArray2<'py, f64>,
        overrides: &Bound<'py, PyDict>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let scene = scene.frame(py, &Overrides::of(overrides)?)?;
        let (begins, ends) = (points(py, "origins", &origins)?, points(py, "ends", &ends)?);
        check_pairs(py, ("origins", "ends"), (begins.len(), ends.len()))?;
        let light = self.work(py, progress, |renderer, progress| {
            let pairs = begins.iter().zip(ends.iter());
            let ray = |(begin, end): (&[f64; 3], &[f64; 3])| {
                Ray::between(DVec3::from_array(*begin), DVec3::from_array(*end))
            };
            let rays: Vec<Ray> = pairs.map(ray).collect();
            renderer.integrate_with_progress(&scene, &rays, progress)
        })?;
        rows(py, light)
    }

    fn irradiance<'py>(
        &self,
        py: Python<'py>,
        scene: &OpenedScene,
        points: PyReadonlyArray2<'py, f64>,
        normals: PyReadonlyArray2<'py, f64>,
        overrides: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let scene = scene.frame(py, &Overrides::of(overrides)?)?;
        let vectors = |rows: &[[f64; 3]]| rows.iter().copied().map(DVec3::from_array).collect();
        let points: Vec<DVec3> = vectors(&self::points(py, "points", &points)?);
        let normals: Vec<DVec3> = vectors(&self::points(py, "normals", &normals)?);
        check_pairs(py, ("points", "normals"), (points.len(), normals.len()))?;
        let light = self.work(py, None, |renderer, _| {
            renderer.irradiance(&scene, &points, &normals)
        })?;
        rows(py, light)
    }

    /// Enqueues a frame into a buffer or an image of pyopencl's, and returns the handle of its event.
    fn enqueue<'py>(
        &self,
        py: Python<'py>,
        scene: &OpenedScene,
        target: (Bound<'py, PyAny>, bool),
        depth_and_points: (Option<Bound<'py, PyAny>>, Vec<Bound<'py, PyAny>>),
        wait_for: Vec<Bound<'py, PyAny>>,
        overrides: &Bound<'py, PyDict>,
    ) -> PyResult<usize> {
        let (depth, points) = depth_and_points;
        let scene = scene.frame_beside(py, &Overrides::of(overrides)?, !points.is_empty())?;
        let (scene, in_buffers) = with_rows(scene, &points)?;
        crate::opencl::enqueue(
            self,
            &scene,
            &target,
            (depth.as_ref(), &in_buffers),
            &wait_for,
        )
    }

    /// What the devices are, a dictionary each.
    #[getter]
    fn device_records<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.devices
            .iter()
            .map(|device| record(py, device))
            .collect()
    }

    #[getter]
    fn last_cost<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let cost = self.work(py, None, |renderer, _| Ok(renderer.last_cost()))?;
        let record = PyDict::new(py);
        record.set_item("kernel_seconds", cost.kernel.as_secs_f64())?;
        record.set_item("integrals", cost.integrals)?;
        record.set_item("samples", cost.samples)?;
        record.set_item("launches", cost.launches)?;
        Ok(record)
    }
}

/// Returns triples as an array of (n, 3).
fn rows<T: numpy::Element + Copy>(
    py: Python<'_>,
    light: Vec<[T; 3]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = light.len();
    let flat = numpy::PyArray1::from_vec(py, light.into_flattened());
    flat.reshape([count, 3])
}
