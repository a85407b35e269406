//! Frames into the caller's own memory.

use std::sync::{Arc, Mutex};

use energywave::{Renderer, reference};

use crate::border;
use crate::picture::Rows;
use crate::registry;
use crate::renderer::RendererHandle;
use crate::scene::{SceneHandle, scene_of};
use crate::status::{Status, guarded};

/// Renders a scene into the caller's memory: linear RGBA in float32, by rows from the top left, which begin
/// `row_stride` bytes after each other (a multiple of 4; 0: no gap). What lies between rows stays as it is. The first
/// frame of each mix of sources builds kernels, for seconds. Where the call fails, the memory may hold a part of the
/// frame.
///
/// # Safety
/// `rgba` points to `rgba_bytes` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_render(
    renderer: *mut RendererHandle,
    scene: *const SceneHandle,
    rgba: *mut f32,
    rgba_bytes: usize,
    row_stride: usize,
) -> Status {
    guarded(|| {
        let kept: Arc<Mutex<Renderer>> = registry::find(renderer)?;
        let scene = scene_of(scene)?;
        let rows = Rows::new::<f32>(scene.image, 4, (rgba_bytes, row_stride), "rgba")?;
        // SAFETY: the caller's promise.
        let target = unsafe { border::values_mut(rgba, rows.values, "rgba") }?;
        let mut renderer = registry::lock(&kept)?;
        if rows.is_tight() {
            return Ok(renderer.render_into(&scene, target)?);
        }
        rows.fill(target, &renderer.render_mapped(&scene)?);
        Ok(())
    })
}

/// Renders a scene in float64 by another method than the devices': the truth, hundreds of times slower, on all cores
/// and without OpenCL. The memory is as of energywave_render. Waves of particles and colliders are left out; a renderer
/// on `reference` draws them too.
///
/// # Safety
/// As energywave_render.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_reference(
    scene: *const SceneHandle,
    rgba: *mut f32,
    rgba_bytes: usize,
    row_stride: usize,
) -> Status {
    guarded(|| {
        let scene = scene_of(scene)?;
        let rows = Rows::new::<f32>(scene.image, 4, (rgba_bytes, row_stride), "rgba")?;
        // SAFETY: the caller's promise.
        let target = unsafe { border::values_mut(rgba, rows.values, "rgba") }?;
        rows.fill(target, reference::render(&scene)?.as_slice());
        Ok(())
    })
}
