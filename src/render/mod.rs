//! The renderer: one front for the OpenCL devices and the built-in reference.

mod bake;
mod bake_error;
mod bloom;
mod device;
mod engines;
mod host;
mod host_depth;
mod host_points;
mod irradiance;
mod joined;
mod layers;
mod moments;
mod one;
mod over;
mod ray_order;
mod rays;
mod referenced;
mod seen;
mod several;
mod shares;
mod shutter;
mod stage;
mod surfaces;

use std::ops::{ControlFlow, Deref, Range};
use std::time::Instant;

pub use device::{Device, Devices};
pub use host_depth::HostDepth;
pub use host_points::HostPoints;

use crate::cost::FrameCost;
use crate::error::{Error, Result};
use crate::image::{Bloom, RadianceImage, kept_image, spread_light};
use crate::opencl::{MappedFilm, RendererOptions};
use crate::reference;
use crate::scene::{CheckedSources, DepthLayers, Scene};
pub use bake_error::BakeError;
use device::Backend;
use one::{DeviceRenderer, Rows};
use referenced::{draw_reference, reference_cost};
use several::SeveralRenderer;
use shutter::Shutter;
use stage::Stage;

/// An image in the renderer's own memory, linear RGBA by rows, readable until it is dropped.
#[derive(Debug)]
pub struct MappedImage<'a>(MappedBackend<'a>);

#[derive(Debug)]
enum MappedBackend<'a> {
    OpenCl(MappedFilm<'a>),
    Host(&'a [f32]),
}

impl Deref for MappedImage<'_> {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        match &self.0 {
            MappedBackend::OpenCl(mapped) => mapped,
            MappedBackend::Host(values) => values,
        }
    }
}

/// Renders scenes on a device, or on several at once. Kernels and buffers are kept: frames after the first allocate
/// nothing on the device and upload only what changed.
#[derive(Debug)]
pub struct Renderer {
    backend: RendererBackend,
    /// The sources that were checked last.
    checked: Option<CheckedSources>,
    /// Whether frames have the bloom of their scene's display.
    spreads_bloom: bool,
    /// The depths, finer than pixels, that were taken apart last.
    layers: Option<DepthLayers>,
    /// What parts of the last frame cost that were drawn before its last part.
    cost_before: FrameCost,
    /// Whether there was light besides surfaces in the last frame.
    has_light: bool,
    /// An image that is put together of parts, and lent.
    kept: Option<RadianceImage>,
    /// What is made of scenes before their light is drawn.
    stage: Stage,
    /// What means over time keep.
    shutter: Shutter,
    /// At how many moments the last frame was drawn.
    moments: u32,
}

#[derive(Debug)]
enum RendererBackend {
    OpenCl(Box<DeviceRenderer>),
    Several(Box<SeveralRenderer>),
    Reference {
        image: Option<RadianceImage>,
        cost: FrameCost,
    },
}

impl Renderer {
    /// Opens a device. Kernels are built when a scene first needs them.
    ///
    /// # Errors
    /// [`Error::Device`] if the driver refuses.
    pub fn new(device: &Device) -> Result<Self> {
        Self::with_options(device, &RendererOptions::default())
    }

    /// Opens a device with options of the caller's choice.
    ///
    /// # Errors
    /// As [`Renderer::new`], and [`Error::Unsupported`] for options that kernels cannot be built for.
    pub fn with_options(device: &Device, options: &RendererOptions) -> Result<Self> {
        Ok(Self::with_backend(match &device.backend {
            Backend::OpenCl(device) => {
                RendererBackend::OpenCl(Box::new(DeviceRenderer::new(device, options)?))
            }
            Backend::Reference => RendererBackend::Reference {
                image: None,
                cost: FrameCost::default(),
            },
        }))
    }

    /// Opens devices that draw every frame together, each a range of its rows: in the first frame as many as it has
    /// compute units beside the others, then by the time that it took in the last ones, so that all are done together.
    /// A device too slow for a row gets one again now and then.
    ///
    /// Devices of one kind draw the image that one of them draws, bit for bit; others differ within the tolerance.
    /// Single rays ([`Renderer::integrate`]) go to the first. With one device this is [`Renderer::with_options`].
    ///
    /// # Errors
    /// [`Error::Unsupported`] if there is no device, or the built-in reference is among several; [`Error::Device`].
    pub fn on_devices(devices: &[Device], options: &RendererOptions) -> Result<Self> {
        match devices {
            [] => Err(Error::Unsupported(
                "a renderer needs a device; the list has none".to_owned(),
            )),
            [device] => Self::with_options(device, options),
            several => {
                let renderer = SeveralRenderer::new(several, options)?;
                let backend = RendererBackend::Several(Box::new(renderer));
                Ok(Self::with_backend(backend))
            }
        }
    }

    fn with_backend(backend: RendererBackend) -> Self {
        Self {
            backend,
            checked: None,
            spreads_bloom: false,
            layers: None,
            cost_before: FrameCost::default(),
            has_light: true,
            kept: None,
            stage: Stage::default(),
            shutter: Shutter::default(),
            moments: 0,
        }
    }

    /// Returns the rows of the last frame that each device drew, in the order of [`Renderer::on_devices`]; none before
    /// the first frame, or on one device.
    #[must_use]
    pub fn shares(&self) -> &[Range<u32>] {
        match &self.backend {
            RendererBackend::Several(renderer) => renderer.rows(),
            RendererBackend::OpenCl(_) | RendererBackend::Reference { .. } => &[],
        }
    }

    /// Renders the scene's linear radiance, RGBA.
    ///
    /// # Errors
    /// [`Error::Scene`] if the scene is not valid; [`Error::Build`] if the kernels' compiler refuses;
    /// [`Error::OutOfMemory`], [`Error::Device`].
    pub fn render(&mut self, scene: &Scene) -> Result<RadianceImage> {
        self.render_with_progress(scene, &mut |_| ControlFlow::Continue(()))
    }

    /// Renders as [`Renderer::render`] does; `progress` is told the finished share of the work, 0 to 1, several times a
    /// second, and may stop it.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::Interrupted`] if `progress` stopped the work.
    pub fn render_with_progress(
        &mut self,
        scene: &Scene,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<RadianceImage> {
        self.check(scene)?;
        let bloom = self.bloom_of(scene);
        let beside = match &self.backend {
            RendererBackend::OpenCl(renderer) => {
                renderer.missing_bytes(scene.image.pixels(), bloom.is_some())
            }
            RendererBackend::Several(_) | RendererBackend::Reference { .. } => 0,
        };
        let mut image = RadianceImage::beside(scene.image, beside)?;
        let light = image.as_mut_slice();
        self.draw(scene, whole(scene, light, bloom), progress)?;
        image.mark_bloomed(bloom);
        Ok(image)
    }

    /// Renders into the caller's memory: `4 * width * height` values, linear RGBA by rows from the top left.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::Unsupported`] if the slice has another length.
    pub fn render_into(&mut self, scene: &Scene, target: &mut [f32]) -> Result<()> {
        self.render_into_with_progress(scene, target, &mut |_| ControlFlow::Continue(()))
    }

    /// Renders some rows of the scene's image into the caller's memory, such as a part of a larger image: linear RGBA
    /// by rows from the top left, the first of `rows` at the beginning of `target`, each `stride` values after the one
    /// before. What lies between the rows, and after the last, is left alone.
    ///
    /// An image that is rendered in parts is, within the scene's tolerance, the one that is rendered whole; bit for bit
    /// where the parts begin at multiples of 256 rows, however slow or busy the device is.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::Unsupported`] if the image does not have those rows, a row of `4 * width`
    /// values is longer than `stride`, `target` ends before the last row does, or the renderer was told to spread a
    /// bloom that the scene has.
    pub fn render_rows(
        &mut self,
        scene: &Scene,
        rows: Range<u32>,
        target: &mut [f32],
        stride: usize,
    ) -> Result<()> {
        self.check(scene)?;
        let (width, height) = (scene.image.width, scene.image.height);
        if rows.start > rows.end || rows.end > height {
            return Err(Error::Unsupported(format!(
                "render_rows: rows {} to {}, the image has {height}",
                rows.start, rows.end
            )));
        }
        if rows.is_empty() {
            return Ok(());
        }
        let row = 4 * width as usize;
        let before_last = (rows.len() - 1).saturating_mul(stride);
        let needed = before_last.saturating_add(row);
        if stride < row || target.len() < needed {
            return Err(Error::Unsupported(format!(
                "render_rows: {} values in rows {stride} apart; {width}x{} RGBA pixels need rows of {row}, and \
                 {needed} in all",
                target.len(),
                rows.len()
            )));
        }
        if self.bloom_of(scene).is_some() {
            return Err(Error::Unsupported(
                "render_rows: a bloom needs all of an image; spread it when all rows are there (Renderer::bloom)"
                    .to_owned(),
            ));
        }
        let wanted = Rows {
            rows,
            target,
            stride,
            bloom: None,
        };
        self.draw(scene, wanted, &mut |_| ControlFlow::Continue(()))
    }

    /// Renders into the renderer's own memory. On one CPU device the image is where the kernels wrote it: nothing is
    /// copied.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::OutOfMemory`] if the image is larger than one buffer of the device.
    pub fn render_mapped(&mut self, scene: &Scene) -> Result<MappedImage<'_>> {
        self.check(scene)?;
        let bloom = self.bloom_of(scene);
        if scene.has_stage() || self.has_layers(scene)? {
            let values = self.keep_drawn(scene, bloom)?;
            return Ok(MappedImage(MappedBackend::Host(values)));
        }
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => {
                let mapped = renderer.render_mapped(scene, bloom)?;
                Ok(MappedImage(MappedBackend::OpenCl(mapped)))
            }
            RendererBackend::Several(renderer) => {
                let values = renderer.render_kept(scene, bloom)?;
                Ok(MappedImage(MappedBackend::Host(values)))
            }
            RendererBackend::Reference { image, cost } => {
                let begun = Instant::now();
                let image = kept_image(image, scene.image)?;
                let nothing = &mut |_: f32| ControlFlow::Continue(());
                let (method, rows) = (scene.integration.method, 0..scene.image.height);
                reference::render_rows(scene, method, rows, image.as_mut_slice(), nothing)?;
                if let Some(bloom) = bloom {
                    spread_light(scene.image, image.as_mut_slice(), &bloom);
                }
                *cost = reference_cost(scene, scene.image.pixels(), begun.elapsed());
                Ok(MappedImage(MappedBackend::Host(image.as_slice())))
            }
        }
    }

    /// Returns what the last frame cost.
    #[must_use]
    pub fn last_cost(&self) -> FrameCost {
        match self.has_light {
            true => self.cost_before.then(self.cost_of_part()),
            false => self.cost_before,
        }
    }

    fn cost_of_part(&self) -> FrameCost {
        match &self.backend {
            RendererBackend::OpenCl(renderer) => renderer.cost(),
            RendererBackend::Several(renderer) => renderer.cost(),
            RendererBackend::Reference { cost, .. } => *cost,
        }
    }

    /// Checks a scene; its sources only if they changed.
    fn check(&mut self, scene: &Scene) -> Result<()> {
        self.cost_before = FrameCost::default();
        self.has_light = true;
        self.moments = 1;
        scene.validate_again(&mut self.checked)
    }

    fn draw_part(
        &mut self,
        scene: &Scene,
        wanted: Rows<'_>,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => {
                renderer.render_rows(scene, wanted, progress)?;
                Ok(())
            }
            RendererBackend::Several(renderer) => renderer.render_rows(scene, wanted, progress),
            RendererBackend::Reference { cost, .. } => {
                let begun = Instant::now();
                let pixels = wanted.rows.len() * scene.image.width as usize;
                draw_reference(scene, wanted, progress)?;
                *cost = reference_cost(scene, pixels, begun.elapsed());
                Ok(())
            }
        }
    }

    /// Returns the engine of the device, if there is one device.
    pub(crate) fn wave(&mut self) -> Option<&mut crate::wave::Wave> {
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => Some(renderer.wave()),
            RendererBackend::Several(_) | RendererBackend::Reference { .. } => None,
        }
    }
}

/// Returns all rows of a scene's image.
fn whole<'a>(scene: &Scene, target: &'a mut [f32], bloom: Option<Bloom>) -> Rows<'a> {
    Rows {
        rows: 0..scene.image.height,
        target,
        stride: 4 * scene.image.width as usize,
        bloom,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_renderer_may_move_to_another_thread() {
        fn is_send<T: Send>() {}
        is_send::<Renderer>();
    }
}
