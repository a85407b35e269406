//! Every kernel on every lane width, small enough for a simulator: `.ci/run` runs this under oclgrind, which watches
//! every access. On any other device it is one more test, of its own lane width.
#![allow(unsafe_code)] // hosts call OpenCL

use crate::common;
use crate::common::host::Host;
use energywave::image::DepthAlong;
use energywave::scene::Method;
use energywave::verify::built_in_rays;
use energywave::{Renderer, RendererOptions};
use opencl3::memory::{CL_FLOAT, CL_HALF_FLOAT, CL_MEM_HOST_NO_ACCESS, CL_MEM_READ_WRITE, CL_RGBA};

#[test]
fn every_kernel_runs_on_every_lane_width() {
    println!("device: {}", common::device());
    let mut scene = common::full_scene(7, 5); // 35 pixels: no multiple of any lane width
    let rays: Vec<_> = built_in_rays()
        .unwrap()
        .iter()
        .take(21)
        .map(|known| known.ray)
        .collect();
    // As a GPU does it: a group of one lane each shares a tile.
    let mut shared_tiles = common::options(1, "");
    shared_tiles.tile_workers = Some(16);
    let device = common::device();
    let is_simulator = device.name.contains("Oclgrind");
    let mut builds: Vec<RendererOptions> = common::lane_widths()
        .into_iter()
        .filter(|lanes| is_simulator || *lanes == device.lanes)
        .map(|lanes| common::options(lanes, ""))
        .collect();
    // PoCL 3.1 compiles it for hours.
    builds.extend(is_simulator.then_some(shared_tiles));
    for options in builds {
        let mut renderer = Renderer::with_options(&common::device(), &options).unwrap();
        for method in [Method::simpson(4), Method::default()] {
            scene.integration.method = method;
            // Squares behind a wall with an edge.
            let mut hidden = common::squared(&scene);
            hidden.depth = Some(common::depths(&scene, DepthAlong::Axis, |column, row| {
                if column + row < 6 {
                    3.0 + 0.1 * f64::from(row)
                } else {
                    f64::INFINITY
                }
            }));
            let image = renderer.render(&scene).unwrap();
            assert!(image.as_slice().iter().all(|value| value.is_finite()));
            let traced = renderer.integrate(&scene, &rays).unwrap();
            assert!(traced.iter().flatten().all(|value| value.is_finite()));
            let hidden = renderer.render(&hidden).unwrap();
            assert!(hidden.as_slice().iter().all(|value| value.is_finite()));
        }
    }
}

#[test]
fn frames_for_a_host_touch_nothing_but_their_own() {
    // Each in a context of its own: in one context oclgrind 21.10 calls buffers of the second uninitialised, which it
    // does not where the second runs alone.
    for lanes in [1, 16] {
        let host = Host::new(0);
        let options = common::options(lanes, "");
        let (context, queue) = (host.context.get(), host.queue.get());
        // SAFETY: both are alive.
        let mut renderer = unsafe { Renderer::on_raw_host(context, queue, &options) }.unwrap();
        for method in [Method::simpson(common::DIVISIONS), Method::default()] {
            let mut scene = common::empty_scene(21, 10);
            scene.integration.method = method;
            scene.spheres.push(common::sphere([0.3, 0.2, 0.1], 1.0));
            for (flags, channels) in [
                (0, CL_HALF_FLOAT),
                (0, CL_FLOAT),
                (CL_MEM_HOST_NO_ACCESS, CL_FLOAT),
            ] {
                let flags = flags | CL_MEM_READ_WRITE;
                let image = host.image_of(flags, scene.image, CL_RGBA, channels);
                // SAFETY: the image lives until the frame is over.
                unsafe { renderer.enqueue(&scene, (&image).into(), &[]) }
                    .unwrap()
                    .wait()
                    .unwrap();
            }
        }
    }
}
