//! Crowds: the engine that draws points of light in any number into a film on an OpenCL device, at a cost that hardly
//! depends on their number. Seen from the eye, they are sorted into cells of pixels; what cells give off is taken at
//! the nodes of tiles, which are quartered where it matters (Greengard, Rokhlin 1987, with Chebyshev nodes: Fong, Darve
//! 2009).

mod buffers;
mod enqueue;
mod kernels;
pub(crate) mod pack;
mod self_test;
mod sort;
mod sources;

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;
use std::time::Instant;

use opencl3::event::Event;

use crate::cost::FrameCost;
use crate::error::Result;
use crate::image::{DepthAlong, DepthImage, ImageSize};
use crate::opencl::{
    Argument, Compute, Film, FilmFormat, Handle, RawMemory, RendererOptions, UploadedShared,
    run_time,
};
use crate::scene::{Camera, CrowdSight, Integration, Points, Profile, Scene};
use buffers::{Buffers, NODES_OF_TILE};
use enqueue::{Enqueue, Stage};
use kernels::Kernels;
pub(crate) use kernels::build_text;
use pack::{CrowdView, Sorted};
use self_test::self_test;
use sort::Sorter;

/// Work-items in a group of a GPU. On a CPU groups are single: neighbours may differ much in their work.
const GROUP: usize = 32;

/// Counts: `cl/crowd/types.h`.
const COUNTS: usize = 20;
const COUNTED_CELLS: usize = 16;
const COUNTED_PAIRS: usize = 18;

/// Pixels of the lowest tile.
const PIXELS_OF_TILE: u64 = 64;

/// The kernels and buffers of a device for crowds of a profile, which are kept from frame to frame.
#[derive(Debug)]
pub(crate) struct Crowd {
    options: RendererOptions,
    profile: Profile,
    /// Of a format, for rays that end at depths, or are whole.
    kernels: HashMap<(FilmFormat, bool), Kernels>,
    /// Of what points were sorted.
    known: Option<(Known, Sorted)>,
    sorter: Sorter,
    buffers: Buffers,
    depths: UploadedShared<f32>,
    /// Whether tiles have the light of the last plan.
    is_lit: bool,
    under_way: Vec<(Stage, Handle<Event>)>,
    cost: FrameCost,
}

/// What decides how points are seen and sorted. Of the lists themselves, which may be a host's, nothing is kept.
#[derive(Debug, Clone, PartialEq)]
struct Known {
    points: Vec<(u64, Points)>,
    camera: Camera,
    image: ImageSize,
    integration: Integration,
}

/// What is to be drawn.
#[derive(Debug)]
pub(crate) struct CrowdPlan {
    view: CrowdView,
    format: FilmFormat,
    /// Whether rays end at depths; depths of others on the device, `None`: the scene's.
    has_ends: bool,
    depths: Option<RawMemory>,
}

impl Crowd {
    /// Makes one without kernels: they are built when a scene first needs them.
    pub(crate) fn new(options: &RendererOptions, profile: Profile) -> Self {
        Self {
            options: options.clone(),
            profile,
            kernels: HashMap::new(),
            known: None,
            sorter: Sorter::default(),
            buffers: Buffers::new(),
            depths: UploadedShared::new("the depth image"),
            is_lit: false,
            under_way: Vec::new(),
            cost: FrameCost::default(),
        }
    }

    /// Returns what was drawn since the last plan cost.
    pub(crate) fn cost(&self) -> FrameCost {
        self.cost
    }

    /// Returns how many kernels were built.
    pub(crate) fn kernel_count(&self) -> usize {
        self.kernels.len()
    }

    /// Plans the crowd of a valid scene whose points all belong to crowds but for those that are too bright, behind
    /// depths that the device has, if there are any: sees and sorts them, and makes sure that kernels are built.
    /// `None`: the scene has none.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Build`](crate::Error::Build),
    /// [`Error::SelfTest`](crate::Error::SelfTest),
    /// [`Error::Device`](crate::Error::Device); [`Error::Unsupported`](crate::Error::Unsupported) for a camera whose
    /// image has no grid.
    pub(crate) fn plan(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        there: Option<(RawMemory, DepthAlong)>,
        format: FilmFormat,
    ) -> Result<Option<CrowdPlan>> {
        self.cost = FrameCost::default();
        let is_own = |it: &Points| it.crowd_profile() == self.profile && !it.points.is_empty();
        if !scene.points.iter().any(is_own) {
            return Ok(None);
        }
        let own = scene.depth.as_ref().map(DepthImage::along);
        let along = there.map(|(_, along)| along).or(own);
        let kind = (format, along.is_some());
        if let Entry::Vacant(entry) = self.kernels.entry(kind) {
            let (kernels, program) = kernels::build(compute, kind, &self.options)?;
            let kernels = self_test(compute, kind, &self.options, (kernels, &program))?;
            entry.insert(kernels);
        }
        let sight = CrowdSight::new(scene)?;
        let known = Known {
            points: scene.points.iter().map(Points::stamp).collect(),
            camera: scene.camera.clone(),
            image: scene.image,
            integration: scene.integration,
        };
        let sorted = match &self.known {
            Some((same, sorted)) if *same == known => *sorted,
            _ => {
                self.known = None;
                let begun = Instant::now();
                let mut sorted = self.sorter.see(scene, &sight, self.profile);
                let (sorter, buffers) = (&mut self.sorter, &mut self.buffers);
                let count = sorted.sources as usize;
                let cells = buffers.cells.reserve(compute, count)?;
                let sources = buffers.sources.reserve(compute, count)?;
                sorted.occupied = cells.fill(compute, count, |cells| {
                    sources.fill(compute, count, |sources| sorter.sort(sources, cells))
                })??;
                buffers.starts.write(compute, &sorter.starts)?;
                buffers.rest.write(compute, &sorter.rest)?;
                self.cost.crowds.sorting = begun.elapsed();
                self.known = Some((known, sorted));
                sorted
            }
        };
        if sorted.sources + sorted.rest == 0 {
            return Ok(None);
        }
        let view = pack::view(scene, self.profile, &sorted, along)?;
        self.buffers.reserve(compute, &view, along.is_some())?;
        let depths = scene.depth.as_ref().map(DepthImage::shared_values);
        self.depths.upload(compute, depths)?;
        self.buffers.numbers.write(compute, &view.numbers())?;
        self.buffers.roots.write(compute, &view.roots())?;
        self.is_lit = false;
        Ok(Some(CrowdPlan {
            view,
            format,
            has_ends: along.is_some(),
            depths: there.map(|(memory, _)| memory),
        }))
    }

    /// Enqueues what draws whole rows of pixels into a film. Nothing here waits.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Device`](crate::Error::Device).
    pub(crate) fn draw(
        &mut self,
        compute: &Compute,
        plan: &CrowdPlan,
        pixels: Range<u32>,
        film: &mut Film,
    ) -> Result<()> {
        let Some(kernels) = self.kernels.get(&(plan.format, plan.has_ends)) else {
            return Ok(());
        };
        let (view, buffers) = (&plan.view, &self.buffers);
        let lanes = self.options.lanes.unwrap_or(compute.device().lanes);
        let group = match lanes {
            1 => GROUP,
            _ => 1,
        };
        let depths: &dyn Argument = match &plan.depths {
            Some(memory) => memory,
            None => self.depths.argument(),
        };
        let mut enqueue = Enqueue {
            compute,
            view,
            buffers,
            lanes,
            group,
            under_way: &mut self.under_way,
        };
        if !self.is_lit {
            enqueue.light_tiles(kernels, depths)?;
            self.is_lit = true;
        }
        let first = pixels.start / view.width / 8 * view.tile_columns;
        let end = pixels.end.div_ceil(view.width).div_ceil(8) * view.tile_columns;
        let size = (view.width, view.height);
        let drawn = film.arguments(compute, &pixels, size, true, true)?;
        let mut arguments: Vec<(&str, &dyn Argument)> = vec![
            ("starts", buffers.starts.argument()),
            ("sources", buffers.sources.argument()),
            ("levels", buffers.levels.argument()),
            ("numbers", buffers.numbers.argument()),
            ("tiles", buffers.tiles.argument()),
            ("values", buffers.values.argument()),
            ("owners", buffers.owners.argument()),
            ("counts", buffers.counts.argument()),
            ("first_tile", &first),
            ("end_tile", &end),
            ("shares", buffers.shares.argument()),
            ("ends_of_tiles", buffers.ends.argument()),
        ];
        arguments.extend(drawn.named());
        enqueue.launch(
            Stage::Pixels,
            &kernels.draw,
            &arguments,
            (end - first) as usize,
        )
    }

    /// Waits for what is under way, and adds up what it cost.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) if a launch failed.
    pub(crate) fn settle(&mut self, compute: &Compute) -> Result<()> {
        let mut outcome = Ok(());
        let crowds = &mut self.cost.crowds;
        for (stage, event) in self.under_way.drain(..) {
            match run_time(compute, &event) {
                Ok(time) => {
                    self.cost.kernel += time;
                    *match stage {
                        Stage::Cells => &mut crowds.cells,
                        Stage::Tiles => &mut crowds.tiles,
                        Stage::Pixels => &mut crowds.pixels,
                    } += time;
                }
                Err(error) => outcome = outcome.and(Err(error)),
            }
            self.cost.launches += 1;
        }
        outcome?;
        self.depths.settle(compute)?;
        if let (Some(counts), true) = (&self.buffers.counts.buffer, self.is_lit) {
            let mut found = [0_u32; COUNTS];
            counts.read(compute, &mut found)?;
            let [cells, limits, pairs] = [COUNTED_CELLS, COUNTED_CELLS + 1, COUNTED_PAIRS]
                .map(|place| u64::from(found[place]));
            let nodes = NODES_OF_TILE as u64;
            self.cost.integrals = nodes * (cells + limits) + PIXELS_OF_TILE * pairs;
        }
        Ok(())
    }
}
