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
use crate::image::{Bloom, DepthImage};
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
    /// Surfaces are found before this returns, on a queue that waits for no host.
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
    /// on the device, anew for every frame, after `wait_list` and what is on the host's queue before the frame. Where a
    /// scene has surfaces, metaballs or visible colliders, this waits for them.
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
    pub(super) unsafe fn enqueue_frame(
        &mut self,
        scene: &Scene,
        target: HostTarget,
        depth: Option<&HostDepth>,
        wait_list: &[cl_event],
    ) -> Result<Event> {
        self.check(scene)?;
        self.host_renderer()?;
        let simulated = self.simulated(scene)?;
        let scene = simulated.as_ref().unwrap_or(scene);
        if self.is_joined(scene)? {
            // SAFETY: the caller's promise.
            return unsafe { self.enqueue_joined(scene, (target, depth), wait_list) };
        }
        let bloom = self.bloom_of(scene);
        let renderer = self.host_renderer()?;
        // SAFETY: the caller's promise.
        unsafe { renderer.enqueue(scene, bloom, (target, depth), wait_list) }
    }

    /// Enqueues a frame that is put together of parts; only depths that a host has on the device are waited for.
    ///
    /// # Safety
    /// As [`Renderer::enqueue_behind`].
    unsafe fn enqueue_joined(
        &mut self,
        scene: &Scene,
        (target, depth): (HostTarget, Option<&HostDepth>),
        wait_list: &[cl_event],
    ) -> Result<Event> {
        let bloom = self.bloom_of(scene);
        let renderer = self.host_renderer()?;
        let size = (scene.image.width, scene.image.height);
        // SAFETY: the caller's promise.
        unsafe { HostLink::check(&renderer.compute, target, size, wait_list) }?;
        let behind = match depth {
            // SAFETY: the same.
            Some(depth) => Some(unsafe { renderer.fetch(scene, (target, depth), wait_list) }?),
            None => None,
        };
        let behind = behind.map(|depth| Scene {
            depth: Some(depth),
            ..scene.clone()
        });
        let scene = behind.as_ref().unwrap_or(scene);
        let seen = match scene.has_surfaces() {
            true => Some(self.see_all_surfaces(scene)?),
            false => None,
        };
        let parts = self.parts_of(scene, seen.as_ref())?;
        let mut cost = FrameCost::default();
        let mut draw = |renderer: &mut DeviceRenderer, film: &mut Film| {
            cost = renderer.draw_parts(scene, &parts, film, bloom.as_ref())?;
            Ok(())
        };
        let renderer = self.host_renderer()?;
        // SAFETY: the caller's promise.
        let event = unsafe { renderer.draw_for_host(target, size, wait_list, &mut draw) }?;
        self.cost_before = self.cost_before.then(cost);
        Ok(event)
    }
}

/// Draws into a film with what a renderer has but its own film and its host.
type DrawFilm<'a> = dyn FnMut(&mut DeviceRenderer, &mut Film) -> Result<()> + 'a;

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
        let size = (scene.image.width, scene.image.height);
        let depth = match depth {
            Some(depth) => {
                let values = depth.values(scene)?;
                let compute = &self.compute;
                // SAFETY: the caller's promise.
                let held = unsafe { HeldDepths::take(compute, depth.memory, target, size) }?;
                Some((held, values, depth.lengths_along()))
            }
            None => None,
        };
        let mut draw = |renderer: &mut Self, film: &mut Film| {
            let Self {
                engines,
                spreader,
                host_depths,
                compute,
                ..
            } = renderer;
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
        // SAFETY: the caller's promise.
        unsafe { self.draw_for_host(target, size, wait_list, &mut draw) }
    }

    /// Waits for a host's depths, and reads their lengths.
    ///
    /// # Safety
    /// As [`crate::Renderer::enqueue_behind`].
    unsafe fn fetch(
        &mut self,
        scene: &Scene,
        (target, depth): (HostTarget, &HostDepth),
        wait_list: &[cl_event],
    ) -> Result<DepthImage> {
        let Self {
            host,
            host_depths,
            compute,
            ..
        } = self;
        let values = depth.values(scene)?;
        let size = (scene.image.width, scene.image.height);
        // SAFETY: the caller's promise.
        let held = unsafe { HeldDepths::take(compute, depth.memory, target, size) }?;
        host_depth::prepare(compute, host_depths)?;
        let host = host.as_mut().ok_or_else(no_host)?;
        // SAFETY: the same.
        unsafe { host.begin_after(compute, wait_list) }?;
        host_depths.enqueue(compute, &held, &values)?;
        let lengths = host_depths.read(compute, scene.image.pixels())?;
        DepthImage::new(scene.image, depth.lengths_along(), lengths)
    }

    /// Has a film drawn that is aimed at a host's memory. Nothing here waits.
    ///
    /// # Safety
    /// As [`crate::Renderer::enqueue`].
    pub(super) unsafe fn draw_for_host(
        &mut self,
        target: HostTarget,
        size: (u32, u32),
        wait_list: &[cl_event],
        draw: &mut DrawFilm<'_>,
    ) -> Result<Event> {
        self.bloom_cost = FrameCost::default();
        let mut host = self.host.take().ok_or_else(no_host)?;
        let mut film = std::mem::take(&mut self.film);
        // SAFETY: the caller's promise.
        let begun = unsafe { host.begin(&self.compute, &mut film, target, size, wait_list) };
        let ended = begun.and_then(|mut frame| {
            let mut drawn = draw(self, &mut film);
            if matches!(drawn, Err(Error::Build { .. })) {
                match host.copies_instead(&self.compute, &mut film, &mut frame) {
                    Ok(true) => drawn = draw(self, &mut film),
                    Ok(false) => {}
                    Err(error) => drawn = Err(error),
                }
            }
            film.leave_unfinished(false); // wherever it ended
            host.end(&self.compute, &mut film, frame, drawn)
        });
        (self.film, self.host) = (film, Some(host));
        ended
    }
}

/// Makes the error of a frame that was to be enqueued by a renderer without a host.
pub(super) fn no_host() -> Error {
    unfit(
        "queue",
        "this renderer was made without one; make it with Renderer::on_host",
    )
}
