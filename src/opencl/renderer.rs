//! Renders scenes on an OpenCL device: uploads what changed, launches the kernels, reads the image back.

use std::ops::{ControlFlow, Range};
use std::time::{Duration, Instant};

use opencl3::command_queue::CommandQueue;

use super::counts::Counts;
use super::depths::Depths;
use super::handle::Handle;
use super::job::{Job, MOST_LANES, Wanted, grain_rows};
use super::kernels::{Kernels, Variant};
use super::launch::{Launched, Output};
use super::lists::Lists;
use super::mapped::Mapped;
use super::pace::Pace;
use super::program::BuildOptions;
use super::tiles::OpenTiles;
use super::{Compute, DeviceBuffer, OpenClDevice};
use crate::error::{Error, Result};
use crate::pack::{self, Rule, Sources, layout};
use crate::ray::{Ray, ViewPlane};
use crate::renderer::FrameCost;
use crate::scene::Scene;

/// A pixel of the output: linear RGBA.
pub(super) type Pixel = [f32; 4];

/// A device with its kernels and buffers, which are kept from frame to frame.
#[derive(Debug)]
pub struct OpenClRenderer {
    pub(super) options: BuildOptions,
    pub(super) kernels: Kernels,
    pub(super) lanes: u32,
    pub(super) lists: Lists,
    pub(super) open_tiles: OpenTiles,
    pub(super) counts: Counts,
    pub(super) depths: Depths,
    pub(super) output: Option<DeviceBuffer<Pixel>>,
    pub(super) pace: Pace,
    pub(super) cost: FrameCost,
    /// Launches of frames that nobody waited for.
    pub(super) unwatched: Vec<Launched>,
    /// The host's queue, if frames are enqueued for one.
    pub(super) host_queue: Option<Handle<CommandQueue>>,
    /// Whether the device itself writes the caller's memory where it can; else what it wrote is copied there.
    pub(crate) writes_in_place: bool,
    pub(super) compute: Compute,
}

/// Reads a band of pixels from the beginning of the output buffer.
type Read<'a> = dyn FnMut(&DeviceBuffer<Pixel>, &Compute, Range<usize>) -> Result<()> + 'a;

/// A larger output buffer would gain nothing; 8192x8192 pixels fit.
const MOST_BAND_BYTES: u64 = 1 << 30;

impl OpenClRenderer {
    /// Opens a device. Kernels are built when a scene first needs them.
    ///
    /// # Errors
    /// [`Error::Device`] if the driver refuses.
    pub fn new(device: &OpenClDevice, options: &BuildOptions) -> Result<Self> {
        Ok(Self::with_compute(Compute::new(device)?, options))
    }

    pub(super) fn with_compute(compute: Compute, options: &BuildOptions) -> Self {
        Self {
            kernels: Kernels::default(),
            lanes: options.lanes.unwrap_or(compute.device.lanes),
            lists: Lists::new(),
            open_tiles: OpenTiles::default(),
            counts: Counts::default(),
            depths: Depths::new(),
            output: None,
            pace: Pace::new(),
            cost: FrameCost::default(),
            unwatched: Vec::new(),
            host_queue: None,
            writes_in_place: false,
            options: options.clone(),
            compute,
        }
    }

    /// The device's properties.
    pub fn device(&self) -> &OpenClDevice {
        self.compute.device()
    }

    /// Renders some rows of a valid scene into `target`, RGBA by rows that begin `stride` values apart. `progress` hears the
    /// finished share and may stop the work. Gives the time from the first launch on, unless kernels had to be built.
    pub(crate) fn render_rows(
        &mut self,
        scene: &Scene,
        rows: Range<u32>,
        target: &mut [f32],
        stride: usize,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Option<Duration>> {
        let built = self.kernels.count();
        let job = self.job(scene, Output::Own)?;
        let is_built = self.kernels.count() == built;
        let width = scene.image.width as usize;
        let [begin, end] = [rows.start, rows.end].map(|row| row as usize * width);
        let begun = Instant::now();
        if stride == 4 * width {
            let target: &mut [Pixel] = bytemuck::cast_slice_mut(&mut target[..4 * (end - begin)]);
            if self.reaches(target) {
                self.run_in_place(&job, begin..end, target, progress)?;
                return Ok(is_built.then(|| begun.elapsed()));
            }
        }
        let mut read = |output: &DeviceBuffer<Pixel>, compute: &Compute, band: Range<usize>| {
            let first = (band.start - begin) / width * stride;
            let target = &mut target[first..];
            match stride == 4 * width {
                true => output.read(
                    compute,
                    bytemuck::cast_slice_mut(&mut target[..4 * band.len()]),
                ),
                false => output.read_rows(compute, band.len(), 4 * width, target, stride),
            }
        };
        let grain = grain_rows(scene) * scene.image.width;
        self.run(&job, begin..end, grain, &mut read, progress)?;
        Ok(is_built.then(|| begun.elapsed()))
    }

    /// What the last frame cost.
    pub(crate) fn cost(&self) -> FrameCost {
        self.cost
    }

    /// Packs a frame and uploads what changed.
    pub(super) fn job(&mut self, scene: &Scene, output: Output) -> Result<Job> {
        let plane = ViewPlane::new(&scene.camera, scene.image);
        // The corner pixels are the farthest from the eye.
        let reach = plane.first_pixel.length() + plane.ray_length;
        let sources = Sources::new(scene, plane.eye, reach, plane.ray_length);
        let view = pack::view(&plane, scene);
        self.depths.upload(&self.compute, scene.depth.as_ref())?;
        self.upload(scene, view, sources, Wanted::Pixels(output))
    }

    /// Linear RGBA along single rays; light is measured over the parameter s.
    pub(crate) fn trace(&mut self, scene: &Scene, rays: &[Ray]) -> Result<Vec<Pixel>> {
        let origin = rays.first().map_or(glam::DVec3::ZERO, |ray| ray.origin);
        let records: Vec<_> = rays.iter().map(|ray| pack::ray(ray, origin)).collect();
        let far = |ray: &Ray| ray.origin.distance(origin) + ray.span.length();
        let reach = rays.iter().map(far).fold(0.0, f64::max);
        let sources = Sources::new(scene, origin, reach, 1.0);
        let view = pack::view_of_rays(scene);
        let job = self.upload(scene, view, sources, Wanted::Rays(&records))?;
        let mut radiances = vec![[0.0; 4]; rays.len()];
        let mut read = |output: &DeviceBuffer<Pixel>, compute: &Compute, band: Range<usize>| {
            output.read(compute, &mut radiances[band])
        };
        let nothing = &mut |_: f32| ControlFlow::Continue(());
        self.run(&job, 0..rays.len(), MOST_LANES, &mut read, nothing)?;
        Ok(radiances)
    }

    fn upload(
        &mut self,
        scene: &Scene,
        view: layout::View,
        sources: Sources,
        wanted: Wanted<'_>,
    ) -> Result<Job> {
        let fitting = Rule::of(&scene.integration, sources.have_squares());
        let rule = self.options.rule.unwrap_or(fitting);
        let units = self.device().compute_units;
        let job = Job::new(scene, rule, view, sources, &wanted, units);
        let (compute, options) = (&self.compute, &self.options);
        if let Some(built) = self.kernels.prepare(compute, options, job.task, &rule)? {
            self.self_test(job.task, built, &scene.integration)?;
        }
        let nodes = match job.task.method {
            Variant::Simpson => {
                // Of a ray that ends early, only the kernel knows where its nodes are.
                let decay = scene.decay.filter(|_| !job.task.has_depth);
                pack::nodes(scene.integration.divisions, decay)
            }
            Variant::Exact { .. } => Vec::new(),
        };
        self.lists
            .upload(&self.compute, &nodes, &job.sources, wanted.rays())?;
        Ok(job)
    }

    /// Renders pixels in bands that fit into one buffer of the device, multiples of `grain`, and has each read.
    pub(super) fn run(
        &mut self,
        job: &Job,
        pixels: Range<usize>,
        grain: u32,
        read: &mut Read<'_>,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        let band_len = self.band_len(pixels.len(), grain)?;
        self.begin(job, pixels.len())?;
        for begin in pixels.clone().step_by(band_len) {
            let band = begin..pixels.end.min(begin + band_len);
            let share = |pixel: u32| (pixel as usize - pixels.start) as f32 / pixels.len() as f32;
            let mut report = |pixel: u32| progress(share(pixel));
            let last = self.launch_band(job, band.start as u32..band.end as u32, &mut report)?;
            read(self.output()?, &self.compute, band)?;
            self.settle(job, last)?;
        }
        self.settle_uploads()
    }

    /// Renders into the device's own buffer and maps it: on a CPU, nothing is copied.
    pub(crate) fn render_mapped(&mut self, scene: &Scene) -> Result<Mapped<'_>> {
        let job = self.job(scene, Output::Own)?;
        let pixels = scene.image.pixels();
        if self.band_len(pixels, job.work.grain)? < pixels {
            return Err(Error::OutOfMemory(format!(
                "{}: {}x{} pixels are more than one buffer of the device holds; read the image back instead",
                self.device().name,
                scene.image.width,
                scene.image.height
            )));
        }
        self.begin(&job, pixels)?;
        let last = self.launch_band(&job, 0..pixels as u32, &mut |_| ControlFlow::Continue(()))?;
        let pointer = self.output()?.map(&self.compute, pixels)?;
        let mapped = Mapped {
            pointer,
            pixels,
            renderer: self,
        };
        mapped.renderer.settle(&job, last)?;
        mapped.renderer.settle_uploads()?;
        Ok(mapped)
    }

    /// A copy that failed means a wrong image: it is asked for when everything is over.
    fn settle_uploads(&mut self) -> Result<()> {
        self.depths.settle(&self.compute)?;
        self.lists.settle(&self.compute)
    }

    /// The output buffer, which `reserve_output` makes.
    pub(super) fn output(&self) -> Result<&DeviceBuffer<Pixel>> {
        self.output
            .as_ref()
            .ok_or_else(|| Error::OutOfMemory("there is no output buffer".to_owned()))
    }

    /// Makes sure of an output buffer for `pixels` pixels, or for as many as the device's limits allow, a multiple of
    /// `grain`.
    fn band_len(&mut self, pixels: usize, grain: u32) -> Result<usize> {
        let grain = grain as usize;
        let grains = (self.most_output_bytes() as usize / size_of::<Pixel>() / grain).max(1);
        let wanted = pixels.min(grains * grain);
        self.reserve_output(wanted)?;
        Ok(wanted.max(1))
    }

    /// Of an output buffer.
    pub(super) fn most_output_bytes(&self) -> u64 {
        let device = &self.compute.device;
        // A quarter of the memory leaves room for the sources and for everyone else.
        let bytes = device.max_allocation_bytes.min(device.memory_bytes / 4);
        bytes.min(MOST_BAND_BYTES)
    }

    /// Makes sure of an output buffer for so many pixels.
    pub(super) fn reserve_output(&mut self, pixels: usize) -> Result<()> {
        if self
            .output
            .as_ref()
            .is_none_or(|output| output.len() < pixels)
        {
            self.output = None;
            self.output = Some(DeviceBuffer::image(&self.compute, "the image", pixels)?);
        }
        Ok(())
    }
}
