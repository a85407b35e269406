//! Tiles: the tolerance is met where interpolation is hardest, each pixel comes once, and the cost follows the wave's
//! outline.

use crate::common;
use crate::common::random::random_scene;
use crate::common::tile_scenes::{hard_scenes, usual_view};
use crate::common::{at_tolerance, difference, lane_widths, meets, renderer, sampled};
use energywave::image::ImageSize;
use energywave::scene::{Method, Preset, Profile, Sampling, Torus};
use energywave::{RadianceImage, Renderer, Scene, reference};
use glam::DVec3;

const TOLERANCES: [f64; 3] = [1e-2, 1e-3, 1e-4];

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
    assert!(renderer.last_cost().integrals < all / 2);
    scene.spheres[1].coefficient = -0.9;
    assert_eq!(scene.sampling(), Sampling::Pixels);
    renderer.render(&scene).unwrap();
    assert_eq!(renderer.last_cost().integrals, all);
    // Light that is negative everywhere cancels nothing.
    scene.spheres[0].coefficient = -1.0;
    assert_eq!(scene.sampling(), Sampling::Tiles);
}

#[test]
fn every_lane_width_paints_the_same_image() {
    let mut scene = common::full_scene(75, 37);
    scene.integration.method = Method::exact(1e-4);
    scene.camera.target = DVec3::new(0.05, 0.02, 0.03);
    let expected = reference::render(&scene).unwrap();
    for lanes in lane_widths() {
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
fn integrals(renderer: &mut Renderer, scene: &Scene, width: u32, height: u32) -> u64 {
    let mut scene = scene.clone();
    scene.image = ImageSize { width, height };
    scene.depth = scene
        .depth
        .map(|depth| common::resized(&depth, scene.image));
    renderer.render(&scene).unwrap();
    renderer.last_cost().integrals
}

/// Whether the light of some sources ends.
fn ends(scene: &Scene) -> bool {
    scene.tori.iter().any(|ring| ring.reach.is_some())
}

/// Returns how many lights all sources have: one, or that of each layer.
fn lights(scene: &Scene) -> u64 {
    let mut count = 0;
    macro_rules! count {
        ($($list:ident),*) => {
            $(scene.$list.iter().for_each(|it| count += it.layers.len().max(1) as u64);)*
        };
    }
    count!(spheres, cylinders, beams, tori, curves, segments, paths);
    count
}

#[test]
fn integrals_grow_with_the_outline_and_not_with_the_pixels() {
    let mut renderer = renderer(common::device().lanes, "");
    for (name, scene) in common::figures(48, common::exact_of) {
        // A level line costs more or less as it lies in the rows of tiles: several heights are summed.
        let mut of_width = |width: u32| -> u64 {
            let heights = [540, 545, 550].map(|height| height * width / 960);
            heights
                .map(|height| integrals(&mut renderer, &scene, width, height))
                .iter()
                .sum()
        };
        let (small, large) = (of_width(960), of_width(1920));
        let growth = large as f64 / small as f64;
        assert!(growth < 2.6, "{name}: {small} to {large}");
        let all = 3 * 1920 * 1080 * lights(&scene);
        // Where light ends tiles are rough too.
        let share = if ends(&scene) { 5 } else { 10 };
        assert!(share * large < all, "{name}: {large} of {all}");
        let pixels = sampled(&scene, Sampling::Pixels);
        assert_eq!(
            integrals(&mut renderer, &pixels, 96, 54),
            96 * 54 * lights(&scene)
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
        integrals(renderer, &scene, 256, 256) as f64 / f64::from(count)
    };
    let (few, many) = (
        per_source(&mut renderer, 16),
        per_source(&mut renderer, 512),
    );
    assert!(many < 1.2 * few, "{few} and {many}");
    assert!(many < 0.1 * 65536.0, "{many} of 65536");
}

/// A ring whose light ends, seen all but edge-on, from cameras that turn a little.
fn rings_with_an_end() -> impl Iterator<Item = Scene> {
    (0..4).map(|turn| {
        let mut scene = common::empty_scene(960, 540);
        scene.integration.method = Method::exact(1e-3);
        scene.decay = None;
        scene.camera.eye = DVec3::new(0.0, -6.0, 1.4);
        scene.camera.target = DVec3::new(0.7 + 0.009 * f64::from(turn), 0.0, 0.1);
        scene.camera.ray_length = Some(16.0);
        scene.tori.push(Torus {
            center: DVec3::new(-0.55, -0.18, 0.06),
            axis: DVec3::new(5.2, -0.9, 0.3),
            profile: Profile::InverseSquare,
            radius: 0.018,
            reach: Some(0.4),
            ..Torus::new(0.85)
        });
        scene
    })
}

#[test]
fn a_tile_that_a_rings_light_only_touches_has_it_and_hasty_steps_to_the_ring_lose_it() {
    let lost = |options: &str| {
        let mut renderer = renderer(common::device().lanes, options);
        let mut draw =
            |scene: &Scene, sampling| renderer.render(&sampled(scene, sampling)).unwrap();
        let lost = rings_with_an_end().map(|scene| {
            let tiles = draw(&scene, Sampling::Tiles);
            let pixels = draw(&scene, Sampling::Pixels);
            let brightest = pixels.as_slice().iter().copied().fold(0.0, f32::max);
            let pairs = tiles.as_slice().iter().zip(pixels.as_slice());
            let is_lost =
                |(tile, pixel): &(&f32, &f32)| **tile == 0.0 && **pixel > 1e-6 * brightest;
            pairs.filter(is_lost).count()
        });
        lost.sum::<usize>()
    };
    let (own, hasty) = (lost(""), lost("-DTORUS_BENDS=0.0f"));
    assert_eq!(own, 0);
    assert!(hasty > 20, "hasty steps lost {hasty} values only");
}

/// A preset with an absolute tolerance, and the light that is taken away.
fn nova(absolute: f64, sign: f64) -> Scene {
    let preset = Preset::ALL.iter().find(|preset| preset.name == "nova");
    let mut scene = Scene::from_toml(preset.unwrap().text).unwrap();
    scene.integration.absolute_tolerance = absolute;
    for sphere in scene.spheres.iter_mut() {
        for layer in &mut sphere.layers {
            layer.color = layer.color.map(|color| sign * color);
        }
    }
    scene
}

#[test]
fn light_may_be_off_by_an_absolute_tolerance_which_saves_integrals_and_keeps_black() {
    const ABSOLUTE: f64 = 3e-4;
    let mut renderer = renderer(common::device().lanes, "");
    let truth = at_tolerance(&nova(0.0, 1.0), 1e-5);
    let truth = renderer.render(&sampled(&truth, Sampling::Pixels)).unwrap();
    let mut draw = |absolute| {
        let image = renderer.render(&nova(absolute, 1.0)).unwrap();
        (image, renderer.last_cost().integrals)
    };
    // By how many times the absolute tolerance values are off beyond the relative one: of 99.9 %, and at most.
    let beyond = |image: &RadianceImage| {
        let pairs = image.as_slice().iter().zip(truth.as_slice());
        let excess = pairs.map(|(value, truth)| (value - truth).abs() - 1e-2 * truth);
        let mut excess: Vec<f32> = excess.map(|it| it / ABSOLUTE as f32).collect();
        excess.sort_by(f32::total_cmp);
        (excess[excess.len() * 999 / 1000], excess[excess.len() - 1])
    };
    let ((strict, all), (own, fewer), (wide, _)) = (draw(0.0), draw(ABSOLUTE), draw(1.0));
    let found = [&strict, &own, &wide].map(beyond);
    assert!(fewer < all * 4 / 5, "{fewer} of {all}");
    assert!(found[0].1 <= 0.0 && found[1].1 < 1.0, "{found:?}");
    assert!(found[2].0 > 1.0, "{found:?}");
    assert!(own.as_slice().iter().all(|value| *value >= 0.0));
    // Black stays black, but where a tile's light ends between its nodes.
    let pairs = own.as_slice().iter().zip(truth.as_slice());
    let is_lit = |(value, truth): &(&f32, &f32)| **truth == 0.0 && **value > 1e-9;
    let lit = pairs.filter(is_lit).count();
    assert!(
        lit * 10_000 < truth.as_slice().len(),
        "{lit} of black are lit"
    );
    // Where light is taken away, nothing may be clamped, and errors stay relative.
    let mut draw = |absolute| renderer.render(&nova(absolute, -1.0)).unwrap();
    assert_eq!(draw(ABSOLUTE).as_slice(), draw(0.0).as_slice());
}
