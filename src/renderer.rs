//! The renderer: one front for the OpenCL devices and the built-in reference.

use std::ops::{ControlFlow, Deref, Range};
use std::time::{Duration, Instant};

use crate::device::{Backend, Device};
use crate::error::{Error, Result, SceneError};
use crate::image::RadianceImage;
use crate::opencl::{BuildOptions, Mapped, OpenClRenderer};
use crate::ray::Ray;
use crate::reference::{self, Tracer};
use crate::scene::{ImageSize, Method, Scene};
use crate::several::SeveralRenderer;

/// What a frame cost.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FrameCost {
    /// Time that the device worked on kernels; of several devices, the longest.
    pub kernel: Duration,
    /// Integrals: pairs of a ray and a source.
    pub evaluations: u64,
    /// Samples of fields; 0 where they were not counted: the method `exact` takes as many as it needs.
    pub field_evaluations: u64,
    /// Launches of kernels.
    pub launches: u32,
}

/// An image in the renderer's own memory, linear RGBA by rows, readable until it is dropped.
#[derive(Debug)]
pub struct MappedImage<'a>(MappedBackend<'a>);

#[derive(Debug)]
enum MappedBackend<'a> {
    OpenCl(Mapped<'a>),
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

/// Renders scenes on a device, or on several at once. Kernels and buffers are kept: frames after the first allocate nothing on the device and
/// upload only what changed.
#[derive(Debug)]
pub struct Renderer {
    pub(crate) backend: RendererBackend,
}

#[derive(Debug)]
pub(crate) enum RendererBackend {
    OpenCl(Box<OpenClRenderer>),
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
        Self::with_options(device, &BuildOptions::default())
    }

    /// Like [`Renderer::new`], with a lane width and compiler options of the caller's choice.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn with_options(device: &Device, options: &BuildOptions) -> Result<Self> {
        let backend = match &device.backend {
            Backend::OpenCl(device) => {
                RendererBackend::OpenCl(Box::new(OpenClRenderer::new(device, options)?))
            }
            Backend::Reference => RendererBackend::Reference {
                image: None,
                cost: FrameCost::default(),
            },
        };
        Ok(Self { backend })
    }

    /// Draws every frame on all these devices at once, each a range of its rows: in the first frame as many as it has
    /// compute units beside the others, then by the time that it took in the last ones, so that all are done together.
    /// A device too slow for a row gets one again now and then.
    ///
    /// Devices of one kind draw the image that one of them draws, bit for bit; others differ within the tolerance. Single
    /// rays ([`Renderer::trace`]) go to the first. One device is as by [`Renderer::with_options`].
    ///
    /// # Errors
    /// [`Error::Unsupported`] if there is no device, or the built-in reference is among several; [`Error::Device`].
    pub fn on_devices(devices: &[Device], options: &BuildOptions) -> Result<Self> {
        match devices {
            [] => Err(Error::Unsupported(
                "a renderer needs a device; the list has none".to_owned(),
            )),
            [device] => Self::with_options(device, options),
            several => {
                let renderer = SeveralRenderer::new(several, options)?;
                let backend = RendererBackend::Several(Box::new(renderer));
                Ok(Self { backend })
            }
        }
    }

    /// The rows of the last frame that each device drew, in the order of [`Renderer::on_devices`]; none before the first
    /// frame, or on one device.
    pub fn shares(&self) -> &[Range<u32>] {
        match &self.backend {
            RendererBackend::Several(renderer) => renderer.rows(),
            RendererBackend::OpenCl(_) | RendererBackend::Reference { .. } => &[],
        }
    }

    /// The scene's linear radiance, RGBA.
    ///
    /// # Errors
    /// [`Error::Scene`] if the scene is not valid; [`Error::Build`] if the kernels' compiler refuses;
    /// [`Error::OutOfMemory`], [`Error::Device`].
    pub fn render(&mut self, scene: &Scene) -> Result<RadianceImage> {
        self.render_with_progress(scene, &mut |_| ControlFlow::Continue(()))
    }

    /// Like [`Renderer::render`]; `progress` hears the finished share of the work, 0 to 1, several times a second, and
    /// may stop it.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::Interrupted`] if `progress` stopped the work.
    pub fn render_with_progress(
        &mut self,
        scene: &Scene,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<RadianceImage> {
        scene.validate()?;
        let mut image = RadianceImage::new(scene.image)?;
        let row = 4 * scene.image.width as usize;
        self.draw(scene, image.as_mut_slice(), row, progress)?;
        Ok(image)
    }

    /// Renders into the caller's memory: `4 * width * height` values, linear RGBA by rows from the top left.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::Unsupported`] if the slice has another length.
    pub fn render_into(&mut self, scene: &Scene, target: &mut [f32]) -> Result<()> {
        scene.validate()?;
        let needed = 4 * scene.image.pixels();
        if target.len() != needed {
            return Err(Error::Unsupported(format!(
                "render_into: {} values given, {}x{} RGBA pixels are {needed}",
                target.len(),
                scene.image.width,
                scene.image.height
            )));
        }
        let row = 4 * scene.image.width as usize;
        self.draw(scene, target, row, &mut |_| ControlFlow::Continue(()))
    }

    /// Renders into a part of the caller's memory, such as a part of a larger image: linear RGBA by rows from the top left,
    /// the first at the beginning of `target`, each `stride` values after the one before. What lies between the rows, and
    /// after the last, is left alone.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::Unsupported`] if a row of `4 * width` values is longer than `stride`, or
    /// `target` ends before the last row does.
    pub fn render_into_rows(
        &mut self,
        scene: &Scene,
        target: &mut [f32],
        stride: usize,
    ) -> Result<()> {
        scene.validate()?;
        let (row, rows) = (4 * scene.image.width as usize, scene.image.height as usize);
        let needed = (rows - 1).saturating_mul(stride).saturating_add(row);
        if stride < row || target.len() < needed {
            return Err(Error::Unsupported(format!(
                "render_into_rows: {} values in rows {stride} apart; {}x{} RGBA pixels need rows of {row}, and {needed} in \
                 all",
                target.len(),
                scene.image.width,
                scene.image.height
            )));
        }
        self.draw(scene, target, stride, &mut |_| ControlFlow::Continue(()))
    }

    /// Renders into the renderer's own memory. On one CPU device the image is where the kernels wrote it: nothing is copied.
    ///
    /// # Errors
    /// As [`Renderer::render`], and [`Error::OutOfMemory`] if the image is larger than one buffer of the device.
    pub fn render_mapped(&mut self, scene: &Scene) -> Result<MappedImage<'_>> {
        scene.validate()?;
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => {
                let mapped = renderer.render_mapped(scene)?;
                Ok(MappedImage(MappedBackend::OpenCl(mapped)))
            }
            RendererBackend::Several(renderer) => {
                let values = renderer.render_kept(scene)?;
                Ok(MappedImage(MappedBackend::Host(values)))
            }
            RendererBackend::Reference { image, cost } => {
                let begun = Instant::now();
                let image = kept_image(image, scene.image)?;
                let nothing = &mut |_: f32| ControlFlow::Continue(());
                let method = scene.integration.method;
                reference::render_into(scene, method, image.as_mut_slice(), nothing)?;
                *cost = reference_cost(scene, begun.elapsed());
                Ok(MappedImage(MappedBackend::Host(image.as_slice())))
            }
        }
    }

    /// What the last frame cost.
    pub fn last_cost(&self) -> FrameCost {
        match &self.backend {
            RendererBackend::OpenCl(renderer) => renderer.cost(),
            RendererBackend::Several(renderer) => renderer.cost(),
            RendererBackend::Reference { cost, .. } => *cost,
        }
    }

    fn draw(
        &mut self,
        scene: &Scene,
        target: &mut [f32],
        stride: usize,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => {
                let rows = 0..scene.image.height;
                renderer.render_rows(scene, rows, target, stride, progress)?;
                Ok(())
            }
            RendererBackend::Several(renderer) => {
                renderer.render_into(scene, target, stride, progress)
            }
            RendererBackend::Reference { image, cost } => {
                let begun = Instant::now();
                let (method, row) = (scene.integration.method, 4 * scene.image.width as usize);
                if stride == row {
                    let target = &mut target[..4 * scene.image.pixels()];
                    reference::render_into(scene, method, target, progress)?;
                } else {
                    let image = kept_image(image, scene.image)?;
                    reference::render_into(scene, method, image.as_mut_slice(), progress)?;
                    let rows = image.as_slice().chunks_exact(row);
                    for (to, from) in target.chunks_mut(stride).zip(rows) {
                        to[..row].copy_from_slice(from);
                    }
                }
                *cost = reference_cost(scene, begun.elapsed());
                Ok(())
            }
        }
    }

    /// Linear RGB along single rays, light measured over the parameter s; the scene's camera,
    /// image and depth play no part.
    ///
    /// # Errors
    /// As [`Renderer::render`]; [`Error::Scene`] also for a ray that [`Ray::fault`] refuses.
    pub fn trace(&mut self, scene: &Scene, rays: &[Ray]) -> Result<Vec<[f64; 3]>> {
        scene.validate()?;
        for (index, ray) in rays.iter().enumerate() {
            if let Some(fault) = ray.fault() {
                return Err(SceneError::value(format!("ray {index}"), fault).into());
            }
        }
        let pixels = match &mut self.backend {
            RendererBackend::OpenCl(renderer) => renderer.trace(scene, rays)?,
            RendererBackend::Several(renderer) => renderer.trace(scene, rays)?,
            RendererBackend::Reference { .. } => {
                let tracer = Tracer::new(scene, scene.integration.method, 1.0);
                let radiances = rays.iter().map(|ray| tracer.radiance(ray, 1.0).to_array());
                return Ok(radiances.collect());
            }
        };
        let colors = pixels.iter().map(|p| [p[0], p[1], p[2]].map(f64::from));
        Ok(colors.collect())
    }
}

/// The renderer's own image, made anew if it has another size.
pub(crate) fn kept_image(
    image: &mut Option<RadianceImage>,
    size: ImageSize,
) -> Result<&mut RadianceImage> {
    let kept = image.take().filter(|image| image.size() == size);
    Ok(image.insert(match kept {
        Some(image) => image,
        None => RadianceImage::new(size)?,
    }))
}

/// The reference's time is all its own; the samples of its adaptive quadrature are not counted.
fn reference_cost(scene: &Scene, time: Duration) -> FrameCost {
    let evaluations = scene.image.pixels() as u64 * scene.source_count() as u64;
    let samples = match scene.integration.method {
        Method::Simpson => u64::from(scene.integration.divisions) + 1,
        Method::Exact => 0,
    };
    FrameCost {
        kernel: time,
        evaluations,
        field_evaluations: evaluations * samples,
        launches: 1,
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
