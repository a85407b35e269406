//! Light along single rays.

use super::{Renderer, RendererBackend};
use crate::error::{Result, SceneError};
use crate::reference::{Tracer, particle_light};
use crate::scene::{List, Ray, Scene};

impl Renderer {
    /// Integrates along single rays: linear RGB, over the parameter or the length of each ray as the scene's measure
    /// says. The scene's camera, image, depth and surfaces play no part: nothing hides light. With
    /// [`Jittered`](crate::scene::Method::Jittered) a ray's place in the list takes the place of its pixel's number.
    ///
    /// Particles as light, and those of waves at the scene's moment, are integrated in float64 on the host, on every
    /// device, by quadrature: slowly.
    ///
    /// # Errors
    /// As [`Renderer::render`]; [`Error::Scene`](crate::Error::Scene) also for a ray that [`Ray::fault`] refuses;
    /// [`Error::Unsupported`](crate::Error::Unsupported) for a scene with volumes.
    pub fn integrate(&mut self, scene: &Scene, rays: &[Ray]) -> Result<Vec<[f64; 3]>> {
        self.check(scene)?;
        for (index, ray) in rays.iter().enumerate() {
            if let Some(fault) = ray.fault() {
                return Err(SceneError::value(format!("ray {index}"), fault).into());
            }
        }
        scene.check_rays_alone()?;
        if !scene.has_particles() {
            return self.integrate_sources(scene, rays);
        }
        let simulated = self.simulated_waves(scene)?;
        let given = simulated.as_ref().unwrap_or(scene);
        let sources = Scene {
            particles: List::new(),
            light_elements: List::new(),
            ..given.clone()
        };
        let mut lights = self.integrate_sources(&sources, rays)?;
        for (light, of_particles) in lights.iter_mut().zip(particle_light(given, rays)) {
            for (light, part) in light.iter_mut().zip(of_particles.to_array()) {
                *light += part;
            }
        }
        Ok(lights)
    }

    /// Integrates along valid rays in a valid scene without particles.
    fn integrate_sources(&mut self, scene: &Scene, rays: &[Ray]) -> Result<Vec<[f64; 3]>> {
        let pixels = match &mut self.backend {
            RendererBackend::OpenCl(renderer) => renderer.integrate(scene, rays)?,
            RendererBackend::Several(renderer) => renderer.integrate(scene, rays)?,
            RendererBackend::Reference { .. } => {
                let tracer = Tracer::new(scene, scene.integration.method);
                let radiance = |(ray, number)| tracer.radiance(ray, 1.0, number).to_array();
                return Ok(rays.iter().zip(0..).map(radiance).collect());
            }
        };
        let measure = |ray: &Ray| scene.integration.scale(ray.span.length());
        let colors = pixels.iter().zip(rays).map(|(pixel, ray)| {
            let [red, green, blue, _] = *pixel;
            [red, green, blue].map(|light| measure(ray) * f64::from(light))
        });
        Ok(colors.collect())
    }
}
