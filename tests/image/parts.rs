//! Parts of an image, single rays, and scenes that change from frame to frame, beside whole images of renderers that
//! drew nothing before.

use crate::common;
use crate::common::{difference, renderer, sampled};
use energywave::image::{DepthAlong, ImageSize};
use energywave::scene::{BeamEnd, Decay, List, Measure, Method, Profile, Sampling};
use energywave::{Device, ErrorKind, RadianceImage, Ray, Renderer, Scene};
use glam::DVec3;

fn reference() -> Renderer {
    Renderer::new(&Device::reference()).unwrap()
}

fn device() -> Renderer {
    renderer(common::device().lanes, "")
}

/// Sums of the same light in another order: where launches are slow, they take fewer sources each.
const ROUNDING: f64 = 2e-6;

/// One source, so that its light is never summed in parts, in an image of more than two parts, the last no whole tile.
fn tall_scene(method: Method) -> Scene {
    let mut scene = common::empty_scene(70, 600);
    scene.integration.method = method;
    scene
        .tori
        .push(common::torus([0.1, 0.0, 0.0], [0.1, 0.2, 2.0], 0.9));
    scene
}

fn methods() -> [Method; 3] {
    [
        common::by(Sampling::Tiles),
        common::by(Sampling::Pixels),
        Method::simpson(64),
    ]
}

/// Renders an image in parts that end at these rows, each with `gap` values after every row.
fn in_parts(renderer: &mut Renderer, scene: &Scene, ends: &[u32], gap: usize) -> Vec<f32> {
    const MARK: f32 = -7.0;
    let row = 4 * scene.image.width as usize;
    let mut image = Vec::new();
    let mut begin = 0;
    for end in ends {
        let rows = begin..*end;
        let mut target = vec![MARK; rows.len() * (row + gap)];
        renderer
            .render_rows(scene, rows, &mut target, row + gap)
            .unwrap();
        for values in target.chunks(row + gap) {
            image.extend(&values[..row]);
            assert!(values[row..].iter().all(|value| *value == MARK));
        }
        begin = *end;
    }
    image
}

#[test]
fn parts_that_begin_at_multiples_of_256_rows_are_the_whole_to_the_bit() {
    for method in methods() {
        let scene = tall_scene(method);
        let whole = device().render(&scene).unwrap();
        let mut renderer = device();
        for (ends, gap) in [
            (vec![256, 512, 600], 0),
            (vec![512, 600], 3),
            (vec![0, 256, 256, 600], 0),
            (vec![600], 4),
        ] {
            let parts = in_parts(&mut renderer, &scene, &ends, gap);
            assert!(parts == whole.as_slice(), "{method:?}, {ends:?}, {gap}");
        }
        // In any order.
        let mut last = vec![0.0; 4 * 70 * 88];
        renderer
            .render_rows(&scene, 512..600, &mut last, 4 * 70)
            .unwrap();
        assert!(last == whole.as_slice()[4 * 70 * 512..], "{method:?}");
    }
}

#[test]
fn parts_that_begin_elsewhere_are_the_whole_within_the_tolerance() {
    let mut seen = false;
    for method in methods() {
        let scene = tall_scene(method);
        let mut renderer = device();
        let whole = renderer.render(&scene).unwrap();
        let mut image = RadianceImage::new(scene.image).unwrap();
        let parts = in_parts(&mut renderer, &scene, &[61, 300, 301, 600], 0);
        image.as_mut_slice().copy_from_slice(&parts);
        let found = difference(&image, &whole);
        assert!(common::meets(&found, 2e-3), "{method:?}: {found:?}");
        // So the comparison by bits sees other tiles.
        seen |= image != whole;
    }
    assert!(seen, "tiles that begin elsewhere give the same bits");
}

#[test]
fn parts_of_the_reference_are_the_whole_wherever_they_begin() {
    let mut scene = tall_scene(Method::simpson(8));
    scene.image.height = 40;
    let mut renderer = reference();
    let whole = renderer.render(&scene).unwrap();
    for gap in [0, 5] {
        let parts = in_parts(&mut renderer, &scene, &[7, 8, 40], gap);
        assert!(parts == whole.as_slice(), "{gap}");
    }
}

#[test]
fn rows_that_are_not_there_are_refused_and_none_are_nothing() {
    let mut scene = tall_scene(Method::simpson(8));
    scene.image.height = 40;
    let row = 4 * 70;
    for mut renderer in [device(), reference()] {
        let mut target = vec![-7.0; 40 * row];
        let reversed = std::ops::Range { start: 5, end: 3 };
        for (rows, words) in [
            (0..41, "rows 0 to 41, the image has 40"),
            (41..41, "rows 41 to 41, the image has 40"),
            (40..u32::MAX, "the image has 40"),
            (reversed, "rows 5 to 3, the image has 40"),
        ] {
            let error = renderer
                .render_rows(&scene, rows, &mut target, row)
                .unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Unsupported);
            assert!(error.to_string().contains(words), "{error}");
        }
        for (rows, length, stride) in [
            (0..2, 2 * row - 1, row),
            (0..2, 2 * row, row - 1),
            (0..2, 2 * row, row + 1),
            (0..2, 2 * row, 0),
            (3..40, 37 * row, usize::MAX),
        ] {
            let target = &mut target[..length];
            let error = renderer
                .render_rows(&scene, rows, target, stride)
                .unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Unsupported, "{error}");
        }
        for rows in [0..0, 7..7, 40..40] {
            renderer.render_rows(&scene, rows, &mut [], row).unwrap();
        }
        assert!(
            target.iter().all(|value| *value == -7.0),
            "something was written"
        );
        renderer
            .render_rows(&scene, 39..40, &mut target[..row], row)
            .unwrap();
        assert!(target[..row].iter().all(|value| *value >= 0.0));
    }
}

#[test]
fn rays_measured_by_length_are_the_parameters_times_their_own_length() {
    let mut scene = common::full_scene(8, 8);
    let ends = [[0.5, 3.0, -1.0], [-0.4, 5.0, 0.2], [0.1, -1.0, 0.3]];
    let rays = ends.map(|end| Ray::between(DVec3::new(0.2, -3.0, 1.0), DVec3::from(end)));
    let lengths = rays.map(|ray| ray.span.length());
    assert!((lengths[0] / lengths[2] - 1.0).abs() > 0.5);
    for mut renderer in [device(), reference()] {
        for method in [Method::simpson(64), Method::exact(1e-4)] {
            scene.integration.method = method;
            let mut integrals = |measure| {
                scene.integration.measure = measure;
                renderer.integrate(&scene, &rays).unwrap()
            };
            let by_parameter = integrals(Measure::Parameter);
            let by_length = integrals(Measure::Length);
            assert_eq!((by_parameter.len(), by_length.len()), (3, 3));
            for ((parameter, length), times) in by_parameter.iter().zip(&by_length).zip(lengths) {
                for (parameter, length) in parameter.iter().zip(length) {
                    let ratio = length / parameter;
                    assert!(
                        (ratio / times - 1.0).abs() < 1e-12,
                        "{method:?}: {ratio}, not {times}"
                    );
                }
            }
        }
    }
}

type Change = (&'static str, fn(&mut Scene));

/// Everything of a scene that a renderer keeps something of.
const CHANGES: [Change; 21] = [
    ("a sphere's coefficient", |scene| {
        scene.spheres[0].coefficient *= 1.5
    }),
    ("a sphere more", |scene| {
        scene.spheres.push(common::sphere([0.1, 0.2, 0.9], 1.0))
    }),
    ("a sphere fewer", |scene| scene.spheres.truncate(1)),
    ("other spheres", |scene| {
        scene.spheres = List::from(vec![common::sphere([0.2, 0.2, 0.2], 2.0)]);
    }),
    ("no spheres", |scene| scene.spheres.clear()),
    ("spheres of another scene", |scene| {
        let mut other = common::empty_scene(8, 8);
        other.spheres.push(common::sphere([0.4, 0.3, 0.5], 9.0));
        std::mem::swap(&mut scene.spheres, &mut other.spheres);
    }),
    ("a cylinder's point", |scene| {
        scene.cylinders[0].point.z += 0.2
    }),
    ("a beam's direction", |scene| {
        scene.beams[0].direction.x += 0.2
    }),
    ("a beam's end", |scene| {
        scene.beams[1].end = BeamEnd::Taper(2.0)
    }),
    ("a ring's radius", |scene| {
        scene
            .tori
            .iter_mut()
            .for_each(|torus| torus.major_radius *= 1.1);
    }),
    ("a ring's profile", |scene| {
        scene.tori[0].profile = Profile::InverseSquare
    }),
    ("a curve's point", |scene| {
        scene.curves[0].control_points[1].z += 0.3
    }),
    ("a curve's series", |scene| {
        scene.curves[0].intensity = Some(vec![0.1, 0.9, 0.4, 0.3, 0.2]);
    }),
    ("the eye", |scene| scene.camera.eye.x += 0.3),
    ("the angle of view", |scene| scene.camera.fov_y = 30.0),
    ("the ray's length", |scene| {
        scene.camera.ray_length = Some(4.0)
    }),
    ("the decay", |scene| {
        scene.decay = Some(Decay::new(0.3, 0.2));
    }),
    ("the softening", |scene| scene.integration.softening = 0.1),
    ("the measure", |scene| {
        scene.integration.measure = Measure::Length
    }),
    ("the depths", |scene| {
        scene.depth = Some(common::depths(scene, DepthAlong::Ray, |column, _| {
            2.0 + 0.1 * f64::from(column)
        }));
    }),
    ("the way of depths", |scene| {
        let depth = scene.depth.take().unwrap();
        let values = depth.as_slice().to_vec();
        scene.depth = Some(
            energywave::image::DepthImage::new(depth.size(), DepthAlong::Axis, values).unwrap(),
        );
    }),
];

/// A scene of every kind, partly hidden.
fn changing_scene(method: Method) -> Scene {
    let mut scene = common::full_scene(24, 17);
    scene.curves.truncate(2);
    scene.integration.method = method;
    scene.depth = Some(common::depths(
        &scene,
        DepthAlong::Ray,
        |column, row| match column + row < 12 {
            true => 3.0,
            false => f64::INFINITY,
        },
    ));
    scene
}

fn is_same(a: &RadianceImage, b: &RadianceImage) -> bool {
    difference(a, b).max < ROUNDING
}

#[test]
fn a_scene_that_changed_is_drawn_anew_and_as_before_when_that_is_taken_back() {
    for method in [common::by(Sampling::Tiles), Method::simpson(32)] {
        let scene = changing_scene(method);
        let mut renderer = device();
        let before = renderer.render(&scene).unwrap();
        for (what, change) in CHANGES {
            let mut changed = scene.clone();
            change(&mut changed);
            let found = renderer.render(&changed).unwrap();
            let seen = difference(&found, &before).max;
            assert!(seen > 1e-3, "{what}, {method:?}: nothing changed");
            // A renderer that has drawn nothing keeps nothing.
            let alone = device().render(&changed).unwrap();
            assert!(is_same(&found, &alone), "{what}, {method:?}");
            let again = renderer.render(&scene).unwrap();
            assert!(is_same(&again, &before), "{what}, {method:?}, taken back");
        }
    }
}

/// Scenes of one source each, of every kind, whose light is never summed in parts.
fn lone_sources() -> Vec<Scene> {
    let full = changing_scene(common::by(Sampling::Tiles));
    let mut dark = full.clone();
    dark.spheres.clear();
    dark.cylinders.clear();
    dark.beams.clear();
    dark.tori.clear();
    dark.curves.clear();
    let mut scenes = vec![dark; 5];
    scenes[0].spheres.push(full.spheres[0].clone());
    scenes[1].cylinders.push(full.cylinders[0].clone());
    scenes[2].beams.push(full.beams[1].clone());
    scenes[3].tori.push(full.tori[0].clone());
    scenes[4].curves.push(full.curves[0].clone());
    scenes
}

#[test]
fn a_scene_that_did_not_change_gives_the_same_bits() {
    let mut renderer = device();
    let images: Vec<_> = lone_sources()
        .iter()
        .map(|scene| renderer.render(scene).unwrap())
        .collect();
    for (index, scene) in lone_sources().iter().enumerate() {
        // Equal contents in other places, then the very scene, then a copy.
        assert!(renderer.render(scene).unwrap() == images[index], "{index}");
        assert!(
            renderer.render(scene).unwrap() == images[index],
            "{index}, again"
        );
        let copy = scene.clone();
        assert!(
            renderer.render(&copy).unwrap() == images[index],
            "{index}, a copy"
        );
        assert!(
            device().render(scene).unwrap() == images[index],
            "{index}, alone"
        );
        let mut moved = copy;
        moved.camera.eye.x += 1e-3;
        assert!(
            renderer.render(&moved).unwrap() != images[index],
            "{index}, moved"
        );
    }
}

#[test]
fn a_scene_whose_size_changed_is_drawn_anew() {
    let mut scene = changing_scene(common::by(Sampling::Tiles));
    scene.depth = None;
    let mut renderer = device();
    let small = renderer.render(&scene).unwrap();
    scene.image = ImageSize {
        width: 40,
        height: 30,
    };
    let large = renderer.render(&scene).unwrap();
    assert_eq!(large.size(), scene.image);
    assert!(is_same(&large, &device().render(&scene).unwrap()));
    scene.image = small.size();
    assert!(is_same(&renderer.render(&scene).unwrap(), &small));
}

#[test]
fn a_scene_that_became_wrong_is_refused_and_drawn_when_it_is_right_again() {
    let mut scene = changing_scene(common::by(Sampling::Tiles));
    for mut renderer in [device(), reference()] {
        let right = renderer.render(&scene).unwrap();
        scene.tori[0].major_radius *= -1.0;
        for _ in 0..2 {
            let error = renderer.render(&scene).unwrap_err();
            assert!(
                error.to_string().contains("torus[0].major_radius"),
                "{error}"
            );
        }
        scene.tori[0].major_radius *= -1.0;
        assert!(is_same(&renderer.render(&scene).unwrap(), &right));
    }
}

#[test]
fn what_was_taken_by_tiles_is_taken_by_pixels_when_that_is_asked() {
    let scene = changing_scene(common::by(Sampling::Tiles));
    let mut renderer = device();
    renderer.render(&scene).unwrap();
    let by_tiles = renderer.last_cost().integrals;
    let by_pixels = sampled(&scene, Sampling::Pixels);
    let found = renderer.render(&by_pixels).unwrap();
    let all = scene.image.pixels() * scene.source_count();
    assert_eq!(renderer.last_cost().integrals, all as u64);
    assert!(by_tiles != all as u64);
    assert!(is_same(&found, &device().render(&by_pixels).unwrap()));
}
