//! Bloom on an OpenCL device, over what engines have drawn into a film: the same pyramid as [`Bloom`]'s on the host.

mod kernels;
mod self_test;
mod sources;
mod steps;

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use opencl3::event::Event;

use crate::cost::FrameCost;
use crate::error::Result;
use crate::image::{Bloom, ImageSize};
use crate::opencl::{
    Argument, Compute, DeviceBuffer, Film, FilmFormat, Handle, Pixel, RendererOptions, Uploaded,
    run_time, state,
};
use kernels::Kernels;
pub(crate) use kernels::build_text;
pub use steps::BloomStep;
use steps::Steps;

/// What spreads light on a device: kernels and memory, which are kept from frame to frame.
#[derive(Debug)]
pub struct Spreader {
    options: RendererOptions,
    kernels: HashMap<FilmFormat, Kernels>,
    levels: Option<DeviceBuffer<Pixel>>,
    /// For which picture and bloom they are, and in which form.
    known: Option<(ImageSize, Bloom)>,
    steps: Steps,
    step_list: Uploaded<BloomStep>,
    weights: Uploaded<f32>,
    /// Launches that nobody has waited for.
    under_way: Vec<Handle<Event>>,
}

impl Spreader {
    /// Makes one without kernels: they are built when they are first needed.
    pub fn new(options: &RendererOptions) -> Self {
        Self {
            options: options.clone(),
            kernels: HashMap::new(),
            levels: None,
            known: None,
            steps: Steps::default(),
            step_list: Uploaded::new("the steps of the bloom"),
            weights: Uploaded::new("the weights of the bloom"),
            under_way: Vec::new(),
        }
    }

    /// Returns how many bytes of the host's memory a bloom of so many pixels takes that are not there yet.
    pub(crate) fn missing_bytes(&self, compute: &Compute, pixels: usize) -> u64 {
        let there = self.levels.as_ref().map_or(0, DeviceBuffer::len);
        // All levels together are a third of the picture, and what rows and columns of odd numbers are rounded up by.
        let missing = (pixels / 2).saturating_sub(there) * size_of::<Pixel>();
        match compute.device().shares_host_memory {
            true => missing as u64,
            false => 0,
        }
    }

    /// Spreads the light of all pixels of a film, whose first is the picture's, after what was enqueued before; the
    /// film's pixels are finished then. Nothing here waits but for the compiler.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`](crate::Error::OutOfMemory), [`Error::Build`](crate::Error::Build),
    /// [`Error::SelfTest`](crate::Error::SelfTest), [`Error::Device`](crate::Error::Device).
    pub fn spread(
        &mut self,
        compute: &Compute,
        film: &mut Film,
        size: ImageSize,
        bloom: &Bloom,
    ) -> Result<()> {
        let is_going_on = |event: &Handle<Event>| matches!(state(event), Ok(false));
        self.under_way.retain(is_going_on);
        let format = film.format();
        self.prepare(compute, format, size, bloom)?;
        let drawn = film.drawn(compute, (size.width, size.height))?;
        let on_film = drawn.named();
        let strength = bloom.strength as f32;
        let count = self.steps.list.len() as u32;
        let mut common: Vec<(&str, &dyn Argument)> = vec![
            ("steps", &self.step_list),
            ("weights", &self.weights),
            ("levels", &self.levels),
            ("strength", &strength),
            ("end", &count),
        ];
        common.extend(on_film);
        let Some(kernels) = self.kernels.get(&format) else {
            return Ok(());
        };
        for launch in self.steps.launches() {
            let kernel = kernels.of(launch.stage);
            let mut arguments = common.clone();
            arguments.push(("first", &launch.step));
            arguments.retain(|(name, _)| kernel.parameters().iter().any(|it| it == name));
            let group = kernel.group(compute, launch.group(compute.device().form))?;
            let items = launch.items.unwrap_or(group);
            let event = kernel.launch(compute, &arguments, items, group)?;
            self.under_way.push(event);
        }
        Ok(())
    }

    /// Waits for what is under way, and returns what it cost.
    ///
    /// # Errors
    /// [`Error::Device`](crate::Error::Device) if a launch or a copy failed.
    pub fn settle(&mut self, compute: &Compute) -> Result<FrameCost> {
        let mut cost = FrameCost::default();
        for event in self.under_way.drain(..) {
            cost.kernel += run_time(compute, &event)?;
            cost.launches += 1;
        }
        self.step_list.settle(compute)?;
        self.weights.settle(compute)?;
        Ok(cost)
    }

    /// Builds kernels, makes room for the levels, and uploads what is known of them.
    fn prepare(
        &mut self,
        compute: &Compute,
        format: FilmFormat,
        size: ImageSize,
        bloom: &Bloom,
    ) -> Result<()> {
        if let Entry::Vacant(entry) = self.kernels.entry(format) {
            let (kernels, program) = Kernels::build(compute, format, &self.options)?;
            let built = (kernels, &program);
            entry.insert(self_test::self_test(compute, format, &self.options, built)?);
        }
        let is_known = self.known == Some((size, *bloom));
        if !is_known {
            self.known = None;
            self.steps = Steps::new(size, bloom, compute.device().form);
            self.known = Some((size, *bloom));
        }
        let pixels = self.steps.pixels;
        if self.levels.as_ref().is_none_or(|it| it.len() < pixels) {
            self.levels = None;
            let what = "the levels of the bloom";
            self.levels = Some(DeviceBuffer::new(compute, what, pixels)?);
        }
        let (list, weights) = (&self.steps.list, &self.steps.weights);
        self.step_list.upload_unless(is_known, compute, list)?;
        self.weights.upload_unless(is_known, compute, weights)
    }
}
