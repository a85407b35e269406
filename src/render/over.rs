//! Frames that follow each other in one image.

use std::ops::ControlFlow;

use super::{Renderer, whole};
use crate::error::{Error, Result};
use crate::image::RadianceImage;
use crate::scene::Scene;

impl Renderer {
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
