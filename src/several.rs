//! One frame on several devices: all at once, each draws a range of its rows.

use std::ops::{ControlFlow, Range};
use std::sync::{OnceLock, mpsc};
use std::thread;
use std::time::Duration;

use crate::device::{Backend, Device};
use crate::error::{Error, Result};
use crate::image::RadianceImage;
use crate::opencl::{BuildOptions, OpenClRenderer, grain_rows};
use crate::ray::Ray;
use crate::renderer::{FrameCost, kept_image};
use crate::scene::Scene;
use crate::shares::Shares;

/// Devices that share the rows of each frame out among them.
#[derive(Debug)]
pub(crate) struct SeveralRenderer {
    renderers: Vec<OpenClRenderer>,
    shares: Shares,
    rows: Vec<Range<u32>>,
    cost: FrameCost,
    image: Option<RadianceImage>,
}

/// What all devices of a frame have in common.
struct Frame<'a> {
    scene: &'a Scene,
    stride: usize,
    /// The first that occurs stops all.
    error: OnceLock<Error>,
}

/// A device's part of a frame.
struct Part<'a> {
    renderer: &'a mut OpenClRenderer,
    rows: Range<u32>,
    target: &'a mut [f32],
    time: Option<Duration>,
}

impl SeveralRenderer {
    pub(crate) fn new(devices: &[Device], options: &BuildOptions) -> Result<Self> {
        let open = |device| open(device, options);
        Ok(Self {
            renderers: devices.iter().map(open).collect::<Result<_>>()?,
            shares: Shares::new(devices.iter().map(|d| f64::from(d.compute_units.max(1)))),
            rows: Vec::new(),
            cost: FrameCost::default(),
            image: None,
        })
    }

    /// As [`OpenClRenderer::render_rows`], of all rows. After an error, all devices have ended.
    pub(crate) fn render_into(
        &mut self,
        scene: &Scene,
        target: &mut [f32],
        stride: usize,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        let height = scene.image.height;
        let rows = self.shares.split(height, grain_rows(scene));
        let frame = Frame {
            scene,
            stride,
            error: OnceLock::new(),
        };
        let mut rest = target;
        let mut parts = Vec::new();
        for (renderer, rows) in self.renderers.iter_mut().zip(&rows) {
            let len = rest.len().min(rows.len() * stride);
            let (target, below) = rest.split_at_mut(len);
            rest = below;
            parts.push(Part {
                renderer,
                rows: rows.clone(),
                target,
                time: None,
            });
        }
        draw(&mut parts, &frame, progress);
        if let Some(error) = frame.error.into_inner() {
            return Err(error);
        }
        self.cost = cost(&parts);
        let times: Vec<Option<Duration>> = parts.iter().map(|part| part.time).collect();
        self.shares.learn(&rows, &times);
        self.rows = rows;
        Ok(())
    }

    /// Renders into memory of its own.
    pub(crate) fn render_kept(&mut self, scene: &Scene) -> Result<&[f32]> {
        let mut image = self.image.take();
        let target = kept_image(&mut image, scene.image)?.as_mut_slice();
        let row = 4 * scene.image.width as usize;
        let nothing = &mut |_: f32| ControlFlow::Continue(());
        self.render_into(scene, target, row, nothing)?;
        self.image = image;
        Ok(self.image.as_ref().map_or(&[], RadianceImage::as_slice))
    }

    /// On the first device.
    pub(crate) fn trace(&mut self, scene: &Scene, rays: &[Ray]) -> Result<Vec<[f32; 4]>> {
        let traced = self.renderers[0].trace(scene, rays)?;
        self.cost = self.renderers[0].cost();
        Ok(traced)
    }

    /// Of the last frame, in the order of the devices.
    pub(crate) fn rows(&self) -> &[Range<u32>] {
        &self.rows
    }

    pub(crate) fn cost(&self) -> FrameCost {
        self.cost
    }
}

fn open(device: &Device, options: &BuildOptions) -> Result<OpenClRenderer> {
    match &device.backend {
        Backend::OpenCl(device) => {
            let mut renderer = OpenClRenderer::new(device, options)?;
            renderer.writes_in_place = true;
            Ok(renderer)
        }
        Backend::Reference => Err(Error::Unsupported(
            "the built-in reference shares no frame with other devices; choose it alone, or OpenCL devices alone"
                .to_owned(),
        )),
    }
}

/// Draws all parts that have rows: the first on this thread, which also tells `progress` of all. Threads are begun anew
/// for every frame: that takes 30 us, and kept ones (rayon's) woke so unevenly that frames of 1 ms took 1.15 times as long.
fn draw(
    parts: &mut [Part<'_>],
    frame: &Frame<'_>,
    progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
) {
    let mut parts = parts.iter_mut().filter(|part| !part.rows.is_empty());
    let (sender, others) = mpsc::channel();
    let mut finished = Vec::new();
    thread::scope(|scope| {
        let own = parts.next();
        for (number, part) in parts.enumerate() {
            let sender = sender.clone();
            let rows = part.rows.len() as f32;
            let work = move || {
                part.draw(frame, &mut |share| {
                    // Somebody hears: the channel lasts longer than the thread.
                    let _ = sender.send((number + 1, share * rows));
                });
            };
            if let Err(error) = thread::Builder::new().spawn_scoped(scope, work) {
                let message = format!("no thread for another device: {error}");
                let _ = frame.error.set(Error::OutOfMemory(message));
            }
        }
        drop(sender);
        let mut hear = |(number, rows): (usize, f32)| {
            finished.resize(finished.len().max(number + 1), 0.0);
            finished[number] = rows;
            let share = finished.iter().sum::<f32>() / frame.scene.image.height as f32;
            if frame.error.get().is_none() && progress(share.min(1.0)).is_break() {
                let _ = frame.error.set(Error::Interrupted);
            }
        };
        if let Some(part) = own {
            let rows = part.rows.len() as f32;
            part.draw(frame, &mut |share| {
                others.try_iter().for_each(&mut hear);
                hear((0, share * rows));
            });
        }
        others.into_iter().for_each(hear);
    });
}

impl Part<'_> {
    fn draw(&mut self, frame: &Frame<'_>, report: &mut dyn FnMut(f32)) {
        let (rows, stride) = (self.rows.clone(), frame.stride);
        let mut progress = |share: f32| {
            report(share);
            match frame.error.get() {
                Some(_) => ControlFlow::Break(()),
                None => ControlFlow::Continue(()),
            }
        };
        let drawn =
            self.renderer
                .render_rows(frame.scene, rows, self.target, stride, &mut progress);
        match drawn {
            Ok(time) => self.time = time,
            Err(error) => {
                let _ = frame.error.set(error); // the first one counts
            }
        }
    }
}

/// What all parts cost.
fn cost(parts: &[Part<'_>]) -> FrameCost {
    let parts = parts.iter().filter(|part| !part.rows.is_empty());
    parts.fold(FrameCost::default(), |sum, part| {
        let cost = part.renderer.cost();
        FrameCost {
            kernel: sum.kernel.max(cost.kernel),
            evaluations: sum.evaluations + cost.evaluations,
            field_evaluations: sum.field_evaluations + cost.field_evaluations,
            launches: sum.launches + cost.launches,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Table;
    use crate::image::{DepthAlong, DepthImage};
    use crate::opencl::discover;
    use crate::renderer::{Renderer, RendererBackend};

    #[test]
    fn the_error_of_one_device_is_the_frames_and_the_next_frame_is_drawn() {
        let device = Device::select("0").unwrap();
        let mut scene = Table::Torus.scene(128, 64);
        let image = Renderer::new(&device).unwrap().render(&scene).unwrap();
        let mut opencl = discover().devices.swap_remove(0);
        opencl.max_allocation_bytes = 40_000; // no depth for every pixel
        let mut small = device.clone();
        small.backend = Backend::OpenCl(opencl);
        let devices = [device, small];
        let mut renderer = Renderer::on_devices(&devices, &BuildOptions::default()).unwrap();
        assert!(matches!(renderer.backend, RendererBackend::Several(_)));
        let depths = vec![f32::INFINITY; scene.image.pixels()];
        for _ in 0..2 {
            scene.depth =
                Some(DepthImage::new(scene.image, DepthAlong::Ray, depths.clone()).unwrap());
            let error = renderer.render(&scene).unwrap_err();
            assert!(matches!(error, Error::OutOfMemory(_)), "{error}");
            scene.depth = None;
            assert!(renderer.render(&scene).unwrap() == image);
        }
    }
}
