//! Stratified samples against their definition in float64, and what they gain.

use crate::common::{self, WORST_PIXEL, difference, renderer};
use energywave::image::{DepthAlong, compare};
use energywave::scene::{Absorption, Decay, Method};
use energywave::{Device, RadianceImage, Ray, Renderer, Scene};
use glam::DVec3;

fn jittered(divisions: u32, seed: u32) -> Method {
    Method::Jittered { divisions, seed }
}

fn device() -> Renderer {
    renderer(common::device().lanes, "")
}

fn reference() -> Renderer {
    Renderer::new(&Device::reference()).unwrap()
}

/// A ring, a point and a curve with a series.
fn scene() -> Scene {
    let mut scene = common::empty_scene(31, 17);
    scene
        .tori
        .push(common::torus([0.1, 0.0, 0.0], [0.1, 0.2, 2.0], 0.9));
    scene.spheres.push(common::sphere([0.4, 0.3, 0.5], 1.5));
    let series = vec![1.0, 0.2, 0.6, 1.0];
    scene
        .curves
        .push(common::curve(common::CURVE_SHAPES[0], Some(series)));
    scene.integration.method = jittered(64, 5);
    scene
}

/// The largest relative difference of a pixel from the reference's.
fn off(renderer: &mut Renderer, scene: &Scene) -> f64 {
    let expected = reference().render(scene).unwrap();
    difference(&renderer.render(scene).unwrap(), &expected).max
}

#[test]
fn the_devices_samples_are_the_references() {
    let plain = scene();
    let mut hidden = scene();
    let wall = |column: u32, _| if column < 15 { 3.2 } else { f64::INFINITY };
    hidden.depth = Some(common::depths(&hidden, DepthAlong::Ray, wall));
    let mut faded = scene();
    faded.decay = Some(Decay {
        power: 1,
        ..Decay::new(0.1, 0.1)
    });
    faded.absorption = Some(Absorption { kappa: 0.3 });
    let mut endless = scene();
    endless.decay = None;
    for (scene, what) in [
        (&plain, "plain"),
        (&hidden, "depths"),
        (&faded, "fading"),
        (&endless, "no decay"),
    ] {
        let found = off(&mut device(), scene);
        assert!(found < WORST_PIXEL, "{what}: {found:e}");
    }
    let spoiled = off(
        &mut renderer(common::device().lanes, common::BROKEN_FIELDS),
        &plain,
    );
    assert!(spoiled > WORST_PIXEL, "a spoiled field passed: {spoiled:e}");
    let mut other = plain.clone();
    other.integration.method = jittered(64, 6);
    let image = device().render(&other).unwrap();
    let found = difference(&image, &reference().render(&plain).unwrap()).max;
    assert!(
        found > WORST_PIXEL,
        "other random numbers passed: {found:e}"
    );
}

#[test]
fn every_lane_width_has_the_same_random_numbers() {
    for lanes in common::lane_widths() {
        let found = off(&mut renderer(lanes, ""), &scene());
        assert!(found < WORST_PIXEL, "{lanes} lanes: {found:e}");
    }
}

#[test]
fn any_number_of_divisions_works() {
    let mut renderer = device();
    let mut scene = scene();
    scene.image.height = 3;
    for divisions in [1, 2, 7, 255, 256, 257, 65536] {
        scene.integration.method = jittered(divisions, 1);
        let found = off(&mut renderer, &scene);
        assert!(found < WORST_PIXEL, "{divisions}: {found:e}");
    }
}

#[test]
fn a_seed_has_its_own_picture_and_always_the_same() {
    let mut renderer = device();
    let mut draw = |seed| {
        let mut scene = scene();
        scene.integration.method = jittered(64, seed);
        renderer.render(&scene).unwrap()
    };
    let first = draw(0);
    for seed in [1, 2, u32::MAX] {
        let other = draw(seed);
        // 31 pixels a row: another seed is no shift of the pattern.
        for shift in 0..3 {
            let pairs = first.as_slice()[4 * shift..].iter().zip(other.as_slice());
            let same = pairs.filter(|(a, b)| a == b && **a != 1.0).count();
            assert!(same < 30, "{seed}, {shift}: {same} values are equal");
        }
    }
    assert!(draw(0) == first);
}

#[test]
fn rays_of_a_list_have_the_random_numbers_of_their_places() {
    let scene = scene();
    let ray = Ray::between(DVec3::new(0.3, -3.0, 1.6), DVec3::new(-0.4, 9.0, -4.0));
    let rays = [ray; 40];
    let found = device().integrate(&scene, &rays).unwrap();
    let expected = reference().integrate(&scene, &rays).unwrap();
    for (found, expected) in found.iter().zip(&expected) {
        let error = (found[0] / expected[0] - 1.0).abs();
        assert!(error < WORST_PIXEL, "{found:?} {expected:?}");
    }
    let mut distinct: Vec<f64> = found.iter().map(|light| light[0]).collect();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    assert_eq!(distinct.len(), rays.len());
}

/// Mean light of 5x5 pixels, block by block.
fn means(image: &RadianceImage) -> RadianceImage {
    let mut size = image.size();
    (size.width, size.height) = (size.width / 5, size.height / 5);
    let mut means = RadianceImage::new(size).unwrap();
    for (index, mean) in means.as_mut_slice().chunks_exact_mut(4).enumerate() {
        let (column, row) = (index as u32 % size.width, index as u32 / size.width);
        for place in 0..25 {
            let pixel = image.pixel(5 * column + place % 5, 5 * row + place / 5);
            mean.iter_mut()
                .zip(pixel.unwrap())
                .for_each(|(mean, value)| *mean += value / 25.0);
        }
    }
    means
}

#[test]
fn the_mean_over_pixels_is_closer_to_the_integral_than_that_of_simpsons_rule() {
    let mut renderer = device();
    let mut scene = Scene::from_toml(include_str!("../../scenes/figure-14.toml")).unwrap();
    let mut draw = |method| {
        scene.integration.method = method;
        renderer.render(&scene).unwrap()
    };
    let truth = draw(Method::exact(1e-4));
    let [simpson, own] = [Method::simpson(64), jittered(64, 0)].map(&mut draw);
    let rms = |a: &RadianceImage, b: &RadianceImage| compare(a, b).unwrap().rms;
    let (of_pixels, of_means) = (rms(&own, &truth), rms(&means(&own), &means(&truth)));
    let of_simpson = rms(&means(&simpson), &means(&truth));
    println!("pixels {of_pixels:e}, means {of_means:e}, of Simpson's rule {of_simpson:e}");
    // Of 25 independent errors the mean has a fifth; those of rings nearly all.
    assert!(of_means < 0.3 * of_pixels && of_means < 0.5 * of_simpson);
}
