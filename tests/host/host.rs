//! Frames in a host's own OpenCL: its context and queue, its buffer or image, its events.
#![allow(unsafe_code)] // hosts call OpenCL

use crate::common;
use crate::common::host::Host;
use energywave::HostTarget;
use energywave::image::Bloom;
use energywave::scene::{Method, Sampling};
use energywave::{RadianceImage, Renderer, Scene};
use opencl3::command_queue::{CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE, CL_QUEUE_PROFILING_ENABLE};
use opencl3::event::{Event, create_user_event, set_user_event_status};
use opencl3::memory::{
    Buffer, CL_FLOAT, CL_HALF_FLOAT, CL_MEM_HOST_NO_ACCESS, CL_MEM_READ_WRITE, CL_RGBA, ClMem,
};
use opencl3::types::cl_event;

const RUNNING: i32 = 1;

/// Every kind of source, in a size that fits no vector and no tile, by each way to take pixels.
fn scenes() -> Vec<(&'static str, Scene)> {
    let full = common::full_scene(99, 70);
    let with = |method| {
        let mut scene = full.clone();
        scene.integration.method = method;
        scene
    };
    vec![
        ("simpson", with(Method::simpson(common::DIVISIONS))),
        ("pixels", with(common::by(Sampling::Pixels))),
        ("tiles", with(common::by(Sampling::Tiles))),
    ]
}

/// Draws into a target of the host's.
fn enqueue(
    renderer: &mut Renderer,
    scene: &Scene,
    target: HostTarget,
    wait_list: &[cl_event],
) -> energywave::Result<Event> {
    // SAFETY: the tests keep targets and events until they have waited.
    unsafe { renderer.enqueue(scene, target, wait_list) }
}

/// The largest difference of any value, relative to the image's.
pub fn difference(found: &[f32], expected: &RadianceImage) -> f32 {
    let pairs = found.iter().zip(expected.as_slice());
    assert_eq!(found.len(), expected.as_slice().len());
    pairs
        .map(|(a, b)| (a - b).abs() / b.abs().max(1e-3))
        .fold(0.0, |worst, d| if d <= worst { worst } else { d })
}

#[test]
fn buffers_and_float_images_of_a_host_get_the_image_that_is_read_back() {
    let host = Host::new(0);
    let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
    for (name, scene) in scenes() {
        let size = scene.image;
        let expected = Renderer::new(&common::device())
            .unwrap()
            .render(&scene)
            .unwrap();
        let buffer = host.buffer(CL_MEM_READ_WRITE, size);
        let image = host.image(size, CL_FLOAT);
        for target in [HostTarget::from(&buffer), HostTarget::from(&image)] {
            // The third frame has learnt its pace from the first two.
            for _ in 0..3 {
                let event = enqueue(&mut renderer, &scene, target, &[]).unwrap();
                assert_eq!(event.command_queue().unwrap(), host.queue.get());
                let found = host.read(target, size, &[&event]);
                assert_eq!(difference(&found, &expected), 0.0, "{name} {target:?}");
            }
        }
        assert_eq!(
            renderer.render(&scene).unwrap(),
            expected,
            "{name}, read back"
        );
    }
}

/// Half has 11 binary digits.
const HALF_ROUNDING: f32 = 1.0 / 2048.0;

/// Kernels that write images are compiled without the shuffles of those that fill buffers: float32 rounds differently.
const OTHER_KERNEL: f32 = 2e-4;

#[test]
fn images_of_halves_and_those_that_cannot_be_mapped_get_the_same_image() {
    let host = Host::new(0);
    let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
    for (name, scene) in scenes() {
        let size = scene.image;
        let expected = renderer.render(&scene).unwrap();
        for (flags, channel_type, limit) in [
            (0, CL_HALF_FLOAT, HALF_ROUNDING + OTHER_KERNEL),
            (
                CL_MEM_HOST_NO_ACCESS,
                CL_HALF_FLOAT,
                HALF_ROUNDING + OTHER_KERNEL,
            ),
            (CL_MEM_HOST_NO_ACCESS, CL_FLOAT, OTHER_KERNEL),
        ] {
            let image = host.image_of(CL_MEM_READ_WRITE | flags, size, CL_RGBA, channel_type);
            let event = enqueue(&mut renderer, &scene, (&image).into(), &[]).unwrap();
            let copy = host.copy(&image, size, &event);
            let worst = difference(&host.read((&copy).into(), size, &[]), &expected);
            assert!(worst <= limit, "{name}, {flags}: {worst}");
            assert!(
                channel_type == CL_FLOAT || worst > 1e-5,
                "these are no halves"
            );
        }
    }
}

/// A scene whose kernels are built soon.
fn one_sphere() -> Scene {
    let mut scene = common::empty_scene(99, 70);
    scene.integration.method = common::by(Sampling::Pixels);
    scene.spheres.push(common::sphere([0.0; 3], 1.0));
    scene
}

#[test]
fn a_hosts_buffers_and_images_get_the_bloom_that_is_read_back() {
    let host = Host::new(0);
    let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
    let mut scene = one_sphere();
    scene.display.bloom = Some(Bloom::new(0.5));
    let size = scene.image;
    let without = renderer.render(&scene).unwrap();
    renderer.spread_bloom(true);
    let expected = renderer.render(&scene).unwrap();
    assert!(difference(without.as_slice(), &expected) > 0.05);
    let buffer = host.buffer(CL_MEM_READ_WRITE, size);
    let unmapped = CL_MEM_READ_WRITE | CL_MEM_HOST_NO_ACCESS;
    let images = [
        host.image(size, CL_FLOAT),
        host.image(size, CL_HALF_FLOAT),
        host.image_of(unmapped, size, CL_RGBA, CL_FLOAT),
        host.image_of(unmapped, size, CL_RGBA, CL_HALF_FLOAT),
    ];
    let kernels = HALF_ROUNDING + OTHER_KERNEL;
    let limits = [0.0, kernels, OTHER_KERNEL, kernels];
    // The second frame finds everything built.
    for _ in 0..2 {
        let event = enqueue(&mut renderer, &scene, (&buffer).into(), &[]).unwrap();
        let found = host.read((&buffer).into(), size, &[&event]);
        assert_eq!(difference(&found, &expected), 0.0);
        for (image, limit) in images.iter().zip(limits) {
            let event = enqueue(&mut renderer, &scene, image.into(), &[]).unwrap();
            let copy = host.copy(image, size, &event);
            let worst = difference(&host.read((&copy).into(), size, &[]), &expected);
            assert!(worst <= limit, "{limit:e}: {worst:e}");
        }
    }
    // What is not told to spread it does not.
    renderer.spread_bloom(false);
    let event = enqueue(&mut renderer, &scene, (&buffer).into(), &[]).unwrap();
    let found = host.read((&buffer).into(), size, &[&event]);
    assert_eq!(difference(&found, &without), 0.0);
}

#[test]
fn where_no_kernel_can_write_images_a_buffer_is_copied_to_them() {
    let host = Host::new(0);
    // As PoCL 7 does: kernels that write images are not built.
    // SAFETY: such kernels are never run.
    let options = unsafe {
        energywave::internals::with_compiler_options(
            &energywave::RendererOptions::default(),
            "-D write_imagef=there_is_none",
        )
    };
    let (context, queue) = (host.context.get(), host.queue.get());
    // SAFETY: the host keeps both.
    let mut renderer = unsafe { Renderer::on_raw_host(context, queue, &options) }.unwrap();
    let mut scene = one_sphere();
    scene.display.bloom = Some(Bloom::new(0.5));
    renderer.spread_bloom(true);
    let expected = renderer.render(&scene).unwrap();
    let mut smaller = scene.clone();
    smaller.image.height -= 9;
    let smaller_expected = renderer.render(&smaller).unwrap();
    let halves = HALF_ROUNDING + OTHER_KERNEL;
    for (scene, expected, channel_type, limit) in [
        (&scene, &expected, CL_FLOAT, 0.0),
        (&scene, &expected, CL_HALF_FLOAT, halves),
        (&smaller, &smaller_expected, CL_FLOAT, 0.0),
    ] {
        let size = scene.image;
        let flags = CL_MEM_READ_WRITE | CL_MEM_HOST_NO_ACCESS;
        let image = host.image_of(flags, size, CL_RGBA, channel_type);
        let event = enqueue(&mut renderer, scene, (&image).into(), &[]).unwrap();
        let copy = host.copy(&image, size, &event);
        let worst = difference(&host.read((&copy).into(), size, &[]), expected);
        assert!(worst <= limit, "{channel_type:#x}, {size:?}: {worst}");
    }
    // Without the fall-back it is an error: other faults of a build are told.
    // SAFETY: no kernel is built.
    let broken = unsafe {
        energywave::internals::with_compiler_options(
            &energywave::RendererOptions::default(),
            "-D LANES=3",
        )
    };
    // SAFETY: the host keeps both.
    let mut renderer = unsafe { Renderer::on_raw_host(context, queue, &broken) }.unwrap();
    let image = host.image_of(
        CL_MEM_READ_WRITE | CL_MEM_HOST_NO_ACCESS,
        scene.image,
        CL_RGBA,
        CL_FLOAT,
    );
    let error = enqueue(&mut renderer, &scene, (&image).into(), &[]).unwrap_err();
    assert_eq!(error.kind(), energywave::ErrorKind::Build);
}

#[test]
fn frames_wait_for_the_hosts_events_and_the_call_does_not() {
    for properties in [
        0,
        CL_QUEUE_PROFILING_ENABLE,
        CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE,
    ] {
        let host = Host::new(properties);
        let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
        let (_, first) = scenes().swap_remove(2);
        let mut second = first.clone();
        second.tori[0].major_radius *= 1.3;
        second.depth = Some(common::depths(
            &second,
            energywave::image::DepthAlong::Ray,
            |x, _| {
                if x < 50 { 3.0 } else { f64::INFINITY }
            },
        ));
        let targets = [(); 2].map(|()| host.buffer(CL_MEM_READ_WRITE, first.image));
        // Kernels are built now: a compiler is waited for.
        for scene in [&first, &second] {
            enqueue(&mut renderer, scene, (&targets[1]).into(), &[])
                .unwrap()
                .wait()
                .unwrap();
        }
        let gate = Event::new(create_user_event(host.context.get()).unwrap());
        let one = enqueue(&mut renderer, &first, (&targets[0]).into(), &[gate.get()]).unwrap();
        // The second has other sources and depths, while the first is still to come.
        let two = enqueue(&mut renderer, &second, (&targets[1]).into(), &[one.get()]).unwrap();
        std::thread::sleep(std::time::Duration::from_millis(50));
        for event in [&one, &two] {
            assert!(
                event.command_execution_status().unwrap().0 >= RUNNING,
                "did not wait"
            );
        }
        set_user_event_status(gate.get(), 0).unwrap();
        for (event, scene, target) in [(&one, &first, &targets[0]), (&two, &second, &targets[1])] {
            let found = host.read(target.into(), scene.image, &[event]);
            let expected = Renderer::new(&common::device())
                .unwrap()
                .render(scene)
                .unwrap();
            assert_eq!(difference(&found, &expected), 0.0, "queue {properties}");
        }
    }
}

#[test]
fn a_host_gets_every_reference_back() {
    let host = Host::new(0);
    let scene = common::full_scene(16, 16);
    let (buffer, image): (Buffer<f32>, _) = (
        host.buffer(CL_MEM_READ_WRITE, scene.image),
        host.image(scene.image, CL_FLOAT),
    );
    let counts = || {
        vec![
            host.context.reference_count().unwrap(),
            host.queue.reference_count().unwrap(),
            buffer.reference_count().unwrap(),
            image.reference_count().unwrap(),
        ]
    };
    let draw = || {
        let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
        for target in [HostTarget::from(&buffer), HostTarget::from(&image)] {
            let event = enqueue(&mut renderer, &scene, target, &[]).unwrap();
            event.wait().unwrap();
        }
        counts()
    };
    draw(); // PoCL 3.1 keeps a reference to the context after the first frame of each kind, once
    // A driver lets go of what is over in a thread of its own.
    let settled = || {
        host.queue.finish().unwrap();
        let mut last = counts();
        for _ in 0..50 {
            std::thread::sleep(std::time::Duration::from_millis(10));
            last = counts()
                .into_iter()
                .zip(last)
                .map(|(a, b)| a.min(b))
                .collect();
        }
        last
    };
    let before = settled();
    assert!(draw()[0] > before[0], "the context is retained");
    assert_eq!(settled(), before);
}
