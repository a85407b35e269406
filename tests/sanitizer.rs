//! Every kernel on every lane width, small enough for a simulator: `.ci/run` runs this under oclgrind, which watches every
//! access. On any other device it is one more test.
#![allow(clippy::unwrap_used)]

mod common;

use energywave::image::DepthAlong;
use energywave::scene::Method;
use energywave::verify::{KnownRay, built_in_rays};
use energywave::{BuildOptions, Renderer};

#[test]
fn every_kernel_runs_on_every_lane_width() {
    println!("device: {}", common::device());
    let mut scene = common::full_scene(7, 5); // 35 pixels: no multiple of any lane width
    scene.integration.divisions = 4;
    let rays: Vec<_> = built_in_rays()
        .unwrap()
        .iter()
        .take(21)
        .map(KnownRay::ray)
        .collect();
    // As a GPU does it: a group of one lane each shares a tile.
    let shared_tiles = BuildOptions {
        tile_workers: Some(16),
        ..common::options(1, "")
    };
    let is_simulator = common::device().name.contains("Oclgrind");
    let mut builds: Vec<BuildOptions> = common::LANE_WIDTHS
        .map(|lanes| common::options(lanes, ""))
        .to_vec();
    // PoCL 3.1 compiles it for hours.
    builds.extend(is_simulator.then_some(shared_tiles));
    for options in builds {
        let mut renderer = Renderer::with_options(&common::device(), &options).unwrap();
        for method in [Method::Simpson, Method::Exact] {
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
            let traced = renderer.trace(&scene, &rays).unwrap();
            assert!(traced.iter().flatten().all(|value| value.is_finite()));
            let hidden = renderer.render(&hidden).unwrap();
            assert!(hidden.as_slice().iter().all(|value| value.is_finite()));
        }
    }
}
