//! Crowds among a hundred boxes that end rays, against the sum over all points in float64.

use energywave::image::{DepthAlong, DepthImage};
use energywave::scene::Crowd;
use energywave::{Renderer, Scene};
use fastrand::Rng;
use glam::DVec3;

use super::crowd_truth::{FEWER_PIXELS, FILLING, MANY, PIXELS, Shape, fault, scene, truth};
use super::crowds::PROFILES;
use super::figures::galaxy;
use crate::common;

/// The promise of a tolerance.
const TOLERANCE: f64 = 1e-3;

/// What light may jump by between tiles.
const STEP: f64 = 5e-4;

/// Ends the rays of a scene at a hundred boxes in and around its points.
pub fn put_boxes(scene: &mut Scene, along: DepthAlong) {
    let mut rng = Rng::with_seed(11);
    let mut place = |size: f64| DVec3::from([(); 3].map(|()| size * (2.0 * rng.f64() - 1.0)));
    let boxes: Vec<(DVec3, DVec3)> = (0..100)
        .map(|_| {
            let (middle, half) = (place(1.6), place(0.12).abs() + 0.03);
            (middle - half, middle + half)
        })
        .collect();
    let (plane, size) = (scene.view_plane(), scene.image);
    let length = |index: usize| {
        let ray = plane.ray(index as u32 % size.width, index as u32 / size.width);
        let way = ray.origin - plane.eye;
        let to_plane = way.length();
        let toward = way / to_plane;
        let hit = |(low, high): &(DVec3, DVec3)| {
            let (a, b) = ((*low - plane.eye) / toward, (*high - plane.eye) / toward);
            let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
            (enter <= leave && enter > 0.0).then_some(enter)
        };
        let nearest = boxes.iter().filter_map(hit).fold(f64::INFINITY, f64::min);
        match along {
            DepthAlong::Axis => (nearest * toward.dot(plane.forward)) as f32,
            _ => nearest as f32,
        }
    };
    let lengths: Vec<f32> = (0..size.pixels()).map(length).collect();
    assert!(lengths.iter().filter(|it| it.is_finite()).count() > lengths.len() / 20);
    scene.depth = Some(DepthImage::new(size, along, lengths).unwrap());
}

/// Ends the rays of a scene at steps of five pixels.
pub fn put_steps(scene: &mut Scene) {
    let length = |column: u32, row: u32| 3.4 + 0.4 * f64::from((column / 5 + row / 5) % 5);
    scene.depth = Some(common::depths(scene, DepthAlong::Ray, length));
}

fn among_boxes(shape: Shape, count: usize, profile: energywave::scene::Profile) -> Scene {
    let mut scene = scene(shape, count, profile, TOLERANCE);
    let along = match count % 2 {
        0 => DepthAlong::Axis,
        _ => DepthAlong::Ray,
    };
    put_boxes(&mut scene, along);
    scene
}

/// Draws crowds among boxes, and returns what is wrong with their pictures.
fn faults(renderer: &mut Renderer, cases: &[(Shape, usize)]) -> Vec<String> {
    let mut faults = Vec::new();
    for (shape, count) in cases {
        for profile in PROFILES {
            let scene = among_boxes(*shape, *count, profile);
            let image = renderer.render(&scene).unwrap();
            let many = if *count > 3000 { FEWER_PIXELS } else { PIXELS };
            let name = format!("{shape:?} of {count} among boxes, {profile:?}");
            faults.extend(fault(&scene, image.as_slice(), TOLERANCE, many, &name));
        }
    }
    faults
}

#[test]
fn crowds_among_boxes_are_within_a_thousandth() {
    let cases = [
        (Shape::Ball, 1000),
        (Shape::Clumps, 1001),
        (Shape::Edge, 1000),
        (Shape::OnePixel, 1001),
        (Shape::Behind, 1000),
        (Shape::Fractal, 1000),
        (Shape::HeavyTails, 1001),
        (Shape::AllAround, 1000),
        (Shape::Inside, 1000),
        (Shape::AtPlane, 1001),
    ];
    let mut renderer = common::renderer(common::device().lanes, "");
    assert_eq!(faults(&mut renderer, &cases), Vec::<String>::new());
}

#[test]
fn large_crowds_among_boxes_are_within_a_thousandth() {
    let cases = [
        (Shape::Ball, FILLING),
        (Shape::Ball, MANY),
        (Shape::Ball, 30_000),
        (Shape::Clumps, 30_001),
        (Shape::HeavyTails, 30_000),
        (Shape::Fractal, 30_000),
        (Shape::Fractal, 60_000),
        (Shape::HeavyTails, 60_001),
    ];
    let mut renderer = common::renderer(common::device().lanes, "");
    assert_eq!(faults(&mut renderer, &cases), Vec::<String>::new());
}

/// Draws the repository's galaxy behind steps and among boxes, and returns what is wrong with the pictures.
fn faults_of_galaxy(renderer: &mut Renderer) -> Vec<String> {
    let mut faults = Vec::new();
    for profile in PROFILES {
        let [mut stepped, mut boxed] = [(); 2].map(|()| galaxy(profile));
        put_steps(&mut stepped);
        put_boxes(&mut boxed, DepthAlong::Axis);
        for (scene, what) in [(stepped, "behind steps"), (boxed, "among boxes")] {
            let image = renderer.render(&scene).unwrap();
            let name = format!("galaxy {what}, {profile:?}");
            let fault = fault(&scene, image.as_slice(), TOLERANCE, FEWER_PIXELS, &name);
            faults.extend(fault);
        }
    }
    faults
}

#[test]
fn a_galaxy_is_within_a_thousandth_where_its_light_ends_every_few_pixels() {
    let mut renderer = common::renderer(common::device().lanes, "");
    assert_eq!(faults_of_galaxy(&mut renderer), Vec::<String>::new());
    for spoiled in ["-D ONE_END", "-D ONE_DEPTH"] {
        let mut renderer = common::renderer(common::device().lanes, spoiled);
        assert!(!faults_of_galaxy(&mut renderer).is_empty(), "{spoiled}");
    }
}

#[test]
fn nothing_jumps_at_the_borders_of_tiles_among_boxes() {
    let mut renderer = common::renderer(common::device().lanes, "");
    for profile in PROFILES {
        let scene = among_boxes(Shape::Ball, 1000, profile);
        let image = renderer.render(&scene).unwrap();
        let width = scene.image.width as usize;
        let off = |pixel: usize| {
            let (light, all) = truth(&scene, pixel);
            let found = &image.as_slice()[4 * pixel..];
            [0, 1, 2].map(|k| (f64::from(found[k]) - light[k]) / all[k].max(1e-300))
        };
        let mut steps = Vec::new();
        for row in (3..scene.image.height as usize).step_by(5) {
            for column in (8..width).step_by(8) {
                let pixel = row * width + column;
                let (one, other) = (off(pixel - 1), off(pixel));
                let jump = |k: usize| (one[k] - other[k]).abs();
                steps.push(jump(0).max(jump(1)).max(jump(2)));
            }
        }
        steps.sort_by(f64::total_cmp);
        let (most, worst) = (steps[steps.len() * 99 / 100], steps[steps.len() - 1]);
        println!("{profile:?}: steps of 99 % within {most:.1e}, worst {worst:.1e}");
        assert!(worst <= STEP, "{profile:?}: {worst:.1e}");
    }
}

#[test]
fn spoiled_builds_of_crowds_among_boxes_are_found() {
    for spoiled in ["-D ONE_END", "-D ONE_DEPTH"] {
        let mut renderer = common::renderer(common::device().lanes, spoiled);
        let faults = faults(&mut renderer, &[(Shape::Ball, 1000)]);
        assert!(!faults.is_empty(), "{spoiled}");
    }
}

#[test]
fn depths_that_hide_nothing_or_all_are_right() {
    let mut renderer = common::renderer(common::device().lanes, "");
    for profile in PROFILES {
        let mut scene = scene(Shape::Ball, 1000, profile, TOLERANCE);
        let open = renderer.render(&scene).unwrap();
        let pixels = scene.image.pixels();
        let mut behind = |depth: f32| {
            let lengths = vec![depth; pixels];
            scene.depth = Some(DepthImage::new(scene.image, DepthAlong::Ray, lengths).unwrap());
            let image = renderer.render(&scene).unwrap();
            scene.integration.crowd = Crowd::Never;
            let apart = renderer.render(&scene).unwrap();
            scene.integration.crowd = Crowd::Auto;
            (image, apart)
        };
        let (image, _) = behind(f32::INFINITY);
        let far = |(a, b): (&f32, &f32)| (a - b).abs() / b.abs().max(1e-30);
        let all = image.as_slice().iter().zip(open.as_slice());
        assert!(all.map(far).fold(0.0, f32::max) < 1e-3, "{profile:?}");
        let (image, apart) = behind(0.5);
        assert_eq!(image.as_slice(), apart.as_slice(), "{profile:?}");
    }
}
