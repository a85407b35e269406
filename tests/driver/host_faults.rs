//! Whatever call fails while a frame is enqueued for a host, and whatever a host gives that does not fit: an error, no
//! panic, the host's queue is never finished, and its next frame is right.
#![allow(unsafe_code)] // hosts call OpenCL

use crate::common;
use std::time::Duration;

use crate::common::host::Host;
use crate::common::layer::{Layer, with_layer};
use energywave::HostTarget;
use energywave::scene::{Antialias, Metaballs, PointList};
use energywave::{Error, Renderer, Scene};
use glam::DVec3;
use opencl3::event::{Event, create_user_event, set_user_event_status};
use opencl3::memory::{
    CL_FLOAT, CL_MEM_READ_ONLY, CL_MEM_READ_WRITE, CL_MEM_WRITE_ONLY, CL_RGBA, CL_UNSIGNED_INT8,
    ClMem,
};
use opencl3::types::{CL_NON_BLOCKING, cl_event};

const OUT_OF_RESOURCES: i32 = -5;

/// Calls by which a frame is enqueued.
const CALLS: [&str; 10] = [
    "clEnqueueMarkerWithWaitList",
    "clFlush",
    "clEnqueueWriteBuffer",
    "clSetKernelArg",
    "clEnqueueNDRangeKernel",
    "clEnqueueMapImage",
    "clEnqueueMapBuffer",
    "clEnqueueUnmapMemObject",
    "clGetEventInfo",
    "clGetEventProfilingInfo",
];

/// Two frames by tiles; from one to the other all lists change.
fn film() -> [Scene; 2] {
    [0.0, 0.3].map(|shift| {
        let mut scene = common::empty_scene(72, 40);
        scene.integration.method = energywave::scene::Method::default();
        scene.spheres.push(common::sphere([shift, 0.3, 0.5], 1.5));
        let axis = [0.1, 0.2, 2.0];
        scene.tori.push(common::torus([0.1, shift, 0.0], axis, 0.9));
        scene
    })
}

fn enqueue(
    renderer: &mut Renderer,
    scene: &Scene,
    target: HostTarget,
    wait_list: &[cl_event],
) -> energywave::Result<Event> {
    // SAFETY: the tests keep targets and events until they have waited.
    unsafe { renderer.enqueue(scene, target, wait_list) }
}

#[test]
fn a_call_that_fails_is_an_error_and_the_hosts_next_frame_is_right() {
    with_layer(|| {
        let layer = Layer::new();
        let host = Host::new(0);
        let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
        let [first, second] = film();
        let expected = renderer.render(&second).unwrap();
        let image = host.image(first.image, CL_FLOAT);
        let buffer = host.buffer(CL_MEM_READ_WRITE, first.image);
        for target in [HostTarget::from(&image), HostTarget::from(&buffer)] {
            let mut draw = |scene| enqueue(&mut renderer, scene, target, &[]);
            for call in CALLS {
                for nth in 1.. {
                    draw(&first).unwrap().wait().unwrap();
                    layer.fail(call, nth, OUT_OF_RESOURCES);
                    let outcome = draw(&second);
                    if layer.disarm() == 0 {
                        let is_for_images = call.to_lowercase().contains("map");
                        let is_buffer = matches!(target, HostTarget::Buffer(_));
                        assert!(nth > 1 || is_for_images && is_buffer, "{call}: never");
                        break;
                    }
                    // What only asks how earlier frames went, or flushes once more, is no reason to draw nothing.
                    let is_minor = call.starts_with("clGet") || call == "clFlush";
                    match outcome {
                        Ok(event) => assert!(is_minor && event.wait().is_ok(), "{call}, {nth}"),
                        Err(error) => {
                            let words = error.to_string();
                            assert!(CALLS.iter().any(|call| words.contains(call)), "{words}");
                            assert!(words.contains(", -5)"), "{words}");
                        }
                    }
                    let event = draw(&second).unwrap();
                    let found = host.read(target, second.image, &[&event]);
                    assert!(found == expected.as_slice(), "{call}, {nth}");
                }
            }
        }
        assert_eq!(layer.finishes(host.queue.get()), 0);
    });
}

/// Two frames with surfaces, whose edges lie within pixels.
fn surfaces() -> [Scene; 2] {
    film().map(|mut scene| {
        (scene.image.width, scene.image.height) = (40, 24);
        scene.integration.antialias = Antialias::Footprint;
        scene.tori.clear();
        let place = 0.4 * scene.camera.eye + DVec3::X * scene.spheres[0].center.x;
        let points = PointList::new(vec![place]).unwrap();
        scene.metaballs.push(Metaballs::new(points, 2.0));
        scene
    })
}

/// The largest difference, as a share of the brightest.
fn off(found: &[f32], expected: &[f32]) -> f32 {
    let brightest = expected.iter().copied().fold(0.0, f32::max);
    let pairs = found.iter().zip(expected);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) / brightest
}

#[test]
fn a_call_that_fails_while_surfaces_are_drawn_is_an_error_and_the_next_frame_is_right() {
    with_layer(|| {
        let layer = Layer::new();
        let host = Host::new(0);
        let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
        let [first, second] = surfaces();
        let expected = renderer.render(&second).unwrap();
        let buffer = host.buffer(CL_MEM_READ_WRITE, first.image);
        let target = HostTarget::from(&buffer);
        let mut draw = |scene| enqueue(&mut renderer, scene, target, &[]);
        for call in [
            "clEnqueueMarkerWithWaitList",
            "clEnqueueWriteBuffer",
            "clEnqueueReadBuffer",
            "clEnqueueNDRangeKernel",
        ] {
            let mut most = 0;
            for nth in 1.. {
                let event = draw(&first).unwrap();
                let other = host.read(target, first.image, &[&event]);
                assert!(off(&other, expected.as_slice()) > 1e-2, "{call}, {nth}");
                layer.fail(call, nth, OUT_OF_RESOURCES);
                let outcome = draw(&second);
                if layer.disarm() == 0 {
                    break;
                }
                most = nth;
                let words = outcome.map(drop).unwrap_err().to_string();
                assert!(words.contains(", -5)"), "{call}, {nth}: {words}");
                let event = draw(&second).unwrap();
                let found = host.read(target, second.image, &[&event]);
                let off = off(&found, expected.as_slice());
                assert!(off <= 1e-6, "{call}, {nth}: {off:e}");
            }
            assert!(most > 1, "{call}: {most}");
        }
        assert_eq!(layer.finishes(host.queue.get()), 0);
    });
}

#[test]
fn a_renderer_of_a_host_may_be_dropped_on_a_lost_device() {
    with_layer(|| {
        let layer = Layer::new();
        let host = Host::new(0);
        let [first, second] = film();
        let buffer = host.buffer(CL_MEM_READ_WRITE, first.image);
        let target = HostTarget::from(&buffer);
        let before = layer.live();
        for nth in (1..120).step_by(8) {
            let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
            let event = enqueue(&mut renderer, &first, target, &[]).unwrap();
            event.wait().unwrap();
            drop(event);
            layer.lose_device(nth, OUT_OF_RESOURCES);
            let outcome = enqueue(&mut renderer, &second, target, &[]);
            drop(renderer);
            layer.disarm();
            drop(outcome);
            assert_eq!(layer.live(), before, "{nth}");
        }
    });
}

#[test]
fn what_was_launched_before_a_fault_is_over_before_the_hosts_next_command() {
    with_layer(|| {
        let layer = Layer::new();
        let host = Host::new(0);
        let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
        let [scene, _] = film();
        let mut buffer = host.buffer(CL_MEM_READ_WRITE, scene.image);
        let target = HostTarget::from(&buffer);
        let event = enqueue(&mut renderer, &scene, target, &[]).unwrap();
        event.wait().unwrap(); // kernels are built now

        let gate = Event::new(create_user_event(host.context.get()).unwrap());
        layer.fail("clEnqueueNDRangeKernel", 4, OUT_OF_RESOURCES);
        let outcome = enqueue(&mut renderer, &scene, target, &[gate.get()]);
        outcome.map(drop).unwrap_err();
        assert_eq!(layer.disarm(), 1);
        let marks = vec![-1.0_f32; 4 * scene.image.pixels()];
        // SAFETY: the marks live until the read below has waited for all before it.
        let written = unsafe {
            host.queue
                .enqueue_write_buffer(&mut buffer, CL_NON_BLOCKING, 0, &marks, &[])
        };
        written.unwrap();
        host.queue.flush().unwrap();
        set_user_event_status(gate.get(), 0).unwrap();
        std::thread::sleep(Duration::from_millis(100)); // for kernels that nothing waits for
        assert!(host.read(target, scene.image, &[]) == marks);
    });
}

#[test]
fn what_does_not_fit_is_refused_before_anything_is_enqueued() {
    with_layer(|| {
        let layer = Layer::new();
        let (host, other) = (Host::new(0), Host::new(0));
        let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
        let scene = common::full_scene(40, 30);
        let (size, mut wider, mut fewer) = (scene.image, scene.image, scene.image);
        wider.width += 1;
        fewer.height -= 1;
        let null = std::ptr::null_mut();
        let rgba = |flags, channel_type| host.image_of(flags, size, CL_RGBA, channel_type);
        let buffer = |flags| host.buffer(flags, size);
        let (small, foreign) = (
            host.buffer(CL_MEM_READ_WRITE, fewer),
            other.buffer(CL_MEM_READ_WRITE, size),
        );
        let (read_only, write_only) = (buffer(CL_MEM_READ_ONLY), buffer(CL_MEM_WRITE_ONLY));
        let (wide, bytes) = (
            host.image(wider, CL_FLOAT),
            rgba(CL_MEM_READ_WRITE, CL_UNSIGNED_INT8),
        );
        let (read_only_image, foreign_image) = (
            rgba(CL_MEM_READ_ONLY, CL_FLOAT),
            other.image(size, CL_FLOAT),
        );
        let good = buffer(CL_MEM_READ_WRITE);
        let before = layer.calls("clEnqueue*");
        let refused: [(HostTarget, &str); 12] = [
            (HostTarget::Buffer(null), "the host's buffer: null"),
            (HostTarget::Image(null), "the host's image: null"),
            (
                (&small).into(),
                "buffer: 18560 bytes; 40x30 float32 RGBA pixels need 19200",
            ),
            ((&foreign).into(), "buffer: it belongs to another context"),
            (
                (&read_only).into(),
                "buffer: kernels may not write it (CL_MEM_READ_ONLY)",
            ),
            (
                (&write_only).into(),
                "buffer: kernels may not read it (CL_MEM_WRITE_ONLY)",
            ),
            (
                HostTarget::Buffer(wide.get()),
                "buffer: it is another kind of memory object",
            ),
            (
                HostTarget::Image(good.get()),
                "image: it is another kind of memory object",
            ),
            ((&wide).into(), "image: 41x30 pixels, the scene has 40x30"),
            (
                (&bytes).into(),
                "image: channels of order 0x10b5 and type 0x10da; they must be CL_RGBA",
            ),
            (
                (&read_only_image).into(),
                "image: kernels may not write it (CL_MEM_READ_ONLY)",
            ),
            (
                (&foreign_image).into(),
                "image: it belongs to another context",
            ),
        ];
        for (target, words) in refused {
            let error = enqueue(&mut renderer, &scene, target, &[]).unwrap_err();
            assert!(matches!(error, Error::Host { .. }), "{error:?}");
            assert!(
                error.to_string().contains(words),
                "{error}\nhas not: {words}"
            );
        }
        let mut refuse = |scene: &Scene, events: &[cl_event], words: &str| {
            let error = enqueue(&mut renderer, scene, (&good).into(), events).unwrap_err();
            assert!(
                error.to_string().contains(words),
                "{error}\nhas not: {words}"
            );
        };
        let event = Event::new(create_user_event(other.context.get()).unwrap());
        refuse(
            &scene,
            &[event.get()],
            "wait list: an event of it belongs to another context",
        );
        refuse(&scene, &[null], "wait list: it has a null event");
        let mut invalid = scene.clone();
        invalid.tori[0].major_radius = -1.0;
        refuse(&invalid, &[], "torus[0].major_radius");

        assert_eq!(layer.calls("clEnqueue*"), before);
        let event = enqueue(&mut renderer, &scene, (&good).into(), &[]).unwrap();
        assert!(layer.calls("clEnqueue*") > before);
        let found = host.read((&good).into(), size, &[&event]);
        assert!(found == renderer.render(&scene).unwrap().as_slice());

        let error = Renderer::on_host(&host.context, &other.queue).unwrap_err();
        assert!(
            error
                .to_string()
                .contains("the host's queue: it belongs to another context")
        );
        let mut own = Renderer::new(&common::device()).unwrap();
        let error = enqueue(&mut own, &scene, (&good).into(), &[]).unwrap_err();
        assert!(error.to_string().contains("made without one"), "{error}");
    });
}

#[test]
fn an_event_of_the_host_that_fails_fails_the_frame_and_nothing_aborts() {
    with_layer(|| {
        let _layer = Layer::new();
        let [scene, _] = film();
        for is_image in [true, false] {
            // PoCL 3.1 may never end what comes on a queue after a command that failed: each has a host of its own.
            let host = Host::new(0);
            let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
            let image = host.image(scene.image, CL_FLOAT);
            let buffer = host.buffer(CL_MEM_READ_WRITE, scene.image);
            let target = match is_image {
                true => HostTarget::from(&image),
                false => HostTarget::from(&buffer),
            };
            let gate = Event::new(create_user_event(host.context.get()).unwrap());
            let event = enqueue(&mut renderer, &scene, target, &[gate.get()]).unwrap();
            set_user_event_status(gate.get(), OUT_OF_RESOURCES).unwrap();
            assert!(event.wait().is_err());
            // A wait for what has failed already may never end.
            let error = enqueue(&mut renderer, &scene, target, &[gate.get()]).unwrap_err();
            let words = "wait list: an event of it has failed";
            assert!(error.to_string().contains(words), "{error}");
        }
    });
}
