//! The bloom of a frame, or of an image, on the renderer's device.

use super::one::DeviceRenderer;
use super::{Renderer, RendererBackend};
use crate::error::Result;
use crate::image::{Bloom, ImageSize, RadianceImage, spread_light};
use crate::opencl::{Film, Pixel};
use crate::scene::Scene;

impl Renderer {
    /// Lets the next frames have the bloom of their scene's display, worked out on the device before they are read; at
    /// first they have none, since radiance is what scenes are compared by. [`Renderer::render`],
    /// [`render_with_progress`](Renderer::render_with_progress), [`render_into`](Renderer::render_into),
    /// [`render_mapped`](Renderer::render_mapped) and [`enqueue`](Renderer::enqueue) spread it;
    /// [`render_rows`](Renderer::render_rows) cannot. Images say that they have it ([`RadianceImage::bloom`]), and no
    /// display spreads it again; what was rendered into memory of the caller is for displays without.
    ///
    /// ```no_run
    /// # fn main() -> energywave::Result<()> {
    /// # let (device, mut scene) = (energywave::Device::best()?, energywave::Scene::from_file("laser.toml")?);
    /// scene.display.bloom = Some(energywave::image::Bloom::new(0.2));
    /// let mut renderer = energywave::Renderer::new(&device)?;
    /// renderer.spread_bloom(true);
    /// let picture = renderer.render(&scene)?.tone_map(&scene.display);
    /// # Ok(())
    /// # }
    /// ```
    pub fn spread_bloom(&mut self, spreads: bool) {
        self.spreads_bloom = spreads;
    }

    /// Spreads the light of an image on the device, as [`RadianceImage::bloomed`] does on the host: of one that came in
    /// parts, say, or whose exposure was to be found first. A CPU works in the image's own memory. The built-in
    /// reference does it on the host; so does a device whose buffers are too small.
    ///
    /// # Errors
    /// [`Error::Build`](crate::Error::Build) if the kernels' compiler refuses;
    /// [`Error::SelfTest`](crate::Error::SelfTest), [`Error::OutOfMemory`](crate::Error::OutOfMemory),
    /// [`Error::Device`](crate::Error::Device). The image's light is undefined then.
    pub fn bloom(&mut self, image: &mut RadianceImage, bloom: &Bloom) -> Result<()> {
        self.spread(image.size(), image.as_mut_slice(), bloom)?;
        image.mark_bloomed(Some(*bloom));
        Ok(())
    }

    pub(super) fn spread(
        &mut self,
        size: ImageSize,
        light: &mut [f32],
        bloom: &Bloom,
    ) -> Result<()> {
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => renderer.bloom(size, light, bloom),
            RendererBackend::Several(renderer) => renderer.bloom(size, light, bloom),
            RendererBackend::Reference { .. } => {
                spread_light(size, light, bloom);
                Ok(())
            }
        }
    }

    /// Returns the bloom that a frame is to have.
    pub(super) fn bloom_of(&self, scene: &Scene) -> Option<Bloom> {
        let bloom = scene.display.bloom.filter(|bloom| bloom.strength > 0.0);
        bloom.filter(|_| self.spreads_bloom)
    }
}

impl DeviceRenderer {
    /// Spreads the light of an image, 4 values a pixel, where it is.
    pub(crate) fn bloom(
        &mut self,
        size: ImageSize,
        light: &mut [f32],
        bloom: &Bloom,
    ) -> Result<()> {
        let Self {
            spreader,
            bloom_cost,
            film,
            compute,
            ..
        } = self;
        let (pixels, _) = light.as_chunks_mut::<4>();
        let pixels: &mut [Pixel] = pixels;
        let count = pixels.len();
        if Film::reaches(compute, pixels) {
            let mut film = film.lend(compute, pixels)?;
            spreader.spread(compute, &mut film, size, bloom)?;
            film.show_host(count)?;
        } else if film.reserve_band(compute, count, 1)? >= count {
            film.write(compute, pixels)?;
            spreader.spread(compute, film, size, bloom)?;
            film.read(compute, pixels)?;
        } else {
            spread_light(size, light, bloom);
        }
        *bloom_cost = spreader.settle(compute)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::opencl::{RendererOptions, discover};
    use crate::render::one::{Rows, tests::ring};

    #[test]
    fn an_image_has_the_same_bloom_in_its_place_in_a_copy_and_larger_than_a_buffer() {
        let mut scene = ring(96);
        scene.image.width = 100;
        let (size, values) = (scene.image, 4 * scene.image.pixels());
        let bloom = Bloom::new(0.5);
        let (mut images, mut without) = (Vec::new(), Vec::new());
        // The last one comes in bands, which the host has to join.
        for bytes in [1 << 30, 40_000] {
            let mut device = discover().devices.swap_remove(0);
            device.max_allocation_bytes = bytes;
            let options = RendererOptions::default();
            let mut renderer = DeviceRenderer::new(&device, &options).unwrap();
            let mut draw = |bloom: Option<Bloom>, light: &mut [f32]| {
                let wanted = Rows {
                    rows: 0..size.height,
                    target: light,
                    stride: 4 * size.width as usize,
                    bloom,
                };
                let nothing = &mut |_: f32| ControlFlow::Continue(());
                renderer.render_rows(&scene, wanted, nothing).unwrap();
                renderer.bloom_cost.launches
            };
            let mut film = vec![0.0; values];
            let launches = draw(Some(bloom), &mut film);
            assert_eq!(launches >= 2, bytes > 40_000);
            let mut before = vec![0.0; values + 4];
            assert_eq!(draw(None, &mut before[..values]), 0);
            // Where kernels can work in it, and one value after that.
            let aligned = before.as_ptr().addr() % 16 / 4;
            for begin in [(4 - aligned) % 4, (5 - aligned) % 4] {
                let mut after = before.clone();
                after.copy_within(..values, begin);
                renderer
                    .bloom(size, &mut after[begin..begin + values], &bloom)
                    .unwrap();
                images.push(after[begin..begin + values].to_vec());
            }
            images.push(film);
            without = before;
        }
        let is_like = |image: &[f32]| {
            let mut pairs = image.iter().zip(&images[0]);
            pairs.all(|(found, expected)| (found - expected).abs() <= 2e-6 * expected)
        };
        assert!(images.iter().all(|image| is_like(image)));
        assert!(!is_like(&without));
    }
}
