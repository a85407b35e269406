//! Frames into a host's OpenCL buffer or image, with its events, behind its depths, and with its points.

use std::ffi::c_char;
use std::mem::{self, offset_of};
use std::sync::{Arc, Mutex};

use energywave::image::DepthAlong;
use energywave::{HostDepth, HostDepthMemory, HostTarget, Renderer, Scene};

use crate::border::{self, Versioned};
use crate::host_points::{Points, points_of};
use crate::registry;
use crate::renderer::{RendererHandle, flag};
use crate::scene::{SceneHandle, scene_of};
use crate::status::{Outcome, Status, bad_argument, guarded};

/// A memory object is a buffer.
pub const ENERGYWAVE_BUFFER: u32 = 1;
/// A memory object is an image.
pub const ENERGYWAVE_IMAGE: u32 = 2;

/// OpenCL's memory object, `cl_mem` without its `*`.
#[allow(dead_code, reason = "C knows it by its name alone")]
pub struct ClMem;

/// OpenCL's event, `cl_event` without its `*`.
#[allow(dead_code, reason = "C knows it by its name alone")]
pub struct ClEvent;

/// Where a frame of a host goes, and what it waits for.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Frame {
    /// `sizeof` of this struct.
    pub struct_size: usize,
    /// Where light goes. A buffer of float32, four values a pixel, by rows from the top left, made with
    /// `CL_MEM_READ_WRITE`; or a 2D image of the scene's size, `CL_RGBA` of `CL_FLOAT` or `CL_HALF_FLOAT`.
    pub target: *mut ClMem,
    /// ENERGYWAVE_BUFFER or ENERGYWAVE_IMAGE.
    pub target_kind: u32,
    /// How many events the frame waits for, besides what is on the host's queue.
    pub wait_count: u32,
    /// The events; NULL if there are none.
    pub wait_list: *const *mut ClEvent,
    /// Depths that end the rays, one a pixel; NULL: nothing hides the light.
    pub depth: *mut ClMem,
    /// ENERGYWAVE_BUFFER: float32. ENERGYWAVE_IMAGE: the first channel of `CL_R`, `CL_DEPTH` or `CL_RGBA`.
    pub depth_kind: u32,
    /// 1: the first row of depths is the lowest, as OpenGL draws.
    pub depth_is_bottom_up: u32,
    /// `ray`, `axis`, or of the scene's camera matrices `ndc` or `buffer`; NULL: `ray`.
    pub depth_along: *const c_char,
    /// World units to a unit of depth; 0: 1.
    pub depth_scale: f64,
    /// Of a buffer: where the first row of depths begins, bytes.
    pub depth_offset: usize,
    /// Of a buffer: from row to row of depths, bytes; 0: no gap.
    pub depth_row_pitch: usize,
    /// Points of light besides the scene's, an array; NULL if there are none.
    pub points: *const Points,
    /// How many elements that array has.
    pub points_count: u32,
    /// 0.
    pub reserved: u32,
}

// SAFETY: it begins with its size, and its fields are numbers and addresses.
unsafe impl Versioned for Frame {
    const FIRST: usize = offset_of!(Frame, points);
}

impl Frame {
    fn target(&self) -> Outcome<HostTarget> {
        let target = self.target.cast();
        match self.target_kind {
            ENERGYWAVE_BUFFER => Ok(HostTarget::Buffer(target)),
            ENERGYWAVE_IMAGE => Ok(HostTarget::Image(target)),
            other => Err(wrong_kind("frame.target_kind", other)),
        }
    }

    /// # Safety
    /// `depth_along` is NULL, or ends with a 0.
    unsafe fn depth(&self, scene: &Scene) -> Outcome<Option<HostDepth>> {
        if self.depth.is_null() {
            return Ok(None);
        }
        let depth = self.depth.cast();
        let memory = match self.depth_kind {
            ENERGYWAVE_BUFFER => HostDepthMemory::Buffer {
                buffer: depth,
                offset: self.depth_offset,
                row_pitch: self.depth_row_pitch,
            },
            ENERGYWAVE_IMAGE => HostDepthMemory::Image(depth),
            other => return Err(wrong_kind("frame.depth_kind", other)),
        };
        // SAFETY: the caller's promise.
        let along = unsafe { border::optional_text(self.depth_along, "frame.depth_along") }?;
        let along = match along.unwrap_or("ray") {
            "ray" => DepthAlong::Ray,
            "axis" => DepthAlong::Axis,
            "ndc" => DepthAlong::Ndc,
            "buffer" => DepthAlong::Buffer,
            other => {
                let other = energywave::shown(other);
                let reason = format!("\"{other}\" is none; use ray, axis, ndc, buffer");
                return Err(bad_argument("frame.depth_along", &reason));
            }
        };
        let mut depth = HostDepth::of_camera(memory, along, &scene.camera)?;
        if self.depth_scale != 0.0 {
            depth.scale = self.depth_scale;
        }
        depth.is_bottom_up = flag(self.depth_is_bottom_up, "frame.depth_is_bottom_up")?;
        Ok(Some(depth))
    }
}

fn wrong_kind(name: &str, kind: u32) -> crate::status::Failure {
    let reason = format!("{kind}; it must be ENERGYWAVE_BUFFER or ENERGYWAVE_IMAGE");
    bad_argument(name, &reason)
}

/// Enqueues a frame that is drawn into a host's buffer or image: the renderer is one of energywave_renderer_on_host.
/// The frame begins after the events and what is on the host's queue before it; what comes after it on an in-order
/// queue waits for it. Nothing here waits for the device, but for the compiler the first time that a scene needs other
/// kernels, and where surfaces meet the host's depths. With points this waits for what the frame waits for, and reads
/// them: when it comes back they may be written again. `*event` is the frame's end, a marker on the host's queue, which
/// the caller releases; `event` may be NULL.
///
/// # Safety
/// `frame` points to as many bytes as it says, and its points to as many structs; all memory objects and events are
/// alive, or NULL; texts end with a 0. Until the event is over nothing else uses the target, and nothing writes the
/// depths. `event` is NULL, or points to a place for an event.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_enqueue(
    renderer: *mut RendererHandle,
    scene: *const SceneHandle,
    frame: *const Frame,
    event: *mut *mut ClEvent,
) -> Status {
    guarded(|| {
        let kept: Arc<Mutex<Renderer>> = registry::find(renderer)?;
        let scene = scene_of(scene)?;
        // SAFETY: the caller's promise.
        let frame = unsafe { border::read_struct(frame, "frame") }?;
        let target = frame.target()?;
        let count = frame.wait_count as usize;
        // SAFETY: the same, four times.
        let (depth, points, wait_list, event) = unsafe {
            let depth = frame.depth(&scene)?;
            let points = points_of(frame.points, frame.points_count, "frame.points")?;
            let wait_list = border::values(frame.wait_list, count, "frame.wait_list")?;
            let event = match event.is_null() {
                true => None,
                false => Some(border::out(event, "event")?),
            };
            (depth, points, wait_list, event)
        };
        let events: Vec<_> = wait_list.iter().map(|event| event.cast()).collect();
        let mut renderer = registry::lock(&kept)?;
        // SAFETY: the same.
        let drawn = unsafe {
            match &depth {
                depth if !points.is_empty() => {
                    renderer.enqueue_points(&scene, target, &points, depth.as_ref(), &events)
                }
                Some(depth) => renderer.enqueue_behind(&scene, target, depth, &events),
                None => renderer.enqueue(&scene, target, &events),
            }
        }?;
        if let Some(event) = event {
            event.set(drawn.get().cast());
            mem::forget(drawn); // the caller releases it
        }
        Ok(())
    })
}
