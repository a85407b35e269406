//! Contexts, queues, buffers, images and events of pyopencl's, taken by their handles (`int_ptr`).
#![allow(unsafe_code)] // pyopencl hands over handles that only it knows to be alive

use std::ffi::c_void;

use energywave::opencl3::event::Event;
use energywave::scene::Scene;
use energywave::{HostTarget, RendererOptions};
use pyo3::prelude::*;

use crate::failure::{exception, misuse};
use crate::renderer::Renderer;

/// Returns the handle that an object of pyopencl's has.
fn handle(object: &Bound<'_, PyAny>, place: &str) -> PyResult<usize> {
    let pointer = object
        .getattr("int_ptr")
        .and_then(|it| it.extract::<usize>());
    match pointer {
        Ok(pointer) if pointer != 0 => Ok(pointer),
        _ => {
            let reason = format!("{} has no handle (int_ptr)", object.get_type());
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
    let context = queue.getattr("context")?;
    let (context_handle, queue_handle) = (handle(&context, "context")?, handle(queue, "queue")?);
    let opened = py.detach(|| {
        let context = context_handle as *mut c_void;
        let queue = queue_handle as *mut c_void;
        // SAFETY: the objects that own these handles live until this returns; the renderer retains both.
        unsafe { energywave::Renderer::on_raw_host(context, queue, &RendererOptions::default()) }
    });
    opened.map_err(|error| exception(py, &error))
}

/// Enqueues a frame, and returns the handle of its event, whose owner is the caller.
pub fn enqueue(
    renderer: &Renderer,
    scene: &Scene,
    (target, is_image): (&Bound<'_, PyAny>, bool),
    wait_for: &[Bound<'_, PyAny>],
) -> PyResult<usize> {
    let py = target.py();
    let memory = handle(target, "target")?;
    let events = wait_for.iter().map(|event| handle(event, "wait_for"));
    let events = events.collect::<PyResult<Vec<usize>>>()?;
    renderer.work(py, None, |renderer, _| {
        let memory = memory as *mut c_void;
        let target = match is_image {
            true => HostTarget::Image(memory),
            false => HostTarget::Buffer(memory),
        };
        let events: Vec<_> = events.iter().map(|event| *event as *mut c_void).collect();
        // SAFETY: the objects that own these handles live until this returns; OpenCL retains what its commands use.
        // What else is done with the target meanwhile is the caller's affair, as with any command of a queue.
        let event: Event = unsafe { renderer.enqueue(scene, target, &events) }?;
        let handle = event.get() as usize;
        std::mem::forget(event); // the reference goes to the caller
        Ok(handle)
    })
}
