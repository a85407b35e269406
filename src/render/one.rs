//! Renders scenes on one OpenCL device: plans a frame, draws it in bands that fit into the film, and reads them back.

use std::ops::{ControlFlow, Range};
use std::time::{Duration, Instant};

use super::engines::{Engines, FramePlan};
use crate::bloom::Spreader;
use crate::cost::FrameCost;
use crate::error::{Error, Result};
use crate::image::{Bloom, ImageSize};
use crate::mesh::Meshes;
use crate::metaball::Surfaces;
use crate::opencl::{
    Adder, Compute, Film, HostDepths, HostLink, MappedFilm, OpenClDevice, Pixel, RendererOptions,
};
use crate::scene::{Ray, Scene};
use crate::volume::{CellValue, Grid, Volume};
use crate::wave::Wave;

/// A device with its engines and its film, which are kept from frame to frame.
#[derive(Debug)]
pub(crate) struct DeviceRenderer {
    // Dropped in this order: what uses the context before the context.
    pub(super) engines: Engines,
    pub(super) spreader: Spreader,
    pub(super) surfaces: Surfaces,
    pub(super) adder: Adder,
    /// Where parts of a host's frame are drawn.
    pub(super) part: Film,
    pub(super) meshes: Meshes,
    /// Of the bloom of the last frame.
    pub(super) bloom_cost: FrameCost,
    pub(super) film: Film,
    /// The host whose frames are enqueued, if there is one.
    pub(super) host: Option<HostLink>,
    pub(super) host_depths: HostDepths,
    /// Whether the device itself writes the caller's memory where it can; else what it wrote is copied there.
    pub(crate) writes_in_place: bool,
    /// Another queue, for what is not to wait for a host.
    pub(super) beside: Option<Compute>,
    pub(super) compute: Compute,
}

/// Rows of an image that are wanted, and where: RGBA by rows that begin `stride` values apart, the first at the
/// beginning of `target`.
pub(crate) struct Rows<'a> {
    pub rows: Range<u32>,
    pub target: &'a mut [f32],
    pub stride: usize,
    /// Of the light of all rows, if they are those of an image and no others lie between them.
    pub bloom: Option<Bloom>,
}

/// Hears the finished share of the work, 0 to 1, and may stop it.
type Progress<'a> = dyn FnMut(f32) -> ControlFlow<()> + 'a;

/// Reads a band of pixels, numbered in the image, from the beginning of the film.
type Read<'a> = dyn FnMut(&mut Film, &Compute, Range<usize>) -> Result<()> + 'a;

impl DeviceRenderer {
    /// Opens a device. Kernels are built when a scene first needs them.
    ///
    /// # Errors
    /// [`Error::Device`] if the driver refuses.
    pub(crate) fn new(device: &OpenClDevice, options: &RendererOptions) -> Result<Self> {
        Self::with_compute(Compute::new(device)?, None, options)
    }

    pub(crate) fn with_compute(
        compute: Compute,
        host: Option<HostLink>,
        options: &RendererOptions,
    ) -> Result<Self> {
        check_known(compute.device(), options)?;
        Ok(Self {
            engines: Engines::new(&compute, options)?,
            spreader: Spreader::new(options),
            surfaces: Surfaces::new(options),
            adder: Adder::new(options),
            part: Film::new(),
            meshes: Meshes::new(options),
            bloom_cost: FrameCost::default(),
            film: Film::new(),
            host,
            host_depths: HostDepths::new(options),
            writes_in_place: false,
            beside: None,
            compute,
        })
    }

    pub(crate) fn wave(&mut self) -> &mut Wave {
        &mut self.engines.wave
    }

    /// Returns how much more of the host's memory a frame of so many pixels takes, beside the image, bytes.
    pub(crate) fn missing_bytes(&self, pixels: usize, has_bloom: bool) -> u64 {
        let levels = match has_bloom {
            true => self.spreader.missing_bytes(&self.compute, pixels),
            false => 0,
        };
        self.film.missing_bytes(&self.compute, pixels) + levels
    }

    /// Returns what the last frame cost.
    pub(crate) fn cost(&self) -> FrameCost {
        self.engines.cost().then(self.bloom_cost)
    }

    /// Returns what [`Wave::grain_rows`] says.
    pub(crate) fn grain_rows(&mut self, scene: &Scene) -> u32 {
        self.engines.wave.grain_rows(scene)
    }

    /// Plans a frame of a valid scene.
    pub(super) fn plan(&mut self, scene: &Scene) -> Result<FramePlan> {
        self.bloom_cost = FrameCost::default();
        let format = self.film.format();
        self.engines.plan(&self.compute, scene, None, format)
    }

    /// Renders some rows of a valid scene, and returns the time from the first launch on unless kernels had to be
    /// built.
    pub(crate) fn render_rows(
        &mut self,
        scene: &Scene,
        wanted: Rows<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<Option<Duration>> {
        let built = self.engines.kernel_count();
        let plan = self.plan(scene)?;
        let is_built = self.engines.kernel_count() == built;
        let begun = Instant::now();
        let Rows {
            rows,
            target,
            stride,
            bloom,
        } = wanted;
        let bloom = bloom.map(|bloom| (scene.image, bloom));
        let width = scene.image.width as usize;
        let pixels = Wave::pixels_of(scene, &rows);
        let (begin, len) = (pixels.start as usize, pixels.len());
        if stride == 4 * width {
            let target: &mut [Pixel] = bytemuck::cast_slice_mut(&mut target[..4 * len]);
            if self.writes_in_place && Film::reaches(&self.compute, target) {
                self.draw_in_place(&plan, pixels, target, progress)?;
                return Ok(is_built.then(|| begun.elapsed()));
            }
        }
        let grain = self.grain_rows(scene) * scene.image.width;
        let mut read = |film: &mut Film, compute: &Compute, band: Range<usize>| {
            let first = (band.start - begin) / width * stride;
            let target = &mut target[first..];
            match stride == 4 * width {
                true => {
                    let target = &mut target[..4 * band.len()];
                    film.read(compute, bytemuck::cast_slice_mut(target))
                }
                false => film.read_rows(compute, band.len(), 4 * width, target, stride),
            }
        };
        let is_whole = self.draw_bands(&plan, pixels, grain, bloom, &mut read, progress)?;
        if let (Some((size, bloom)), false) = (bloom, is_whole) {
            self.bloom(size, &mut target[..4 * len], &bloom)?;
        }
        Ok(is_built.then(|| begun.elapsed()))
    }

    /// Samples the emission of a valid scene in the cells of a grid.
    pub(crate) fn bake(
        &mut self,
        scene: &Scene,
        cells: (Grid, CellValue),
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Volume> {
        self.engines
            .wave
            .bake(&self.compute, scene, cells, progress)
    }

    /// Returns linear RGBA along single rays; light is measured over the parameter s.
    pub(crate) fn integrate(
        &mut self,
        scene: &Scene,
        rays: &[Ray],
        progress: &mut Progress<'_>,
    ) -> Result<Vec<Pixel>> {
        let plan = self.engines.plan_rays(&self.compute, scene, rays)?;
        let mut radiances = vec![[0.0; 4]; rays.len()];
        let mut read = |film: &mut Film, compute: &Compute, band: Range<usize>| {
            film.read(compute, &mut radiances[band])
        };
        let all = 0..rays.len() as u32;
        self.bloom_cost = FrameCost::default();
        self.draw_bands(&plan, all, plan.grain(), None, &mut read, progress)?;
        Ok(radiances)
    }

    /// Draws pixels in bands that fit into one buffer of the device, multiples of `grain`, and has each read; with the
    /// bloom where there is a single band. Returns whether there was.
    pub(super) fn draw_bands(
        &mut self,
        plan: &FramePlan,
        pixels: Range<u32>,
        grain: u32,
        bloom: Option<(ImageSize, Bloom)>,
        read: &mut Read<'_>,
        progress: &mut Progress<'_>,
    ) -> Result<bool> {
        let Self {
            engines,
            spreader,
            film,
            compute,
            ..
        } = self;
        let band_len = film.reserve_band(compute, pixels.len(), grain)?;
        engines.begin(compute, plan, pixels.len())?;
        for begin in pixels.clone().step_by(band_len) {
            let band = begin..pixels.end.min(begin.saturating_add(band_len as u32));
            film.begin_at(begin);
            let mut report = |pixel| progress(share(&pixels, pixel));
            engines.draw(compute, plan, band.clone(), film, &mut report)?;
            if let (Some((size, bloom)), true) = (bloom, band == pixels) {
                spreader.spread(compute, film, size, &bloom)?;
            }
            read(film, compute, band.start as usize..band.end as usize)?;
            engines.settle(compute, plan)?;
        }
        self.bloom_cost = spreader.settle(compute)?;
        engines.settle_uploads(compute)?;
        Ok(band_len >= pixels.len())
    }

    /// Lets the device draw pixels where the caller wants them.
    fn draw_in_place(
        &mut self,
        plan: &FramePlan,
        pixels: Range<u32>,
        target: &mut [Pixel],
        progress: &mut Progress<'_>,
    ) -> Result<()> {
        let Self {
            engines,
            film,
            compute,
            ..
        } = self;
        let mut film = film.lend(compute, target)?;
        engines.begin(compute, plan, pixels.len())?;
        film.begin_at(pixels.start);
        let mut report = |pixel| progress(share(&pixels, pixel));
        engines.draw(compute, plan, pixels.clone(), &mut film, &mut report)?;
        film.show_host(pixels.len())?;
        engines.settle(compute, plan)?;
        engines.settle_uploads(compute)
    }

    /// Renders into the film's own buffer and maps it: on a CPU, nothing is copied.
    pub(crate) fn render_mapped(
        &mut self,
        scene: &Scene,
        bloom: Option<Bloom>,
    ) -> Result<MappedFilm<'_>> {
        let plan = self.plan(scene)?;
        let Self {
            engines,
            spreader,
            bloom_cost,
            film,
            compute,
            ..
        } = self;
        let pixels = scene.image.pixels();
        if film.reserve_band(compute, pixels, plan.grain())? < pixels {
            return Err(Error::OutOfMemory(format!(
                "{}: {}x{} pixels are more than one buffer of the device holds; read the image back instead",
                compute.device().name,
                scene.image.width,
                scene.image.height
            )));
        }
        engines.begin(compute, &plan, pixels)?;
        film.begin_at(0);
        let nothing = &mut |_: u32| ControlFlow::Continue(());
        engines.draw(compute, &plan, 0..pixels as u32, film, nothing)?;
        if let Some(bloom) = bloom {
            spreader.spread(compute, film, scene.image, &bloom)?;
        }
        let mapped = film.map(compute, pixels)?;
        engines.settle(compute, &plan)?;
        *bloom_cost = spreader.settle(compute)?;
        engines.settle_uploads(compute)?;
        Ok(mapped)
    }
}

/// Refuses a device whose driver is known not to draw, unless the caller insists.
fn check_known(device: &OpenClDevice, options: &RendererOptions) -> Result<()> {
    match &device.known_fault {
        Some(fault) if !options.skips_self_test => Err(Error::SelfTest {
            device: device.name.clone(),
            driver: format!("{}, {}", device.platform, device.driver),
            reason: fault.clone(),
        }),
        _ => Ok(()),
    }
}

/// Returns the finished share of some pixels.
fn share(pixels: &Range<u32>, pixel: u32) -> f32 {
    (pixel - pixels.start) as f32 / pixels.len() as f32
}

#[cfg(test)]
pub(crate) mod tests {
    use glam::DVec3;

    use super::*;
    use crate::image::ImageSize;
    use crate::opencl::discover;
    use crate::scene::{Camera, Decay, Method, Profile, Torus};

    /// Makes a scene of a ring seen from 4 away, `size` pixels wide and high, by Simpson's rule.
    pub(crate) fn ring(size: u32) -> Scene {
        let mut scene = Scene::new(Camera::new(DVec3::new(2.8, 1.6, 2.3), DVec3::ZERO));
        scene.image = ImageSize {
            width: size,
            height: size,
        };
        scene.decay = Some(Decay::new(0.1, 0.1));
        scene.integration.method = Method::Simpson { divisions: 64 };
        scene.tori.push(Torus {
            profile: Profile::Inverse,
            coefficient: 1.0,
            ..Torus::new(0.9)
        });
        scene
    }

    fn draw(
        renderer: &mut DeviceRenderer,
        scene: &Scene,
        rows: Range<u32>,
        stride: usize,
    ) -> Vec<f32> {
        let mut target = vec![0.0; rows.len() * stride];
        let wanted = Rows {
            rows,
            target: &mut target,
            stride,
            bloom: None,
        };
        let nothing = &mut |_: f32| ControlFlow::Continue(());
        renderer.render_rows(scene, wanted, nothing).unwrap();
        target
    }

    #[test]
    fn an_image_larger_than_a_buffer_comes_in_bands() {
        let mut scene = ring(96);
        scene.image.width = 100;
        let mut images = Vec::new();
        for bytes in [1 << 30, 40_000] {
            let mut device = discover().devices.swap_remove(0);
            device.max_allocation_bytes = bytes;
            let options = RendererOptions::default();
            let mut renderer = DeviceRenderer::new(&device, &options).unwrap();
            for stride in [400, 401] {
                let target = draw(&mut renderer, &scene, 0..96, stride);
                let rows = target.chunks(stride).map(|row| row[..400].to_vec());
                images.push(rows.collect::<Vec<_>>());
            }
        }
        assert!(images.windows(2).all(|pair| pair[0] == pair[1]));
        assert!(images[0].iter().flatten().all(|value| *value > 0.0));
    }

    #[test]
    fn an_image_cut_between_tiles_is_the_same_to_the_bit_and_cut_elsewhere_is_not() {
        let mut scene = ring(160);
        scene.integration.method = Method::default();
        let device = discover().devices.swap_remove(0);
        let options = RendererOptions::default();
        let mut renderer = DeviceRenderer::new(&device, &options).unwrap();
        let grain = renderer.grain_rows(&scene);
        let mut draw = |cut: u32, is_in_place: bool| {
            renderer.writes_in_place = is_in_place;
            let mut whole = draw(&mut renderer, &scene, 0..cut, 640);
            whole.extend(draw(&mut renderer, &scene, cut..160, 640));
            whole
        };
        let whole = draw(0, false);
        for cut in [0, grain, 128, 160] {
            assert!(
                draw(cut, true) == whole && draw(cut, false) == whole,
                "{cut}"
            );
        }
        assert!(draw(60, true) != whole && draw(60, false) != whole);
    }
}
