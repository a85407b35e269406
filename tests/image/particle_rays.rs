//! Light of particles along single rays against the pixels of the device: a ray is given what its pixel shows.

use energywave::scene::Antialias;
use energywave::{Device, Ray, Renderer, Scene};
use glam::DVec3;

use crate::particles::{OF_STREAK, cloud, renderer, splash, streaks};

/// What float32 leaves of a pixel besides its share, of the brightest.
const OF_BRIGHTEST: f64 = 2e-5;

/// Every so many pixels are compared.
const STEP: usize = 31;

/// Returns the rays through some pixels, moved aside by so many columns.
fn rays(scene: &Scene, columns: u32) -> Vec<Ray> {
    let plane = scene.view_plane();
    let width = scene.image.width;
    let through = |index: u32| plane.ray(index % width + columns, index / width);
    (0..scene.image.pixels() as u32)
        .step_by(STEP)
        .map(through)
        .collect()
}

/// Returns how many values of rays differ from those of their pixels, and how many are light.
fn differing(lights: &[[f64; 3]], pixels: &[f32]) -> (usize, usize) {
    let brightest = pixels
        .iter()
        .fold(0.0, |most, it| f64::max(most, (*it).into()));
    let pixels = pixels.chunks(4).step_by(STEP);
    let pairs = lights
        .iter()
        .zip(pixels)
        .flat_map(|(light, pixel)| light.iter().zip(&pixel[..3]));
    let off = |(light, pixel): &(&f64, &f32)| {
        (f64::from(**pixel) - **light).abs() > OF_STREAK * light.abs() + OF_BRIGHTEST * brightest
    };
    let lit = lights.iter().filter(|light| light[0] > 0.0).count();
    (pairs.filter(off).count(), lit)
}

#[test]
fn single_rays_are_given_the_light_of_their_pixels() {
    let mut device = renderer("");
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    let eye = DVec3::new(1.0, -7.0, 2.0);
    let mut wave = splash(40.0);
    wave.colliders[0].visible = false; // no surface hides light from single rays
    for (name, mut scene) in [
        ("balls", cloud(eye)),
        ("streaks", streaks(eye)),
        ("waves", wave),
    ] {
        scene.integration.antialias = Antialias::None;
        let shown = device.render(&scene).unwrap();
        for renderer in [&mut device, &mut reference] {
            let along = renderer.integrate(&scene, &rays(&scene, 0)).unwrap();
            let (off, lit) = differing(&along, shown.as_slice());
            assert!(off == 0 && lit > 5, "{name}: {off} differ, {lit} are lit");
        }
        // Of the pixels beside them the light is another.
        let beside = device.integrate(&scene, &rays(&scene, 1)).unwrap();
        assert!(differing(&beside, shown.as_slice()).0 > 5, "{name}");
    }
}
