//! The light that waves cast on points that a host lists.

use glam::DVec3;

use super::one::DeviceRenderer;
use super::{Renderer, RendererBackend};
use crate::error::{Error, Result, SceneError};
use crate::reference;
use crate::scene::{Scene, point_fault};

impl DeviceRenderer {
    /// Returns what [`Meshes::irradiance`](crate::mesh::Meshes) says.
    fn irradiance(
        &mut self,
        scene: &Scene,
        points: &[DVec3],
        normals: &[DVec3],
    ) -> Result<Vec<[f32; 3]>> {
        let Self {
            meshes, compute, ..
        } = self;
        meshes.irradiance(compute, scene, points, normals)
    }
}

impl Renderer {
    /// Returns the irradiance, linear RGB, of points of surfaces with these normals, of any length but zero: what the
    /// cores of a scene's waves cast on them, by its [`Lighting`](crate::scene::Lighting), or by the default where it
    /// has none; with shadows, what its meshes leave of that. A matt surface of the albedo a then has the radiance
    /// `a / pi` times that. Ambient light and a sun play no part, nor do particles. Of several devices the first does
    /// it.
    ///
    /// Float32 finds it within 1e-2 of the integral, as a rule within 1e-4: what is worst are circles and curves that
    /// the horizon of a near surface cuts.
    ///
    /// # Errors
    /// As [`Renderer::render`]; [`Error::Unsupported`] if there are not as many normals as points; [`Error::Scene`] for
    /// a point or a normal that is not finite, or a normal that is zero.
    pub fn irradiance(
        &mut self,
        scene: &Scene,
        points: &[DVec3],
        normals: &[DVec3],
    ) -> Result<Vec<[f32; 3]>> {
        self.check(scene)?;
        if points.len() != normals.len() {
            return Err(Error::Unsupported(format!(
                "irradiance: {} points and {} normals; each point has one",
                points.len(),
                normals.len()
            )));
        }
        let mut directions = Vec::with_capacity(normals.len());
        for (index, (point, normal)) in points.iter().zip(normals).enumerate() {
            if let Some(fault) = point_fault(*point) {
                return Err(SceneError::value(format!("point {index}"), fault).into());
            }
            if !normal.is_finite() {
                let message = format!("{normal} is not finite");
                return Err(SceneError::value(format!("normal {index}"), message).into());
            }
            let Some(direction) = normal.try_normalize() else {
                let message = "has no direction: it is zero";
                return Err(SceneError::value(format!("normal {index}"), message).into());
            };
            directions.push(direction);
        }
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => renderer.irradiance(scene, points, &directions),
            RendererBackend::Several(renderer) => {
                renderer.first().irradiance(scene, points, &directions)
            }
            RendererBackend::Reference { .. } => {
                let found = reference::irradiance(scene, points, &directions)?;
                let single = |light: [f64; 3]| light.map(|channel| channel as f32);
                Ok(found.into_iter().map(single).collect())
            }
        }
    }
}
