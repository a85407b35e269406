//! The method `exact` where it is hardest: rays through cores and along them, dark and tiny sources, extreme numbers.

use crate::common;
use crate::common::random::{KINDS, Kind, add_source, random_view};
use crate::common::{WORST_PIXEL, at_tolerance, difference, outer_lane_widths, renderer};
use energywave::image::ImageSize;
use energywave::scene::{Antialias, Camera, Curve, Decay, Measure, Method, Profile};
use energywave::{Scene, reference};
use glam::DVec3;

/// A view whose middle pixel looks at a point of a core, along a ray that float64 too takes for one through it.
fn through_a_core(kind: Kind) -> Scene {
    let mut camera = Camera::new(DVec3::new(0.0, -3.0, 0.0), DVec3::ZERO);
    camera.ray_length = Some(9.0);
    let mut scene = Scene::new(camera);
    scene.integration.antialias = Antialias::None;
    scene.integration.method = Method::exact(1e-4);
    scene.integration.measure = Measure::Parameter;
    scene.decay = Some(Decay::new(0.2, 0.3));
    scene.image = ImageSize {
        width: 5,
        height: 5,
    };
    let white = (1.0, DVec3::ONE);
    match kind {
        Kind::Sphere => scene.spheres.push(common::sphere([0.0; 3], 1.0)),
        Kind::Cylinder => scene
            .cylinders
            .push(common::cylinder([0.0; 3], [1.0, 0.2, 0.5])),
        Kind::Beam => scene.beams.push(common::beam(
            [-0.4, -0.08, -0.2],
            [1.0, 0.2, 0.5],
            Some(0.3),
        )),
        Kind::Torus => scene
            .tori
            .push(common::torus([0.0, 1.0, 0.0], [0.0, 0.3, 1.0], 1.0)),
        Kind::Curve => scene.curves.push(Curve {
            coefficient: white.0,
            color: white.1,
            profile: Profile::Inverse,
            ..Curve::new([[-1.0, 0.2, -0.5], [0.0, -0.2, 0.0], [1.0, 0.2, 0.5]].map(DVec3::from))
        }),
    }
    if kind == Kind::Torus {
        // The ring's nearest point to the eye.
        let torus = &mut scene.tori[0];
        torus.axis = DVec3::Z;
        torus.center = DVec3::new(0.0, 1.0, 0.0);
    }
    scene
}

#[test]
fn a_ray_through_a_core_has_the_finite_value_of_the_floored_field() {
    for kind in KINDS {
        let scene = through_a_core(kind);
        let expected = reference::render(&scene).unwrap();
        for lanes in outer_lane_widths() {
            let image = renderer(lanes, "").render(&scene).unwrap();
            let middle = 4 * (2 * 5 + 2);
            let (value, expected) = (image.as_slice()[middle], expected.as_slice()[middle]);
            let error = (value / expected - 1.0).abs();
            assert!(
                error < 1e-3,
                "{kind:?}, {lanes} lanes: {value}, not {expected}"
            );
        }
    }
}

/// Views and sources of which each once defeated a version of the kernels.
fn hard_views() -> Vec<(&'static str, Scene)> {
    let arch = [[-1.0, 0.0, 0.0], [0.0, 0.3, 1.5], [1.0, 0.0, 0.0]];
    let view = |eye: [f64; 3], target: [f64; 3]| {
        let mut scene = common::empty_scene(24, 24);
        (scene.camera.eye, scene.camera.target) = (eye.into(), target.into());
        scene.camera.ray_length = Some(common::far_beyond_target(&scene.camera));
        scene.integration.method = Method::default();
        scene
    };
    let usual = || view([0.0, -4.0, 2.0], [0.0; 3]);
    let odd = |mut scene: Scene| {
        scene.image = ImageSize {
            width: 25,
            height: 25,
        };
        scene
    };
    let mut views = Vec::new();

    let mut scene = usual();
    let mut series = vec![0.0; 10];
    (series[3], series[7]) = (1.0, 100.0);
    scene.curves.push(common::curve(arch, Some(series)));
    views.push(("dark stretches of a curve", scene));

    let mut scene = usual();
    let series = (0..100).map(|k| f64::from(k % 2)).collect();
    scene.curves.push(common::curve(arch, Some(series)));
    views.push(("a hundred weights", scene));

    let mut scene = usual();
    scene.decay = Some(Decay::new(1e-9, 1e-9));
    scene.curves.push(common::curve(arch, None));
    scene
        .tori
        .push(common::torus([0.0; 3], [0.0, 0.1, 1.0], 0.9));
    views.push(("all light at the ray's begin", scene));

    let mut scene = odd(view([0.0, 0.0, -4.0], [0.0; 3]));
    scene.camera.up = DVec3::Y;
    scene
        .cylinders
        .push(common::cylinder([0.0; 3], [0.0, 0.0, 1.0]));
    views.push(("along a line", scene));

    let mut scene = odd(view([0.0, -4.0, 0.0], [0.0; 3]));
    (scene.camera.near, scene.camera.ray_length) = (1e-6, Some(8.0));
    scene.spheres.push(common::sphere([0.0, -4.0, 0.0], 1.0));
    views.push(("from within a point", scene));

    for beside in [1e-4, 1e-2] {
        let x = 0.9 + beside;
        let mut scene = odd(view([x, -4.0, 0.0], [x, 0.0, 0.0]));
        scene
            .tori
            .push(common::torus([0.0; 3], [0.0, 0.0, 1.0], 0.9));
        views.push(("along a tangent of a ring", scene));
    }

    // The ray along the beam is within the floor of distances all the way, and its light falls with the taper.
    for taper in [0.5, 2.0, 13.0, 30.0] {
        let mut scene = odd(view([0.0, -4.0, 0.0], [0.0; 3]));
        let beam = common::beam([0.0, 10.0, 0.0], [0.0, 1.0, 0.0], Some(taper));
        scene.beams.push(beam);
        views.push(("along a taper", scene));
    }
    // The rays' lines meet at the eye, on the core, but the stretch that is lit is far from there, and short.
    for (tip, along) in [([0.0, 10.0, 0.0], 1.0), ([0.3, -3.0, 0.2], -1.0)] {
        for taper in [1e-5, 1e-7, 1e-9] {
            let mut scene = odd(view([0.0, -4.0, 0.0], [0.0; 3]));
            scene.decay = None;
            let mut beam = common::beam(tip, [0.0, along, 0.0], Some(taper));
            beam.sphere_coefficient = 1e-12;
            scene.beams.push(beam);
            views.push(("a short taper seen from its line", common::squared(&scene)));
        }
    }

    let mut scene = usual();
    scene.camera.ray_length = Some(1e5);
    scene
        .tori
        .push(common::torus([0.0; 3], [0.0, 0.0, 1.0], 0.9));
    views.push(("so long a ray that the floor of distances is wide", scene));
    views
}

#[test]
fn hard_views_meet_the_tolerance() {
    let mut renderer = renderer(common::device().lanes, "");
    for (name, scene) in hard_views() {
        let expected = reference::render(&scene).unwrap();
        for tolerance in [1e-3, 1e-5] {
            let scene = at_tolerance(&scene, tolerance);
            let found = difference(&renderer.render(&scene).unwrap(), &expected);
            assert!(
                found.max <= (10.0 * tolerance).max(WORST_PIXEL),
                "{name} at {tolerance:e}: {found:?}"
            );
        }
    }
}

/// Scenes meant to break something: cameras on cores, rings around the eye, rays along lines and axes, extreme numbers.
fn awkward_scene(seed: u64) -> Scene {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut scene = random_view(&mut random, 5);
    for kind in KINDS {
        add_source(&mut random, kind, &mut scene);
    }
    let eye = scene.camera.eye;
    let ahead = scene.camera.target - eye;
    match seed % 8 {
        0 => scene.spheres.push(common::sphere(eye.to_array(), 1.0)),
        1 => scene
            .cylinders
            .push(common::cylinder(eye.to_array(), ahead.to_array())),
        2 => scene
            .tori
            .push(common::torus(eye.to_array(), ahead.to_array(), 1e-6)),
        3 => scene.tori.push(common::torus(
            (eye + DVec3::X).to_array(),
            [0.0, 1.0, 0.0],
            1.0,
        )),
        4 => scene.curves.push(common::curve(
            [eye.to_array(); 3],
            Some(vec![1.0, 0.0, -1.0]),
        )),
        5 => {
            let points = [eye, eye + ahead, eye + 2.0 * ahead].map(|p| p.to_array());
            scene.curves.push(common::curve(points, None));
        }
        6 => {
            let points = [eye + ahead, eye, eye + ahead].map(|p| p.to_array());
            scene.curves.push(common::curve(points, Some(vec![0.0; 5])));
        }
        _ => {
            let huge = 10_f64.powf(8.0 * random.f64());
            scene
                .tori
                .push(common::torus([huge, 0.0, 0.0], [1.0, huge, 0.0], huge));
            scene
                .spheres
                .push(common::sphere([0.0, huge, 0.0], 1.0 / huge));
            scene.camera.near *= 1e-4;
        }
    }
    let spread = |random: &mut fastrand::Rng| 10_f64.powf(6.0 * random.f64() - 4.0);
    if random.bool() {
        scene.decay = Some(Decay::new(spread(&mut random), spread(&mut random)));
    }
    at_tolerance(&scene, if random.bool() { 1e-3 } else { 1e-6 })
}

#[test]
fn every_pixel_of_every_valid_scene_is_finite() {
    let mut renderer = renderer(common::device().lanes, "");
    let mut drawn = 0;
    for seed in 0..400 {
        let scene = awkward_scene(seed);
        if scene.validate().is_err() {
            continue;
        }
        drawn += 1;
        let image = renderer.render(&scene).unwrap();
        assert!(
            image.as_slice().iter().all(|value| value.is_finite()),
            "seed {seed}: {scene:?}"
        );
    }
    assert!(drawn > 350, "only {drawn} scenes were valid");
}
