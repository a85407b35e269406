//! Contexts, queues, buffers, images and events of pyopencl's, taken by their handles (`int_ptr`).
#![allow(unsafe_code)] // pyopencl hands over handles that only it knows to be alive

use std::ffi::c_void;

use energywave::image::DepthAlong;
use energywave::opencl3::event::Event;
use energywave::scene::Scene;
use energywave::{HostDepth, HostDepthMemory, HostPoints, HostTarget, RendererOptions, Result};
use pyo3::prelude::*;

use crate::failure::{exception, misuse};
use crate::overrides::word;
use crate::points::BufferPoints;
use crate::renderer::Renderer;

/// What an `energywave.HostDepth` says.
#[derive(Debug, Clone, Copy)]
struct Depth {
    memory: usize,
    is_image: bool,
    along: DepthAlong,
    scale: f64,
    is_bottom_up: bool,
    /// Of a buffer, bytes.
    offset: usize,
    row_pitch: usize,
}

impl Depth {
    fn of(depth: &Bound<'_, PyAny>) -> PyResult<Self> {
        let words = [
            ("ray", DepthAlong::Ray),
            ("axis", DepthAlong::Axis),
            ("ndc", DepthAlong::Ndc),
            ("buffer", DepthAlong::Buffer),
        ];
        let bytes = |name: &str| {
            depth.getattr(name)?.extract::<usize>().map_err(|_| {
                let place = format!("depth.{name}");
                let remedy = "give a whole number of bytes, a multiple of 4";
                misuse(depth.py(), &place, "it is no number of bytes", remedy)
            })
        };
        Ok(Self {
            memory: handle(&depth.getattr("memory")?, "depth.memory")?,
            is_image: depth.getattr("is_image")?.extract()?,
            along: word("depth.along", &depth.getattr("along")?, &words)?,
            scale: depth.getattr("scale")?.extract().map_err(|_| {
                let remedy = "give a number, not 0";
                misuse(depth.py(), "depth.scale", "it is no number", remedy)
            })?,
            is_bottom_up: depth.getattr("is_bottom_up")?.is_truthy()?,
            offset: bytes("offset")?,
            row_pitch: bytes("row_pitch")?,
        })
    }

    /// Returns what the library is told, of a scene whose camera has the projection.
    fn of_host(&self, scene: &Scene) -> Result<HostDepth> {
        let memory = self.memory as *mut c_void;
        let memory = match self.is_image {
            true => HostDepthMemory::Image(memory),
            false => HostDepthMemory::Buffer {
                buffer: memory,
                offset: self.offset,
                row_pitch: self.row_pitch,
            },
        };
        let mut depth = HostDepth::of_camera(memory, self.along, &scene.camera)?;
        depth.scale = self.scale;
        depth.is_bottom_up = self.is_bottom_up;
        Ok(depth)
    }
}

/// Sets in the environment what drivers need and lack, as the program does: PoCL's threads, its linker, its cache. What
/// it returns the user should know. The package calls it when it is imported.
#[pyfunction]
pub fn suit_drivers() -> Vec<String> {
    // SAFETY: Python's lock is held, under which Python itself changes the environment (`os.environ`); threads that
    // read it at this moment without the lock would be at odds with Python, too.
    unsafe { energywave::suit_pocl() }
}

fn type_name(object: &Bound<'_, PyAny>) -> String {
    let name = object.get_type().name();
    name.map_or_else(|_| "thing".to_owned(), |name| name.to_string())
}

/// Returns the handle that an object of pyopencl's has.
pub fn handle(object: &Bound<'_, PyAny>, place: &str) -> PyResult<usize> {
    let pointer = object
        .getattr("int_ptr")
        .and_then(|it| it.extract::<usize>());
    match pointer {
        Ok(pointer) if pointer != 0 => Ok(pointer),
        _ => {
            let reason = format!(
                "it is of type {} and has no handle (int_ptr)",
                type_name(object)
            );
            Err(misuse(
                object.py(),
                place,
                &reason,
                "give an object of pyopencl's",
            ))
        }
    }
}

/// Makes a renderer on the context and the device of a queue.
pub fn renderer_on(py: Python<'_>, queue: &Bound<'_, PyAny>) -> PyResult<energywave::Renderer> {
    let context = queue.getattr("context").map_err(|_| {
        let reason = format!("it is of type {} and has no context", type_name(queue));
        misuse(py, "queue", &reason, "give a pyopencl.CommandQueue")
    })?;
    let (context_handle, queue_handle) = (handle(&context, "context")?, handle(queue, "queue")?);
    let opened = py.detach(|| {
        let context = context_handle as *mut c_void;
        let queue = queue_handle as *mut c_void;
        // SAFETY: the objects that own these handles live until this returns; the renderer retains both.
        unsafe { energywave::Renderer::on_raw_host(context, queue, &RendererOptions::default()) }
    });
    opened.map_err(|error| exception(py, &error))
}

/// Enqueues a frame, behind depths and with points in buffers if there are some, and returns the handle of its event,
/// whose owner is the caller.
pub fn enqueue(
    renderer: &Renderer,
    scene: &Scene,
    (target, is_image): &(Bound<'_, PyAny>, bool),
    (depth, points): (Option<&Bound<'_, PyAny>>, &[BufferPoints]),
    wait_for: &[Bound<'_, PyAny>],
) -> PyResult<usize> {
    let py = target.py();
    let memory = handle(target, "target")?;
    let depth = depth.map(Depth::of).transpose()?;
    let events = wait_for.iter().map(|event| handle(event, "wait_for"));
    let events = events.collect::<PyResult<Vec<usize>>>()?;
    renderer.work(py, None, |renderer, _| {
        let memory = memory as *mut c_void;
        let target = match is_image {
            true => HostTarget::Image(memory),
            false => HostTarget::Buffer(memory),
        };
        let events: Vec<_> = events.iter().map(|event| *event as *mut c_void).collect();
        let depth = depth.map(|depth| depth.of_host(scene)).transpose()?;
        let points: Vec<HostPoints> = points.iter().map(BufferPoints::of_host).collect();
        // SAFETY: the objects that own these handles live until this returns; OpenCL retains what its commands use.
        // What else is done with target, depths and points meanwhile is the caller's affair, as with any command of a
        // queue.
        let event: Event = unsafe {
            match &depth {
                depth if !points.is_empty() => {
                    renderer.enqueue_points(scene, target, &points, depth.as_ref(), &events)
                }
                Some(depth) => renderer.enqueue_behind(scene, target, depth, &events),
                None => renderer.enqueue(scene, target, &events),
            }
        }?;
        let handle = event.get() as usize;
        std::mem::forget(event); // the reference goes to the caller
        Ok(handle)
    })
}
