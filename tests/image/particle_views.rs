//! Particles, streaks and surfaces through cameras of engines, parallel ones among them; with a bloom, and while a
//! shutter is open.

use std::ops::Range;

use energywave::image::Bloom;
use energywave::scene::{AnimatedScene, Camera};
use energywave::{RadianceImage, Renderer, Scene, reference};
use glam::dcamera as camera;
use glam::{DMat4, DVec3};

use super::particles::worst;
use super::particles::{FAR, OF_PIXEL, OF_STREAK, SIZE, cloud, expect_true, renderer, streaks};
use super::shutter;
use crate::common::metaballs;

/// What the light of a bloom may be off on another device than the host.
const BLOOM: f32 = 1e-5;

/// What a blurred frame may be off the mean of 256, and what a frame at the beginning is off at least.
const CLOSE: f32 = 1e-3;
const MOVED: f32 = 0.05;

/// Cameras at an eye that look at the origin, and whether they are parallel.
fn cameras(eye: DVec3) -> Vec<(&'static str, Camera)> {
    use camera::rh::proj as rhp;
    let view = camera::rh::view::look_at_mat4(eye, DVec3::ZERO, DVec3::Z);
    let left_handed = camera::lh::view::look_at_mat4(eye, DVec3::ZERO, DVec3::Z);
    let aspect = f64::from(SIZE.width) / f64::from(SIZE.height);
    let (side, height) = (2.2 * aspect, 2.2);
    let matrices = |view: DMat4, projection: DMat4| Camera::from_matrices(view, projection);
    vec![
        (
            "vulkan",
            matrices(view, rhp::vulkan::perspective(0.6, aspect, 0.3, 40.0)),
        ),
        (
            "reversed, left-handed",
            matrices(
                left_handed,
                camera::lh::proj::directx::perspective_infinite_reverse(0.6, aspect, 0.3),
            ),
        ),
        (
            "off-centre",
            matrices(
                view,
                rhp::directx::frustum(-0.13, 0.07, -0.06, 0.11, 0.3, 40.0),
            ),
        ),
        (
            "sheared",
            matrices(
                view,
                DMat4::from_cols_array(&[
                    1.0, 0.0, 0.0, 0.0, 0.35, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
                ]) * rhp::vulkan::perspective(0.6, aspect, 0.3, 40.0),
            ),
        ),
        (
            "parallel",
            matrices(
                view,
                rhp::directx::orthographic(-side, side, -height, height, 0.3, 40.0),
            ),
        ),
        (
            "parallel, off-centre",
            matrices(
                view,
                rhp::directx::orthographic(-1.4, 3.0, -height, 1.5, 0.3, 40.0),
            ),
        ),
    ]
}

/// Cameras whose rows and columns lean, both of them.
fn leaning_cameras(eye: DVec3) -> Vec<(&'static str, Camera)> {
    use camera::rh::proj as rhp;
    let view = camera::rh::view::look_at_mat4(eye, DVec3::ZERO, DVec3::Z);
    let (side, height) = (3.0, 2.2);
    let matrices = |view: DMat4, projection: DMat4| Camera::from_matrices(view, projection);
    vec![
        (
            "sheared both ways, off-centre",
            matrices(
                view,
                DMat4::from_cols_array(&[
                    1.0, -0.2, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
                ]) * rhp::directx::frustum(-0.13, 0.07, -0.06, 0.11, 0.3, 40.0),
            ),
        ),
        (
            "parallel, sheared",
            matrices(
                view,
                DMat4::from_cols_array(&[
                    1.0, 0.1, 0.0, 0.0, -0.4, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
                ]) * rhp::directx::orthographic(-side, side, -height, height, 0.3, 40.0),
            ),
        ),
    ]
}

fn through(mut scene: Scene, camera: Camera) -> Scene {
    scene.camera = Camera {
        ray_length: scene.camera.ray_length,
        ..camera
    };
    scene
}

#[test]
fn cameras_of_engines_see_particles_as_float64_does() {
    let mut renderer = renderer("");
    for (name, camera) in cameras(FAR).into_iter().chain(leaning_cameras(FAR)) {
        let balls = through(cloud(FAR), camera.clone());
        expect_true(name, &mut renderer, &balls, OF_PIXEL);
        let streaks = through(streaks(FAR), camera);
        expect_true(name, &mut renderer, &streaks, OF_STREAK);
        // Another camera at the same place sees something else.
        let truth = reference::render(&balls).unwrap();
        let worst = worst(&mut renderer, &cloud(FAR), &truth, OF_PIXEL);
        assert!(worst > 1e3, "{name}: {worst}");
    }
}

#[test]
fn cameras_of_engines_see_surfaces_as_float64_does() {
    let block = metaballs::block(0.45, 0.25);
    let mut renderer = renderer("");
    let others = metaballs::truth(&block);
    for (name, camera) in cameras(block.camera.eye) {
        let scene = through(block.clone(), camera);
        let errors = metaballs::expect_true(name, &mut renderer, &scene);
        assert!(errors.hits > 1000, "{name}: {errors:?}");
        let errors = metaballs::errors(&mut renderer, &scene, &others);
        assert!(!errors.are_small(), "{name}: {errors:?}");
    }
}

#[test]
fn particles_and_streaks_have_the_bloom_of_the_host() {
    let mut renderer = renderer("");
    let mut scene = streaks(FAR);
    scene.particles = cloud(FAR).particles;
    let without = renderer.render(&scene).unwrap();
    let bloom = Bloom::new(0.5);
    scene.display.bloom = Some(bloom);
    renderer.spread_bloom(true);
    let found = renderer.render(&scene).unwrap();
    let expected = without.bloomed(&bloom).unwrap();
    let off = |image: &RadianceImage| {
        let pairs = image.as_slice().iter().zip(expected.as_slice());
        let off = pairs.map(|(found, expected)| (found - expected).abs() / expected.max(1e-3));
        off.fold(0.0, f32::max)
    };
    assert!(off(&found) < BLOOM, "{:e}", off(&found));
    assert!(off(&without) > 1e3 * BLOOM, "{:e}", off(&without));
}

/// By how much of itself, and of 0.5 % of the brightest, a pixel is off, of 99.9 % of them.
fn off(found: &RadianceImage, expected: &RadianceImage) -> f32 {
    let floor = 0.005 * expected.as_slice().iter().copied().fold(0.0, f32::max);
    let pairs = found.as_slice().iter().zip(expected.as_slice());
    let off = pairs.map(|(found, expected)| (found - expected).abs() / (expected + floor));
    let mut off: Vec<f32> = off.collect();
    off.sort_by(f32::total_cmp);
    off[off.len() - off.len() / 1000 - 1]
}

/// Compares a blurred frame with the mean of many, and says how far that is from the frame at the beginning.
fn expect_blurred(renderer: &mut Renderer, name: &str, scene: &AnimatedScene, times: &Range<f64>) {
    let expected = shutter::mean(renderer, scene, times, 256);
    let blurred = renderer.render_shutter(scene, times.clone()).unwrap();
    let moments = renderer.last_moments();
    let first = renderer.render(&scene.at(times.start).unwrap()).unwrap();
    let (found, sharp) = (off(&blurred, &expected), off(&first, &expected));
    println!("{name}: {moments} moments, {found:e}; one {sharp:e}");
    assert!(found <= CLOSE, "{name}, {moments} moments: {found:e}");
    assert!(sharp > MOVED, "{name}: {sharp:e}");
}

#[test]
fn particles_that_move_are_blurred_as_the_mean_of_256_frames_is() {
    let scene = shutter::scene(
        "[camera]\neye = [0, -6, 1]\ntarget = [0, 0, 0]\n[[particles]]\nradius = 0.5\n\
         lattice = { count = 60, columns = [4, 5], spacing = 0.6, jitter = 0.5 }\n\
         translate = { times = [0, 1], values = [[0, 0, 0], [12, 0, 9]] }\n",
    );
    let times = scene.open_at(0.0, 24.0);
    expect_blurred(&mut renderer(""), "particles", &scene, &times);
}

#[test]
fn waves_that_hit_things_are_blurred_as_the_mean_of_256_frames_is() {
    let scene = shutter::scene(
        "[camera]\neye = [-120, -95, 50]\ntarget = [-12, 0, 0]\n[[wave]]\norigin = [-50, 0, 0]\n\
         direction = [1, 0, 0]\n[[collider]]\nbox = { center = [8, 0, 0], half = [8, 22, 22] }\nvisible = true\n",
    );
    let times = scene.open_at(1.0, 24.0);
    expect_blurred(&mut renderer(""), "waves", &scene, &times);
}
