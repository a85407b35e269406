//! Volumes: the engine that draws the light of textures of cells into a film on an OpenCL device, by rays or by slices.

mod kernels;
pub mod pack;
mod self_test;
mod smooth;
mod sources;

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::ops::Range;

use opencl3::event::Event;

use crate::cost::FrameCost;
use crate::error::Result;
use crate::image::{DepthAlong, DepthImage};
use crate::opencl::{
    Argument, Compute, DeviceType, Film, FilmFormat, Handle, Kernel, RawMemory, RendererOptions,
    SharedImage, UploadedShared, has_images, run_time,
};
use crate::scene::{Scene, Volume};
use crate::volume::Texture;
use kernels::Form;
pub(crate) use kernels::build_text;
use pack::{TextureView, TextureVolume};
use smooth::Smooth;

/// Work-items in a group, which share nothing.
const GROUP: usize = 16;

/// Pixels of a launch: desktop GPUs kill launches of seconds.
const PIXELS: u32 = 1 << 17;

/// The kernels and buffers of a device, which are kept from frame to frame.
#[derive(Debug)]
pub(crate) struct Textures {
    options: RendererOptions,
    kernels: HashMap<Form, Kernel>,
    /// Of each volume.
    values: Vec<UploadedShared<f32>>,
    images: Vec<SharedImage>,
    /// Of each that is drawn by bricks.
    smooth: Vec<SmoothOnDevice>,
    depths: UploadedShared<f32>,
    under_way: Vec<Handle<Event>>,
    cost: FrameCost,
}

/// What a volume is where it changes little.
#[derive(Debug)]
struct SmoothOnDevice {
    host: Option<Smooth>,
    cells: UploadedShared<f32>,
    bricks: UploadedShared<f32>,
}

/// What is to be drawn.
#[derive(Debug)]
pub(crate) struct TexturePlan {
    view: TextureView,
    volumes: Vec<TextureVolume>,
    form: Form,
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
            images: Vec::new(),
            smooth: Vec::new(),
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
        let form = (format, self.has_images(compute, scene));
        if let Entry::Vacant(entry) = self.kernels.entry(form) {
            let (kernel, program) = kernels::build(compute, form, &self.options)?;
            let built = (kernel, &program);
            entry.insert(self_test::self_test(compute, form, &self.options, built)?);
        }
        self.prepare(compute, scene, there, form).map(Some)
    }

    /// Returns whether the cells of all volumes go into images: GPUs have caches for those, CPUs draw four times as
    /// fast from buffers.
    fn has_images(&self, compute: &Compute, scene: &Scene) -> bool {
        let is_gpu = compute.device().device_type == DeviceType::Gpu;
        let fit = |volume: &Volume| has_images(compute, texels(&volume.texture));
        self.options.volume_images.unwrap_or(is_gpu) && scene.volumes.iter().all(fit)
    }

    fn prepare(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        there: Option<(RawMemory, DepthAlong)>,
        form: Form,
    ) -> Result<TexturePlan> {
        let plane = scene.view_plane();
        let seen = Volume::all_as_seen(&scene.volumes, &plane);
        let make = || UploadedShared::new("the cells of a volume");
        self.values.resize_with(seen.len(), make);
        self.images.resize_with(seen.len(), SharedImage::default);
        for (index, volume) in seen.iter().enumerate() {
            let texture = &volume.texture;
            let values = texture.values();
            match form.1 {
                true => self.images[index].upload(compute, texels(texture), values)?,
                false => {
                    self.values[index].upload_made(compute, values, || pack::strided(texture))?
                }
            }
        }
        let method = scene.integration.volumes;
        self.smooth.resize_with(seen.len(), SmoothOnDevice::new);
        for (smooth, volume) in self.smooth.iter_mut().zip(&seen) {
            if pack::skips(volume, method) {
                smooth.upload(compute, volume)?;
            }
        }
        let depths = scene.depth.as_ref().map(DepthImage::shared_values);
        self.depths.upload(compute, depths)?;
        let own = scene.depth.as_ref().map(DepthImage::along);
        let along = there.map(|(_, along)| along).or(own);
        Ok(TexturePlan {
            view: TextureView::new(scene, &plane, along),
            volumes: seen
                .iter()
                .map(|volume| TextureVolume::new(volume, &plane, method))
                .collect(),
            form,
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
        let Some(kernel) = self.kernels.get(&plan.form) else {
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
            let image = self.images[index].argument();
            let values: &dyn Argument = match plan.form.1 {
                true => &image,
                false => self.values[index].argument(),
            };
            let mut begin = pixels.start;
            while begin < pixels.end {
                let part = begin..pixels.end.min(begin.saturating_add(PIXELS));
                let drawn = film.arguments(compute, &part, size, true, true)?;
                let mut arguments: Vec<(&str, &dyn Argument)> = vec![
                    ("view", &plan.view),
                    ("volume", volume),
                    ("values", values),
                    ("coarse", self.smooth[index].cells.argument()),
                    ("bricks", self.smooth[index].bricks.argument()),
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
        for smooth in &mut self.smooth {
            smooth.cells.settle(compute)?;
            smooth.bricks.settle(compute)?;
        }
        self.depths.settle(compute)
    }
}

/// Returns the size of the image of a texture: channels stand behind each other.
fn texels(texture: &Texture) -> [u32; 3] {
    let [columns, rows, layers] = texture.cells();
    [columns, rows, layers * texture.channels()]
}

impl SmoothOnDevice {
    fn new() -> Self {
        Self {
            host: None,
            cells: UploadedShared::new("the coarse cells of a volume"),
            bricks: UploadedShared::new("the bricks of a volume"),
        }
    }

    fn upload(&mut self, compute: &Compute, volume: &Volume) -> Result<()> {
        let (texture, interpolation) = (&volume.texture, volume.interpolation);
        let kept = self
            .host
            .take()
            .filter(|it| it.is_of(texture, interpolation));
        let host = self
            .host
            .insert(kept.unwrap_or_else(|| Smooth::new(texture, interpolation)));
        self.cells.upload(compute, Some(&host.cells))?;
        self.bricks.upload(compute, Some(&host.bricks))
    }
}
