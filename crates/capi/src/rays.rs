//! Light along rays that the caller lists.

use std::sync::{Arc, Mutex};

use energywave::glam::DVec3;
use energywave::scene::Ray;
use energywave::{Error, Renderer};

use crate::border;
use crate::registry;
use crate::renderer::RendererHandle;
use crate::scene::{SceneHandle, scene_of};
use crate::status::{Status, bad_argument, guarded};

/// Integrates along single rays, from origins to ends, world units: `count` times three values each, x, y, z. `rgb`
/// gets linear red, green, blue of each, over the parameter or the length of the ray as the scene's measure says. The
/// scene's camera, image, depth and surfaces play no part.
///
/// # Safety
/// `origins`, `ends` and `rgb` point to `3 * count` values each, and `rgb` overlaps neither.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn energywave_integrate(
    renderer: *mut RendererHandle,
    scene: *const SceneHandle,
    origins: *const f64,
    ends: *const f64,
    count: usize,
    rgb: *mut f64,
) -> Status {
    guarded(|| {
        let kept: Arc<Mutex<Renderer>> = registry::find(renderer)?;
        let scene = scene_of(scene)?;
        let values = count
            .checked_mul(3)
            .ok_or_else(|| bad_argument("count", "more values than there can be"))?;
        // SAFETY: the caller's promise, three times.
        let (origins, ends, target) = unsafe {
            let origins = border::values(origins, values, "origins")?;
            let ends = border::values(ends, values, "ends")?;
            (origins, ends, border::values_mut(rgb, values, "rgb")?)
        };
        let mut rays = Vec::new();
        rays.try_reserve_exact(count).map_err(|_| {
            Error::OutOfMemory(format!("{count} rays: more memory than the system grants"))
        })?;
        let pairs = origins.chunks_exact(3).zip(ends.chunks_exact(3));
        rays.extend(
            pairs
                .map(|(start, end)| Ray::between(DVec3::from_slice(start), DVec3::from_slice(end))),
        );
        let lights = registry::lock(&kept)?.integrate(&scene, &rays)?;
        target.copy_from_slice(lights.as_flattened());
        Ok(())
    })
}
