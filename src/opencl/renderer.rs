//! Renders scenes on an OpenCL device: uploads what changed, launches the kernels, reads the image back.

use std::ops::{ControlFlow, Range};
use std::time::Duration;

use opencl3::event::Event;

use super::counts::{self, Counts};
use super::depths::Depths;
use super::handle::Handle;
use super::job::Job;
use super::kernels::{Kernels, Rays, Variant};
use super::launch::{Pace, Part, launch};
use super::lists::Lists;
use super::mapped::Mapped;
use super::program::{Argument, BuildOptions, enqueue, run_time, set_arguments};
use super::tiles::{self, OpenTiles};
use super::{Compute, DeviceBuffer, OpenClDevice};
use crate::device::DeviceType;
use crate::error::{Error, Result};
use crate::pack::{self, Rule, Sources, layout};
use crate::ray::{Ray, ViewPlane};
use crate::renderer::FrameCost;
use crate::scene::Scene;

/// A pixel of the output: linear RGBA.
type Pixel = [f32; 4];

/// A device with its kernels and buffers, which are kept from frame to frame.
#[derive(Debug)]
pub struct OpenClRenderer {
    options: BuildOptions,
    kernels: Kernels,
    lanes: u32,
    lists: Lists,
    open_tiles: OpenTiles,
    counts: Counts,
    depths: Depths,
    pub(super) output: Option<DeviceBuffer<Pixel>>,
    pace: Pace,
    cost: FrameCost,
    pub(super) compute: Compute,
}

/// Reads a band of pixels from the beginning of the output buffer.
type Read<'a> = dyn FnMut(&DeviceBuffer<Pixel>, &Compute, Range<usize>) -> Result<()> + 'a;

/// A launch under way.
struct Launched {
    /// Of each pass.
    events: Vec<Handle<Event>>,
    /// If every pixel takes every source.
    integrals: u64,
    /// Samples of fields, or an estimate.
    evaluations: f64,
}

/// A larger output buffer would gain nothing; 8192x8192 pixels fit.
const MOST_BAND_BYTES: u64 = 1 << 30;

impl OpenClRenderer {
    /// Opens a device. Kernels are built when a scene first needs them.
    ///
    /// # Errors
    /// [`Error::Device`] if the driver refuses.
    pub fn new(device: &OpenClDevice, options: &BuildOptions) -> Result<Self> {
        Ok(Self {
            kernels: Kernels::default(),
            lanes: options.lanes.unwrap_or(device.lanes),
            lists: Lists::new(),
            open_tiles: OpenTiles::default(),
            counts: Counts::default(),
            depths: Depths::default(),
            output: None,
            pace: Pace::new(),
            cost: FrameCost::default(),
            options: options.clone(),
            compute: Compute::new(device)?,
        })
    }

    /// The device's properties.
    pub fn device(&self) -> &OpenClDevice {
        self.compute.device()
    }

    /// Renders a valid scene into `target`, RGBA by rows that begin `stride` values apart. `progress` hears the finished
    /// share and may stop the work.
    pub(crate) fn render_into(
        &mut self,
        scene: &Scene,
        target: &mut [f32],
        stride: usize,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        let job = self.job(scene)?;
        let row = 4 * scene.image.width as usize;
        let grain = job.work.grain.max(scene.image.width); // whole rows
        let mut read = |output: &DeviceBuffer<Pixel>, compute: &Compute, band: Range<usize>| {
            let first = band.start / scene.image.width as usize * stride;
            match stride == row {
                true => output.read(
                    compute,
                    bytemuck::cast_slice_mut(&mut target[4 * band.start..4 * band.end]),
                ),
                false => output.read_rows(compute, band.len(), row, &mut target[first..], stride),
            }
        };
        self.run(&job, scene.image.pixels(), grain, &mut read, progress)
    }

    /// What the last frame cost.
    pub(crate) fn cost(&self) -> FrameCost {
        self.cost
    }

    /// Packs a frame and uploads what changed.
    fn job(&mut self, scene: &Scene) -> Result<Job> {
        let plane = ViewPlane::new(&scene.camera, scene.image);
        // The corner pixels are the farthest from the eye.
        let reach = plane.first_pixel.length() + plane.ray_length;
        let sources = Sources::new(scene, plane.eye, reach, plane.ray_length);
        let view = pack::view(&plane, scene);
        self.depths.upload(&self.compute, scene.depth.as_ref())?;
        self.upload(scene, view, sources, None)
    }

    /// Linear RGBA along single rays; light is measured over the parameter s.
    pub(crate) fn trace(&mut self, scene: &Scene, rays: &[Ray]) -> Result<Vec<Pixel>> {
        let origin = rays.first().map_or(glam::DVec3::ZERO, |ray| ray.origin);
        let records: Vec<_> = rays.iter().map(|ray| pack::ray(ray, origin)).collect();
        let far = |ray: &Ray| ray.origin.distance(origin) + ray.span.length();
        let reach = rays.iter().map(far).fold(0.0, f64::max);
        let sources = Sources::new(scene, origin, reach, 1.0);
        let job = self.upload(scene, pack::view_of_rays(scene), sources, Some(&records))?;
        let mut radiances = vec![[0.0; 4]; rays.len()];
        let mut read = |output: &DeviceBuffer<Pixel>, compute: &Compute, band: Range<usize>| {
            output.read(compute, &mut radiances[band])
        };
        let nothing = &mut |_: f32| ControlFlow::Continue(());
        self.run(&job, rays.len(), 1, &mut read, nothing)?;
        Ok(radiances)
    }

    fn upload(
        &mut self,
        scene: &Scene,
        view: layout::View,
        sources: Sources,
        rays: Option<&[layout::RayRecord]>,
    ) -> Result<Job> {
        let fitting = Rule::of(&scene.integration, sources.have_squares());
        let rule = self.options.rule.unwrap_or(fitting);
        let units = self.device().compute_units;
        let job = Job::new(scene, rule, view, sources, rays.is_some(), units);
        self.kernels
            .prepare(&self.compute, &self.options, job.task, &rule)?;
        let nodes = match job.task.method {
            Variant::Simpson => {
                // Of a ray that ends early, only the kernel knows where its nodes are.
                let decay = scene.decay.filter(|_| !job.task.has_depth);
                pack::nodes(scene.integration.divisions, decay)
            }
            Variant::Exact { .. } => Vec::new(),
        };
        self.lists
            .upload(&self.compute, &nodes, &job.sources, rays)?;
        Ok(job)
    }

    /// Renders so many pixels in bands that fit into one buffer of the device, multiples of `grain`, and has each read.
    fn run(
        &mut self,
        job: &Job,
        pixels: usize,
        grain: u32,
        read: &mut Read<'_>,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        let band_len = self.band_len(pixels, grain)?;
        self.begin(job, pixels)?;
        for begin in (0..pixels).step_by(band_len) {
            let band = begin..pixels.min(begin + band_len);
            let mut report = |pixel: u32| progress(pixel as f32 / pixels as f32);
            let last = self.launch_band(job, band.start as u32..band.end as u32, &mut report)?;
            read(self.output()?, &self.compute, band)?;
            self.settle(job, last)?;
        }
        self.lists.settle(&self.compute)
    }

    /// Renders into the device's own buffer and maps it: on a CPU, nothing is copied.
    pub(crate) fn render_mapped(&mut self, scene: &Scene) -> Result<Mapped<'_>> {
        let job = self.job(scene)?;
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
        mapped.renderer.lists.settle(&mapped.renderer.compute)?;
        Ok(mapped)
    }

    /// Begins a frame of so many pixels. The first makes room for the largest launches that may follow.
    fn begin(&mut self, job: &Job, pixels: usize) -> Result<()> {
        self.pace.begin(&job.sources);
        self.cost = FrameCost::default();
        let largest = Part {
            pixels: 0..job.work.most_pixels().min(pixels as u32),
            sources: 0..job.work.source_count.min(job.work.most_sources),
        };
        self.open_tiles
            .reserve(&self.compute, &job.passes(&largest))
    }

    /// Launches all sources on a band of pixels. The last launch may still be under way.
    fn launch_band(
        &mut self,
        job: &Job,
        band: Range<u32>,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<Option<Launched>> {
        let all = job.work.source_count;
        let mut pixel = band.start;
        let mut last = None;
        while pixel < band.end {
            let pixels = pixel..pixel + self.pace.pixels(&job.work, band.end - pixel);
            let mut source = 0;
            loop {
                // One launch at a time: the pace of the next depends on it, and the queue stays short.
                self.settle(job, last.take())?;
                let count = self
                    .pace
                    .sources(&job.work, pixels.len() as u32, all - source);
                let part = Part {
                    pixels: pixels.clone(),
                    sources: source..source + count,
                };
                last = Some(self.launch(job, &part, pixels.start - band.start)?);
                source = part.sources.end;
                if source >= all {
                    break;
                }
            }
            pixel = pixels.end;
            if progress(pixel).is_break() {
                self.settle(job, last)?;
                return Err(Error::Interrupted);
            }
        }
        Ok(last)
    }

    fn launch(&mut self, job: &Job, part: &Part, slot: u32) -> Result<Launched> {
        let passes = job.passes(part);
        self.open_tiles.reserve(&self.compute, &passes)?;
        if self.counts_in(job) {
            self.counts.reset(&self.compute)?;
        }
        let launch = launch(part, slot, &job.sources, job.work.node_count);
        let lists = &self.lists;
        let common: [&dyn Argument; 12] = [
            &job.view,
            &launch,
            &lists.nodes,
            &lists.spheres,
            &lists.cylinders,
            &lists.beams,
            &lists.tori,
            &lists.curves,
            &lists.spline_pieces,
            &self.counts,
            &self.depths,
            self.output()?,
        ];
        let kernel = self.kernels.get(job.task)?;
        let enqueue = |more: &[&dyn Argument], items: usize, group: usize| {
            set_arguments(&self.compute, kernel, &[&common, more].concat())?;
            enqueue(&self.compute, kernel, items, group)
        };
        // On PoCL groups of 4 to 64 are equally fast, 128 leave a core idle on small images; one work-item for several
        // spans of lanes gains nothing.
        let device = self.device().device_type;
        let group = match device {
            DeviceType::Gpu => 64,
            _ => 16,
        };
        let items = part.pixels.len().div_ceil(self.lanes as usize);
        let OpenTiles { places, light } = &self.open_tiles;
        let events = match job.task.rays {
            Rays::Pixels => vec![enqueue(&[], items, group)?],
            Rays::Listed => vec![enqueue(&[&lists.rays], items, group)?],
            Rays::Tiles => {
                let units = self.device().compute_units;
                let workers = tiles::workers(self.device(), &self.options) as usize;
                let enqueue = |pass: &layout::TilePass| {
                    let items = tiles::groups(pass, units) * workers;
                    enqueue(&[pass, places, light], items, workers)
                };
                passes.iter().map(enqueue).collect::<Result<_>>()?
            }
        };
        if self.counts_in(job) {
            self.counts.fetch(&self.compute)?;
        }
        Ok(Launched {
            events,
            integrals: part.pixels.len() as u64 * (part.sources.end - part.sources.start),
            evaluations: part.evaluations(&job.work),
        })
    }

    /// Whether a job's kernels count.
    fn counts_in(&self, job: &Job) -> bool {
        job.task.rays == Rays::Tiles || self.options.counts_nodes
    }

    /// Waits for a launch and learns from it.
    fn settle(&mut self, job: &Job, launched: Option<Launched>) -> Result<()> {
        let Some(launched) = launched else {
            return Ok(());
        };
        let mut time = Duration::ZERO;
        for event in &launched.events {
            time += run_time(&self.compute, event)?;
        }
        self.pace.measured(launched.evaluations, time);
        let cost = &mut self.cost;
        cost.kernel += time;
        cost.launches += launched.events.len() as u32;
        let counted = self.counts.settle(&self.compute)?;
        cost.evaluations += match job.task.rays {
            Rays::Tiles => u64::from(counted[counts::INTEGRALS]),
            Rays::Pixels | Rays::Listed => launched.integrals,
        };
        cost.field_evaluations += match job.task.method {
            Variant::Simpson => launched.evaluations as u64,
            Variant::Exact { .. } => u64::from(counted[counts::NODES]),
        };
        Ok(())
    }

    /// The output buffer, which `band_len` makes.
    fn output(&self) -> Result<&DeviceBuffer<Pixel>> {
        self.output
            .as_ref()
            .ok_or_else(|| Error::OutOfMemory("there is no output buffer".to_owned()))
    }

    /// Makes sure of an output buffer for `pixels` pixels, or for as many as the device's limits allow, a multiple of
    /// `grain`.
    fn band_len(&mut self, pixels: usize, grain: u32) -> Result<usize> {
        let device = &self.compute.device;
        // A quarter of the memory leaves room for the sources and for everyone else.
        let bytes = device
            .max_allocation_bytes
            .min(device.memory_bytes / 4)
            .min(MOST_BAND_BYTES);
        let grain = grain as usize;
        let grains = (bytes as usize / size_of::<Pixel>() / grain).max(1);
        let wanted = pixels.min(grains * grain);
        match &self.output {
            Some(output) if output.len() >= wanted => {}
            _ => {
                self.output = None;
                self.output = Some(DeviceBuffer::image(&self.compute, "the image", wanted)?);
            }
        }
        Ok(wanted.max(1))
    }
}
