//! Tiles: the tolerance is met where interpolation is hardest, each pixel comes once, and the cost follows the wave's
//! outline.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::random::random_scene;
use common::{LANE_WIDTHS, difference, meets, renderer};
use energywave::ray::ViewPlane;
use energywave::scene::{ImageSize, Method, Sampling};
use energywave::{Renderer, Scene, reference};
use glam::DVec3;

const TOLERANCES: [f64; 3] = [1e-2, 1e-3, 1e-4];

/// No multiple of any tile, more than one of the largest.
const SIZE: ImageSize = ImageSize {
    width: 130,
    height: 75,
};

fn view(eye: [f64; 3], target: [f64; 3]) -> Scene {
    let mut scene = common::empty_scene(SIZE.width, SIZE.height);
    (scene.camera.eye, scene.camera.target) = (eye.into(), target.into());
    scene.integration.method = Method::Exact;
    scene
}

fn usual_view() -> Scene {
    view([0.0, -4.0, 2.0], [0.0; 3])
}

/// The point that shows at a place of the image, in pixels, so far behind the projection plane as that is from the eye
/// times `depth`.
fn point_at(scene: &Scene, column: f64, row: f64, depth: f64) -> [f64; 3] {
    let plane = ViewPlane::new(&scene.camera, scene.image);
    let on_plane = plane.first_pixel + plane.column_step * column + plane.row_step * row;
    (plane.eye + on_plane * (1.0 + depth)).to_array()
}

fn direction(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    (DVec3::from(to) - DVec3::from(from)).to_array()
}

const ARCH: [[f64; 3]; 3] = [[-1.0, 0.0, 0.0], [0.0, 0.3, 1.5], [1.0, 0.0, 0.0]];

/// Views and sources meant to fool a test of smoothness.
fn hard_scenes() -> Vec<(&'static str, Scene)> {
    let mut scenes = Vec::new();

    let mut scene = usual_view();
    for (column, row) in [(27.0, 27.5), (40.3, 70.0), (100.0, 31.0)] {
        let center = point_at(&scene, column, row, 3.0);
        scene
            .tori
            .push(common::torus(center, [0.0, 1.0, 1.0], 0.004));
    }
    scenes.push(("rings thinner than a pixel", scene));

    let mut scene = usual_view();
    for (column, row) in [(63.5, 63.5), (119.5, 15.5), (7.5, 71.5), (80.0, 40.0)] {
        let center = point_at(&scene, column, row, 3.0);
        scene.spheres.push(common::sphere(center, 1.0));
    }
    scenes.push(("points in the corners of tiles and on a pixel", scene));

    let mut scene = usual_view();
    let corner = point_at(&scene, 63.5, 63.5, 3.0);
    let other = point_at(&scene, 127.5, 0.0, 3.5);
    scene
        .cylinders
        .push(common::cylinder(corner, direction(corner, other)));
    scenes.push(("a line through a corner of tiles", scene));

    let mut scene = view([0.0, -3.0, 0.0], [0.0; 3]);
    scene
        .tori
        .push(common::torus([0.0; 3], [0.0, 0.0, 1.0], 0.9));
    scenes.push(("a ring seen edge-on", scene));

    let mut scene = view([0.003, -3.0, 0.002], [0.0; 3]);
    scene
        .tori
        .push(common::torus([0.0; 3], [0.002, 1.0, 0.0], 0.9));
    scenes.push(("along the axis of a ring", scene));

    let mut scene = view([0.01, -2.0, 1.6], [0.0, 0.0, 0.8]);
    let series = vec![1.0, 0.9, 0.3, 0.2];
    scene.curves.push(common::curve(ARCH, Some(series)));
    scenes.push(("a jump of the intensity, from beside its sheet", scene));

    let mut scene = usual_view();
    let series = vec![0.1, 1.0, 0.2, 0.2, 1.0, 0.1, 0.6];
    let folded = [[-1.0, -0.2, 0.0], [1.6, 0.3, 0.9], [-0.8, 0.2, 0.1]];
    scene.curves.push(common::curve(folded, Some(series)));
    scenes.push(("a jump of the intensity, from outside", scene));

    let mut scene = usual_view();
    for (column, row) in [(36.0, 36.0), (39.0, 37.0), (90.0, 50.0), (90.0, 51.0)] {
        let center = point_at(&scene, column, row, 3.0);
        scene.spheres.push(common::sphere(center, 1.0));
    }
    for row in [20.0, 23.0] {
        let (left, right) = (
            point_at(&scene, 0.0, row, 3.0),
            point_at(&scene, 129.0, row + 2.0, 3.0),
        );
        scene
            .cylinders
            .push(common::cylinder(left, direction(left, right)));
    }
    scenes.push(("two cores in one tile", scene));

    // A jump of the slope where the plane through the tip passes the rays' ends.
    let mut scene = view([-3.0, -3.0, 1.0], [0.0, 0.3, 0.0]);
    scene.image = ImageSize {
        width: 256,
        height: 256,
    };
    (scene.camera.near, scene.camera.ray_length) = (0.5, Some(4.0));
    scene.decay = None;
    let mut beam = common::beam([0.1, 0.2, -0.1], [2.0, 1.0, 0.5], None);
    (beam.cap_coefficient, beam.sphere_coefficient) = (Some(0.0), 0.05);
    scene.beams.push(beam);
    scenes.push(("a beam without a cap", scene));

    let mut scene = usual_view();
    for (column, row) in [(-1.5, 40.0), (130.5, 3.0), (70.0, 75.7)] {
        let center = point_at(&scene, column, row, 3.0);
        scene.spheres.push(common::sphere(center, 1.0));
    }
    let (left, right) = (
        point_at(&scene, 0.0, -2.0, 3.0),
        point_at(&scene, 129.0, -1.0, 2.0),
    );
    scene
        .cylinders
        .push(common::cylinder(left, direction(left, right)));
    scenes.push(("cores just outside the image", scene));

    let mut scene = view([0.85, 0.1, 0.05], [-0.9, 0.0, 0.0]);
    (scene.camera.near, scene.camera.ray_length) = (0.02, Some(4.0));
    scene
        .tori
        .push(common::torus([0.0; 3], [0.0, 0.1, 1.0], 0.9));
    scene.curves.push(common::curve(
        [[0.9, -0.4, 0.3], [0.8, 0.0, 0.0], [0.7, 0.9, 0.4]],
        None,
    ));
    scenes.push(("a camera inside the wave", scene));

    let mut scene = view([-0.13, 0.05, 0.03], [-0.03, 0.23, 0.19]);
    (scene.camera.near, scene.camera.ray_length) = (0.13, Some(10.0));
    scene.camera.fov_y = 110.0;
    scene.curves.push(common::curve(
        [
            [0.06, -0.08, 0.03],
            [-0.09, -0.1, -0.05],
            [-0.07, 0.06, -0.1],
        ],
        Some(vec![0.75, 0.27, 0.37]),
    ));
    scenes.push(("a wide view past a core behind it", scene));

    for (name, series) in [
        ("a stripe as wide as a short curve", vec![1.0, 0.2, 1.0]),
        ("a short curve with dark ends", vec![0.0, 1.0, 0.0]),
    ] {
        let mut scene = usual_view();
        scene.image.height = 130;
        let points = [88.0, 90.5, 93.0].map(|column| point_at(&scene, column, 20.0, 3.0));
        scene.curves.push(common::curve(points, Some(series)));
        scenes.push((name, scene));
    }

    for softening in [0.002, 0.03, 0.4] {
        let mut scene = usual_view();
        scene.integration.softening = softening;
        scene.spheres.push(common::sphere([0.4, 0.3, 0.5], 1.5));
        let (axis, radius) = ([0.1, 0.2, 2.0], 0.9);
        scene.tori.push(common::torus([0.0; 3], axis, radius));
        scene.curves.push(common::curve(ARCH, None));
        scenes.push(("softened cores", scene));
    }

    let mut scene = common::full_scene(SIZE.width, SIZE.height);
    scene.integration.method = Method::Exact;
    // No pixel looks at the origin, where two curves end.
    scene.camera.target = DVec3::new(0.05, 0.02, 0.03);
    scene.decay = None;
    scenes.push(("every kind, without decay", scene));
    scenes
}

fn at_tolerance(scene: &Scene, tolerance: f64) -> Scene {
    let mut scene = scene.clone();
    scene.integration.tolerance = tolerance;
    scene
}

fn sampled(scene: &Scene, sampling: Sampling) -> Scene {
    let mut scene = scene.clone();
    scene.integration.sampling = Some(sampling);
    scene
}

/// Accepts every interpolation that seems smooth at the nodes.
const UNTESTED: &str = "-DLEAST_CLEARANCE=0.0f -DMOST_SPREAD=1e9f -DMOST_ERROR(pass)=1e9f";

#[test]
fn hard_scenes_meet_every_tolerance_because_interpolations_are_tested() {
    let mut tested = renderer(common::device().lanes, "");
    let mut untested = renderer(common::device().lanes, UNTESTED);
    let (mut missed, mut missed_untested) = (Vec::new(), Vec::new());
    for (name, scene) in hard_scenes() {
        let expected = reference::render(&scene).unwrap();
        for tolerance in TOLERANCES {
            let image = tested.render(&at_tolerance(&scene, tolerance)).unwrap();
            let found = difference(&image, &expected);
            if !meets(&found, tolerance) {
                missed.push(format!("{name} at {tolerance:e}: {found:?}"));
            }
        }
        let image = untested.render(&at_tolerance(&scene, 1e-3)).unwrap();
        if !meets(&difference(&image, &expected), 1e-3) {
            missed_untested.push(name);
        }
    }
    assert!(missed.is_empty(), "{}", missed.join("\n"));
    println!("untested: {missed_untested:?}");
    assert!(
        missed_untested.len() > 4,
        "untested, only {missed_untested:?}"
    );
}

#[test]
fn random_scenes_by_tiles_meet_the_tolerance_as_they_do_by_pixels() {
    let mut renderer = renderer(common::device().lanes, "");
    for seed in 100..130 {
        let scene = random_scene(seed, 160);
        let strict = at_tolerance(&sampled(&scene, Sampling::Pixels), 1e-5);
        let expected = renderer.render(&strict).unwrap();
        for tolerance in [1e-2, 1e-3] {
            let scene = at_tolerance(&scene, tolerance);
            let by_pixels = renderer.render(&sampled(&scene, Sampling::Pixels)).unwrap();
            let by_tiles = renderer.render(&sampled(&scene, Sampling::Tiles)).unwrap();
            let (pixels, tiles) = (
                difference(&by_pixels, &expected),
                difference(&by_tiles, &expected),
            );
            assert!(meets(&pixels, tolerance), "seed {seed}: {pixels:?}");
            assert!(meets(&tiles, tolerance), "seed {seed}: {tiles:?}");
        }
    }
}

#[test]
fn sources_of_opposite_signs_are_taken_at_every_pixel() {
    let mut renderer = renderer(common::device().lanes, "");
    let mut scene = usual_view();
    scene.spheres.push(common::sphere([0.2, 0.0, 0.1], 1.0));
    scene.spheres.push(common::sphere([-0.3, 0.1, 0.0], 0.9));
    assert_eq!(scene.sampling(), Sampling::Tiles);
    let all = 2 * scene.image.pixels() as u64;
    renderer.render(&scene).unwrap();
    assert!(renderer.last_cost().evaluations < all / 2);
    scene.spheres[1].coefficient = -0.9;
    assert_eq!(scene.sampling(), Sampling::Pixels);
    renderer.render(&scene).unwrap();
    assert_eq!(renderer.last_cost().evaluations, all);
    // Light that is negative everywhere cancels nothing.
    scene.spheres[0].coefficient = -1.0;
    assert_eq!(scene.sampling(), Sampling::Tiles);
}

#[test]
fn every_lane_width_paints_the_same_image() {
    let mut scene = common::full_scene(75, 37);
    scene.integration.method = Method::Exact;
    scene.integration.tolerance = 1e-4;
    scene.camera.target = DVec3::new(0.05, 0.02, 0.03);
    let expected = reference::render(&scene).unwrap();
    for lanes in LANE_WIDTHS {
        let found = difference(&renderer(lanes, "").render(&scene).unwrap(), &expected);
        assert!(meets(&found, 1e-4), "{lanes} lanes: {found:?}");
    }
}

#[test]
fn images_of_every_shape_are_painted_once_and_in_full() {
    let mut renderer = renderer(common::device().lanes, "");
    for (width, height) in [
        (1, 1),
        (7, 2),
        (8, 8),
        (65, 1),
        (1, 130),
        (63, 64),
        (200, 3),
    ] {
        let mut scene = usual_view();
        scene.image = ImageSize { width, height };
        scene.spheres.push(common::sphere([0.1, 0.2, 0.3], 1.0));
        scene
            .tori
            .push(common::torus([0.0; 3], [0.0, 0.1, 1.0], 0.9));
        let by_tiles = renderer.render(&scene).unwrap();
        let by_pixels = renderer.render(&sampled(&scene, Sampling::Pixels)).unwrap();
        let found = difference(&by_tiles, &by_pixels);
        assert!(found.max < 2e-3, "{width}x{height}: {found:?}");
        assert!(by_tiles.as_slice().chunks(4).all(|pixel| pixel[3] == 1.0));
    }
}

#[test]
fn frames_are_equal_to_the_bit_in_many_launches_and_in_few() {
    let mut scene = random_scene(7, 500);
    scene.image.height = 700;
    let mut renderer = renderer(common::device().lanes, "");
    let first = renderer.render(&scene).unwrap();
    let launches = renderer.last_cost().launches;
    let mut again = renderer.render(&scene).unwrap();
    for _ in 0..3 {
        again = renderer.render(&scene).unwrap();
    }
    assert!(renderer.last_cost().launches < launches);
    assert_eq!(first, again);
}

/// Spheres in a cube.
fn many_spheres(count: u32, image: ImageSize) -> Scene {
    let mut random = fastrand::Rng::with_seed(1);
    let mut scene = usual_view();
    scene.image = image;
    let mut coordinate = || 2.0 * random.f64() - 1.0;
    for _ in 0..count {
        let center = [coordinate(), coordinate(), coordinate()];
        scene.spheres.push(common::sphere(center, 1.0));
    }
    scene
}

#[test]
fn more_sources_than_a_launch_takes_are_all_in_the_image() {
    let mut renderer = renderer(common::device().lanes, "");
    let image = ImageSize {
        width: 70,
        height: 40,
    };
    let scene = many_spheres(5000, image);
    let by_pixels = sampled(&scene, Sampling::Pixels);
    let expected = renderer.render(&by_pixels).unwrap();
    let found = difference(&renderer.render(&scene).unwrap(), &expected);
    assert!(found.max < 1e-3, "{found:?}");
    let mut less = scene;
    less.spheres.pop();
    let found = difference(&renderer.render(&less).unwrap(), &expected);
    assert!(found.max > 1e-4, "one sphere less is not seen: {found:?}");
}

/// Integrals of a frame.
fn evaluations(renderer: &mut Renderer, scene: &Scene, width: u32, height: u32) -> u64 {
    let mut scene = scene.clone();
    scene.image = ImageSize { width, height };
    scene.depth = scene
        .depth
        .map(|depth| common::resized(&depth, scene.image));
    renderer.render(&scene).unwrap();
    renderer.last_cost().evaluations
}

#[test]
fn integrals_grow_with_the_outline_and_not_with_the_pixels() {
    let mut renderer = renderer(common::device().lanes, "");
    for (name, scene) in common::figures(48, Method::Exact) {
        // A level line costs more or less as it lies in the rows of tiles: several heights are summed.
        let mut of_width = |width: u32| -> u64 {
            let heights = [540, 545, 550].map(|height| height * width / 960);
            heights
                .map(|height| evaluations(&mut renderer, &scene, width, height))
                .iter()
                .sum()
        };
        let (small, large) = (of_width(960), of_width(1920));
        let growth = large as f64 / small as f64;
        assert!(growth < 2.6, "{name}: {small} to {large}");
        let all = 3 * 1920 * 1080 * scene.source_count() as u64;
        assert!(10 * large < all, "{name}: {large} of {all}");
        let pixels = sampled(&scene, Sampling::Pixels);
        assert_eq!(
            evaluations(&mut renderer, &pixels, 96, 54),
            96 * 54 * scene.source_count() as u64
        );
    }
}

#[test]
fn a_source_costs_as_much_among_many_as_alone() {
    let mut renderer = renderer(common::device().lanes, "");
    let image = ImageSize {
        width: 256,
        height: 256,
    };
    let per_source = |renderer: &mut Renderer, count| {
        let scene = many_spheres(count, image);
        evaluations(renderer, &scene, 256, 256) as f64 / f64::from(count)
    };
    let (few, many) = (
        per_source(&mut renderer, 16),
        per_source(&mut renderer, 512),
    );
    assert!(many < 1.2 * few, "{few} and {many}");
    assert!(many < 0.1 * 65536.0, "{many} of 65536");
}
