//! Surfaces among light: they hide what is behind them, shine by themselves, and have smooth edges.

use energywave::image::{Bloom, DepthAlong, DepthImage, ImageSize};
use energywave::internals::see_surfaces;
use energywave::scene::{
    Antialias, Camera, Lattice, Metaballs, Method, PointList, Sampling, Sphere,
};
use energywave::{Device, RadianceImage, Renderer, Scene, reference};
use glam::DVec3;

use crate::common::{self, device};

/// What adding up in another order may change.
const ROUNDING: f32 = 1e-5;

/// A block of particles before the eye, and light behind and before it.
fn scene() -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.4, -6.0, 2.0), DVec3::ZERO));
    scene.image = ImageSize {
        width: 96,
        height: 70,
    };
    scene.integration.antialias = Antialias::None;
    let lattice = Lattice {
        columns: [5, 3],
        jitter: 0.2,
        ..Lattice::new(45, 0.5)
    };
    let mut surface = Metaballs::new(PointList::lattice(&lattice).unwrap(), 0.8);
    surface.color = DVec3::new(0.2, 0.3, 0.5);
    scene.metaballs.push(surface);
    scene
}

fn glow(y: f64) -> Sphere {
    Sphere {
        center: DVec3::new(0.2, y, 0.1),
        radius: 0.3,
        reach: Some(1.0),
        ..Sphere::default()
    }
}

fn renderer() -> Renderer {
    common::renderer(device().lanes, "")
}

fn pixels(image: &RadianceImage) -> &[[f32; 4]] {
    image.as_slice().as_chunks().0
}

fn are_like(found: &RadianceImage, expected: &RadianceImage) -> bool {
    let mut pairs = found.as_slice().iter().zip(expected.as_slice());
    pairs.all(|(found, expected)| (found - expected).abs() <= ROUNDING * (1.0 + expected.abs()))
}

#[test]
fn light_behind_a_surface_is_hidden_and_light_before_it_is_not() {
    let mut renderer = renderer();
    let alone = renderer.render(&scene()).unwrap();
    let (lengths, _) = see_surfaces(&mut renderer, &scene()).unwrap();
    let with = |y: f64| {
        let mut scene = scene();
        scene.spheres.push(glow(y));
        scene
    };
    let behind = renderer.render(&with(3.5)).unwrap();
    let before = renderer.render(&with(-3.0)).unwrap();
    let (mut hits, mut lit, mut beside) = (0, 0, 0);
    for (index, length) in lengths.iter().enumerate() {
        let [alone, behind, before] =
            [&alone, &behind, &before].map(|image| pixels(image)[index][0]);
        if length.is_finite() {
            hits += 1;
            assert_eq!(behind, alone);
            lit += usize::from(before > alone + 1e-3);
        } else {
            beside += usize::from(behind > 1e-3);
        }
    }
    assert!(
        hits > 600 && lit > 100 && beside > 100,
        "{hits} {lit} {beside}"
    );
}

#[test]
fn a_surface_is_a_depth_and_a_light() {
    for antialias in [Antialias::None, Antialias::Footprint] {
        for sampling in [Sampling::Pixels, Sampling::Tiles] {
            let mut renderer = renderer();
            let mut whole = scene();
            whole.integration.antialias = antialias;
            whole.integration.method = Method::Exact {
                tolerance: 1e-3,
                sampling,
            };
            whole.spheres.extend([glow(0.0), glow(2.0)]);
            let (lengths, light) = see_surfaces(&mut renderer, &whole).unwrap();
            let across = if antialias == Antialias::None { 1 } else { 4 };
            let size = ImageSize {
                width: across * whole.image.width,
                height: across * whole.image.height,
            };
            let mut apart = whole.clone();
            apart.metaballs.clear();
            apart.depth = Some(DepthImage::new(size, DepthAlong::Ray, lengths).unwrap());
            let mut expected = renderer.render(&apart).unwrap();
            for (to, from) in expected.as_mut_slice().chunks_mut(4).zip(light.chunks(4)) {
                (0..3).for_each(|channel| to[channel] += from[channel]);
            }
            let found = renderer.render(&whole).unwrap();
            assert!(are_like(&found, &expected), "{antialias:?} {sampling:?}");
            let mapped = renderer.render_mapped(&whole).unwrap().to_vec();
            assert!(mapped == found.as_slice());
            let row = 4 * whole.image.width as usize;
            let mut rows = vec![0.0; 30 * row];
            renderer
                .render_rows(&whole, 16..46, &mut rows, row)
                .unwrap();
            let differs = rows
                .iter()
                .zip(&found.as_slice()[16 * row..])
                .filter(|(a, b)| (*a - *b).abs() > 2e-3);
            assert_eq!(differs.count(), 0);
        }
    }
}

#[test]
fn edges_are_the_mean_of_many_rays() {
    let mut renderer = renderer();
    let mut smooth = scene();
    smooth.integration.antialias = Antialias::Footprint;
    let found = renderer.render(&smooth).unwrap();
    let mut fine = scene();
    fine.image.width *= 4;
    fine.image.height *= 4;
    let fine = renderer.render(&fine).unwrap();
    let width = smooth.image.width as usize;
    let mut mixed = 0;
    for (index, pixel) in pixels(&found).iter().enumerate() {
        let (column, row) = (index % width * 4, index / width * 4);
        let rays =
            (0..16).map(|ray| pixels(&fine)[(row + ray / 4) * 4 * width + column + ray % 4][2]);
        let rays: Vec<f32> = rays.collect();
        let mean = rays.iter().sum::<f32>() / 16.0;
        assert!(
            (pixel[2] - mean).abs() < 1e-5,
            "{index}: {} {mean}",
            pixel[2]
        );
        mixed += usize::from(rays.contains(&0.0) && mean > 0.0);
    }
    assert!(mixed > 60, "{mixed}");
}

#[test]
fn given_depths_hide_surfaces_and_choose_their_rays() {
    let mut renderer = renderer();
    let scene = scene();
    let (open, _) = see_surfaces(&mut renderer, &scene).unwrap();
    for (across, along) in [
        (1, DepthAlong::Ray),
        (3, DepthAlong::Ray),
        (2, DepthAlong::Axis),
    ] {
        let mut hidden = scene.clone();
        let size = ImageSize {
            width: across * scene.image.width,
            height: across * scene.image.height,
        };
        let half = |index: u32| {
            if index % size.width < size.width / 2 {
                3.0
            } else {
                f32::INFINITY
            }
        };
        let depths: Vec<f32> = (0..size.pixels() as u32).map(half).collect();
        hidden.depth = Some(DepthImage::new(size, along, depths.clone()).unwrap());
        let (lengths, light) = see_surfaces(&mut renderer, &hidden).unwrap();
        assert_eq!(lengths.len(), size.pixels());
        let pairs = lengths.iter().zip(&depths);
        assert!(pairs.clone().all(|(found, given)| found <= given));
        assert!(
            pairs
                .clone()
                .all(|(found, given)| *given != 3.0 || *found == 3.0)
        );
        let width = scene.image.width as usize;
        for (index, pixel) in light.chunks(4).enumerate() {
            assert!(index % width >= width / 2 || pixel[..3] == [0.0; 3]);
        }
        let seen = pairs.filter(|(found, given)| found < given).count();
        let right = open
            .iter()
            .enumerate()
            .filter(|(index, length)| index % width >= width / 2 && length.is_finite());
        let expected = right.count() * (across * across) as usize;
        assert!(seen.abs_diff(expected) * 50 < expected, "{seen} {expected}");
    }
}

#[test]
fn the_nearest_of_several_surfaces_is_seen() {
    let mut renderer = renderer();
    let near = PointList::new(vec![DVec3::new(0.0, -2.0, 0.6)]).unwrap();
    let mut second = Metaballs::new(near, 3.0);
    second.color = DVec3::X;
    let mut alone = scene();
    alone.metaballs.clear();
    alone.metaballs.push(second.clone());
    let (first, _) = see_surfaces(&mut renderer, &scene()).unwrap();
    let (alone, red) = see_surfaces(&mut renderer, &alone).unwrap();
    for swap in [false, true] {
        let mut both = scene();
        both.metaballs.push(second.clone());
        if swap {
            both.metaballs.swap(0, 1);
        }
        let (found, light) = see_surfaces(&mut renderer, &both).unwrap();
        for (index, length) in found.iter().enumerate() {
            let expected = first[index].min(alone[index]);
            assert!(
                (length - expected).abs() < 1e-4 || *length == expected,
                "{index}: {length} {expected}"
            );
            if alone[index] < first[index] {
                assert!((light[4 * index] - red[4 * index]).abs() < 1e-4);
            }
        }
    }
}

#[test]
fn the_reference_draws_the_same_picture() {
    let mut scene = scene();
    scene.spheres.extend([glow(0.0), glow(2.0)]);
    scene.image.width = 48;
    scene.image.height = 35;
    for antialias in [Antialias::None, Antialias::Footprint] {
        scene.integration.antialias = antialias;
        let expected = reference::render(&scene).unwrap();
        let found = renderer().render(&scene).unwrap();
        let device = Renderer::new(&Device::reference())
            .unwrap()
            .render(&scene)
            .unwrap();
        for image in [&found, &device] {
            let off = pixels(image).iter().zip(pixels(&expected));
            let off =
                off.filter(|(a, b)| (0..3).any(|k| (a[k] - b[k]).abs() > 2e-2 * (0.1 + b[k])));
            let off: Vec<_> = off.collect();
            println!("{antialias:?}: {} {:?}", off.len(), off.first());
            assert!(off.len() < 5);
        }
    }
}

#[test]
fn a_bloom_is_of_surfaces_too_and_motion_blurs_them() {
    let mut renderer = renderer();
    let mut scene = scene();
    scene.spheres.push(glow(-3.0));
    let plain = renderer.render(&scene).unwrap();
    scene.display.bloom = Some(Bloom::new(0.3));
    renderer.spread_bloom(true);
    let bloomed = renderer.render(&scene).unwrap();
    assert!(bloomed.bloom().is_some());
    assert!(are_like(
        &bloomed,
        &plain.bloomed(&Bloom::new(0.3)).unwrap()
    ));
    renderer.spread_bloom(false);
    let moved = |time: f64| {
        let mut scene = self::scene();
        scene.metaballs[0].translate.x = time;
        Ok(scene)
    };
    let mean = renderer.render_mean(0.0..0.5, moved).unwrap();
    let still = [0.0, 0.25, 0.5].map(|time| renderer.render(&moved(time).unwrap()).unwrap());
    let between = pixels(&mean)
        .iter()
        .zip(pixels(&still[0]))
        .zip(pixels(&still[2]));
    let between = between.filter(|((mean, first), last)| {
        let (low, high) = (first[2].min(last[2]), first[2].max(last[2]));
        mean[2] > low + 0.02 && mean[2] < high - 0.02
    });
    assert!(between.count() > 100);
}
