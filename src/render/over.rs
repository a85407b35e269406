//! Frames in memory that is there: the caller's, or an image that they follow each other in.

use std::ops::ControlFlow;

use super::{Renderer, whole};
use crate::error::{Error, Result};
use crate::image::RadianceImage;
use crate::scene::Scene;

impl Renderer {
    /// Renders as [`Renderer::render_into`] does; `progress` is told the finished share of the work, 0 to 1, several
    /// times a second, and may stop it.
    ///
    /// # Errors
    /// As there, and [`Error::Interrupted`] if `progress` stopped the work. What the target holds is undefined then.
    pub fn render_into_with_progress(
        &mut self,
        scene: &Scene,
        target: &mut [f32],
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        self.check(scene)?;
        let needed = 4 * scene.image.pixels();
        if target.len() != needed {
            return Err(Error::Unsupported(format!(
                "render_into: {} values given, {}x{} RGBA pixels are {needed}",
                target.len(),
                scene.image.width,
                scene.image.height
            )));
        }
        let all = whole(scene, target, self.bloom_of(scene));
        self.draw(scene, all, progress)
    }

    /// Renders over an image of the scene's size, as [`Renderer::render_with_progress`] renders a new one.
    ///
    /// # Errors
    /// As there, and [`Error::Unsupported`] if the image has another size. Its light is undefined then.
    pub fn render_over(
        &mut self,
        scene: &Scene,
        image: &mut RadianceImage,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        self.check(scene)?;
        if image.size() != scene.image {
            return Err(Error::Unsupported(format!(
                "render_over: an image of {}x{} pixels, the scene's has {}x{}",
                image.size().width,
                image.size().height,
                scene.image.width,
                scene.image.height
            )));
        }
        let bloom = self.bloom_of(scene);
        image.mark_bloomed(bloom);
        self.draw(scene, whole(scene, image.as_mut_slice(), bloom), progress)
    }
}
