//! One frame on several devices: all at once, each draws a range of its rows.

use std::ops::{ControlFlow, Range};
use std::sync::{OnceLock, mpsc};
use std::thread;
use std::time::Duration;

use super::device::{Backend, Device};
use super::one::{DeviceRenderer, Rows};
use super::shares::Shares;
use crate::cost::FrameCost;
use crate::error::{Error, Result};
use crate::image::{Bloom, ImageSize, RadianceImage, kept_image};
use crate::opencl::RendererOptions;
use crate::scene::{Ray, Scene};

/// Devices that share the rows of each frame out among them.
#[derive(Debug)]
pub(crate) struct SeveralRenderer {
    renderers: Vec<DeviceRenderer>,
    shares: Shares,
    rows: Vec<Range<u32>>,
    cost: FrameCost,
    image: Option<RadianceImage>,
}

/// What all devices of a frame have in common.
struct SharedFrame<'a> {
    scene: &'a Scene,
    row_count: f32,
    stride: usize,
    /// The first that occurs stops all devices.
    error: OnceLock<Error>,
}

/// A device's part of a frame.
struct Share<'a> {
    renderer: &'a mut DeviceRenderer,
    rows: Range<u32>,
    target: &'a mut [f32],
    time: Option<Duration>,
}

impl SeveralRenderer {
    pub(crate) fn new(devices: &[Device], options: &RendererOptions) -> Result<Self> {
        let open = |device| open(device, options);
        Ok(Self {
            renderers: devices.iter().map(open).collect::<Result<_>>()?,
            shares: Shares::new(devices.iter().map(|d| f64::from(d.compute_units.max(1)))),
            rows: Vec::new(),
            cost: FrameCost::default(),
            image: None,
        })
    }

    /// Returns the device that draws what is not shared out.
    pub(crate) fn first(&mut self) -> &mut DeviceRenderer {
        &mut self.renderers[0]
    }

    /// Renders as [`DeviceRenderer::render_rows`] does. After an error, all devices have ended.
    pub(crate) fn render_rows(
        &mut self,
        scene: &Scene,
        wanted: Rows<'_>,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<()> {
        let stride = wanted.stride;
        let all = wanted.rows.clone();
        let grain = self.renderers[0].grain_rows(scene);
        let split = self.shares.split(all.end - all.start, grain);
        let rows: Vec<Range<u32>> = split
            .into_iter()
            .map(|rows| all.start + rows.start..all.start + rows.end)
            .collect();
        let frame = SharedFrame {
            scene,
            row_count: (all.end - all.start) as f32,
            stride,
            error: OnceLock::new(),
        };
        let mut rest = &mut *wanted.target;
        let mut parts = Vec::new();
        for (renderer, rows) in self.renderers.iter_mut().zip(&rows) {
            let len = rest.len().min(rows.len() * stride);
            let (target, below) = rest.split_at_mut(len);
            rest = below;
            parts.push(Share {
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
        if let Some(bloom) = wanted.bloom {
            self.bloom(scene.image, wanted.target, &bloom)?;
        }
        Ok(())
    }

    /// Spreads the light of a whole image on the first device.
    pub(crate) fn bloom(
        &mut self,
        size: ImageSize,
        light: &mut [f32],
        bloom: &Bloom,
    ) -> Result<()> {
        let first = &mut self.renderers[0];
        first.bloom(size, light, bloom)?;
        self.cost = self.cost.then(first.bloom_cost);
        Ok(())
    }

    /// Renders into memory of its own.
    pub(crate) fn render_kept(&mut self, scene: &Scene, bloom: Option<Bloom>) -> Result<&[f32]> {
        let mut image = self.image.take();
        let target = kept_image(&mut image, scene.image)?.as_mut_slice();
        let row = 4 * scene.image.width as usize;
        let nothing = &mut |_: f32| ControlFlow::Continue(());
        let all = Rows {
            rows: 0..scene.image.height,
            target,
            stride: row,
            bloom,
        };
        self.render_rows(scene, all, nothing)?;
        self.image = image;
        Ok(self.image.as_ref().map_or(&[], RadianceImage::as_slice))
    }

    /// Integrates on the first device.
    pub(crate) fn integrate(
        &mut self,
        scene: &Scene,
        rays: &[Ray],
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Vec<[f32; 4]>> {
        let traced = self.renderers[0].integrate(scene, rays, progress)?;
        self.cost = self.renderers[0].cost();
        Ok(traced)
    }

    /// Returns the rows of the last frame, in the order of the devices.
    pub(crate) fn rows(&self) -> &[Range<u32>] {
        &self.rows
    }

    pub(crate) fn cost(&self) -> FrameCost {
        self.cost
    }
}

fn open(device: &Device, options: &RendererOptions) -> Result<DeviceRenderer> {
    match &device.backend {
        Backend::OpenCl(device) => {
            let mut renderer = DeviceRenderer::new(device, options)?;
            renderer.writes_in_place = true;
            Ok(renderer)
        }
        Backend::Reference => Err(Error::Unsupported(
            "the built-in reference shares no frame with other devices; choose it alone, or OpenCL devices alone"
                .to_owned(),
        )),
    }
}

/// Draws all parts that have rows: the first on this thread, which also tells `progress` about all. Threads are started
/// anew for every frame: that takes 30 us, and kept ones (rayon's) woke so unevenly that frames of 1 ms took 1.15 times
/// as long.
fn draw(
    parts: &mut [Share<'_>],
    frame: &SharedFrame<'_>,
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
                    // Somebody receives this: the channel outlives the thread.
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
            let share = finished.iter().sum::<f32>() / frame.row_count;
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

impl Share<'_> {
    fn draw(&mut self, frame: &SharedFrame<'_>, report: &mut dyn FnMut(f32)) {
        let (rows, stride) = (self.rows.clone(), frame.stride);
        let mut progress = |share: f32| {
            report(share);
            match frame.error.get() {
                Some(_) => ControlFlow::Break(()),
                None => ControlFlow::Continue(()),
            }
        };
        let part = Rows {
            rows,
            target: self.target,
            stride,
            bloom: None, // which needs all rows
        };
        let drawn = self.renderer.render_rows(frame.scene, part, &mut progress);
        match drawn {
            Ok(time) => self.time = time,
            Err(error) => {
                let _ = frame.error.set(error); // the first one counts
            }
        }
    }
}

/// Returns what all parts cost.
fn cost(parts: &[Share<'_>]) -> FrameCost {
    let parts = parts.iter().filter(|part| !part.rows.is_empty());
    parts.fold(FrameCost::default(), |sum, part| {
        sum.beside(part.renderer.cost())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{DepthAlong, DepthImage};
    use crate::opencl::discover;
    use crate::render::{Renderer, RendererBackend, one::tests::ring};

    #[test]
    fn the_error_of_one_device_is_the_frames_and_the_next_frame_is_drawn() {
        let device = Device::select("0").unwrap();
        let mut scene = ring(128);
        let image = Renderer::new(&device).unwrap().render(&scene).unwrap();
        let mut opencl = discover().devices.swap_remove(0);
        opencl.max_allocation_bytes = 40_000; // no depth for every pixel
        let mut small = device.clone();
        small.backend = Backend::OpenCl(opencl);
        let devices = [device, small];
        let mut renderer = Renderer::on_devices(&devices, &RendererOptions::default()).unwrap();
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
