//! Carries a plan out: the launches of a frame, how much each takes, what is learnt from it.

use std::ops::{ControlFlow, Range};
use std::time::Duration;

use opencl3::event::Event;

use super::counts::CountedNumbers;
use super::kernels::{Rays, Variant};
use super::pack::layout::Launch;
use super::partition::{Part, Place, TILE_SHARES};
use super::plan::Plan;
use super::tiles::{self, OpenTiles};
use super::{Wave, counts};
use crate::cost::FrameCost;
use crate::error::{Error, Result};
use crate::opencl::{Argument, Compute, DeviceForm, Film, Handle, run_time, state, wait};

/// Launches that are enqueued at once: while the host sees to the next one, the device works on another.
const MOST_UNDER_WAY: usize = 2;

/// A launch under way.
#[derive(Debug)]
pub(super) struct Launched {
    /// Of each pass.
    events: Vec<Handle<Event>>,
    /// The copy of zeros before it, if there was one.
    reset: Option<Handle<Event>>,
    /// What was counted by this launch and those before it, since numbers were last fetched.
    counted: Option<CountedNumbers>,
    /// If every pixel takes every source.
    integrals: u64,
    /// Samples of fields, or an estimate.
    samples: f64,
}

impl Wave {
    /// Begins a frame of so many pixels. The first makes room for the largest launches that may follow.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Device`].
    pub(crate) fn begin(&mut self, compute: &Compute, plan: &Plan, pixels: usize) -> Result<()> {
        self.pace.begin(&plan.counts);
        self.cost = FrameCost::default();
        self.under_way.clear();
        self.counts.begin();
        let largest = Part {
            pixels: 0..plan.work.most_pixels().min(pixels as u32),
            sources: 0..plan.work.source_count.min(plan.work.most_sources),
            passes: 0..u32::MAX,
            shares: 0..TILE_SHARES,
        };
        self.open_tiles.reserve(compute, &plan.passes(&largest))
    }

    /// Draws all sources on a band of pixels, at most [`MOST_UNDER_WAY`] launches at a time: the pace of the next
    /// depends on those before, and the queue stays short. The last ones may still be under way: [`Wave::settle`] waits
    /// for them.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if `progress`, which hears the number of the next pixel, says so; [`Error::Device`].
    pub(crate) fn draw(
        &mut self,
        compute: &Compute,
        plan: &Plan,
        band: Range<u32>,
        film: &mut Film,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<()> {
        let mut pixel = band.start;
        while pixel < band.end {
            let pixels = pixel..pixel + self.pace.pixels(&plan.work, band.end - pixel);
            let mut next = Some(Place::default());
            while let Some(place) = next {
                self.settle_down_to(MOST_UNDER_WAY - 1, compute, plan)?;
                let part = self.pace.part(&plan.work, &pixels, place);
                if part.is_first() && self.counts.is_used_up() {
                    self.fetch_counts(compute)?;
                }
                let launched = self.launch(compute, plan, &part, film)?;
                self.under_way.push_back(launched);
                next = part.next(&plan.work);
                pixel = if next.is_some() { pixel } else { pixels.end };
                if progress(pixel).is_break() {
                    self.settle(compute, plan)?;
                    return Err(Error::Interrupted);
                }
            }
        }
        self.fetch_counts(compute)
    }

    /// Draws all sources on all of a frame's pixels without waiting for anything. What is found finished later tells
    /// the pace.
    ///
    /// # Errors
    /// [`Error::Device`] if the driver refuses a launch.
    pub(crate) fn draw_unwatched(
        &mut self,
        compute: &Compute,
        plan: &Plan,
        film: &mut Film,
    ) -> Result<()> {
        self.learn(compute);
        let pixels = plan.size.0 * plan.size.1;
        self.pace.begin_unwatched(&plan.work, pixels);
        let mut pixel = 0;
        while pixel < pixels {
            let some = pixel..pixel + self.pace.pixels(&plan.work, pixels - pixel);
            let mut next = Some(Place::default());
            while let Some(place) = next {
                let part = self.pace.part(&plan.work, &some, place);
                if part.is_first() && self.counts.is_used_up() {
                    self.counts.begin();
                }
                let mut launched = self.launch(compute, plan, &part, film)?;
                self.held.extend(launched.reset.take());
                self.cost.launches += launched.events.len() as u32;
                self.unwatched.push(launched);
                next = part.next(&plan.work);
            }
            pixel = some.end;
        }
        Ok(())
    }

    /// Learns from launches of earlier frames that are over. What failed has told its frame's event.
    fn learn(&mut self, compute: &Compute) {
        self.held.retain(|event| matches!(state(event), Ok(false)));
        for launched in std::mem::take(&mut self.unwatched) {
            let mut states = launched.events.iter().map(|event| state(event));
            if states.any(|is_over| matches!(is_over, Ok(false))) {
                self.unwatched.push(launched);
                continue;
            }
            self.first_launch = None;
            let times = launched.events.iter().map(|event| run_time(compute, event));
            if let Ok(time) = times.sum::<Result<Duration>>() {
                self.pace.measured(launched.samples, time);
            }
        }
    }

    fn launch(
        &mut self,
        compute: &Compute,
        plan: &Plan,
        part: &Part,
        film: &mut Film,
    ) -> Result<Launched> {
        let passes = plan.passes(part);
        self.open_tiles.reserve(compute, &passes)?;
        // The launches of a tile's passes count in one set: each begins with what the one before left open.
        let reset = match self.counts_in(plan) && part.is_first() {
            true => self.counts.take(compute)?,
            false => None,
        };
        let (is_first, is_last) = plan.place_of(part);
        let film = film.arguments(compute, &part.pixels, plan.size, is_first, is_last)?;
        let launch = Launch {
            first_ball: self.packed.sources.rows.first_balls.unwrap_or_default(),
            first_count: self.counts.first(),
            ..plan.launch(part)
        };
        let mut common: Vec<(&str, &dyn Argument)> =
            vec![("integrand", &plan.integrand), ("launch", &launch)];
        common.extend(self.lists.named(&self.packed.sources));
        common.push(("counts", self.counts.argument()));
        common.extend(film.named());
        if let Some(view) = &plan.view {
            let depths = match &plan.depths {
                Some(others) => others,
                None => self.depths.argument(),
            };
            common.extend([("view", view as &dyn Argument), ("depths", depths)]);
        }
        let kernel = self.kernels.get(plan.task)?;
        let enqueue = |more: &[(&str, &dyn Argument)], items: usize, group: usize| {
            kernel.launch(compute, &[&common, more].concat(), items, group)
        };
        // On PoCL groups of 4 to 64 are equally fast, 128 leave a core idle on small images; one work-item for several
        // spans of lanes gains nothing.
        let device = compute.device();
        let group = match device.form {
            DeviceForm::Gpu => 64,
            DeviceForm::Cpu => 16,
        };
        let group = kernel.group(compute, group)?;
        let items = part.pixels.len().div_ceil(self.lanes as usize);
        let OpenTiles { places, light } = &self.open_tiles;
        let events = match plan.task.rays {
            Rays::Pixels => vec![enqueue(&[], items, group)?],
            Rays::Listed => vec![enqueue(&[("rays", self.lists.rays())], items, group)?],
            Rays::Cells => Vec::new(), // which are no pixels: `bake` launches them
            Rays::Tiles => {
                let workers = tiles::workers(device, &self.options) as usize;
                let tiles = |pass: &_| {
                    let items = tiles::groups(pass, device.compute_units) * workers;
                    let more: [(&str, &dyn Argument); 3] = [
                        ("pass", pass),
                        ("open_tiles", places),
                        ("open_light", light),
                    ];
                    enqueue(&more, items, workers)
                };
                passes.iter().map(tiles).collect::<Result<_>>()?
            }
        };
        Ok(Launched {
            events,
            reset,
            counted: None,
            integrals: part.pixels.len() as u64 * (part.sources.end - part.sources.start),
            samples: part.samples(&plan.work),
        })
    }

    /// Has what was counted so far come to the host, with the last launch.
    fn fetch_counts(&mut self, compute: &Compute) -> Result<()> {
        let counted = self.counts.fetch(compute)?;
        self.counts.begin();
        if let Some(last) = self.under_way.back_mut() {
            last.counted = counted;
        }
        Ok(())
    }

    /// Whether a plan's kernels count.
    fn counts_in(&self, plan: &Plan) -> bool {
        plan.task.rays == Rays::Tiles || self.options.counts_samples
    }

    /// Waits for the launches under way and learns from them.
    ///
    /// # Errors
    /// [`Error::Device`] if one failed.
    pub(crate) fn settle(&mut self, compute: &Compute, plan: &Plan) -> Result<()> {
        self.settle_down_to(0, compute, plan)
    }

    /// Waits until no more than so many launches are under way.
    fn settle_down_to(&mut self, most: usize, compute: &Compute, plan: &Plan) -> Result<()> {
        while self.under_way.len() > most {
            if let Some(launched) = self.under_way.pop_front() {
                self.settle_one(compute, plan, launched)?;
            }
        }
        Ok(())
    }

    fn settle_one(&mut self, compute: &Compute, plan: &Plan, launched: Launched) -> Result<()> {
        let mut time = Duration::ZERO;
        for event in &launched.events {
            time += run_time(compute, event)?;
        }
        self.first_launch = None;
        self.pace.measured(launched.samples, time);
        if let Some(reset) = &launched.reset {
            wait(compute, reset, "clEnqueueWriteBuffer")?;
        }
        let counted = match launched.counted {
            Some(counted) => counted.wait(compute)?,
            None => Default::default(),
        };
        let cost = &mut self.cost;
        cost.kernel += time;
        cost.launches += launched.events.len() as u32;
        cost.integrals += match plan.task.rays {
            Rays::Tiles => counted[counts::INTEGRALS],
            Rays::Pixels | Rays::Listed | Rays::Cells => launched.integrals,
        };
        cost.samples += match plan.task.method {
            Variant::Simpson | Variant::Jittered => launched.samples as u64,
            Variant::Exact { .. } => counted[counts::NODES],
        };
        Ok(())
    }

    /// Waits for copies under way. One that failed means a wrong image: it is asked for when everything is over.
    ///
    /// # Errors
    /// [`Error::Device`] if a copy failed.
    pub(crate) fn settle_uploads(&mut self, compute: &Compute) -> Result<()> {
        self.depths.settle(compute)?;
        self.lists.settle(compute)
    }
}
