//! The launches of a frame: how much each takes, what it is given, what is learnt from it.

use std::ops::{ControlFlow, Range};
use std::time::Duration;

use opencl3::event::Event;
use opencl3::types::cl_mem;

use super::copies::state;
use super::handle::Handle;
use super::job::Job;
use super::kernels::{Rays, Variant};
use super::pace::{Part, launch};
use super::program::{Argument, RawMemory, enqueue, run_time, set_arguments};
use super::tiles::{self, OpenTiles};
use super::{OpenClRenderer, counts};
use crate::device::DeviceType;
use crate::error::{Error, Result};
use crate::pack::layout;
use crate::renderer::FrameCost;
use crate::scene::Scene;

/// Where a frame's pixels go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Output {
    /// The renderer's own buffer.
    Own,
    /// A buffer of someone else, for all pixels.
    Buffer(cl_mem),
    /// Likewise, of half floats.
    Halves(cl_mem),
    /// An image of someone else, for all pixels.
    Image(cl_mem),
}

/// A launch under way.
#[derive(Debug)]
pub(super) struct Launched {
    /// Of each pass.
    events: Vec<Handle<Event>>,
    /// If every pixel takes every source.
    integrals: u64,
    /// Samples of fields, or an estimate.
    evaluations: f64,
}

impl OpenClRenderer {
    /// Begins a frame of so many pixels. The first makes room for the largest launches that may follow.
    pub(super) fn begin(&mut self, job: &Job, pixels: usize) -> Result<()> {
        self.pace.begin(&job.sources);
        self.cost = FrameCost::default();
        let largest = Part {
            pixels: 0..job.work.most_pixels().min(pixels as u32),
            sources: 0..job.work.source_count.min(job.work.most_sources),
        };
        self.open_tiles
            .reserve(&self.compute, &job.passes(&largest))
    }

    /// Launches all sources on a band of pixels, one launch at a time: the pace of the next depends on it, and the queue
    /// stays short. The last one may still be under way.
    pub(super) fn launch_band(
        &mut self,
        job: &Job,
        band: Range<u32>,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<Option<Launched>> {
        let mut last = None;
        let mut pixel = band.start;
        while pixel < band.end {
            let pixels = pixel..pixel + self.pace.pixels(&job.work, band.end - pixel);
            let mut source = 0;
            loop {
                self.settle(job, last.take())?;
                let part = self.pace.part(&job.work, &pixels, source);
                last = Some(self.launch(job, &part, pixels.start - band.start, Output::Own)?);
                source = part.sources.end;
                if source >= job.work.source_count {
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

    /// Packs a frame of someone else's memory and launches it, without waiting for anything.
    pub(super) fn launch_frame(&mut self, scene: &Scene, output: Output) -> Result<()> {
        let job = self.job(scene, output)?;
        self.begin(&job, scene.image.pixels())?;
        self.launch_all(&job, scene.image.pixels() as u32, output)
    }

    /// Launches all sources on all of a frame's pixels without waiting for anything. What is found finished later tells
    /// the pace.
    fn launch_all(&mut self, job: &Job, pixels: u32, output: Output) -> Result<()> {
        self.learn()?;
        self.pace.begin_unwatched(&job.work, pixels);
        let mut pixel = 0;
        while pixel < pixels {
            let next = pixel..pixel + self.pace.pixels(&job.work, pixels - pixel);
            let mut source = 0;
            loop {
                let part = self.pace.part(&job.work, &next, source);
                let launched = self.launch(job, &part, next.start, output)?;
                self.cost.launches += launched.events.len() as u32;
                self.unwatched.push(launched);
                source = part.sources.end;
                if source >= job.work.source_count {
                    break;
                }
            }
            pixel = next.end;
        }
        Ok(())
    }

    /// Learns from launches of earlier frames that are over.
    fn learn(&mut self) -> Result<()> {
        let compute = &self.compute;
        let mut outcome = Ok(());
        for launched in std::mem::take(&mut self.unwatched) {
            let states = launched.events.iter().map(|event| state(event));
            match states.collect::<std::result::Result<Vec<bool>, _>>() {
                Ok(states) if states.iter().all(|is_over| *is_over) => {
                    let times = launched.events.iter().map(|e| run_time(compute, e));
                    let time = times.sum::<Result<Duration>>();
                    outcome = outcome.and(time.map(|time| {
                        self.pace.measured(launched.evaluations, time);
                    }));
                }
                Ok(_) => self.unwatched.push(launched),
                Err(code) => {
                    let name = &compute.device.name;
                    let call = "clEnqueueNDRangeKernel";
                    outcome = outcome.and(Err(super::failure::failed(name, call)(code)));
                }
            }
        }
        outcome
    }

    fn launch(&mut self, job: &Job, part: &Part, slot: u32, output: Output) -> Result<Launched> {
        let passes = job.passes(part);
        self.open_tiles.reserve(&self.compute, &passes)?;
        if self.counts_in(job) {
            self.counts.reset(&self.compute)?;
        }
        let launch = launch(part, slot, &job.sources, job.work.node_count);
        let is_whole = launch.accumulate == 0 && launch.is_last == 1;
        let pixels = match output {
            Output::Own => self.output()?.handle(),
            Output::Buffer(buffer) => buffer,
            Output::Image(_) | Output::Halves(_) if is_whole => std::ptr::null_mut(),
            Output::Image(_) | Output::Halves(_) => {
                self.reserve_output(job.view.width as usize * job.view.height as usize)?;
                self.output()?.handle()
            }
        };
        let (pixels, image) = (RawMemory(pixels), output.image());
        let lists = &self.lists;
        let mut common: Vec<&dyn Argument> = vec![
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
            &pixels,
        ];
        common.extend(image.iter().map(|image| image as &dyn Argument));
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
        if self.counts_in(job) && output == Output::Own {
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
    pub(super) fn settle(&mut self, job: &Job, launched: Option<Launched>) -> Result<()> {
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
}

impl Output {
    /// What finished pixels go to, where that is not the buffer in which they are gathered.
    fn image(self) -> Option<RawMemory> {
        match self {
            Self::Image(image) | Self::Halves(image) => Some(RawMemory(image)),
            Self::Own | Self::Buffer(_) => None,
        }
    }
}
