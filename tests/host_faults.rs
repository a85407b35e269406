//! Whatever call fails while a frame is enqueued for a host: an error, no panic, the host's queue is never finished, and
//! its next frame is right.
#![allow(clippy::unwrap_used)]
#![allow(unsafe_code)] // hosts call OpenCL
#![cfg(unix)] // the OpenCL layer is a shared library

mod common;

use std::time::Duration;

use common::host::Host;
use common::layer::Layer;
use energywave::opencl::HostTarget;
use energywave::{Renderer, Scene};
use opencl3::event::{Event, create_user_event, set_user_event_status};
use opencl3::memory::CL_MEM_READ_WRITE;
use opencl3::types::{CL_NON_BLOCKING, cl_event};

const OUT_OF_RESOURCES: i32 = -5;

/// Calls by which a frame is enqueued.
const CALLS: [&str; 7] = [
    "clEnqueueMarkerWithWaitList",
    "clFlush",
    "clEnqueueWriteBuffer",
    "clSetKernelArg",
    "clEnqueueNDRangeKernel",
    "clGetEventInfo",
    "clGetEventProfilingInfo",
];

/// Two frames by tiles; from one to the other all lists change.
fn film() -> [Scene; 2] {
    [0.0, 0.3].map(|shift| {
        let mut scene = common::empty_scene(72, 40);
        scene.integration.method = energywave::scene::Method::Exact;
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
    let layer = Layer::new();
    let host = Host::new(0);
    let mut renderer = Renderer::on_host(&host.context, &host.queue).unwrap();
    let [first, second] = film();
    let buffer = host.buffer(CL_MEM_READ_WRITE, first.image);
    let target = HostTarget::from(&buffer);
    let image = renderer.render(&second).unwrap();
    for call in CALLS {
        for nth in 1.. {
            let event = enqueue(&mut renderer, &first, target, &[]).unwrap();
            event.wait().unwrap();
            layer.fail(call, nth, OUT_OF_RESOURCES);
            let outcome = enqueue(&mut renderer, &second, target, &[]);
            if layer.disarm() == 0 {
                assert!(nth > 1, "no frame calls {call}");
                break;
            }
            let words = outcome.map(drop).unwrap_err().to_string();
            assert!(CALLS.iter().any(|call| words.contains(call)), "{words}");
            assert!(words.contains(", -5)"), "{words}");
            let event = enqueue(&mut renderer, &second, target, &[]).unwrap();
            let found = host.read(target, second.image, &[&event]);
            assert!(found == image.as_slice(), "{call}, {nth}");
        }
    }
    assert_eq!(layer.finishes(host.queue.get()), 0);
}

#[test]
fn a_renderer_of_a_host_may_be_dropped_on_a_lost_device() {
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
}

#[test]
fn what_was_launched_before_a_fault_is_over_before_the_hosts_next_command() {
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
}
