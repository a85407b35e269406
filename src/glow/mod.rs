//! Particles as light: the engine that draws balls and streaks, each of whose light ends at a distance, into a film on
//! an OpenCL device. They are seen from the eye, and listed by tiles of pixels, anew for every frame, on the host; for
//! listed rays they are found in a tree.

mod along;
mod kernels;
pub mod pack;
mod self_test;
mod shapes;
mod sources;
mod tiles;
mod tree;

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;

use opencl3::event::Event;

use crate::cost::FrameCost;
use crate::error::Result;
use crate::image::{DepthAlong, DepthImage, ImageSize};
use crate::opencl::{
    Argument, Compute, Film, FilmFormat, Handle, Kernel, RawMemory, RendererOptions, Uploaded,
    UploadedShared, run_time, state,
};
use crate::scene::{Camera, Ray, Scene};
use along::{Along, RayPlan};
pub(crate) use kernels::build_text;
use pack::{Element, GlowView, Packed, Sight};
use tiles::Tiles;

/// Work-items in a group, which share nothing: of a CPU few enough that all cores are busy to the end.
const GROUP: usize = 2;
const GPU_GROUP: usize = 32;

/// Units of rays of a launch: desktop GPUs kill launches of seconds.
const UNITS: u32 = 1 << 16;

/// The kernels and buffers of a device, which are kept from frame to frame.
#[derive(Debug)]
pub(crate) struct Glow {
    options: RendererOptions,
    kernels: HashMap<FilmFormat, Kernel>,
    /// Of what elements were packed and listed.
    known: Option<Known>,
    packed: Packed,
    tiles: Tiles,
    elements: Uploaded<Element>,
    ends: Uploaded<u32>,
    numbers: Uploaded<u32>,
    depths: UploadedShared<f32>,
    along: Along,
    under_way: Vec<Handle<Event>>,
    cost: FrameCost,
}

/// What decides how particles are seen.
#[derive(Debug, PartialEq)]
struct Known {
    particles: u64,
    elements: u64,
    camera: Camera,
    image: ImageSize,
    /// From the projection plane to the decay's pole, as [`Sight`] has it.
    to_pole: Option<f64>,
}

/// What is to be drawn.
#[derive(Debug)]
pub(crate) enum GlowPlan {
    Picture(PicturePlan),
    Rays(RayPlan),
}

#[derive(Debug)]
pub(crate) struct PicturePlan {
    view: GlowView,
    format: FilmFormat,
    /// Depths of others on the device; `None`: the scene's, if it has any.
    depths: Option<RawMemory>,
}

impl Glow {
    /// Makes one without kernels: they are built when a scene first needs them.
    pub(crate) fn new(options: &RendererOptions) -> Self {
        Self {
            options: options.clone(),
            kernels: HashMap::new(),
            known: None,
            packed: Packed::default(),
            tiles: Tiles::default(),
            elements: Uploaded::new("the particles of light"),
            ends: Uploaded::new("the tiles of particles"),
            numbers: Uploaded::new("the particles of tiles"),
            depths: UploadedShared::new("the depth image"),
            along: Along::new(),
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
        self.kernels.len() + usize::from(self.along.kernel.is_some())
    }

    /// Plans the particles of a valid scene, behind depths that the device has, if there are any: packs and lists them,
    /// uploads what changed, and makes sure that the kernel is built. `None`: the scene has none.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Build`](crate::Error::Build),
    /// [`Error::SelfTest`](crate::Error::SelfTest), [`Error::Device`](crate::Error::Device).
    pub(crate) fn plan(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        there: Option<(RawMemory, DepthAlong)>,
        format: FilmFormat,
    ) -> Result<Option<GlowPlan>> {
        self.cost = FrameCost::default();
        if !scene.has_particles() {
            return Ok(None);
        }
        if let Entry::Vacant(entry) = self.kernels.entry(format) {
            let (kernel, program) = kernels::build(compute, format, &self.options)?;
            let built = (kernel, &program);
            entry.insert(self_test::self_test(compute, format, &self.options, built)?);
        }
        let plan = self.prepare(compute, scene, there, format)?;
        Ok(Some(GlowPlan::Picture(plan)))
    }

    /// Plans light along listed rays through a valid scene, over the parameter of each. `None`: nothing shines.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Build`](crate::Error::Build),
    /// [`Error::SelfTest`](crate::Error::SelfTest), [`Error::Device`](crate::Error::Device).
    pub(crate) fn plan_rays(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        rays: &[Ray],
    ) -> Result<Option<GlowPlan>> {
        self.cost = FrameCost::default();
        if !scene.has_particles() {
            return Ok(None);
        }
        self.along.build(compute, &self.options)?;
        let plan = self.along.prepare(compute, scene, rays)?;
        Ok(Some(GlowPlan::Rays(plan)))
    }

    fn prepare(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        there: Option<(RawMemory, DepthAlong)>,
        format: FilmFormat,
    ) -> Result<PicturePlan> {
        let plane = scene.view_plane();
        let sight = Sight::new(scene, &plane);
        let known = Some(Known {
            particles: scene.particles.revision(),
            elements: scene.light_elements.revision(),
            camera: scene.camera.clone(),
            image: scene.image,
            to_pole: sight.to_pole(),
        });
        let are_there = [
            self.elements.is_there(),
            self.ends.is_there(),
            self.numbers.is_there(),
        ];
        if self.known != known || are_there.contains(&false) {
            self.packed.pack(scene, &sight);
            let size = [scene.image.width, scene.image.height];
            let lanes = self.options.lanes.unwrap_or(compute.device().lanes);
            self.tiles.list(&self.packed.boxes, size, unit(lanes).0);
            self.known = None;
            let (packed, tiles) = (&mut self.packed, &mut self.tiles);
            self.elements.upload_taken(compute, &mut packed.elements)?;
            self.ends.upload_taken(compute, &mut tiles.ends)?;
            self.numbers.upload_taken(compute, &mut tiles.numbers)?;
            self.known = known;
        }
        let depths = scene.depth.as_ref().map(DepthImage::shared_values);
        self.depths.upload(compute, depths)?;
        let own = scene.depth.as_ref().map(DepthImage::along);
        let along = there.map(|(_, along)| along).or(own);
        Ok(PicturePlan {
            view: GlowView {
                tile: self.tiles.size,
                tile_columns: self.tiles.columns,
                ..sight.view(scene, along)
            },
            format,
            depths: there.map(|(memory, _)| memory),
        })
    }

    /// Enqueues what draws whole rows of pixels, or some of the rays, into a film. Nothing here waits.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Device`](crate::Error::Device).
    pub(crate) fn draw(
        &mut self,
        compute: &Compute,
        plan: &GlowPlan,
        pixels: Range<u32>,
        film: &mut Film,
    ) -> Result<()> {
        let is_going_on = |event: &Handle<Event>| matches!(state(event), Ok(false));
        if self.under_way.len() > 64 {
            self.under_way.retain(is_going_on);
        }
        let lanes = self.options.lanes.unwrap_or(compute.device().lanes);
        let plan = match plan {
            GlowPlan::Picture(plan) => plan,
            GlowPlan::Rays(plan) => {
                let event = self.along.draw(compute, plan, &pixels, lanes, film)?;
                self.under_way.extend(event);
                return Ok(());
            }
        };
        let Some(kernel) = self.kernels.get(&plan.format) else {
            return Ok(());
        };
        let view = &plan.view;
        let (unit_columns, unit_rows) = unit(lanes);
        let across = view.width.div_ceil(unit_columns);
        let first = pixels.start / view.width / unit_rows * across;
        let rows = pixels.end.div_ceil(view.width);
        let end = rows.div_ceil(unit_rows) * across;
        let size = (view.width, view.height);
        let drawn = film.arguments(compute, &pixels, size, true, true)?;
        let depths: &dyn Argument = match &plan.depths {
            Some(memory) => memory,
            None => self.depths.argument(),
        };
        for begin in (first..end).step_by(UNITS as usize) {
            let stop = end.min(begin + UNITS);
            let mut arguments: Vec<(&str, &dyn Argument)> = vec![
                ("view", view),
                ("elements", &self.elements),
                ("ends", &self.ends),
                ("numbers", &self.numbers),
                ("depths", depths),
                ("first_unit", &begin),
                ("end_unit", &stop),
            ];
            arguments.extend(drawn.named());
            let wanted = if lanes == 1 { GPU_GROUP } else { GROUP };
            let group = kernel.group(compute, wanted)?;
            let event = kernel.launch(compute, &arguments, (stop - begin) as usize, group)?;
            self.under_way.push(event);
        }
        Ok(())
    }

    /// Waits for what is under way, and adds up what it cost.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) if a launch or a copy failed.
    pub(crate) fn settle(&mut self, compute: &Compute) -> Result<()> {
        let mut outcome = Ok(());
        for event in self.under_way.drain(..) {
            match run_time(compute, &event) {
                Ok(time) => self.cost.kernel += time,
                Err(error) => outcome = outcome.and(Err(error)),
            }
            self.cost.launches += 1;
        }
        outcome?;
        self.along.settle(compute)?;
        self.elements.settle(compute)?;
        self.ends.settle(compute)?;
        self.numbers.settle(compute)?;
        self.depths.settle(compute)
    }
}

/// Returns the columns and rows of a unit of rays, as `cl/block.h` and `cl/glow/near.h` have them: 4 by 4 blocks.
fn unit(lanes: u32) -> (u32, u32) {
    match lanes {
        16 => (16, 16),
        8 => (16, 8),
        4 => (8, 8),
        _ => (1, 1),
    }
}
