//! A scene that names nothing but its sources is a picture, and as bright whatever the rays' length and the way there.

use energywave::image::ImageSize;
use energywave::scene::{Camera, Measure, Profile, Torus};
use energywave::{RadianceImage, Scene, reference};
use glam::DVec3;

use crate::common::difference;

/// A camera and a ring: the smallest scene, and its picture from so many times as far with as much less of an angle.
fn ring(times: f64) -> Scene {
    let camera = "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n";
    let mut scene = Scene::from_toml(&format!("{camera}[[torus]]\nmajor_radius = 1\n")).unwrap();
    scene.image = ImageSize {
        width: 48,
        height: 48,
    };
    scene.camera.eye *= times;
    let half = (scene.camera.fov_y.to_radians() / 2.0).tan() / times;
    scene.camera.fov_y = 2.0 * half.atan().to_degrees();
    scene
}

fn draw(scene: &Scene) -> RadianceImage {
    reference::render(scene).unwrap()
}

#[test]
fn the_smallest_scene_is_a_bright_line_in_a_faint_halo() {
    let scene = ring(1.0);
    let mut in_code = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 2.0), DVec3::ZERO));
    in_code.image = scene.image;
    in_code.tori.push(Torus::new(1.0));
    in_code.display.exposure = in_code.fitting_exposure().into();
    assert_eq!(in_code, scene);
    let shares = |scene: &Scene| {
        let shown = draw(scene).tone_map(&scene.display);
        let pixels = shown.as_slice().chunks_exact(4).map(|pixel| pixel[0]);
        let count = |is_such: fn(u8) -> bool| {
            pixels.clone().filter(|value| is_such(*value)).count() as f64 / 2304.0
        };
        (count(|value| value > 160), count(|value| value < 120))
    };
    let brighter = |times: f64| {
        let mut scene = scene.clone();
        scene.tori[0].coefficient *= times;
        scene.fitting_exposure()
    };
    assert!((brighter(8.0) - brighter(1.0) + 3.0).abs() < 1e-12);
    let is_kept = |(bright, dark): (f64, f64)| (0.02..0.2).contains(&bright) && dark > 0.6;
    assert!(is_kept(shares(&scene)), "{:?}", shares(&scene));
    // What the papers leave is fog.
    let mut paper = scene;
    (paper.tori[0].profile, paper.tori[0].coefficient) = (Profile::Inverse, 1.0);
    paper.integration.measure = Measure::Parameter;
    assert!(!is_kept(shares(&paper)), "{:?}", shares(&paper));
}

#[test]
fn longer_rays_and_a_longer_way_change_brightness_by_a_few_percent_and_that_of_a_reach_not_at_all()
{
    let change = |scene: &Scene, other: &Scene| difference(&draw(other), &draw(scene)).max;
    let longer = |scene: &Scene| {
        let mut longer = scene.clone();
        longer.camera.ray_length = Some(3.0 * scene.ray_length());
        longer
    };
    let scene = ring(1.0);
    let by_length = change(&scene, &longer(&scene));
    // From farther away the ring is another ellipse: what counts is all of its light.
    let mean = |scene: &Scene| draw(scene).as_slice().iter().sum::<f32>();
    let by_way = mean(&ring(4.0)) / mean(&scene) - 1.0;
    println!("{by_length:.3} by longer rays, {by_way:.3} by a longer way");
    assert!(by_length < 0.05 && by_way.abs() < 0.2);
    let bounded = || {
        let mut scene = ring(1.0);
        (scene.tori[0].radius, scene.tori[0].reach) = (0.05, Some(0.8));
        scene
    };
    let scene = bounded();
    let bounded = change(&scene, &longer(&scene));
    assert!(bounded < 1e-6, "{bounded}");
    let mut by_parameter = scene;
    by_parameter.integration.measure = Measure::Parameter;
    assert!(change(&by_parameter, &longer(&by_parameter)) > 0.5);
}
