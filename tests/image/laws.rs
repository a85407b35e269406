//! Laws that every image obeys: linearity, order, mirror, motion, scale, and finite light.

use crate::common;
use crate::common::{difference, full_scene, renderer, simpson_reference};
use energywave::scene::{BeamEnd, Decay, List, Method};
use energywave::{RadianceImage, Scene};
use glam::{DMat3, DVec3};

/// The same light summed from float32 coordinates that round differently.
const ROUNDING: f64 = 2e-4;

fn scale_light(scene: &mut Scene, factor: f64) {
    let of_spheres = scene.spheres.iter_mut().map(|s| &mut s.coefficient);
    let of_cylinders = scene.cylinders.iter_mut().map(|s| &mut s.coefficient);
    let of_tori = scene.tori.iter_mut().map(|s| &mut s.coefficient);
    let of_curves = scene.curves.iter_mut().map(|s| &mut s.coefficient);
    let of_beams = scene.beams.iter_mut().flat_map(|b| {
        let cap = match &mut b.end {
            BeamEnd::Cap(coefficient) => coefficient.as_mut(),
            BeamEnd::Taper(_) => None,
        };
        let parts = [&mut b.coefficient, &mut b.sphere_coefficient];
        parts.into_iter().chain(cap)
    });
    let all = of_spheres.chain(of_cylinders).chain(of_tori);
    let all = all.chain(of_curves).chain(of_beams);
    all.for_each(|coefficient| *coefficient *= factor);
}

#[test]
fn light_is_linear_in_the_coefficients_and_adds_up() {
    let mut renderer = renderer(common::device().lanes, "");
    let scene = full_scene(31, 17);
    let image = renderer.render(&scene).unwrap();
    let mut twice = scene.clone();
    scale_light(&mut twice, 2.0);
    let doubled = renderer.render(&twice).unwrap();
    let pairs = doubled.as_slice().chunks(4).zip(image.as_slice().chunks(4));
    assert!(
        pairs
            .into_iter()
            .all(|(d, i)| (0..3).all(|c| d[c] == 2.0 * i[c]))
    );

    let mut sum = RadianceImage::new(scene.image).unwrap();
    let mut part = scene.clone();
    (part.tori, part.curves) = (List::new(), List::new());
    let mut rest = scene.clone();
    (rest.spheres, rest.cylinders, rest.beams) = (List::new(), List::new(), List::new());
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
    for sphere in scene.spheres.iter_mut() {
        sphere.center = map(sphere.center);
    }
    for cylinder in scene.cylinders.iter_mut() {
        (cylinder.point, cylinder.direction) = (map(cylinder.point), map(cylinder.direction));
    }
    for beam in scene.beams.iter_mut() {
        (beam.tip, beam.direction) = (map(beam.tip), map(beam.direction));
    }
    for torus in scene.tori.iter_mut() {
        (torus.center, torus.axis) = (map(torus.center), map(torus.axis));
    }
    for curve in scene.curves.iter_mut() {
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
        scaled.camera.ray_length = scaled.camera.ray_length.map(|length| length * scale);
        scaled.tori.iter_mut().for_each(|t| t.major_radius *= scale);
        for beam in scaled.beams.iter_mut() {
            if let BeamEnd::Taper(length) = &mut beam.end {
                *length *= scale;
            }
        }
        scale_light(&mut scaled, scale);
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
    for (beam, original) in moved.beams.iter_mut().zip(&scene.beams) {
        beam.direction = original.direction;
    }
    for (torus, original) in moved.tori.iter_mut().zip(&scene.tori) {
        torus.axis = original.axis;
    }
    assert!(difference(&renderer.render(&moved).unwrap(), &image).max < ROUNDING);
}

/// A scene whose every number lies anywhere between the limits, by magnitude.
fn wild_scene(random: &mut fastrand::Rng) -> Scene {
    let magnitude = |random: &mut fastrand::Rng| 10_f64.powf(18.0 * random.f64() - 9.0).min(9e8);
    let scale = magnitude(random);
    let near = |random: &mut fastrand::Rng| {
        // Most points lie within one scale of each other, some anywhere.
        let scale = if random.u8(..8) == 0 {
            magnitude(random)
        } else {
            scale
        };
        DVec3::from([0; 3].map(|_| (scale * (2.0 * random.f64() - 1.0)).clamp(-9e8, 9e8)))
    };
    let mut scene = common::empty_scene(6, 4);
    scene.camera.eye = near(random);
    scene.camera.target = near(random);
    scene.camera.up = near(random);
    scene.camera.near = magnitude(random);
    scene.camera.fov_y = 1.0 + 178.0 * random.f64();
    scene.camera.ray_length = Some(magnitude(random));
    scene.integration.method = Method::simpson(8);
    scene.decay = random
        .bool()
        .then(|| Decay::new(magnitude(random), magnitude(random)));
    let eye = scene.camera.eye;
    let place = |random: &mut fastrand::Rng| {
        if random.u8(..6) == 0 {
            eye
        } else {
            near(random)
        }
    };
    for _ in 0..3 {
        let mut sphere = common::sphere([0.0; 3], 1.0);
        sphere.center = place(random);
        scene.spheres.push(sphere);
        let mut cylinder = common::cylinder([0.0; 3], [1.0; 3]);
        (cylinder.point, cylinder.direction) = (place(random), place(random));
        scene.cylinders.push(cylinder);
        let taper = random.bool().then(|| magnitude(random));
        let mut beam = common::beam([0.0; 3], [1.0; 3], taper);
        (beam.tip, beam.direction) = (place(random), place(random));
        scene.beams.push(beam);
        let mut torus = common::torus([0.0; 3], [1.0; 3], magnitude(random));
        (torus.center, torus.axis) = (place(random), place(random));
        scene.tori.push(torus);
        let mut curve = common::curve([[0.0; 3]; 3], None);
        curve.control_points = [place(random), place(random), place(random)];
        curve.intensity = random.bool().then(|| vec![1.0, 0.2, 0.7, 0.3]);
        scene.curves.push(curve);
    }
    scene
}

#[test]
fn every_pixel_of_every_valid_scene_is_finite() {
    let mut renderer = renderer(common::device().lanes, "");
    let mut valid = 0;
    for seed in 0..3000 {
        let scene = wild_scene(&mut fastrand::Rng::with_seed(seed));
        if scene.validate().is_err() {
            continue;
        }
        let scene = match seed % 3 {
            0 => common::squared(&scene),
            _ => scene,
        };
        if scene.validate().is_err() {
            continue;
        }
        valid += 1;
        let image = renderer.render(&scene).unwrap();
        let is_finite = image.as_slice().iter().all(|value| value.is_finite());
        assert!(is_finite, "seed {seed}: {scene:#?}\n{:?}", image.as_slice());
    }
    assert!(valid > 500, "only {valid} of the scenes are valid");
}

#[test]
fn a_tiny_curve_on_endless_rays_overflows_nothing() {
    let mut renderer = renderer(common::device().lanes, "");
    for size in [1e-3, 1e-5] {
        let mut scene = common::empty_scene(16, 12);
        scene.camera.ray_length = Some(1e9);
        let points = common::CURVE_SHAPES[0].map(|point| point.map(|x| x * size));
        let series = Some(vec![1.0, 0.5, 2.0]);
        scene.curves.push(common::curve(points, series));
        let image = renderer.render(&scene).unwrap();
        let expected = simpson_reference(&scene);
        let found = difference(&image, &expected);
        assert!(found.max < ROUNDING, "size {size}: {found:?}");
    }
}
