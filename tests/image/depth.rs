//! Hidden surfaces: an occluded image is the image of rays cut by hand, by both methods and both samplings, with every
//! kind of source, and its edges are exact to the pixel.

use crate::common;
use crate::common::occluders::{OCCLUDERS, Occluder};
use crate::common::random::{KINDS, random_scene, scene_of};
use crate::common::{
    at_tolerance, depths, difference, lane_widths, meets, renderer, sampled, simpson_reference,
    tolerance,
};
use energywave::Ray;
use energywave::image::{DepthAlong, ImageSize, compare};
use energywave::internals::ViewPlane;
use energywave::scene::{Decay, Measure, Method, Profile, Sampling};
use energywave::{RadianceImage, Renderer, Scene, reference};
use glam::DVec3;

/// Two computations in float32 of the same integral.
const CUT_BY_HAND: f64 = 1e-5;

/// Simpson's rule may have a sample next to a core, whose distance two rays with other coordinates round differently:
/// so far off, and so many pixels in a thousand beyond the other limit.
const CLOSE_SAMPLE: f64 = 1e-4;
const CLOSE_SAMPLES: usize = 20;

/// As exactly as float32 can, at every pixel.
const EXACT: Method = Method::Exact {
    tolerance: 1e-7,
    sampling: Sampling::Pixels,
};

const WAYS: [DepthAlong; 2] = [DepthAlong::Ray, DepthAlong::Axis];

fn plane_of(scene: &Scene) -> ViewPlane {
    scene.view_plane()
}

/// The depths at which the rays of a scene end at these parameters s.
fn with_ends(scene: &Scene, along: DepthAlong, end: impl Fn(u32, u32) -> f64) -> Scene {
    let plane = plane_of(scene);
    let depth = depths(scene, along, |column, row| {
        let to_plane = plane.ray(column, row).origin.distance(plane.eye);
        let distance = (to_plane + end(column, row) * plane.ray_length).max(0.0);
        match along {
            DepthAlong::Axis => distance * plane.near / to_plane,
            _ => distance,
        }
    });
    let mut scene = scene.clone();
    scene.depth = Some(depth);
    scene
}

/// An integral over s in [0,g] is g times that along the ray that ends there, whose decay is alpha / g^2 and beta / g;
/// the ray is cut where the depth says that it ends, in float64.
fn cut_by_hand(renderer: &mut Renderer, scene: &Scene) -> RadianceImage {
    let plane = plane_of(scene);
    let depth = scene.depth.as_ref().unwrap();
    let mut image = RadianceImage::new(scene.image).unwrap();
    let width = scene.image.width as usize;
    for (index, pixel) in image.as_mut_slice().chunks_exact_mut(4).enumerate() {
        let ray = plane.ray((index % width) as u32, (index / width) as u32);
        let to_plane = ray.origin.distance(plane.eye);
        let distance = f64::from(depth.as_slice()[index])
            * match depth.along() {
                DepthAlong::Axis => to_plane / plane.near,
                _ => 1.0,
            };
        let end = ((distance - to_plane) / plane.ray_length).clamp(0.0, 1.0);
        pixel[3] = 1.0;
        if end == 0.0 {
            continue;
        }
        let mut scene = scene.clone();
        scene.decay = scene
            .decay
            .map(|decay| Decay::new(decay.alpha / (end * end), decay.beta / end));
        let measure = match scene.integration.measure {
            Measure::Length => end * plane.ray_length,
            _ => end,
        };
        scene.integration.measure = Measure::Parameter;
        let cut = Ray::between(ray.origin, ray.at(end));
        let light = renderer.integrate(&scene, &[cut]).unwrap()[0];
        for (value, light) in pixel.iter_mut().zip(light) {
            *value = (light * measure) as f32;
        }
    }
    image
}

/// One source of a kind, the rays cut anywhere, some not at all and some all.
fn cut_scene(index: usize, is_square: bool, method: Method, along: DepthAlong) -> Scene {
    let mut scene = scene_of(KINDS[index], 40 + index as u64, 20);
    if is_square {
        scene = common::squared(&scene);
    }
    scene.integration.method = method;
    let mut random = fastrand::Rng::with_seed(index as u64);
    let ends: Vec<f64> = (0..400).map(|_| 1.4 * random.f64() - 0.2).collect();
    with_ends(&scene, along, |column, row| {
        ends[(20 * row + column) as usize]
    })
}

#[test]
fn an_occluded_image_is_that_of_rays_cut_by_hand() {
    let mut renderer = renderer(common::device().lanes, "");
    for along in WAYS {
        for (index, kind) in KINDS.iter().enumerate() {
            for is_square in [false, true] {
                let scene = cut_scene(index, is_square, EXACT, along);
                let image = renderer.render(&scene).unwrap();
                let found = difference(&image, &cut_by_hand(&mut renderer, &scene));
                println!("{kind:?} {along:?}, square: {is_square}: {found:?}");
                assert!(
                    found.max <= CUT_BY_HAND,
                    "{kind:?} {along:?} {is_square}: {found:?}"
                );
            }
        }
    }
}

#[test]
fn so_is_its_simpson_sum() {
    const SIMPSON: Method = Method::Simpson {
        divisions: common::DIVISIONS,
    };
    let mut renderer = renderer(common::device().lanes, "");
    for (index, kind) in KINDS.iter().enumerate() {
        let scene = cut_scene(index, index % 2 == 0, SIMPSON, WAYS[index % 2]);
        let image = renderer.render(&scene).unwrap();
        let expected = cut_by_hand(&mut renderer, &scene);
        let found = difference(&image, &expected);
        println!("{kind:?}: {found:?}");
        assert!(found.max <= CLOSE_SAMPLE, "{kind:?}: {found:?}");
        let pairs = image.as_slice().iter().zip(expected.as_slice());
        let is_off = |(a, b): &(&f32, &f32)| {
            (f64::from(**a) - f64::from(**b)).abs() > CUT_BY_HAND * f64::from(b.abs())
        };
        let off = pairs.filter(is_off).count();
        assert!(
            1000 * off <= CLOSE_SAMPLES * 3 * 400,
            "{kind:?}: {off} values"
        );
    }
}

#[test]
fn depths_off_by_a_thousandth_fail_the_same_comparison() {
    let mut renderer = renderer(common::device().lanes, "");
    for (index, kind) in KINDS.iter().enumerate() {
        let scene = cut_scene(index, true, EXACT, DepthAlong::Ray);
        let expected = cut_by_hand(&mut renderer, &scene);
        let depth = scene.depth.as_ref().unwrap().as_slice();
        let mut off = scene.clone();
        off.depth = Some(depths(&scene, DepthAlong::Ray, |column, row| {
            1.001 * f64::from(depth[(20 * row + column) as usize])
        }));
        let found = difference(&renderer.render(&off).unwrap(), &expected);
        assert!(found.max > CUT_BY_HAND, "{kind:?}: {found:?}");
    }
}

/// No multiple of any tile.
const SIZE: ImageSize = ImageSize {
    width: 130,
    height: 75,
};

fn occluded(scene: &Scene, occluder: Occluder) -> Scene {
    let plane = plane_of(scene);
    let mut scene = scene.clone();
    scene.depth = Some(depths(&scene, DepthAlong::Ray, |column, row| {
        let direction = plane.ray(column, row).span.normalize();
        occluder(direction, &scene)
    }));
    scene
}

/// A ring, a beam, a curve and a point behind all occluders.
fn lit_scene() -> Scene {
    let mut scene = common::empty_scene(SIZE.width, SIZE.height);
    scene.integration.method = Method::default();
    scene
        .tori
        .push(common::torus([0.0; 3], [0.1, 0.2, 1.0], 0.8));
    scene
        .beams
        .push(common::beam([-0.5, 0.1, 0.2], [1.0, 0.1, 0.2], None));
    let arch = common::CURVE_SHAPES[0];
    scene.curves.push(common::curve(arch, None));
    scene.spheres.push(common::sphere([0.4, 0.9, 0.6], 1.0));
    scene
}

#[test]
fn edges_are_exact_to_the_pixel_by_pixels_and_by_tiles() {
    let mut sharp = renderer(common::device().lanes, "");
    let mut spoiled = renderer(
        common::device().lanes,
        "-DMOST_END_ERROR=1e30f -DEND_ERROR_WEIGHT=0.0f -DMOST_ERROR(pass)=1e30f",
    );
    let mut blurred = 0;
    for (name, occluder) in OCCLUDERS {
        let scene = occluded(&lit_scene(), occluder);
        let expected = reference::render(&scene).unwrap();
        for tolerance in [1e-2, 1e-3, 1e-4] {
            for sampling in [Sampling::Pixels, Sampling::Tiles] {
                let scene = sampled(&at_tolerance(&scene, tolerance), sampling);
                let found = difference(&sharp.render(&scene).unwrap(), &expected);
                assert!(
                    meets(&found, tolerance),
                    "{name} by {sampling:?} at {tolerance:e}: {found:?}"
                );
            }
        }
        let found = difference(&spoiled.render(&scene).unwrap(), &expected);
        blurred += usize::from(!meets(&found, 1e-3));
    }
    assert!(
        blurred >= 4,
        "without a look at every depth only {blurred} of 7 images suffer"
    );
}

#[test]
fn random_scenes_with_walls_and_poles_meet_the_tolerance() {
    let mut renderer = renderer(common::device().lanes, "");
    for seed in 0..24 {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut scene = random_scene(seed, 70);
        let tilt = DVec3::from([0; 3].map(|_| 0.6 * random.f64() - 0.3));
        let (far, pole) = (0.2 + 0.8 * random.f64(), random.u32(0..70));
        scene = with_ends(&scene, WAYS[seed as usize % 2], |column, row| {
            let (x, y) = (f64::from(column) / 70.0, f64::from(row) / 70.0);
            let wall = far + tilt.x * x + tilt.y * y + tilt.z * x * y;
            match wall {
                _ if column == pole => 0.1,
                // An end of 0 is not the same in float32.
                wall if wall < 1e-3 => -0.1,
                wall => wall,
            }
        });
        let expected = reference::render(&scene).unwrap();
        let image = renderer.render(&scene).unwrap();
        let found = difference(&image, &expected);
        assert!(meets(&found, 1e-3), "seed {seed}: {found:?}");
    }
}

#[test]
fn cores_at_the_eye_light_only_what_is_seen() {
    let mut renderer = renderer(common::device().lanes, "");
    for profile in [Profile::Inverse, Profile::InverseSquare] {
        for index in 0..4 {
            let mut scene = common::empty_scene(25, 17);
            scene.integration.method = Method::default();
            let eye = scene.camera.eye.to_array();
            match index {
                0 => scene.spheres.push(common::sphere(eye, 1.0)),
                1 => scene.cylinders.push(common::cylinder(eye, [0.3, 1.0, 0.1])),
                2 => scene.beams.push(common::beam(eye, [0.3, 1.0, 0.1], None)),
                _ => scene
                    .tori
                    .push(common::torus([0.0; 3], [0.0, 0.1, 1.0], 0.9)),
            }
            if profile == Profile::InverseSquare {
                scene = common::squared(&scene);
            }
            // What is left of 0 after rounding to float32 is shorter than any step of a distance.
            for (decay, end) in [(scene.decay, 0.0), (None, 0.0), (None, 1e-6)] {
                let mut scene = with_ends(&scene, DepthAlong::Ray, |_, _| end);
                scene.decay = decay;
                let expected = reference::render(&scene).unwrap();
                let found = difference(&renderer.render(&scene).unwrap(), &expected);
                assert!(
                    meets(&found, 1e-3),
                    "{index} {profile:?} {end:e}: {found:?}"
                );
            }
        }
    }
}

#[test]
fn every_lane_width_sees_the_same_surfaces() {
    let (_, ball) = OCCLUDERS[0];
    let scene = occluded(&lit_scene(), ball);
    let expected = reference::render(&scene).unwrap();
    for lanes in lane_widths() {
        for method in [Method::simpson(64), Method::default()] {
            let mut scene = scene.clone();
            scene.integration.method = method;
            let expected = match method {
                Method::Simpson { .. } => &simpson_reference(&scene),
                _ => &expected,
            };
            let found = difference(&renderer(lanes, "").render(&scene).unwrap(), expected);
            assert!(meets(&found, 1e-3), "{lanes} lanes, {method:?}: {found:?}");
        }
    }
}

#[test]
fn a_renderer_takes_depths_of_other_frames_and_sizes_for_none_of_its_own() {
    let (_, ball) = OCCLUDERS[0];
    let (_, wall) = OCCLUDERS[2];
    let open = lit_scene();
    let mut small = lit_scene();
    small.image = ImageSize {
        width: 31,
        height: 17,
    };
    let scenes = [
        occluded(&open, ball),
        occluded(&open, wall),
        occluded(&small, ball),
        open.clone(),
        occluded(&open, ball),
    ];
    let alone = scenes
        .each_ref()
        .map(|scene| renderer(common::device().lanes, "").render(scene).unwrap());
    let mut renderer = renderer(common::device().lanes, "");
    for (scene, expected) in scenes.iter().zip(&alone) {
        assert_eq!(renderer.render(scene).unwrap(), *expected);
    }
    assert_eq!(alone[0], alone[4]);
    assert!(compare(&alone[0], &alone[1]).unwrap().max > 0.1);
}

#[test]
fn a_depth_beyond_the_rays_hides_nothing_and_one_before_them_everything() {
    let mut renderer = renderer(common::device().lanes, "");
    for sampling in [Sampling::Pixels, Sampling::Tiles] {
        let scene = sampled(&lit_scene(), sampling);
        let open = renderer.render(&scene).unwrap();
        for along in WAYS {
            let mut hidden = scene.clone();
            hidden.depth = Some(depths(&scene, along, |_, _| f64::INFINITY));
            // Another program: its rounding may differ, and with it which tiles are interpolated.
            let found = difference(&renderer.render(&hidden).unwrap(), &open);
            let limit = match sampling {
                Sampling::Pixels => CUT_BY_HAND,
                _ => tolerance(&scene),
            };
            assert!(found.max <= limit, "{sampling:?} {along:?}: {found:?}");
            hidden.depth = Some(depths(&scene, along, |_, _| 0.9 * scene.camera.near));
            let image = renderer.render(&hidden).unwrap();
            let mut pixels = image.as_slice().chunks(4);
            assert!(pixels.all(|pixel| pixel == [0.0, 0.0, 0.0, 1.0]));
        }
    }
}
