//! Renderers on a host's own context and queue, which draw into its buffer or image.
//!
//! Kernels run on a queue of our own in the host's context, tied to the host's at both ends by events. So launches are
//! timed even where the host's queue has no profiling, an out-of-order queue needs no barriers, and nothing but two
//! markers is put on the host's queue.
#![allow(unsafe_code)] // hosts hand over handles that only they know to be alive

use opencl3::command_queue::CommandQueue;
use opencl3::context::Context;
use opencl3::event::Event;
use opencl3::types::{cl_command_queue, cl_context, cl_event};

use super::host_depth::{self, HostDepth};
use super::one::DeviceRenderer;
use super::{Renderer, RendererBackend};
use crate::cost::FrameCost;
use crate::error::{Error, Result};
use crate::image::Bloom;
use crate::opencl::{Film, HeldDepths, HostLink, HostTarget, RendererOptions, unfit};
use crate::scene::Scene;
use crate::wave::DeviceDepths;

impl Renderer {
    /// Makes a renderer on a host's context, for the device of the host's queue: it draws into the host's memory by
    /// [`Renderer::enqueue`], and into its own as any other. It keeps a reference to both.
    ///
    /// # Errors
    /// [`Error::Host`](crate::Error::Host) if the queue belongs to another context, or its device cannot render;
    /// [`Error::Device`](crate::Error::Device).
    pub fn on_host(context: &Context, queue: &CommandQueue) -> Result<Self> {
        // SAFETY: the borrows keep both alive.
        unsafe { Self::on_raw_host(context.get(), queue.get(), &RendererOptions::default()) }
    }

    /// Makes a renderer as [`Renderer::on_host`] does, from handles as C has them.
    ///
    /// # Safety
    /// Both are valid handles, which the caller holds a reference to.
    ///
    /// # Errors
    /// As [`Renderer::on_host`].
    pub unsafe fn on_raw_host(
        context: cl_context,
        queue: cl_command_queue,
        options: &RendererOptions,
    ) -> Result<Self> {
        // SAFETY: the caller's promise.
        let (compute, link) = unsafe { HostLink::open(context, queue) }?;
        let renderer = DeviceRenderer::with_compute(compute, Some(link), options)?;
        Ok(Self::with_backend(RendererBackend::OpenCl(Box::new(
            renderer,
        ))))
    }

    /// Enqueues a frame that is drawn into a host's buffer or image, and returns the event of its end, a marker on the
    /// host's queue. The frame begins after `wait_list` and what is on the host's queue before it; what comes after it
    /// on an in-order queue waits for it.
    ///
    /// The host's queue is flushed, never finished, and nothing here waits for it (but for the compiler, the first time
    /// that a scene needs other kernels): what goes wrong on the device later shows at the event, and at the next call.
    /// Dropping the renderer waits until the device has read what was uploaded.
    ///
    /// # Safety
    /// Target and events are valid handles, which the caller holds a reference to. Until the event is over, nothing
    /// else uses the target.
    ///
    /// # Errors
    /// As [`Renderer::render`]; [`Error::Host`](crate::Error::Host) if the renderer was made without a host, or target
    /// or events do not fit: all that is checked before anything is enqueued.
    pub unsafe fn enqueue(
        &mut self,
        scene: &Scene,
        target: HostTarget,
        wait_list: &[cl_event],
    ) -> Result<Event> {
        // SAFETY: the caller's promise.
        unsafe { self.enqueue_frame(scene, target, None, wait_list) }
    }

    /// Enqueues a frame as [`Renderer::enqueue`] does, whose rays end at depths in the host's own memory. They are read
    /// on the device, anew for every frame, after `wait_list` and what is on the host's queue before the frame.
    ///
    /// # Safety
    /// As [`Renderer::enqueue`]; the depths' memory is a valid handle, too, which the caller holds a reference to, and
    /// until the event is over nothing writes there.
    ///
    /// # Errors
    /// As [`Renderer::enqueue`]; [`Error::Host`](crate::Error::Host) also if the depths do not fit: another size,
    /// format or context, memory that kernels may not read or that is the target, a scene with depths of its own.
    pub unsafe fn enqueue_behind(
        &mut self,
        scene: &Scene,
        target: HostTarget,
        depth: &HostDepth,
        wait_list: &[cl_event],
    ) -> Result<Event> {
        // SAFETY: the caller's promise.
        unsafe { self.enqueue_frame(scene, target, Some(depth), wait_list) }
    }

    /// # Safety
    /// As [`Renderer::enqueue_behind`].
    unsafe fn enqueue_frame(
        &mut self,
        scene: &Scene,
        target: HostTarget,
        depth: Option<&HostDepth>,
        wait_list: &[cl_event],
    ) -> Result<Event> {
        self.check(scene)?;
        if scene
            .depth
            .as_ref()
            .is_some_and(|it| it.size() != scene.image)
        {
            let reason =
                "the scene's are finer than its pixels; a host's memory takes one for each pixel";
            return Err(unfit("depth", reason));
        }
        let simulated = self.simulated(scene)?;
        let scene = simulated.as_ref().unwrap_or(scene);
        if scene.has_surfaces() {
            let what = match (scene.meshes.is_empty(), scene.metaballs.is_empty()) {
                (false, _) => "mesh",
                (true, false) => "metaballs",
                (true, true) => "collider",
            };
            let reason = "frames for a host have no surfaces; render them into an image (Renderer::render_into)";
            return Err(unfit(what, reason));
        }
        let bloom = self.bloom_of(scene);
        match &mut self.backend {
            // SAFETY: the caller's promise.
            RendererBackend::OpenCl(renderer) => unsafe {
                renderer.enqueue(scene, bloom, (target, depth), wait_list)
            },
            RendererBackend::Several(_) | RendererBackend::Reference { .. } => Err(no_host()),
        }
    }
}

impl DeviceRenderer {
    /// Enqueues a frame of a valid scene for the host. Nothing here waits.
    ///
    /// # Safety
    /// As [`crate::Renderer::enqueue_behind`].
    unsafe fn enqueue(
        &mut self,
        scene: &Scene,
        bloom: Option<Bloom>,
        (target, depth): (HostTarget, Option<&HostDepth>),
        wait_list: &[cl_event],
    ) -> Result<Event> {
        self.bloom_cost = FrameCost::default();
        let Self {
            engines,
            spreader,
            film,
            host,
            host_depths,
            compute,
            ..
        } = self;
        let host = host.as_mut().ok_or_else(no_host)?;
        let size = (scene.image.width, scene.image.height);
        let depth = match depth {
            Some(depth) => {
                let values = depth.values(scene)?;
                // SAFETY: the caller's promise.
                let held = unsafe { HeldDepths::take(compute, depth.memory, target, size) }?;
                Some((held, values, depth.lengths_along()))
            }
            None => None,
        };
        // SAFETY: the caller's promise.
        let mut frame = unsafe { host.begin(compute, film, target, size, wait_list) }?;
        let mut draw = |film: &mut Film| {
            let depths = match &depth {
                Some((held, values, along)) => {
                    host_depth::prepare(compute, host_depths)?;
                    let memory = host_depths.enqueue(compute, held, values)?;
                    Some(DeviceDepths {
                        memory,
                        along: *along,
                    })
                }
                None => None,
            };
            let plan = engines.plan(compute, scene, depths, film.format())?;
            let pixels = scene.image.pixels();
            engines.begin(compute, &plan, pixels)?;
            engines.draw_unwatched(compute, &plan, pixels, film, bloom.is_some())?;
            let Some(bloom) = bloom else {
                return Ok(());
            };
            spreader.spread(compute, film, scene.image, &bloom)
        };
        let mut drawn = draw(film);
        if matches!(drawn, Err(Error::Build { .. }))
            && host.copies_instead(compute, film, &mut frame)?
        {
            drawn = draw(film);
        }
        host.end(compute, film, frame, drawn)
    }
}

/// Makes the error of a frame that was to be enqueued by a renderer without a host.
fn no_host() -> Error {
    unfit(
        "queue",
        "this renderer was made without one; make it with Renderer::on_host",
    )
}
