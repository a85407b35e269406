//! Surfaces of a frame: they are drawn first, and what they hide ends the rays of the light, which is drawn then.

use std::ops::ControlFlow;
#[cfg(feature = "papers")]
use std::time::Duration;
use std::time::Instant;

use super::one::{DeviceRenderer, Rows};
use super::{Renderer, RendererBackend, whole};
use crate::cost::FrameCost;
use crate::error::Result;
use crate::image::{Bloom, RadianceImage, kept_image};
#[cfg(feature = "papers")]
use crate::metaball::SurfaceCounts;
use crate::reference;
use crate::scene::{Scene, SeenSurfaces};

impl Renderer {
    /// Draws a valid scene.
    pub(super) fn draw(
        &mut self,
        scene: &Scene,
        wanted: Rows<'_>,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        let simulated = self.simulated(scene)?;
        let scene = simulated.as_ref().unwrap_or(scene);
        match scene.has_surfaces() {
            false => self.draw_light(scene, wanted, progress),
            true => self.draw_with_surfaces(scene, wanted, progress),
        }
    }

    /// Draws a scene without surfaces.
    fn draw_light(
        &mut self,
        scene: &Scene,
        wanted: Rows<'_>,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        match self.has_layers(scene)? {
            true => self.draw_layers(scene, wanted, progress),
            false => self.draw_part(scene, wanted, progress),
        }
    }

    /// Draws the surfaces of a valid scene, and all light that they leave.
    fn draw_with_surfaces(
        &mut self,
        scene: &Scene,
        wanted: Rows<'_>,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        let Rows {
            rows,
            target,
            stride,
            bloom,
        } = wanted;
        let seen = self.see_all_surfaces(scene)?;
        self.has_light = scene.source_count() > 0 || scene.has_particles() || scene.has_points();
        if self.has_light {
            let light = Rows {
                rows: rows.clone(),
                target: &mut *target,
                stride,
                bloom: None, // which is of both
            };
            self.draw_light(&seen.left_of(scene), light, progress)?;
            seen.add(scene, rows, (&mut *target, stride));
        } else {
            seen.put(scene, rows, (&mut *target, stride));
        }
        match bloom {
            Some(bloom) => self.spread(scene.image, target, &bloom),
            None => Ok(()),
        }
    }

    /// Finds the surfaces along all rays; several devices leave that to their first.
    pub(crate) fn see_surfaces(&mut self, scene: &Scene) -> Result<(SeenSurfaces, FrameCost)> {
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => renderer.see_surfaces(scene),
            RendererBackend::Several(renderer) => renderer.first().see_surfaces(scene),
            RendererBackend::Reference { .. } => {
                let begun = Instant::now();
                let seen = reference::see_surfaces(scene)?;
                let cost = FrameCost {
                    kernel: begun.elapsed(),
                    launches: 1,
                    ..FrameCost::default()
                };
                Ok((seen, cost))
            }
        }
    }

    /// Returns the device that traces meshes: of several the first, and none on the reference.
    pub(super) fn mesh_device(&mut self) -> Option<&mut DeviceRenderer> {
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => Some(renderer),
            RendererBackend::Several(renderer) => Some(renderer.first()),
            RendererBackend::Reference { .. } => None,
        }
    }

    /// Returns how long particles were sorted in the last frame with surfaces; nothing on the reference.
    #[cfg(feature = "papers")]
    pub(crate) fn surface_sorting(&mut self) -> Duration {
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => renderer.surface_sorting(),
            RendererBackend::Several(renderer) => renderer.first().surface_sorting(),
            RendererBackend::Reference { .. } => Duration::ZERO,
        }
    }

    /// Returns what finding surfaces took in the last frame, if that was counted.
    #[cfg(feature = "papers")]
    pub(crate) fn surface_counts(&mut self) -> SurfaceCounts {
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => renderer.surface_counts(),
            RendererBackend::Several(renderer) => renderer.first().surface_counts(),
            RendererBackend::Reference { .. } => SurfaceCounts::default(),
        }
    }

    fn write_in_place(&mut self, is_wanted: bool) {
        if let RendererBackend::OpenCl(renderer) = &mut self.backend {
            renderer.writes_in_place = is_wanted;
        }
    }

    /// Draws a frame that the host puts together into an image of the renderer's own.
    pub(super) fn keep_drawn(&mut self, scene: &Scene, bloom: Option<Bloom>) -> Result<&[f32]> {
        let mut image = self.kept.take();
        let target = kept_image(&mut image, scene.image)?.as_mut_slice();
        let nothing = &mut |_: f32| ControlFlow::Continue(());
        // The image is there for good: what the device writes into it need not be copied.
        self.write_in_place(true);
        let drawn = self.draw(scene, whole(scene, target, bloom), nothing);
        self.write_in_place(false);
        self.kept = image;
        drawn?;
        Ok(self.kept.as_ref().map_or(&[], RadianceImage::as_slice))
    }
}
