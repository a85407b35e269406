//! Points that a host has in buffers of its own, drawn as those of a scene: a particle system lives there.
#![allow(unsafe_code)] // hosts hand over handles that only they know to be alive

use std::sync::Arc;

use glam::DVec3;
use opencl3::event::Event;
use opencl3::types::{cl_event, cl_mem};

use super::{HostDepth, Renderer};
use crate::error::Result;
use crate::opencl::{Compute, HeldRows, HostTarget, unfit};
use crate::scene::{PointList, PointRows, Points, Profile, Scene};

/// Points of light in a host's own buffers, for [`Renderer::enqueue_points`]: drawn as the same
/// [`Points`] of the scene, to the bit, without a copy of them where the device shares the host's memory, as
/// CPUs do. From a device with its own memory, 16 bytes a row are read for each frame: points are sorted on the host.
/// `examples/sparks.rs` moves a million.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HostPoints {
    /// A buffer of float4: x, y and z, world units; the fourth is not looked at. A place in a larger buffer is a
    /// sub-buffer.
    pub positions: cl_mem,
    /// A buffer of float4, one for each position: linear RGB; the fourth is not looked at. `None`: all have `color`.
    pub lights: Option<cl_mem>,
    /// A buffer of float4, one for each position: where the point was, and along the way from there lies its light, as
    /// by [`PointList::with_previous`]; the fourth is not looked at. `None`: points have not moved.
    pub previous: Option<cl_mem>,
    /// How many points there are, from the beginning of the buffers.
    pub count: usize,
    /// What the light of each is multiplied with.
    pub coefficient: f64,
    /// Linear RGB, of points that have no light of their own.
    pub color: DVec3,
    /// How their light falls off, as of [`Points`].
    pub profile: Profile,
    /// How thick they are, as of [`Points`]; world units, 0 for none.
    pub radius: f64,
}

impl HostPoints {
    /// Takes white points of coefficient 1 whose light falls off with the squared distance.
    #[must_use]
    pub fn new(positions: cl_mem, count: usize) -> Self {
        Self {
            positions,
            lights: None,
            previous: None,
            count,
            coefficient: 1.0,
            color: DVec3::ONE,
            profile: Profile::default(),
            radius: 0.0,
        }
    }

    /// Maps them, and looks at each.
    ///
    /// # Safety
    /// The buffers are alive, and nothing writes there until the points are dropped.
    unsafe fn held(&self, compute: &Arc<Compute>) -> Result<Points> {
        let take = |object, buffer| {
            // SAFETY: the caller's promise.
            unsafe { HeldRows::take(compute, object, buffer, self.count) }
        };
        let some = |object, buffer: Option<cl_mem>| buffer.map(|it| take(object, it)).transpose();
        let rows = HeldPoints {
            positions: take(POSITIONS, self.positions)?,
            lights: some(LIGHTS, self.lights)?,
            previous: some(PREVIOUS, self.previous)?,
        };
        let list = PointList::of_rows(Box::new(rows)).map_err(|reason| unfit("points", reason))?;
        let mut points = Points::new(list);
        (points.coefficient, points.color) = (self.coefficient, self.color);
        (points.profile, points.radius) = (self.profile, self.radius);
        Ok(points)
    }
}

const POSITIONS: &str = "positions of points";
const LIGHTS: &str = "lights of points";
const PREVIOUS: &str = "previous positions of points";

/// A host's buffers, mapped.
struct HeldPoints {
    positions: HeldRows,
    lights: Option<HeldRows>,
    previous: Option<HeldRows>,
}

impl PointRows for HeldPoints {
    fn positions(&self) -> &[[f32; 4]] {
        self.positions.rows()
    }

    fn lights(&self) -> Option<&[[f32; 4]]> {
        self.lights.as_ref().map(HeldRows::rows)
    }

    fn previous(&self) -> Option<&[[f32; 4]]> {
        self.previous.as_ref().map(HeldRows::rows)
    }
}

impl Renderer {
    /// Enqueues a frame as [`Renderer::enqueue`] does, or with depths as [`Renderer::enqueue_behind`], of a scene and
    /// of points in the host's own buffers, which are read anew for every frame: after `wait_list` and what is on the
    /// host's queue before it, which this waits for. When it returns, points have been read and may be written again.
    ///
    /// # Safety
    /// As [`Renderer::enqueue_behind`]; the points' memory objects are valid handles, too, which the caller holds a
    /// reference to, and until this returns nothing writes there.
    ///
    /// # Errors
    /// As [`Renderer::enqueue_behind`]; [`Error::Host`](crate::Error::Host) also if a buffer does not fit or a point is
    /// no number: which is said.
    pub unsafe fn enqueue_points(
        &mut self,
        scene: &Scene,
        target: HostTarget,
        points: &[HostPoints],
        depth: Option<&HostDepth>,
        wait_list: &[cl_event],
    ) -> Result<Event> {
        let mut with_points = scene.clone();
        let renderer = self.host_renderer()?;
        // SAFETY: the caller's promise.
        let queue = unsafe { renderer.begin_reading(scene, target, wait_list) }?;
        for points in points {
            // SAFETY: the same.
            with_points.points.push(unsafe { points.held(&queue) }?);
        }
        // SAFETY: the same.
        unsafe { self.enqueue_frame(&with_points, target, depth, wait_list) }
    }
}

impl super::one::DeviceRenderer {
    /// Returns a queue on which what a host has is read, after its list and what is on its own queue.
    ///
    /// # Safety
    /// As [`Renderer::enqueue`].
    unsafe fn begin_reading(
        &mut self,
        scene: &Scene,
        target: HostTarget,
        wait_list: &[cl_event],
    ) -> Result<Arc<Compute>> {
        let size = (scene.image.width, scene.image.height);
        let host = self.host.as_mut().ok_or_else(super::host::no_host)?;
        // SAFETY: the caller's promise, twice.
        unsafe {
            crate::opencl::HostLink::check(&self.compute, target, size, wait_list)?;
            host.reading_queue(&self.compute, wait_list)
        }
    }
}
