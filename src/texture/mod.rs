//! Volumes: the engine that draws the light of textures of cells into a film on an OpenCL device, by rays or by slices.

mod kernels;
pub mod pack;
mod self_test;
mod sources;

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;

use opencl3::event::Event;

use crate::cost::FrameCost;
use crate::error::Result;
use crate::image::{DepthAlong, DepthImage};
use crate::opencl::{
    Argument, Compute, Film, FilmFormat, Handle, Kernel, RawMemory, RendererOptions,
    UploadedShared, run_time,
};
use crate::scene::Scene;
pub(crate) use kernels::build_text;
use pack::{TextureView, TextureVolume};

/// Work-items in a group, which share nothing.
const GROUP: usize = 16;

/// Pixels of a launch: desktop GPUs kill launches of seconds.
const PIXELS: u32 = 1 << 17;

/// The kernels and buffers of a device, which are kept from frame to frame.
#[derive(Debug)]
pub(crate) struct Textures {
    options: RendererOptions,
    kernels: HashMap<FilmFormat, Kernel>,
    /// Of each volume.
    values: Vec<UploadedShared<f32>>,
    depths: UploadedShared<f32>,
    under_way: Vec<Handle<Event>>,
    cost: FrameCost,
}

/// What is to be drawn.
#[derive(Debug)]
pub(crate) struct TexturePlan {
    view: TextureView,
    volumes: Vec<TextureVolume>,
    format: FilmFormat,
    /// Depths of others on the device; `None`: the scene's, if it has any.
    depths: Option<RawMemory>,
}

/// What stands before and behind in the turn of engines.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turn {
    pub adds: bool,
    pub is_unfinished: bool,
}

impl Textures {
    /// Makes one without kernels: they are built when a scene first needs them.
    pub(crate) fn new(options: &RendererOptions) -> Self {
        Self {
            options: options.clone(),
            kernels: HashMap::new(),
            values: Vec::new(),
            depths: UploadedShared::new("the depth image"),
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

    /// Plans the volumes of a valid scene, behind depths that the device has, if there are any, and uploads what
    /// changed. `None`: the scene has none.
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
    ) -> Result<Option<TexturePlan>> {
        self.cost = FrameCost::default();
        if scene.volumes.is_empty() {
            return Ok(None);
        }
        if let Entry::Vacant(entry) = self.kernels.entry(format) {
            let (kernel, program) = kernels::build(compute, format, &self.options)?;
            let built = (kernel, &program);
            entry.insert(self_test::self_test(compute, format, &self.options, built)?);
        }
        self.prepare(compute, scene, there, format).map(Some)
    }

    fn prepare(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        there: Option<(RawMemory, DepthAlong)>,
        format: FilmFormat,
    ) -> Result<TexturePlan> {
        let make = || UploadedShared::new("the cells of a volume");
        self.values.resize_with(scene.volumes.len(), make);
        let plane = scene.view_plane();
        let seen: Vec<_> = scene.volumes.iter().map(|it| it.as_seen(&plane)).collect();
        for (values, volume) in self.values.iter_mut().zip(&seen) {
            let texture = &volume.texture;
            values.upload_made(compute, texture.values(), || pack::strided(texture))?;
        }
        let depths = scene.depth.as_ref().map(DepthImage::shared_values);
        self.depths.upload(compute, depths)?;
        let own = scene.depth.as_ref().map(DepthImage::along);
        let along = there.map(|(_, along)| along).or(own);
        let method = scene.integration.volumes;
        Ok(TexturePlan {
            view: TextureView::new(scene, &plane, along),
            volumes: seen
                .iter()
                .map(|volume| TextureVolume::new(volume, &plane, method))
                .collect(),
            format,
            depths: there.map(|(memory, _)| memory),
        })
    }

    /// Enqueues what draws pixels into a film, a volume after the other. Nothing here waits.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Device`](crate::Error::Device).
    pub(crate) fn draw(
        &mut self,
        compute: &Compute,
        plan: &TexturePlan,
        pixels: Range<u32>,
        film: &mut Film,
        turn: Turn,
    ) -> Result<()> {
        let Some(kernel) = self.kernels.get(&plan.format) else {
            return Ok(());
        };
        let lanes = self.options.lanes.unwrap_or(compute.device().lanes);
        let size = (plan.view.width, plan.view.height);
        let depths: &dyn Argument = match &plan.depths {
            Some(memory) => memory,
            None => self.depths.argument(),
        };
        for (index, volume) in plan.volumes.iter().enumerate() {
            film.add_to_what_is_there(turn.adds || index > 0);
            film.leave_unfinished(turn.is_unfinished || index + 1 < plan.volumes.len());
            let mut begin = pixels.start;
            while begin < pixels.end {
                let part = begin..pixels.end.min(begin.saturating_add(PIXELS));
                let drawn = film.arguments(compute, &part, size, true, true)?;
                let mut arguments: Vec<(&str, &dyn Argument)> = vec![
                    ("view", &plan.view),
                    ("volume", volume),
                    ("values", self.values[index].argument()),
                    ("depths", depths),
                ];
                arguments.extend(drawn.named());
                let items = part.len().div_ceil(lanes as usize);
                let group = kernel.group(compute, GROUP)?;
                let event = kernel.launch(compute, &arguments, items, group)?;
                self.under_way.push(event);
                begin = part.end;
            }
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
        for values in &mut self.values {
            values.settle(compute)?;
        }
        self.depths.settle(compute)
    }
}
