//! Light along single rays.

use std::ops::ControlFlow;

use glam::DVec3;

use super::{Renderer, RendererBackend, ray_order};
use crate::error::{Error, Result, SceneError};
use crate::reference::{Tracer, particle_light, volume_light};
use crate::scene::{Method, Ray, Scene};
use crate::threads;

/// Hears the finished share of the work, 0 to 1, and may stop it.
type Progress<'a> = dyn FnMut(f32) -> ControlFlow<()> + 'a;

/// So many rays a device gets at once: memory for them is used again, and stays in the caches.
const AT_ONCE: usize = 1 << 16;

/// So many rays a thread takes to give them their light.
const PART: usize = 4096;

/// So many rays of the reference are integrated before it is asked whether to go on: some tenths of a second.
const BAND: usize = 4096;

impl Renderer {
    /// Integrates along single rays: linear RGB, over the parameter or the length of each ray as the scene's measure
    /// says. The scene's camera, image, depth and surfaces play no part: nothing hides light. With
    /// [`Jittered`](crate::scene::Method::Jittered) a ray's place in the list takes the place of its pixel's number.
    ///
    /// Particles as light, those of waves at the scene's moment among them, have on a device the errors that its
    /// pictures have of them, from however far rays come. A tree of them is built on the host when they change. Volumes
    /// are integrated in float64 on the host, on every device, by quadrature: slowly. Billboards face the scene's
    /// camera.
    ///
    /// # Errors
    /// As [`Renderer::render`]; [`Error::Scene`](crate::Error::Scene) also for a ray that [`Ray::fault`] refuses.
    pub fn integrate(&mut self, scene: &Scene, rays: &[Ray]) -> Result<Vec<[f64; 3]>> {
        self.integrate_with_progress(scene, rays, &mut |_| ControlFlow::Continue(()))
    }

    /// Integrates as [`Renderer::integrate`] does; `progress` is told the finished share of the light of sources and
    /// particles, 0 to 1, and may stop it.
    ///
    /// # Errors
    /// As there, and [`Error::Interrupted`](crate::Error::Interrupted) if `progress` stopped the work.
    pub fn integrate_with_progress(
        &mut self,
        scene: &Scene,
        rays: &[Ray],
        progress: &mut Progress<'_>,
    ) -> Result<Vec<[f64; 3]>> {
        self.check(scene)?;
        if let Some((index, fault)) = threads::find_first(rays, |at, ray| Some((at, ray.fault()?)))
        {
            return Err(SceneError::value(format!("ray {index}"), fault).into());
        }
        if scene.has_points() {
            return self.integrate(&scene.with_points_apart(), rays);
        }
        let simulated = self.simulated_waves(scene)?;
        let given = simulated.as_ref().unwrap_or(scene);
        let mut lights = self.integrate_but_volumes(given, rays, progress)?;
        let is_reference = matches!(self.backend, RendererBackend::Reference { .. });
        if is_reference && given.has_particles() {
            add(&mut lights, particle_light(given, rays));
        }
        if !given.volumes.is_empty() {
            add(&mut lights, volume_light(given, rays));
        }
        Ok(lights)
    }

    /// Integrates along valid rays in a valid scene without waves: on a device the light of sources and particles, by
    /// the reference that of sources.
    fn integrate_but_volumes(
        &mut self,
        scene: &Scene,
        rays: &[Ray],
        progress: &mut Progress<'_>,
    ) -> Result<Vec<[f64; 3]>> {
        if let RendererBackend::Reference { .. } = &self.backend {
            return integrate_on_host(scene, rays, progress);
        }
        // Random numbers are those of places in the whole list.
        let at_once = match scene.integration.method {
            Method::Jittered { .. } => rays.len().max(1),
            _ => AT_ONCE,
        };
        let mut lights = vec![[0.0; 3]; rays.len()];
        let parts = rays.chunks(at_once).zip(lights.chunks_mut(at_once));
        for (number, (part, lights)) in parts.enumerate() {
            if number > 0 {
                self.cost_before = self.cost_before.then(self.cost_of_part());
            }
            let (before, of_part) = ((number * at_once) as f32, part.len() as f32);
            let report = &mut |share: f32| progress((before + share * of_part) / rays.len() as f32);
            self.integrate_part(scene, part, lights, report)?;
            // Who draws sources reports.
            let is_silent = scene.source_count() == 0;
            if is_silent && progress((before + of_part) / rays.len() as f32).is_break() {
                return Err(Error::Interrupted);
            }
        }
        Ok(lights)
    }

    /// Integrates along some valid rays on devices.
    fn integrate_part(
        &mut self,
        scene: &Scene,
        rays: &[Ray],
        lights: &mut [[f64; 3]],
        progress: &mut Progress<'_>,
    ) -> Result<()> {
        // Sums and closed forms take as long for rays at random.
        let has_closed_forms =
            scene.tori.is_empty() && scene.curves.is_empty() && scene.paths.is_empty();
        let order = match scene.integration.method {
            Method::Jittered { .. } => None, // whose random numbers are those of places
            Method::Exact { .. } if !has_closed_forms => Some(ray_order::alike(rays)),
            // Rays that are alike meet the same particles.
            _ => scene.has_particles().then(|| ray_order::alike(rays)),
        };
        let in_order = |order: &Vec<u32>| threads::map(order, |place| rays[*place as usize]);
        let ordered = order.as_ref().map(in_order);
        let given = ordered.as_deref().unwrap_or(rays);
        let pixels = match &mut self.backend {
            RendererBackend::OpenCl(renderer) => renderer.integrate(scene, given, progress)?,
            RendererBackend::Several(renderer) => renderer.integrate(scene, given, progress)?,
            RendererBackend::Reference { .. } => Vec::new(), // draws by itself
        };
        let places = order.map(|order| inverse(&order));
        threads::for_each_part(lights, PART, |first, lights| {
            for (index, light) in (first..).zip(lights) {
                let place = places
                    .as_ref()
                    .map_or(index, |places| places[index] as usize);
                let [red, green, blue, _] = pixels[place];
                let measure = scene.integration.scale(rays[index].span.length());
                *light = [red, green, blue].map(|light| measure * f64::from(light));
            }
        });
        Ok(())
    }
}

/// Adds light of other kinds.
fn add(lights: &mut [[f64; 3]], others: Vec<DVec3>) {
    for (light, other) in lights.iter_mut().zip(others) {
        *light = (DVec3::from(*light) + other).to_array();
    }
}

/// Returns where each place went.
fn inverse(order: &[u32]) -> Vec<u32> {
    let mut places = vec![0; order.len()];
    for (index, place) in (0..).zip(order) {
        places[*place as usize] = index;
    }
    places
}

/// Integrates by the reference, on all cores.
fn integrate_on_host(
    scene: &Scene,
    rays: &[Ray],
    progress: &mut Progress<'_>,
) -> Result<Vec<[f64; 3]>> {
    let tracer = Tracer::new(scene, scene.integration.method);
    let mut lights = vec![[0.0; 3]; rays.len()];
    for (band, lights) in lights.chunks_mut(BAND).enumerate() {
        let first = band * BAND;
        threads::for_each_chunk(lights, 1, |index, light| {
            let number = first + index;
            light[0] = tracer
                .radiance(&rays[number], 1.0, number as u32)
                .to_array();
        });
        let done = first + lights.len();
        if progress(done as f32 / rays.len() as f32).is_break() {
            return Err(Error::Interrupted);
        }
    }
    Ok(lights)
}
