//! The renderer: one front for the OpenCL devices and the built-in reference.

use std::ops::ControlFlow;

use crate::device::{Backend, Device};
use crate::error::{Error, Result};
use crate::image::RadianceImage;
use crate::opencl::{BuildOptions, OpenClRenderer};
use crate::ray::Ray;
use crate::reference;
use crate::scene::{Method, Scene};

/// Renders scenes on one device. Kernels and buffers are kept: frames after the first allocate nothing on the device and
/// upload only what changed.
#[derive(Debug)]
pub struct Renderer {
    backend: RendererBackend,
}

#[derive(Debug)]
enum RendererBackend {
    OpenCl(Box<OpenClRenderer>),
    Reference,
}

impl Renderer {
    /// Makes a device ready: builds the kernels for it.
    ///
    /// # Errors
    /// [`Error::Device`] or [`Error::Build`] if the driver refuses.
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
            Backend::Reference => RendererBackend::Reference,
        };
        Ok(Self { backend })
    }

    /// Whether the device has a method.
    pub fn supports(&self, method: Method) -> bool {
        match &self.backend {
            RendererBackend::OpenCl(_) => method == Method::Simpson,
            RendererBackend::Reference => true,
        }
    }

    /// The scene's linear radiance, RGBA.
    ///
    /// # Errors
    /// [`Error::Scene`] if the scene is not valid, [`Error::Unsupported`] if the device lacks the scene's method,
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
        self.draw(scene, image.as_mut_slice(), progress)?;
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
        self.draw(scene, target, &mut |_| ControlFlow::Continue(()))
    }

    fn draw(
        &mut self,
        scene: &Scene,
        target: &mut [f32],
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => renderer.render_into(scene, target, progress),
            RendererBackend::Reference => {
                reference::render_into(scene, scene.integration.method, target, progress)
            }
        }
    }

    /// Linear RGB along single rays, light measured over the parameter s; the scene's camera and image play no part.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn trace(&mut self, scene: &Scene, rays: &[Ray]) -> Result<Vec<[f64; 3]>> {
        scene.validate()?;
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => {
                let pixels = renderer.trace(scene, rays)?;
                Ok(pixels
                    .iter()
                    .map(|p| [p[0], p[1], p[2]].map(f64::from))
                    .collect())
            }
            RendererBackend::Reference => Ok(reference_trace(scene, rays)),
        }
    }
}

fn reference_trace(scene: &Scene, rays: &[Ray]) -> Vec<[f64; 3]> {
    let sources = reference::sources(scene);
    let integrand = reference::Integrand {
        decay: scene.decay,
        softening: scene.integration.softening,
    };
    let radiance = |ray: &Ray| {
        let lights = sources.iter().map(|source| {
            let integral = match scene.integration.method {
                Method::Exact => reference::exact(&source.field, ray, &integrand),
                Method::Simpson => {
                    reference::simpson(&source.field, ray, &integrand, scene.integration.divisions)
                }
            };
            source.emission * integral
        });
        lights.sum::<glam::DVec3>().to_array()
    };
    rays.iter().map(radiance).collect()
}
