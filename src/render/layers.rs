//! Depths finer than pixels: a frame is put together of what is seen before each surface.

use std::ops::ControlFlow;

use super::Renderer;
use super::one::Rows;
use crate::error::Result;
use crate::scene::{DepthLayers, Scene};

impl Renderer {
    /// Takes depths apart that are finer than pixels; says whether they are.
    pub(super) fn has_layers(&mut self, scene: &Scene) -> Result<bool> {
        self.layers = DepthLayers::of(scene, self.layers.take())?;
        Ok(self.layers.is_some())
    }

    /// Draws what is seen before each of the depths that lie in a pixel.
    pub(super) fn draw_layers(
        &mut self,
        scene: &Scene,
        wanted: Rows<'_>,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        let Some(layers) = self.layers.take() else {
            return self.draw_part(scene, wanted, progress);
        };
        let (rows, part) = (wanted.rows, 1.0 / layers.count() as f32);
        let mut before = self.cost_before;
        let mut draw = |scene: &Scene, target: &mut [f32], stride: usize, done: f32| {
            let wanted = Rows {
                rows: rows.clone(),
                target,
                stride,
                bloom: None, // which is of all of them
            };
            self.cost_before = before;
            self.draw_part(scene, wanted, &mut |share| progress(done + part * share))?;
            before = self.last_cost();
            Ok(())
        };
        let drawn = layers.draw(
            scene,
            rows.clone(),
            (&mut *wanted.target, wanted.stride),
            &mut draw,
        );
        self.layers = Some(layers);
        drawn?;
        match wanted.bloom {
            Some(bloom) => self.spread(scene.image, wanted.target, &bloom),
            None => Ok(()),
        }
    }
}
