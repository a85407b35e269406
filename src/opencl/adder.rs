//! Adds the light of pictures to a film, on the device (`cl/add.cl`): a frame for a host is put together by it, of
//! surfaces and of what is seen before each depth of a pixel. Nothing here waits but for the compiler.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use opencl3::event::Event;

use super::copies::state;
use super::handle::Handle;
use super::kernel::{Argument, Kernel};
use super::layout::DeviceStruct;
use super::source::{SHARED, Sources};
use super::{
    Compute, Film, FilmFormat, FilmPart, Program, RendererOptions, Uploaded, UploadedShared,
};
use crate::error::{Error, Result};

/// A picture whose light is added, 4 values a pixel.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Added<'a> {
    /// The host's, which is uploaded.
    Host(&'a Arc<Vec<f32>>),
    /// What the own memory of a film has.
    Film(&'a Film),
}

/// The kernels and what is uploaded for them, which are kept from frame to frame.
#[derive(Debug)]
pub(crate) struct Adder {
    options: RendererOptions,
    kernels: HashMap<FilmFormat, Kernel>,
    light: UploadedShared<f32>,
    shares: Uploaded<f32>,
    /// Launches that nobody waited for.
    held: Vec<Handle<Event>>,
}

impl Adder {
    /// Makes one without kernels: they are built when they are first needed.
    pub(crate) fn new(options: &RendererOptions) -> Self {
        Self {
            options: options.clone(),
            kernels: HashMap::new(),
            light: UploadedShared::new("the light of surfaces"),
            shares: Uploaded::new("the shares of depths"),
            held: Vec::new(),
        }
    }

    /// Makes sure that the kernel for a film's format is built, and computes right.
    ///
    /// # Errors
    /// As [`Program::build`], and [`Error::SelfTest`].
    pub(crate) fn prepare(&mut self, compute: &Compute, format: FilmFormat) -> Result<()> {
        let Entry::Vacant(entry) = self.kernels.entry(format) else {
            return Ok(());
        };
        let sources = Sources {
            files: SHARED.to_vec(),
            kinds: Vec::new(),
        };
        let layout = FilmPart::LAYOUT;
        let size = format!(" -D SIZEOF_{}={}", layout.name.to_uppercase(), layout.size);
        let definitions = size + format.definitions();
        let program = Program::build(
            compute,
            sources.resolve("add.cl"),
            &definitions,
            &self.options,
        )?;
        entry.insert(program.kernel("add_light")?);
        let is_experiment = self.options.skips_self_test || compute.device().is_simulator;
        if is_experiment || program.was_tested() {
            return Ok(());
        }
        // On a queue of its own: the renderer's waits for the host.
        let outcome = compute
            .sibling()
            .and_then(|compute| self.self_test(&compute, format));
        match &outcome {
            Ok(()) => program.mark_tested(),
            Err(_) => drop(self.kernels.remove(&format)),
        }
        outcome
    }

    /// Adds light to all pixels of a film of this size, by the kernel that was prepared: as much of each as `shares`
    /// has, or all of it. The first replaces what was there.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Device`].
    pub(crate) fn add(
        &mut self,
        compute: &Compute,
        (film, size): (&mut Film, (u32, u32)),
        added: Added<'_>,
        shares: Option<&[f32]>,
        is_first: bool,
    ) -> Result<()> {
        self.held.retain(|event| matches!(state(event), Ok(false)));
        if let Added::Host(light) = added {
            self.light.upload(compute, Some(light))?;
        }
        if let Some(shares) = shares {
            self.shares.upload(compute, shares)?;
        }
        let has_shares = u32::from(shares.is_some());
        let light: &dyn Argument = match added {
            Added::Host(_) => self.light.argument(),
            Added::Film(film) => film.pixels()?,
        };
        let kernel = self.kernels.get(&film.format()).ok_or_else(unbuilt)?;
        let pixels = size.0 * size.1;
        let on_film = film.arguments(compute, &(0..pixels), size, is_first, true)?;
        let mut arguments: Vec<(&str, &dyn Argument)> = vec![
            ("light", light),
            ("shares", &self.shares),
            ("has_shares", &has_shares),
        ];
        arguments.extend(on_film.named());
        let group = kernel.group(compute, 64)?;
        let event = kernel.launch(compute, &arguments, pixels as usize, group)?;
        self.held.push(event);
        Ok(())
    }

    /// # Errors
    /// [`Error::SelfTest`] if the kernel computes wrong.
    fn self_test(&mut self, compute: &Compute, format: FilmFormat) -> Result<()> {
        // No multiple of a group.
        let (width, height) = (31, 5);
        let light = |index: usize| 0.25 + index as f32 / 64.0;
        let share = |index: usize| (index % 3) as f32 / 2.0;
        let pixels = (width * height) as usize;
        let given = Arc::new((0..4 * pixels).map(light).collect::<Vec<f32>>());
        let shares: Vec<f32> = (0..pixels).map(share).collect();
        let mut film = Film::in_format(compute, format, width, height)?;
        film.reserve_band(compute, pixels, 1)?;
        film.leave_unfinished(true);
        let size = (width, height);
        self.add(compute, (&mut film, size), Added::Host(&given), None, true)?;
        film.leave_unfinished(false);
        let second = Added::Host(&given);
        self.add(compute, (&mut film, size), second, Some(&shares), false)?;
        let mut found = vec![[0.0; 4]; pixels];
        film.read(compute, &mut found)?;
        // Which halves hold to 11 digits.
        let is_right = |index: usize| {
            let mut channels = found[index][..3].iter().zip(4 * index..);
            channels.all(|(found, at)| {
                let expected = light(at) * (1.0 + share(index));
                (found - expected).abs() <= 1e-3 * expected
            })
        };
        match (0..pixels).find(|index| !is_right(*index)) {
            None => Ok(()),
            Some(index) => {
                let device = compute.device();
                Err(Error::SelfTest {
                    device: device.name.clone(),
                    driver: format!("{} {}", device.platform, device.driver),
                    reason: format!("pixel {index} of the test's sum is {:?}", found[index]),
                })
            }
        }
    }
}

fn unbuilt() -> Error {
    Error::Unsupported("a kernel that was never built was launched".to_owned())
}
