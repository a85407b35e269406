//! Whole images in linear radiance: the worst pixel against the float64 Simpson rule, and laws that every image obeys.
#![allow(clippy::unwrap_used, clippy::panic)]

mod common;

use common::{LANE_WIDTHS, difference, empty_scene, full_scene, renderer};
use energywave::opencl::{DeviceBuffer, Program};
use energywave::pack::{self, Sources, layout};
use energywave::ray::ViewPlane;
use energywave::scene::{ImageSize, Measure};
use energywave::{RadianceImage, Scene, reference};
use glam::{DMat3, DVec3};

/// Worst pixel of a device's Simpson image against float64: a sample that falls next to a core has a distance of few
/// float32 digits, and outweighs the ray's other samples.
const WORST_PIXEL: f64 = 2e-4;

/// 99.9 % of the pixels have no sample that close: what is left is the rounding of some hundred terms.
const MOST_PIXELS: f64 = 2e-5;

/// Two float32 sums of the same terms in another order or with other contractions.
const ROUNDING: f64 = 2e-4;

/// One scene of each kind of source, and one of all.
fn scenes(width: u32, height: u32) -> Vec<(String, Scene)> {
    let full = full_scene(width, height);
    let mut scenes = Vec::new();
    let only = |keep: fn(&mut Scene, &Scene)| {
        let mut scene = empty_scene(width, height);
        keep(&mut scene, &full_scene(8, 8));
        scene
    };
    scenes.push((
        "spheres".to_owned(),
        only(|s, f| s.spheres = f.spheres.clone()),
    ));
    scenes.push((
        "cylinder".to_owned(),
        only(|s, f| s.cylinders = f.cylinders.clone()),
    ));
    scenes.push(("tori".to_owned(), only(|s, f| s.tori = f.tori.clone())));
    for index in 0..full.curves.len() {
        let mut scene = empty_scene(width, height);
        scene.curves.push(full.curves[index].clone());
        scenes.push((format!("curve {index}"), scene));
    }
    scenes.push(("all kinds".to_owned(), full));
    scenes
}

fn figures() -> Vec<(String, Scene)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes");
    let mut figures = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "toml") {
            let mut scene = Scene::from_file(&path).unwrap();
            scene.image = ImageSize {
                width: 96,
                height: 96,
            };
            figures.push((
                path.file_stem().unwrap().to_str().unwrap().to_owned(),
                scene,
            ));
        }
    }
    assert!(figures.len() >= 12, "only {} scenes", figures.len());
    figures
}

#[test]
fn every_image_matches_the_float64_simpson_rule_in_its_worst_pixel() {
    let mut renderer = renderer(common::device().lanes, "");
    for (name, scene) in scenes(61, 47).into_iter().chain(figures()) {
        let image = renderer.render(&scene).unwrap();
        let found = difference(&image, &reference::render_simpson(&scene).unwrap());
        println!("{name}: {found:?}");
        assert!(found.max < WORST_PIXEL, "{name}: {found:?}");
        assert!(found.p999 < MOST_PIXELS, "{name}: {found:?}");
    }
}

#[test]
fn fields_spoiled_by_one_percent_fail_the_same_comparison() {
    let mut renderer = renderer(common::device().lanes, common::BROKEN_FIELDS);
    for (name, scene) in scenes(31, 23) {
        let image = renderer.render(&scene).unwrap();
        let found = difference(&image, &reference::render_simpson(&scene).unwrap());
        assert!(
            found.max > WORST_PIXEL,
            "{name}: the spoiled build passed: {found:?}"
        );
        assert!(
            found.p999 > MOST_PIXELS,
            "{name}: the spoiled build passed: {found:?}"
        );
    }
}

#[test]
fn one_wrong_pixel_fails_the_same_comparison() {
    let scene = full_scene(61, 47);
    let expected = reference::render_simpson(&scene).unwrap();
    let mut image = renderer(common::device().lanes, "").render(&scene).unwrap();
    image.as_mut_slice()[4 * (7 * 61 + 60)] *= 1.001;
    let found = difference(&image, &expected);
    assert!(found.max > WORST_PIXEL, "{found:?}");
    assert_eq!(found.worst, (60, 7));
}

/// Weighted curves whose nearest point is a matter of choice: a point, folds that run twice through the same points, and
/// a nearly straight one from afar.
fn weighted_curves() -> Vec<(&'static str, [[f64; 3]; 3], f64)> {
    vec![
        ("a point", [[0.3, 0.2, 0.1]; 3], 1.0),
        (
            "closed",
            [[0.1, 0.2, 0.3], [0.7, 0.9, 1.3], [0.1, 0.2, 0.3]],
            1.0,
        ),
        (
            "a skew fold",
            [[0.1, 0.2, 0.3], [2.2, 1.4, 0.9], [0.8, 0.6, 0.5]],
            1.0,
        ),
        (
            "a longer skew fold",
            [[0.1, 0.2, 0.3], [1.15, 0.8, 0.6], [0.415, 0.38, 0.39]],
            1.0,
        ),
        (
            "nearly straight",
            [[-0.5, 0.0, 0.0], [0.0, -0.000_475, 0.0], [0.5, 0.0, 0.0]],
            300.0,
        ),
        (
            "straight",
            [[-0.5, 0.0, 0.0], [0.2, 0.0, 0.0], [0.5, 0.0, 0.0]],
            1.0,
        ),
    ]
}

#[test]
fn the_intensity_at_the_nearest_point_does_not_hang_on_rounding() {
    let mut renderer = renderer(common::device().lanes, "");
    for (name, points, distance) in weighted_curves() {
        let mut scene = empty_scene(37, 23);
        scene.camera.eye *= distance;
        scene.camera.near = 0.8 * scene.camera.eye.length();
        let series = Some(vec![1.0, 5.0, 2.0, 8.0]);
        scene.curves.push(common::curve(points, series));
        let image = renderer.render(&scene).unwrap();
        let found = difference(&image, &reference::render_simpson(&scene).unwrap());
        println!("{name}: {found:?}");
        assert!(found.max < WORST_PIXEL, "{name}: {found:?}");
    }
}

#[test]
fn every_lane_width_gives_the_same_image() {
    let scene = full_scene(53, 19);
    let scalar = renderer(1, "").render(&scene).unwrap();
    for lanes in LANE_WIDTHS {
        let found = difference(&renderer(lanes, "").render(&scene).unwrap(), &scalar);
        assert!(found.max < ROUNDING, "{lanes} lanes: {found:?}");
    }
}

#[test]
fn the_portable_forms_give_the_same_image() {
    let scene = full_scene(53, 19);
    let expected = reference::render_simpson(&scene).unwrap();
    for lanes in LANE_WIDTHS {
        let native = renderer(lanes, "").render(&scene).unwrap();
        for form in ["-DPORTABLE_ROOTS", "-DNO_SHUFFLES -DINLINE="] {
            let image = renderer(lanes, form).render(&scene).unwrap();
            let found = difference(&image, &expected);
            assert!(found.max < WORST_PIXEL, "{lanes} lanes, {form}: {found:?}");
            assert!(
                difference(&image, &native).max < ROUNDING,
                "{lanes} lanes, {form}"
            );
        }
    }
}

#[test]
fn two_runs_are_equal_to_the_bit_and_two_scenes_are_not() {
    let scene = full_scene(53, 19);
    let mut renderer = renderer(common::device().lanes, "");
    let first = renderer.render(&scene).unwrap();
    let mut other = scene.clone();
    other.tori[0].major_radius *= 1.0 + 1e-6;
    assert_ne!(renderer.render(&other).unwrap(), first);
    assert_eq!(renderer.render(&scene).unwrap(), first);
    let mut again = common::renderer(common::device().lanes, "");
    assert_eq!(again.render(&scene).unwrap(), first);
}

#[test]
fn a_scene_without_sources_is_black_and_opaque() {
    let mut renderer = renderer(common::device().lanes, "");
    renderer.render(&full_scene(20, 10)).unwrap(); // leaves light in the device's buffer
    let image = renderer.render(&empty_scene(20, 10)).unwrap();
    let is_black = |pixel: &[f32]| pixel == [0.0, 0.0, 0.0, 1.0];
    assert!(image.as_slice().chunks(4).all(is_black));
}

#[test]
fn any_size_works_from_one_pixel_on() {
    for lanes in LANE_WIDTHS {
        let mut renderer = renderer(lanes, "");
        for (width, height) in [(1, 1), (2, 1), (1, 17), (17, 1), (127, 3), (16, 16)] {
            let scene = full_scene(width, height);
            let image = renderer.render(&scene).unwrap();
            assert_eq!((image.size().width, image.size().height), (width, height));
            let found = difference(&image, &reference::render_simpson(&scene).unwrap());
            assert!(
                found.max < WORST_PIXEL,
                "{lanes} lanes, {width}x{height}: {found:?}"
            );
        }
    }
}

#[test]
fn any_number_of_divisions_works() {
    let mut renderer = renderer(common::device().lanes, "");
    for divisions in [2, 4, 200, 254, 256, 258, 1024, 65536] {
        let mut scene = full_scene(5, 3);
        scene.integration.divisions = divisions;
        let image = renderer.render(&scene).unwrap();
        let found = difference(&image, &reference::render_simpson(&scene).unwrap());
        assert!(found.max < WORST_PIXEL, "{divisions}: {found:?}");
    }
}

#[test]
fn decay_measure_and_softening_are_the_references() {
    let mut renderer = renderer(common::device().lanes, "");
    let mut scene = full_scene(31, 17);
    scene.decay = None;
    let mut check = |scene: &Scene, what: &str| {
        let image = renderer.render(scene).unwrap();
        let found = difference(&image, &reference::render_simpson(scene).unwrap());
        assert!(found.max < WORST_PIXEL, "{what}: {found:?}");
        image
    };
    let plain = check(&scene, "no decay");
    scene.integration.softening = 0.2;
    let soft = check(&scene, "softening");
    assert!(soft.as_slice()[0] < plain.as_slice()[0]);
    scene.integration.softening = 0.0;
    scene.integration.measure = Measure::Length;
    let by_length = check(&scene, "length");
    let ratio = by_length.as_slice()[0] / plain.as_slice()[0];
    let length = scene.camera.ray_length() as f32;
    assert!((ratio / length - 1.0).abs() < 1e-5, "{ratio} {length}");
}

#[test]
fn light_is_linear_in_the_coefficients_and_adds_up() {
    let mut renderer = renderer(common::device().lanes, "");
    let scene = full_scene(31, 17);
    let image = renderer.render(&scene).unwrap();
    let mut twice = scene.clone();
    twice.spheres.iter_mut().for_each(|s| s.coefficient *= 2.0);
    twice
        .cylinders
        .iter_mut()
        .for_each(|s| s.coefficient *= 2.0);
    twice.tori.iter_mut().for_each(|s| s.coefficient *= 2.0);
    twice.curves.iter_mut().for_each(|s| s.coefficient *= 2.0);
    let doubled = renderer.render(&twice).unwrap();
    let pairs = doubled.as_slice().chunks(4).zip(image.as_slice().chunks(4));
    assert!(
        pairs
            .into_iter()
            .all(|(d, i)| (0..3).all(|c| d[c] == 2.0 * i[c]))
    );

    let mut sum = RadianceImage::new(scene.image).unwrap();
    let mut part = scene.clone();
    (part.tori, part.curves) = (Vec::new(), Vec::new());
    let mut rest = scene.clone();
    (rest.spheres, rest.cylinders) = (Vec::new(), Vec::new());
    for image in [
        renderer.render(&part).unwrap(),
        renderer.render(&rest).unwrap(),
    ] {
        for (total, value) in sum.as_mut_slice().iter_mut().zip(image.as_slice()) {
            *total += value;
        }
    }
    assert!(difference(&sum, &image).max < 1e-6);
}

#[test]
fn the_order_of_the_sources_does_not_matter() {
    let mut renderer = renderer(common::device().lanes, "");
    let scene = full_scene(31, 17);
    let mut reversed = scene.clone();
    reversed.spheres.reverse();
    reversed.tori.reverse();
    reversed.curves.reverse();
    let (a, b) = (
        renderer.render(&scene).unwrap(),
        renderer.render(&reversed).unwrap(),
    );
    assert_ne!(
        a, b,
        "sums in another order round differently: was the order kept?"
    );
    assert!(difference(&a, &b).max < 1e-6);
}

/// The scene with every vector mapped.
fn mapped(scene: &Scene, map: impl Fn(DVec3) -> DVec3) -> Scene {
    let mut scene = scene.clone();
    let camera = &mut scene.camera;
    (camera.eye, camera.target, camera.up) = (map(camera.eye), map(camera.target), map(camera.up));
    for sphere in &mut scene.spheres {
        sphere.center = map(sphere.center);
    }
    for cylinder in &mut scene.cylinders {
        (cylinder.point, cylinder.direction) = (map(cylinder.point), map(cylinder.direction));
    }
    for torus in &mut scene.tori {
        (torus.center, torus.axis) = (map(torus.center), map(torus.axis));
    }
    for curve in &mut scene.curves {
        curve.control_points = curve.control_points.map(&map);
    }
    scene
}

#[test]
fn a_mirrored_scene_gives_the_mirrored_image() {
    let mut renderer = renderer(common::device().lanes, "");
    let scene = full_scene(31, 17);
    let image = renderer.render(&scene).unwrap();
    let mirrored = mapped(&scene, |v| DVec3::new(-v.x, v.y, v.z));
    let mirrored = renderer.render(&mirrored).unwrap();
    let mut flipped = image.clone();
    let rows = flipped.as_mut_slice().chunks_mut(4 * 31);
    for (row, original) in rows.zip(image.as_slice().chunks(4 * 31)) {
        for (pixel, opposite) in row.chunks_mut(4).zip(original.chunks(4).rev()) {
            pixel.copy_from_slice(opposite);
        }
    }
    assert!(difference(&mirrored, &flipped).max < ROUNDING);
    assert!(
        difference(&mirrored, &image).max > 0.01,
        "the scene is symmetric"
    );
}

#[test]
fn a_moved_turned_and_scaled_scene_gives_the_same_image() {
    let mut renderer = renderer(common::device().lanes, "");
    let scene = full_scene(31, 17);
    let image = renderer.render(&scene).unwrap();
    let turn = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(-1.9);
    let turned = mapped(&scene, |v| turn * v);
    assert!(difference(&renderer.render(&turned).unwrap(), &image).max < ROUNDING);
    // A field of 1/r falls with the scale; coefficients that grow with it keep the light.
    for scale in [1e-4, 1e4] {
        let mut scaled = mapped(&scene, |v| v * scale);
        scaled.camera.near *= scale;
        scaled.tori.iter_mut().for_each(|t| t.major_radius *= scale);
        scaled
            .spheres
            .iter_mut()
            .for_each(|s| s.coefficient *= scale);
        scaled
            .cylinders
            .iter_mut()
            .for_each(|s| s.coefficient *= scale);
        scaled.tori.iter_mut().for_each(|s| s.coefficient *= scale);
        scaled
            .curves
            .iter_mut()
            .for_each(|s| s.coefficient *= scale);
        let found = difference(&renderer.render(&scaled).unwrap(), &image);
        assert!(found.max < ROUNDING, "{scale}: {found:?}");
    }
    // Far from the world's origin float32 would see nothing; coordinates from the eye do.
    let far = DVec3::new(1e6, -2e6, 3e6);
    let mut moved = mapped(&scene, |v| v + far);
    moved.camera.up -= far;
    for (cylinder, original) in moved.cylinders.iter_mut().zip(&scene.cylinders) {
        cylinder.direction = original.direction;
    }
    for (torus, original) in moved.tori.iter_mut().zip(&scene.tori) {
        torus.axis = original.axis;
    }
    assert!(difference(&renderer.render(&moved).unwrap(), &image).max < ROUNDING);
}

#[test]
fn many_sources_in_many_launches_add_up() {
    let mut renderer = renderer(common::device().lanes, "");
    let mut scene = empty_scene(12, 9);
    let mut random = fastrand::Rng::with_seed(11);
    for _ in 0..3000 {
        let center = [0; 3].map(|_| 2.0 * random.f64() - 1.0);
        scene.spheres.push(common::sphere(center, 0.01));
    }
    scene.integration.divisions = 1000; // 325 million samples: several launches on any device
    let image = renderer.render(&scene).unwrap();
    let found = difference(&image, &reference::render_simpson(&scene).unwrap());
    assert!(found.max < WORST_PIXEL, "{found:?}");
}

/// Renders straight into a buffer with 64 marked pixels behind the image; how many marks are left.
fn marks_left(lanes: u32, extra: &str, width: u32, height: u32) -> usize {
    const MARKS: usize = 64;
    const MARK: [f32; 4] = [-1.0, -2.0, -3.0, -4.0];
    let scene = full_scene(width, height);
    let compute = common::compute();
    let program = Program::build(&compute, &["render.cl"], &common::options(lanes, extra)).unwrap();
    let plane = ViewPlane::new(&scene.camera, scene.image);
    let packed = Sources::new(&scene, plane.eye, plane.ray_length);
    let nodes = pack::nodes(20, scene.decay);
    let launch = layout::Launch {
        count: width * height,
        node_count: nodes.len() as u32,
        sphere_end: packed.spheres.len() as u32,
        torus_end: packed.tori.len() as u32,
        curve_end: packed.curves.len() as u32,
        ..bytemuck::Zeroable::zeroed()
    };
    fn upload<T: bytemuck::Pod>(
        compute: &energywave::opencl::Compute,
        values: &[T],
    ) -> DeviceBuffer<T> {
        let mut buffer = DeviceBuffer::new(compute, "list", values.len()).unwrap();
        buffer.write(compute, values).unwrap();
        buffer
    }
    let pixels = scene.image.pixels();
    let output = upload(&compute, &vec![MARK; pixels + MARKS]);
    let view = pack::view(&plane, width, 0.0);
    program
        .run(
            &compute,
            "render",
            &[
                &view,
                &launch,
                &upload(&compute, &nodes),
                &upload(&compute, &packed.spheres),
                &upload(&compute, &packed.cylinders),
                &upload(&compute, &packed.tori),
                &upload(&compute, &packed.curves),
                &upload(&compute, &packed.spline_pieces),
                &output,
            ],
            // More work-items than pixels, as padded work-groups have.
            pixels.div_ceil(lanes as usize) + 3,
            1,
        )
        .unwrap();
    let mut read = vec![[0.0_f32; 4]; pixels + MARKS];
    output.read(&compute, &mut read).unwrap();
    assert!(
        read[..pixels].iter().all(|pixel| pixel[3] == 1.0),
        "a pixel is missing"
    );
    read[pixels..]
        .iter()
        .filter(|pixel| **pixel == MARK)
        .count()
}

#[test]
fn nothing_is_written_behind_the_image() {
    for lanes in LANE_WIDTHS {
        for (width, height) in [(1, 1), (13, 7), (16, 4), (31, 1)] {
            assert_eq!(
                marks_left(lanes, "", width, height),
                64,
                "{lanes} lanes, {width}x{height}"
            );
        }
    }
}

#[test]
fn a_store_of_all_lanes_is_noticed_behind_the_image() {
    assert_eq!(marks_left(8, "-DLAST_LANES(left)=8u", 13, 7), 64 - 5);
}
