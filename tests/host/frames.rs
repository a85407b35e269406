//! Frames behind depths, as a host's and as the scene's own.
#![allow(unsafe_code)] // hosts call OpenCL

use crate::common;
use crate::common::host::{Host, device};
pub use crate::host::difference;
use energywave::image::{DepthAlong, DepthImage, ImageSize};
use energywave::scene::Sampling;
use energywave::{HostDepth, RadianceImage, Renderer, RendererOptions, Scene};
use opencl3::memory::{Buffer, CL_MEM_READ_WRITE};

/// No multiple of any lane width or tile.
pub const SIZE: ImageSize = ImageSize {
    width: 99,
    height: 70,
};

/// What float32 makes of quotients, and light of that; of float64 there is no difference at all.
pub const OFF: f32 = 1e-5;

/// A point of light, by a way to take pixels.
pub fn scene(sampling: Sampling) -> Scene {
    let mut scene = common::empty_scene(SIZE.width, SIZE.height);
    scene.integration.method = common::by(sampling);
    scene.spheres.push(common::sphere([0.0; 3], 1.0));
    scene
}

/// A slope through the light, a hole, and a wall before everything.
pub fn lengths() -> Vec<f32> {
    let value = |pixel: usize| {
        let (column, row) = (pixel % 99, pixel / 99);
        match (column, row) {
            (60.., 40..) => f32::INFINITY,
            (..9, ..9) => 0.0,
            _ => 3.2 + 0.015 * column as f32 + 0.004 * row as f32,
        }
    };
    (0..SIZE.pixels()).map(value).collect()
}

/// A host, a renderer on it, and a target.
pub struct Frames {
    pub host: Host,
    pub renderer: Renderer,
    pub target: Buffer<f32>,
}

impl Frames {
    pub fn with(options: &RendererOptions) -> Self {
        let host = Host::new(0);
        let (context, queue) = (host.context.get(), host.queue.get());
        // SAFETY: the host keeps both.
        let renderer = unsafe { Renderer::on_raw_host(context, queue, options) }.unwrap();
        Self {
            target: host.buffer(CL_MEM_READ_WRITE, SIZE),
            renderer,
            host,
        }
    }

    pub fn new() -> Self {
        Self::with(&RendererOptions::default())
    }

    /// Draws behind depths of the host's.
    pub fn behind(&mut self, scene: &Scene, depth: &HostDepth) -> Vec<f32> {
        let target = (&self.target).into();
        // SAFETY: the target and the tests' depths live until the read is over.
        let event = unsafe { self.renderer.enqueue_behind(scene, target, depth, &[]) }.unwrap();
        self.host.read(target, SIZE, &[&event])
    }

    /// Draws behind depths of the scene's.
    pub fn expected(&mut self, scene: &Scene, depth: DepthImage) -> RadianceImage {
        let mut scene = scene.clone();
        scene.depth = Some(depth);
        self.renderer.render(&scene).unwrap()
    }
}

pub fn image_of(values: &[f32], along: DepthAlong) -> DepthImage {
    DepthImage::new(SIZE, along, values.to_vec()).unwrap()
}

/// What differs where the device computes as the host does.
pub fn limit() -> f32 {
    match device().extensions().unwrap().contains("cl_khr_fp64") {
        true => 0.0,
        false => OFF,
    }
}

/// Good values, with bad ones here and there.
pub fn spoiled(good: &[f32], bad: &[f32]) -> Vec<f32> {
    let mut values = good.to_vec();
    let places = values.iter_mut().skip(17).step_by(31);
    places
        .zip(bad.iter().cycle())
        .for_each(|(value, bad)| *value = *bad);
    values
}
