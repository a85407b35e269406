//! Frames for hosts that are put together of parts: the light of surfaces, which are found first, and what is seen
//! before each depth of a pixel. All parts are drawn and added up on the device (`cl/add.cl`).
//!
//! Surfaces are found on a queue that waits for no host, and their depths come to our memory: only depths that a host
//! has on the device are waited for, where surfaces may lie before or behind them.

use std::sync::Arc;

use super::host::no_host;
use super::one::DeviceRenderer;
use super::{Renderer, RendererBackend};
use crate::cost::FrameCost;
use crate::error::{Error, Result};
use crate::image::Bloom;
use crate::opencl::{Added, Film, FilmFormat};
use crate::scene::{Scene, SeenSurfaces};

/// What a frame is put together of.
#[derive(Debug)]
pub(super) struct Parts {
    /// The light of surfaces, if there are any.
    surfaces: Option<Arc<Vec<f32>>>,
    /// Scenes of light, and which share of each pixel shows them; `None`: all of it.
    lights: Vec<(Scene, Option<Vec<f32>>)>,
}

impl Renderer {
    /// Returns whether a frame of a valid scene for a host is put together of parts.
    pub(super) fn is_joined(&mut self, scene: &Scene) -> Result<bool> {
        Ok(scene.has_surfaces() || self.has_layers(scene)?)
    }

    /// Returns the parts of a scene whose surfaces were seen, if it has any.
    pub(super) fn parts_of(&mut self, scene: &Scene, seen: Option<&SeenSurfaces>) -> Result<Parts> {
        let has_light = scene.source_count() > 0 || scene.has_particles() || scene.has_points();
        self.has_light = seen.is_none() || has_light;
        let mut parts = Parts {
            surfaces: seen.map(|seen| Arc::clone(&seen.light)),
            lights: Vec::new(),
        };
        if self.has_light {
            let left = seen.map_or_else(|| scene.clone(), |seen| seen.left_of(scene));
            self.has_layers(&left)?;
            parts.lights = match &self.layers {
                Some(layers) => layers.parts(&left).collect(),
                None => vec![(left, None)],
            };
        }
        Ok(parts)
    }

    pub(super) fn host_renderer(&mut self) -> Result<&mut DeviceRenderer> {
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) if renderer.host.is_some() => Ok(renderer),
            _ => Err(no_host()),
        }
    }
}

impl DeviceRenderer {
    /// Draws all parts into a film, and spreads their light. Returns what all light but the last part's cost.
    pub(super) fn draw_parts(
        &mut self,
        scene: &Scene,
        parts: &Parts,
        film: &mut Film,
        bloom: Option<&Bloom>,
    ) -> Result<FrameCost> {
        let Self {
            engines,
            spreader,
            adder,
            part,
            compute,
            ..
        } = self;
        let is_unfinished = bloom.is_some();
        adder.prepare(compute, film.format())?;
        let (pixels, count) = (scene.image.pixels(), parts.lights.len());
        let size = (scene.image.width, scene.image.height);
        if count > 0 && part.reserve_band(compute, pixels, 1)? < pixels {
            return Err(Error::OutOfMemory(format!(
                "{}: {}x{} pixels are more than one buffer of the device holds",
                compute.device().name,
                size.0,
                size.1
            )));
        }
        if let Some(light) = &parts.surfaces {
            film.leave_unfinished(is_unfinished || count > 0);
            let added = Added::Host(light);
            adder.add(compute, (film, size), added, None, true)?;
        }
        let mut cost = FrameCost::default();
        for (number, (light, shares)) in parts.lights.iter().enumerate() {
            if number > 0 {
                cost = cost.then(engines.cost());
            }
            let plan = engines.plan(compute, light, None, FilmFormat::Floats)?;
            engines.begin(compute, &plan, pixels)?;
            part.begin_at(0);
            engines.draw_unwatched(compute, &plan, pixels, part, false)?;
            film.leave_unfinished(is_unfinished || number + 1 < count);
            let is_first = number == 0 && parts.surfaces.is_none();
            let added = Added::Film(part);
            adder.add(compute, (film, size), added, shares.as_deref(), is_first)?;
        }
        if let Some(bloom) = bloom {
            spreader.spread(compute, film, scene.image, bloom)?;
        }
        Ok(cost)
    }
}
