//! Every kernel on every lane width, small enough for a simulator: `.ci/run` runs this under oclgrind, which watches
//! every access. On any other device it is one more test, of its own lane width.
#![allow(unsafe_code)] // hosts call OpenCL

use std::ops::ControlFlow;

use crate::common;
use crate::common::host::Host;
use crate::common::meshes::ball;
use energywave::image::{Bloom, DepthAlong};
use energywave::internals::see_surfaces;
use energywave::scene::{
    Antialias, Decay, LightElement, MetaballKernel, MetaballMethod, MetaballSampling, Metaballs,
    Method, Particles, PointList, Points, Profile,
};
use energywave::verify::built_in_rays;
use energywave::volume::{CellValue, Grid};
use energywave::{HostDepth, HostDepthMemory, RadianceImage, Renderer, RendererOptions, Scene};
use glam::DVec3;
use opencl3::memory::{
    CL_FLOAT, CL_HALF_FLOAT, CL_MEM_HOST_NO_ACCESS, CL_MEM_READ_WRITE, CL_RGBA, ClMem,
};

fn is_simulator() -> bool {
    common::device().name.contains("Oclgrind")
}

/// As a GPU does it: a group of one lane each shares a tile.
fn shared_tiles() -> RendererOptions {
    let mut options = common::options(1, "");
    options.tile_workers = Some(16);
    options
}

/// How much of the only tile, 64 pixels wide and high, is hidden.
#[derive(Debug, Clone, Copy)]
enum Wall {
    None,
    /// As smooth as the light: sources may be smooth, too.
    Slanted,
    /// Before the projection plane.
    Near,
    /// Beyond the rays' ends.
    Far,
    Edge,
}

/// A source of one kind, or of all but curves, whose light is smooth on the tile or is not.
fn on_one_tile(kind: usize, is_smooth: bool, wall: Wall) -> Scene {
    let mut scene = common::empty_scene(64, 64);
    scene.integration.method = Method::default();
    let aside = if is_smooth { 9.0 } else { 0.1 };
    match kind {
        0 => scene.spheres.push(common::sphere([aside, 0.2, 0.1], 1.0)),
        1 => {
            let line = common::cylinder([aside, 0.6, 0.2], [0.1, 0.2, 1.0]);
            scene.cylinders.push(line);
        }
        2 => {
            let beam = common::beam([aside, 0.2, 0.4], [0.3, 0.2, 0.9], Some(0.6));
            scene.beams.push(beam);
        }
        3 => {
            let ring = common::torus([aside, 0.0, 0.0], [0.1, 0.2, 2.0], 0.9);
            scene.tori.push(ring);
        }
        _ => {
            let moved = common::CURVE_SHAPES[0].map(|[x, y, z]| [x + aside, y, z]);
            let series = vec![1.0, 0.2, 0.6, 1.0];
            scene.curves.push(common::curve(moved, Some(series)));
        }
    }
    let depth = |column: u32, row: u32| {
        let slanted = 6.0 + 0.002 * f64::from(row) + 0.001 * f64::from(column);
        match wall {
            Wall::Near => 1e-3,
            Wall::Edge if column + row < 60 => 3.0,
            Wall::Far | Wall::Edge => 1e6,
            Wall::None | Wall::Slanted => slanted,
        }
    };
    if !matches!(wall, Wall::None) {
        scene.depth = Some(common::depths(&scene, DepthAlong::Ray, depth));
    }
    scene
}

#[test]
fn groups_that_share_a_tile_stay_together_in_every_branch() {
    if !is_simulator() && common::device().tile_workers == 1 {
        println!("only where work-items share tiles: not checked here");
        return;
    }
    let mut renderer = Renderer::with_options(&common::device(), &shared_tiles()).unwrap();
    let mut taken = |scene: &Scene| {
        let image = renderer.render(scene).unwrap();
        assert!(image.as_slice().iter().all(|value| value.is_finite()));
        renderer.last_cost().integrals
    };
    // Nodes and tests of the tile, and of as many of its sources as pass the first.
    const NODES: u64 = 16;
    for kind in 0..5 {
        for wall in [Wall::None, Wall::Slanted] {
            let integrals = taken(&on_one_tile(kind, true, wall));
            println!("kind {kind}, {wall:?}: {integrals}");
            assert!(integrals >= 2 * NODES, "{kind}, {wall:?}: {integrals}");
            assert_eq!(integrals % NODES, 0, "a group was parted: {kind}, {wall:?}");
        }
    }
    for (wall, is_smooth) in [
        (Wall::Near, true),
        (Wall::Far, true),
        (Wall::Edge, true),
        (Wall::Slanted, false),
    ] {
        let integrals = taken(&on_one_tile(0, is_smooth, wall));
        println!("{wall:?}: {integrals}");
        assert_eq!(integrals == 0, matches!(wall, Wall::Near), "{wall:?}");
        assert_eq!(integrals % NODES, 0, "a group was parted: {wall:?}");
    }
    // Light that ends before the tile, on it, and beyond it.
    for reach in [0.5, 9.0, 40.0] {
        let mut scene = on_one_tile(0, true, Wall::Slanted);
        scene.spheres[0].reach = Some(reach);
        let integrals = taken(&scene);
        println!("reach {reach}: {integrals}");
        assert_eq!(integrals == 0, reach < 1.0, "reach {reach}");
        assert_eq!(integrals % NODES, 0, "a group was parted: reach {reach}");
    }
}

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
    let device = common::device();
    let is_simulator = is_simulator();
    let mut builds: Vec<RendererOptions> = common::lane_widths()
        .into_iter()
        .filter(|lanes| is_simulator || *lanes == device.lanes)
        .map(|lanes| common::options(lanes, ""))
        .collect();
    // PoCL 3.1 compiles it for hours.
    builds.extend(is_simulator.then(shared_tiles));
    for options in builds {
        let mut renderer = Renderer::with_options(&common::device(), &options).unwrap();
        let grid = Grid::new(DVec3::ZERO, DVec3::new(1.9, 0.3, 0.4), 19).unwrap();
        let nothing = &mut |_: f32| ControlFlow::Continue(());
        let volume = renderer.bake(&common::squared(&scene), grid, CellValue::Mean(2), nothing);
        assert!(volume.unwrap().greatest().is_finite());
        let jittered = Method::Jittered {
            divisions: 4,
            seed: 1,
        };
        for method in [Method::simpson(4), jittered, Method::default()] {
            scene.integration.method = method;
            // Squares and other shapes behind a wall with an edge.
            let mut hidden = common::squared(&scene);
            hidden.tori[0].reach = Some(0.8);
            hidden.curves[0].reach = Some(0.8);
            hidden.spheres[0].radius = 0.1;
            hidden.beams[0].profile = Profile::InverseCube;
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

#[test]
fn a_hosts_depths_are_read_where_they_are() {
    let mut scene = common::empty_scene(21, 10);
    scene.integration.method = Method::simpson(4);
    scene.spheres.push(common::sphere([0.3, 0.2, 0.1], 1.0));
    let size = scene.image;
    // Rows of 25 values, the last one not longer than the picture's. What is copied from an image oclgrind 21.10 calls
    // uninitialised. At 1 is the projection plane, where rays begin: nothing is left of them.
    let (before, pitch) = (3, 25);
    for (value, is_dark) in [(3.0, false), (1.0, true)] {
        let host = Host::new(0); // each in a context of its own, as above
        let options = common::options(1, "");
        let (context, queue) = (host.context.get(), host.queue.get());
        // SAFETY: both are alive.
        let mut renderer = unsafe { Renderer::on_raw_host(context, queue, &options) }.unwrap();
        let buffer = host.floats(&vec![value; before + 9 * pitch + 21]);
        let memory = HostDepthMemory::Buffer {
            buffer: buffer.get(),
            offset: 4 * before,
            row_pitch: 4 * pitch,
        };
        let mut depth = HostDepth::new(memory, DepthAlong::Axis);
        depth.is_bottom_up = true;
        let target = host.buffer(CL_MEM_READ_WRITE, size);
        // SAFETY: target and depths live until the frame is over.
        let event = unsafe { renderer.enqueue_behind(&scene, (&target).into(), &depth, &[]) };
        let found = host.read((&target).into(), size, &[&event.unwrap()]);
        assert!(found.iter().all(|value| value.is_finite()));
        let light: f32 = found.chunks(4).map(|pixel| pixel[0]).sum();
        assert_eq!(light == 0.0, is_dark, "{value}: {light}");
    }
}

#[test]
fn a_bloom() {
    let mut scene = common::empty_scene(37, 26);
    scene.integration.method = Method::simpson(4);
    scene.spheres.push(common::sphere([0.0; 3], 1.0));
    // Levels that one group takes, and one before them.
    scene.display.bloom = Some(Bloom {
        strength: 0.5,
        radius: 0.3,
    });
    let mut renderer = common::renderer(common::device().lanes, "");
    let before = renderer.render(&scene).unwrap();
    renderer.spread_bloom(true);
    let after = renderer.render(&scene).unwrap();
    let sum = |image: &RadianceImage| image.as_slice().iter().sum::<f32>();
    let (before, after) = (sum(&before), sum(&after));
    assert!((after - before).abs() < 1e-4 * before, "{before} {after}");
}

#[test]
fn surfaces_are_found_within_the_memory_that_there_is() {
    let device = common::device();
    let widths = common::lane_widths().into_iter();
    for lanes in widths.filter(|lanes| is_simulator() || *lanes == device.lanes) {
        let mut renderer = common::renderer(lanes, "");
        for (kernel, method) in [
            (MetaballKernel::Cone, MetaballMethod::Exact),
            (
                MetaballKernel::Smooth,
                MetaballMethod::Sampling(MetaballSampling::default()),
            ),
        ] {
            // More coincident particles than a window keeps, and others around them; sizes that are multiples of
            // nothing.
            let mut points = vec![DVec3::new(0.1, 0.2, 0.0); 300];
            points.extend((0..30).map(|k| DVec3::new(0.1 * f64::from(k) - 1.5, 0.3, 0.2)));
            let mut scene = common::empty_scene(21, 13);
            scene.metaballs.push(Metaballs {
                kernel,
                method,
                ..Metaballs::new(PointList::new(points).unwrap(), 0.6)
            });
            let (lengths, _) = see_surfaces(&mut renderer, &scene).unwrap();
            assert_eq!(lengths.len(), 21 * 13);
            assert!(lengths.iter().any(|length| length.is_finite()));
        }
    }
}

#[test]
fn meshes_are_met_within_the_memory_that_there_is() {
    let device = common::device();
    let widths = common::lane_widths().into_iter();
    for lanes in widths.filter(|lanes| is_simulator() || *lanes == device.lanes) {
        let mut scene = common::empty_scene(21, 10);
        scene.meshes.push(ball(6));
        for antialias in [Antialias::None, Antialias::Footprint] {
            scene.integration.antialias = antialias;
            let mut renderer = common::renderer(lanes, "");
            let image = renderer.render(&scene).unwrap();
            assert!(image.as_slice().iter().all(|value| value.is_finite()));
            assert!(image.as_slice().chunks(4).any(|pixel| pixel[0] > 0.1));
        }
    }
}

#[test]
fn particles_shine_within_the_memory_that_there_is() {
    let device = common::device();
    let widths = common::lane_widths().into_iter();
    for lanes in widths.filter(|lanes| is_simulator() || *lanes == device.lanes) {
        let mut renderer = common::renderer(lanes, "");
        // Balls of which some are cut by the depth, one at the decay's pole, and a streak; more tiles than one, sizes
        // that are multiples of nothing.
        let mut scene = common::empty_scene(21, 13);
        scene.decay = Some(Decay::new(0.1, 0.1));
        let along = scene.camera.eye.normalize();
        let points = (0..12).map(|k| 0.35 * f64::from(k) * along + 0.05 * DVec3::X);
        let points = PointList::new(points.collect()).unwrap();
        scene.particles.push(Particles::new(points, 0.3));
        scene.light_elements.push(LightElement::Streak {
            ends: [DVec3::new(-1.0, 0.2, 0.1), DVec3::new(0.9, -0.3, 0.4)],
            radii: [0.1, 0.3, 0.2],
            light: DVec3::ONE,
        });
        let depth = |column, _| if column < 10 { 3.4 } else { f64::INFINITY };
        scene.depth = Some(common::depths(&scene, DepthAlong::Axis, depth));
        let image = renderer.render(&scene).unwrap();
        let lit = image.as_slice().chunks(4).filter(|pixel| pixel[0] > 0.0);
        assert!(lit.count() > 20);
        // The same along rays, of which the last lanes have none.
        let plane = scene.view_plane();
        let rays: Vec<_> = (0..21).map(|column| plane.ray(column, 6)).collect();
        let lights = renderer.integrate(&scene, &rays).unwrap();
        assert!(lights.iter().filter(|light| light[0] > 0.0).count() > 5);
    }
}

#[test]
fn crowds_shine_within_the_memory_that_there_is() {
    let device = common::device();
    let widths = common::lane_widths().into_iter();
    for lanes in widths.filter(|lanes| is_simulator() || *lanes == device.lanes) {
        let mut renderer = common::renderer(lanes, "");
        for profile in [Profile::Inverse, Profile::InverseSquare] {
            // In a heap, along a line that leaves the view on both sides, and beside the eye.
            let mut scene = common::empty_scene(45, 29);
            scene.integration.method = Method::default();
            let place = |k: u32| match k % 25 {
                0 | 5 | 10 | 15 | 20 => DVec3::new(0.02 * f64::from(k) - 6.0, 0.2, 0.1),
                1 => scene.camera.eye + DVec3::new(0.01 * f64::from(k), -1.0, 0.0),
                _ => 1e-3 * f64::from(k) * DVec3::new(f64::from(k % 3), f64::from(k % 7), -1.0),
            };
            let points = PointList::new((0..600).map(place).collect()).unwrap();
            let mut points = Points::new(points);
            (points.profile, points.coefficient) = (profile, 1e-3);
            scene.points.push(points);
            let image = renderer.render(&scene).unwrap();
            assert!(image.as_slice().iter().all(|value| value.is_finite()));
            assert!(renderer.last_cost().launches > 5, "no crowd was drawn");
        }
    }
}
