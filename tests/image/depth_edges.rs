//! Depths finer than pixels: an edge of what hides the light is as smooth as the mean of many rays.

use energywave::image::{DepthAlong, DepthImage, ImageSize};
use energywave::scene::{Method, Sampling, Sphere, Torus};
use energywave::{Device, RadianceImage, Renderer, RendererOptions, Scene, reference};
use glam::DVec3;

use crate::common::{self, difference, renderer, sampled};

/// Depths across and down in a pixel.
const ACROSS: u32 = 4;

/// What the mean of rays beside each other differs from one ray through the middle, half of which may be hidden: a
/// quarter of what the light changes from pixel to pixel, which here is up to 2 %.
const SMOOTH: f64 = 5e-3;

fn scene() -> Scene {
    let mut scene = common::empty_scene(60, 44);
    scene.integration.method = Method::exact(1e-4);
    scene.spheres.push(Sphere {
        center: DVec3::new(0.3, 0.4, 0.2),
        radius: 0.8,
        ..Sphere::default()
    });
    scene.tori.push(Torus {
        radius: 0.7,
        ..Torus::new(0.9)
    });
    scene
}

/// A disc before the light, a slope behind it, and nothing beyond an edge that leans.
fn depth_at(scene: &Scene, across: u32, column: u32, row: u32) -> f64 {
    let distance = scene.camera.eye.length();
    let at = |number: u32| (f64::from(number) + 0.5) / f64::from(across);
    let (x, y) = (at(column), at(row));
    match () {
        () if (x - 18.3).hypot(y - 20.6) < 9.7 => 0.8 * distance,
        () if x + 0.3 * y < 50.2 => distance + 0.02 * y,
        () => f64::INFINITY,
    }
}

fn depths(scene: &Scene, across: u32) -> DepthImage {
    let mut fine = scene.clone();
    fine.image = ImageSize {
        width: across * scene.image.width,
        height: across * scene.image.height,
    };
    common::depths(&fine, DepthAlong::Ray, |column, row| {
        depth_at(scene, across, column, row)
    })
}

/// The means of as many rays as there are depths.
fn truth(scene: &Scene) -> RadianceImage {
    let mut fine = scene.clone();
    fine.image.width *= ACROSS;
    fine.image.height *= ACROSS;
    fine.depth = Some(depths(scene, ACROSS));
    let fine = reference::render(&fine).unwrap();
    let mut means = RadianceImage::new(scene.image).unwrap();
    let width = scene.image.width as usize;
    let share = 1.0 / (ACROSS * ACROSS) as f32;
    for (index, pixel) in fine.as_slice().chunks_exact(4).enumerate() {
        let across = ACROSS as usize;
        let (column, row) = (index % (across * width), index / (across * width));
        let at = 4 * (row / across * width + column / across);
        let mean = &mut means.as_mut_slice()[at..at + 4];
        mean.iter_mut()
            .zip(pixel)
            .for_each(|(mean, light)| *mean += share * light);
    }
    means
}

fn with_depths(scene: &Scene, across: u32) -> Scene {
    let mut scene = scene.clone();
    scene.depth = Some(depths(&scene, across));
    scene
}

#[test]
fn edges_are_the_means_of_many_rays_and_a_depth_for_each_pixel_is_not() {
    let scene = scene();
    let truth = truth(&scene);
    let mut renderer = renderer(common::device().lanes, "");
    for sampling in [Sampling::Pixels, Sampling::Tiles] {
        let fine = sampled(&with_depths(&scene, ACROSS), sampling);
        let image = renderer.render(&fine).unwrap();
        let found = difference(&image, &truth);
        assert!(found.max < SMOOTH, "{sampling:?}: {found:?}");
        let coarse = sampled(&with_depths(&scene, 1), sampling);
        let found = difference(&renderer.render(&coarse).unwrap(), &truth);
        assert!(found.max > 0.2, "{sampling:?}: {found:?}");

        // However it is asked for, and where nothing is left of the last frame.
        assert_eq!(&*renderer.render_mapped(&fine).unwrap(), image.as_slice());
        let cost = renderer.last_cost();
        assert!(cost.launches > 1 && cost.integrals > 0, "{cost:?}");
        let mut rows = vec![7.0; 300 * 44];
        renderer.render_rows(&fine, 0..44, &mut rows, 300).unwrap();
        for (row, light) in rows.chunks(300).zip(image.as_slice().chunks(4 * 60)) {
            assert_eq!(&row[..240], light);
            assert!(row[240..].iter().all(|value| *value == 7.0));
        }
    }
    let fine = with_depths(&scene, ACROSS);
    let found = difference(&reference::render(&fine).unwrap(), &truth);
    assert!(found.max < SMOOTH, "{found:?}");
    let mut host =
        Renderer::with_options(&Device::reference(), &RendererOptions::default()).unwrap();
    let image = host.render(&fine).unwrap();
    assert_eq!(image, reference::render(&fine).unwrap());
}

#[test]
fn depths_that_are_equal_within_each_pixel_change_no_bit() {
    let mut renderer = renderer(common::device().lanes, "");
    let scene = scene();
    let coarse = with_depths(&scene, 1);
    let mut repeated = coarse.clone();
    let mut fine = scene.clone();
    (fine.image.width, fine.image.height) = (120, 88);
    repeated.depth = Some(common::depths(&fine, DepthAlong::Ray, |column, row| {
        depth_at(&scene, 1, column / 2, row / 2)
    }));
    let image = renderer.render(&coarse).unwrap();
    assert_eq!(renderer.render(&repeated).unwrap(), image);
    // One renderer, other depths of the same scene.
    let other = renderer.render(&with_depths(&scene, 2)).unwrap();
    assert_ne!(other, image);
    assert_eq!(renderer.render(&repeated).unwrap(), image);
}

#[test]
fn sizes_that_do_not_fit_are_told() {
    let mut scene = scene();
    for (width, height) in [(61, 44), (120, 44), (120, 132), (540, 396), (30, 22)] {
        let size = ImageSize { width, height };
        let values = vec![1.0; size.pixels()];
        scene.depth = Some(DepthImage::new(size, DepthAlong::Ray, values).unwrap());
        let message = scene.validate().unwrap_err().to_string();
        assert!(
            message.contains("must be equal, or the depths 2 to 8 times as many across and down"),
            "{message}"
        );
    }
}
