//! Surfaces as one device sees them: their lengths along rays, and their light.

use std::sync::Arc;
#[cfg(feature = "papers")]
use std::time::Duration;

use super::one::DeviceRenderer;
use crate::cost::FrameCost;
use crate::error::Result;
use crate::image::DepthImage;
#[cfg(feature = "papers")]
use crate::metaball::SurfaceCounts;
use crate::scene::{Scene, SeenSurfaces};

impl DeviceRenderer {
    /// Returns what [`Surfaces::sorting`] says.
    #[cfg(feature = "papers")]
    pub(crate) fn surface_sorting(&self) -> Duration {
        self.surfaces.sorting()
    }

    /// Returns what [`Surfaces::counted`] says.
    #[cfg(feature = "papers")]
    pub(crate) fn surface_counts(&self) -> SurfaceCounts {
        self.surfaces.counted()
    }

    /// Opens the queue on which surfaces are found where the renderer's own may wait for a host.
    fn open_beside(&mut self) -> Result<()> {
        if self.host.is_some() && self.beside.is_none() {
            self.beside = Some(self.compute.sibling()?);
        }
        Ok(())
    }

    /// Finds the surfaces of a valid scene, and returns what that cost, too.
    pub(crate) fn see_surfaces(&mut self, scene: &Scene) -> Result<(SeenSurfaces, FrameCost)> {
        self.open_beside()?;
        let compute = self.beside.as_ref().unwrap_or(&self.compute);
        let seen = self.surfaces.draw(compute, scene, scene.rays_across())?;
        Ok((seen, self.surfaces.cost()))
    }

    /// Finds the meshes of a valid scene along its rays, and returns what that cost, too.
    pub(crate) fn trace_meshes(&mut self, scene: &Scene) -> Result<(DepthImage, FrameCost)> {
        self.open_beside()?;
        let compute = self.beside.as_ref().unwrap_or(&self.compute);
        let depth = self.meshes.trace(compute, scene, scene.rays_across())?;
        Ok((depth, self.meshes.cost()))
    }

    /// Returns the light of the meshes that were traced last, up to final lengths, and what that cost.
    pub(crate) fn shade_meshes(
        &mut self,
        scene: &Scene,
        ends: &DepthImage,
    ) -> Result<(Arc<Vec<f32>>, FrameCost)> {
        let compute = self.beside.as_ref().unwrap_or(&self.compute);
        let light = self.meshes.shade(compute, scene, ends)?;
        Ok((light, self.meshes.cost()))
    }
}
