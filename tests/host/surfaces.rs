//! Frames of a host with surfaces: metaballs and colliders end the light's rays, and their light is added on the
//! device. They are the pictures that are read back, within what float32 loses where light is added in another order.
#![allow(unsafe_code)] // hosts call OpenCL

use crate::common;
use crate::common::host::Host;
use energywave::image::{Bloom, DepthAlong, DepthImage, ImageSize};
use energywave::scene::{
    Antialias, Collider, EmittedWave, Lattice, Mesh, Metaballs, Particles, PointList, Sampling,
    SimulationSettings, TriangleList,
};
use energywave::{
    ErrorKind, HostDepth, HostTarget, RadianceImage, Renderer, RendererOptions, Scene,
};
use glam::DVec3;
use opencl3::event::{Event, create_user_event, set_user_event_status};
use opencl3::memory::{CL_FLOAT, CL_HALF_FLOAT, CL_MEM_READ_WRITE};

/// No multiple of any lane width or tile.
const SIZE: ImageSize = ImageSize {
    width: 67,
    height: 45,
};

/// Of the brightest: light is added in another order.
const ROUNDING: f32 = 1e-6;

/// Of a pixel: half has 11 binary digits.
const HALF_ROUNDING: f32 = 1.0 / 2048.0;

/// A block of metaballs before a point of light, with smooth edges.
fn scene() -> Scene {
    let mut scene = common::empty_scene(SIZE.width, SIZE.height);
    scene.integration.method = common::by(Sampling::Pixels);
    scene.integration.antialias = Antialias::Footprint;
    scene.spheres.push(common::sphere([0.0; 3], 1.0));
    let lattice = Lattice {
        columns: [3, 3],
        jitter: 0.2,
        ..Lattice::new(18, 0.3)
    };
    let mut surface = Metaballs::new(PointList::lattice(&lattice).unwrap(), 0.5);
    surface.translate = 0.25 * scene.camera.eye + DVec3::new(0.2, 0.1, 0.2);
    surface.color = DVec3::new(0.2, 0.4, 0.1);
    scene.metaballs.push(surface);
    scene
}

/// The same with a mesh and a ball that are seen, and particles as light before and behind them.
fn crowded() -> Scene {
    let mut scene = scene();
    let corners = [[0.2, 0.3, -1.2], [1.3, -0.2, -0.4], [0.4, 0.1, 0.8]].map(DVec3::from);
    let triangle = TriangleList::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
    scene.meshes.push(Mesh::new(triangle));
    let mut ball = Collider::sphere(DVec3::new(-0.9, 0.2, -0.5), 0.45);
    ball.color = DVec3::new(0.5, 0.2, 0.3);
    scene.colliders.push(ball);
    let points = PointList::lattice(&Lattice::new(40, 0.7)).unwrap();
    scene.particles.push(Particles::new(points, 0.3));
    scene
}

struct Frames {
    host: Host,
    renderer: Renderer,
}

impl Frames {
    fn with(options: &RendererOptions) -> Self {
        let host = Host::new(0);
        let (context, queue) = (host.context.get(), host.queue.get());
        // SAFETY: the host keeps both.
        let renderer = unsafe { Renderer::on_raw_host(context, queue, options) }.unwrap();
        Self { host, renderer }
    }

    fn new() -> Self {
        Self::with(&RendererOptions::default())
    }

    fn draw(&mut self, scene: &Scene, target: HostTarget) -> Vec<f32> {
        // SAFETY: tests keep their targets until they have been read.
        let event = unsafe { self.renderer.enqueue(scene, target, &[]) }.unwrap();
        self.host.read(target, scene.image, &[&event])
    }

    /// Draws into a buffer.
    fn drawn(&mut self, scene: &Scene) -> Vec<f32> {
        let buffer = self.host.buffer(CL_MEM_READ_WRITE, scene.image);
        self.draw(scene, (&buffer).into())
    }
}

/// The largest difference, as a share of the brightest and of `of_pixel` of the pixel.
fn off(found: &[f32], expected: &RadianceImage, of_pixel: f32) -> f32 {
    let expected = expected.as_slice();
    assert_eq!(found.len(), expected.len());
    let brightest = expected.iter().copied().fold(0.0, f32::max);
    let pairs = found.iter().zip(expected);
    pairs
        .map(|(a, b)| ((a - b).abs() - of_pixel * b.abs()) / brightest)
        .fold(0.0, |worst, d| if d <= worst { worst } else { d })
}

#[test]
fn buffers_and_images_of_a_host_get_the_picture_with_surfaces() {
    let mut frames = Frames::new();
    let mut sharp = crowded();
    sharp.integration.antialias = Antialias::None;
    let mut alone = scene();
    alone.spheres.clear();
    let mut open = crowded();
    open.metaballs.clear();
    open.colliders.clear();
    let open = frames.drawn(&open);
    for (name, scene) in [("crowded", crowded()), ("sharp", sharp), ("alone", alone)] {
        let expected = frames.renderer.render(&scene).unwrap();
        let buffer = frames.host.buffer(CL_MEM_READ_WRITE, SIZE);
        let floats = frames.host.image(SIZE, CL_FLOAT);
        let halves = frames.host.image(SIZE, CL_HALF_FLOAT);
        for (target, of_pixel) in [
            (HostTarget::from(&buffer), 0.0),
            (HostTarget::from(&floats), 0.0),
            (HostTarget::from(&halves), HALF_ROUNDING),
        ] {
            // The second frame finds everything built, and other light in its place.
            for _ in 0..2 {
                let found = frames.draw(&scene, target);
                let off = off(&found, &expected, of_pixel);
                assert!(off <= ROUNDING, "{name}, {target:?}: {off:e}");
            }
        }
        let off = off(&open, &expected, HALF_ROUNDING);
        assert!(off > 1e-2, "{name}, without surfaces: {off:e}");
    }
}

#[test]
fn what_surfaces_and_light_are_together_has_its_bloom() {
    let mut frames = Frames::new();
    let mut scene = crowded();
    scene.display.bloom = Some(Bloom::new(0.5));
    let without = frames.drawn(&scene);
    frames.renderer.spread_bloom(true);
    let expected = frames.renderer.render(&scene).unwrap();
    let halves = frames.host.image(SIZE, CL_HALF_FLOAT);
    let found = frames.drawn(&scene);
    assert!(off(&found, &expected, 0.0) <= ROUNDING);
    let found = frames.draw(&scene, (&halves).into());
    assert!(off(&found, &expected, HALF_ROUNDING) <= ROUNDING);
    assert!(off(&without, &expected, HALF_ROUNDING) > 1e-2);
}

#[test]
fn waves_of_particles_reach_a_host_as_they_are_read_back() {
    let mut frames = Frames::new();
    let mut scene = common::empty_scene(SIZE.width, SIZE.height);
    scene.camera.eye = DVec3::new(-120.0, -95.0, 50.0);
    scene.camera.target = -12.0 * DVec3::X;
    (scene.camera.ray_length, scene.decay) = (None, None);
    let from = DVec3::new(-50.0, 0.0, 0.0);
    scene.waves.push(EmittedWave::new(from, DVec3::X));
    let half = DVec3::new(8.0, 22.0, 22.0);
    scene
        .colliders
        .push(Collider::new_box(8.0 * DVec3::X, half));
    let mut pictures: Vec<Vec<f32>> = Vec::new();
    for (visible, time) in [(true, 60.0), (false, 60.0), (true, 45.5)] {
        scene.colliders[0].visible = visible;
        let mut settings = SimulationSettings::default();
        settings.time = Some(time);
        scene.simulation = Some(settings);
        let expected = frames.renderer.render(&scene).unwrap();
        let found = frames.drawn(&scene);
        let worst = off(&found, &expected, 0.0);
        assert!(worst <= ROUNDING, "{visible}, {time}: {worst:e}");
        for before in &pictures {
            let other = off(before, &expected, 0.0);
            assert!(other > 1e-3, "{visible}, {time}: {other:e}");
        }
        pictures.push(found);
    }
}

#[test]
fn a_hosts_depths_hide_surfaces_and_are_hidden_by_them() {
    let mut frames = Frames::new();
    let scene = crowded();
    let length = |pixel: usize| match pixel % SIZE.width as usize {
        column if column < 20 => f32::INFINITY,
        column => 2.4 + 0.04 * column as f32,
    };
    let lengths: Vec<f32> = (0..SIZE.pixels()).map(length).collect();
    let mut given = scene.clone();
    let depth = DepthImage::new(SIZE, DepthAlong::Ray, lengths.clone());
    given.depth = Some(depth.unwrap());
    let expected = frames.renderer.render(&given).unwrap();
    let buffer = frames.host.floats(&lengths);
    let target = frames.host.buffer(CL_MEM_READ_WRITE, SIZE);
    let depth = HostDepth::new(&buffer, DepthAlong::Ray);
    let (target, renderer) = ((&target).into(), &mut frames.renderer);
    // SAFETY: target and depths live until the read is over.
    let event = unsafe { renderer.enqueue_behind(&scene, target, &depth, &[]) }.unwrap();
    let found = frames.host.read(target, SIZE, &[&event]);
    let worst = off(&found, &expected, 0.0);
    assert!(worst <= ROUNDING, "{worst:e}");
    assert!(off(&frames.drawn(&scene), &expected, 0.0) > 1e-2);
    // Nothing is enqueued where it has a depth of its own, or the target does not fit.
    let smaller = frames
        .host
        .buffer(CL_MEM_READ_WRITE, ImageSize { width: 9, ..SIZE });
    for (scene, target, words) in [
        (&given, target, "the scene has a depth of its own"),
        (&scene, (&smaller).into(), "pixels need"),
    ] {
        // SAFETY: as before.
        let refused = unsafe { frames.renderer.enqueue_behind(scene, target, &depth, &[]) };
        let error = refused.unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Host);
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn surfaces_are_found_while_a_frame_waits_for_its_host() {
    let mut frames = Frames::new();
    let first = scene();
    let mut second = scene();
    second.metaballs[0].translate += DVec3::new(0.3, 0.0, -0.2);
    let expected = [&first, &second].map(|scene| frames.renderer.render(scene).unwrap());
    frames.drawn(&first); // what is built now is waited for
    let targets = [(); 2].map(|()| frames.host.buffer(CL_MEM_READ_WRITE, SIZE));
    let gate = Event::new(create_user_event(frames.host.context.get()).unwrap());
    let (host, renderer) = (&frames.host, &mut frames.renderer);
    let mut draw = |scene: &Scene, target: usize, before: &Event| {
        let target = (&targets[target]).into();
        // SAFETY: targets and events live until the reads are over.
        unsafe { renderer.enqueue(scene, target, &[before.get()]) }.unwrap()
    };
    let one = draw(&first, 0, &gate);
    let two = draw(&second, 1, &one);
    for event in [&one, &two] {
        assert!(
            event.command_execution_status().unwrap().0 >= 1,
            "did not wait"
        );
    }
    set_user_event_status(gate.get(), 0).unwrap();
    for ((event, target), expected) in [&one, &two].into_iter().zip(&targets).zip(&expected) {
        let found = host.read(target.into(), SIZE, &[event]);
        let worst = off(&found, expected, 0.0);
        assert!(worst <= ROUNDING, "{worst:e}");
    }
    assert!(off(expected[0].as_slice(), &expected[1], 0.0) > 1e-2);
}

#[test]
fn a_sum_without_its_shares_is_refused_and_draws_another_picture() {
    let mut options = common::compiled_with(&RendererOptions::default(), "-D ALL_SHARES");
    let scene = scene();
    let mut frames = Frames::with(&options);
    let target = frames.host.buffer(CL_MEM_READ_WRITE, SIZE);
    // SAFETY: the target lives on.
    let drawn = unsafe { frames.renderer.enqueue(&scene, (&target).into(), &[]) };
    let error = drawn.unwrap_err();
    assert_eq!(error.kind(), ErrorKind::SelfTest, "{error}");
    options.skips_self_test = true;
    let mut frames = Frames::with(&options);
    let expected = frames.renderer.render(&scene).unwrap();
    let off = off(&frames.drawn(&scene), &expected, 0.0);
    assert!(off > 1e-2, "{off:e}");
}
