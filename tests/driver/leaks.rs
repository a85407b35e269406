//! Ten thousand frames, and renderers made and dropped, leave as many OpenCL objects and as much memory as there were.

use crate::common;
use std::hint::black_box;
use std::ops::Range;

use crate::common::layer::{Layer, with_layer};
use energywave::image::{DepthAlong, DepthImage};
use energywave::scene::{Method, Sampling};
use energywave::{Renderer, Scene};

/// By how much the memory may grow in 10,000 frames, and with 30 renderers, as the allocator takes it: in steps.
const FRAMES_KIB: i64 = 512;
const RENDERERS_KIB: i64 = 6 << 10;

/// Memory of this process that is in use, KiB.
fn resident() -> i64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmRSS:"));
    let words = line.unwrap().split_whitespace().nth(1);
    words.unwrap().parse().unwrap()
}

/// A frame of a film in which everything changes: by tiles, by pixels and by Simpson's rule, with and without depths.
fn frame(index: u32, depths: &DepthImage) -> Scene {
    let mut scene = common::empty_scene(16, 16);
    scene.integration.method = match index % 3 {
        0 => common::by(Sampling::Tiles),
        1 => common::by(Sampling::Pixels),
        _ => Method::simpson(common::DIVISIONS),
    };
    let shift = 0.5 * f64::from(index).sin();
    scene.camera.eye.x += shift;
    let count = 1 + index % 5;
    for place in (0..count).map(f64::from) {
        scene.spheres.push(common::sphere([shift, place, 0.1], 1.0));
    }
    scene
        .tori
        .push(common::torus([0.0, shift, 0.0], [0.1, 0.2, 1.0], 0.9));
    scene.depth = (index % 4 > 1).then(|| depths.clone());
    scene
}

/// Draws frames of the film, every way in turn; the depth image is another every 50 frames.
fn draw(renderer: &mut Renderer, frames: Range<u32>) {
    let mut target = vec![0.0; 4 * 16 * 16];
    let scene = common::empty_scene(16, 16);
    let depths_from = |index| {
        common::depths(&scene, DepthAlong::Ray, |column, _| {
            f64::from(index % 7 + column)
        })
    };
    let mut depths = depths_from(frames.start);
    for index in frames {
        if index % 50 == 0 {
            depths = depths_from(index);
        }
        let scene = frame(index, &depths);
        match index % 8 {
            0..3 => drop(renderer.render(&scene).unwrap()),
            3..6 => renderer.render_into(&scene, &mut target).unwrap(),
            _ => drop(renderer.render_mapped(&scene).unwrap()),
        }
    }
}

#[test]
fn ten_thousand_frames_leave_no_object_and_no_memory() {
    with_layer(|| {
        let layer = Layer::new();
        let before = layer.live();
        let mut renderer = Renderer::new(&common::device()).unwrap();
        draw(&mut renderer, 0..1000);
        let (live, memory) = (layer.live(), resident());
        for thousand in 1..11 {
            draw(&mut renderer, 1000 * thousand..1000 * (thousand + 1));
            assert_eq!(layer.live(), live, "after {thousand} thousand frames");
        }
        let grown = resident() - memory;
        assert!(grown < FRAMES_KIB, "{grown} KiB more");
        assert_eq!(live.events, 0);
        drop(renderer);
        assert_eq!(layer.live(), before);
    });
}

#[test]
fn thirty_renderers_leave_no_object_and_little_memory() {
    with_layer(|| {
        let layer = Layer::new();
        let device = common::device();
        let before = layer.live();
        let mut memory = Vec::new();
        for _ in 0..40 {
            let mut renderer = Renderer::new(&device).unwrap();
            draw(&mut renderer, 0..2);
            drop(renderer);
            assert_eq!(layer.live(), before);
            memory.push(resident());
        }
        let grown = memory[39] - memory[9];
        assert!(grown < RENDERERS_KIB, "{grown} KiB more: {memory:?}");
    });
}

#[test]
fn what_is_left_behind_is_seen() {
    with_layer(|| {
        let layer = Layer::new();
        let before = layer.live();
        let mut renderer = Renderer::new(&common::device()).unwrap();
        draw(&mut renderer, 0..1);
        std::mem::forget(renderer);
        let live = layer.live();
        assert_eq!(
            (live.contexts, live.queues),
            (before.contexts + 1, before.queues + 1)
        );
        assert!(live.buffers > before.buffers && live.kernels > before.kernels);

        let memory = resident();
        let kept = black_box(vec![1_u8; 64 << 20]); // more than an allocator reuses
        let grown = resident() - memory;
        assert!(grown >= 60 << 10, "{grown} KiB of {} bytes", kept.len());
    });
}
