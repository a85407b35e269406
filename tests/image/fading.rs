//! How light fades along a ray: decays of every power, and absorption, for every kind of source. The truth is the
//! definition, summed in float64, and for points and lines the closed forms.

use energywave::image::DepthAlong;
use energywave::internals::{Integrand, Source, exact, integrate, sources};
use energywave::scene::{
    Absorption, Beam, Curve, Cylinder, Decay, LightPath, Method, PathShape, Profile, Ray, Sampling,
    Segment, Sphere, Torus,
};
use energywave::{Scene, reference};
use glam::DVec3;

use crate::common::{self, at_tolerance, difference, meets, renderer, sampled};

/// The reference's own error, and that of the definition's integral.
const REFERENCE_ERROR: f64 = 1e-8;

/// Integrals below this share of the greatest are measured by it.
const LEAST_LIGHT: f64 = 1e-6;

/// A decay of any power.
pub fn decay(power: u32, beta: f64) -> Option<Decay> {
    Some(Decay {
        power,
        ..Decay::new(0.3, beta)
    })
}

pub fn absorbing(kappa: f64) -> Option<Absorption> {
    Some(Absorption { kappa })
}

/// How light fades, each with what a test that is to fail takes for it.
fn fadings() -> Vec<[(Option<Decay>, Option<Absorption>); 2]> {
    vec![
        [(decay(0, 0.2), None), (decay(1, 0.2), None)],
        [(None, absorbing(0.7)), (None, absorbing(0.8))],
        [(decay(0, 0.2), absorbing(9.0)), (None, absorbing(9.0))],
        [(decay(1, 0.3), None), (decay(2, 0.3), None)],
        [(decay(1, 1e-6), absorbing(0.2)), (decay(1, 2e-6), None)],
        [(decay(2, 0.1), absorbing(0.4)), (decay(2, 0.1), None)],
        [
            (decay(2, 1e-3), absorbing(200.0)),
            (decay(2, 1e-3), absorbing(210.0)),
        ],
        [(decay(3, 0.5), None), (decay(2, 0.5), None)],
        [
            (decay(3, 1e-7), absorbing(1.0)),
            (decay(3, 1e-6), absorbing(1.0)),
        ],
    ]
}

/// One source of every kind.
fn every_kind(profile: Profile, radius: f64, reach: Option<f64>) -> Scene {
    let mut scene = common::empty_scene(32, 32);
    scene.spheres.push(Sphere {
        center: DVec3::new(0.1, 0.2, 0.0),
        ..Sphere::default()
    });
    scene.cylinders.push(Cylinder {
        point: DVec3::new(0.0, 0.4, 0.3),
        ..Cylinder::new(DVec3::X)
    });
    scene.beams.push(Beam::new(DVec3::X));
    scene.tori.push(Torus::new(0.9));
    scene.curves.push(Curve::new([
        DVec3::new(-1.0, 0.3, 0.2),
        DVec3::new(0.2, 0.9, 0.6),
        DVec3::new(0.9, -0.4, 0.1),
    ]));
    scene.segments.push(Segment::new(-DVec3::X, DVec3::X));
    let corners = [[-0.8, 0.5, -0.2], [0.1, -0.4, 0.3], [0.8, 0.3, 0.5]];
    scene.paths.push(LightPath {
        shape: PathShape::Polyline,
        ..LightPath::new(corners.map(DVec3::from).to_vec())
    });
    macro_rules! set {
        ($($list:ident),*) => {
            $(for source in &mut *scene.$list {
                (source.profile, source.radius, source.reach) = (profile, radius, reach);
            })*
        };
    }
    set!(spheres, cylinders, beams, tori, curves, segments, paths);
    scene
}

/// Rays past them, of several lengths; the last but one ends within them, the last begins there.
pub fn rays() -> Vec<Ray> {
    let ray = |from: [f64; 3], to: [f64; 3]| Ray::between(from.into(), to.into());
    vec![
        ray([0.2, -3.0, 0.1], [0.3, 4.0, 0.2]),
        ray([0.4, -2.0, 0.3], [0.1, 3.0, -0.2]),
        ray([-3.0, 0.3, 0.2], [4.0, -0.1, 0.1]),
        ray([0.9, -2.0, 0.003], [0.7, 9.0, 0.001]),
        ray([-0.1, 0.1, 2.0], [0.1, 0.0, -0.1]),
        ray([0.1, 0.2, 0.1], [1.5, 0.4, 0.3]),
    ]
}

pub fn faded(scene: &Scene, (decay, absorption): (Option<Decay>, Option<Absorption>)) -> Scene {
    let mut scene = scene.clone();
    (scene.decay, scene.absorption) = (decay, absorption);
    scene
}

/// The integrals of a scene's light along the rays, by the reference.
pub fn by_reference(scene: &Scene) -> Vec<f64> {
    let integrand = Integrand {
        decay: scene.decay,
        absorption: scene.absorption,
        softening: 0.0,
    };
    let parts = sources(scene);
    let light = |ray: &Ray| {
        parts
            .iter()
            .map(|part| exact(part, ray, &integrand, 1.0))
            .sum()
    };
    rays().iter().map(light).collect()
}

/// The same by the definition: the field without fading, times what fades it, cut at many places.
fn by_definition(scene: &Scene) -> Vec<f64> {
    let plain = Integrand {
        decay: None,
        absorption: None,
        softening: 0.0,
    };
    let (decay, kappa) = (scene.decay, scene.absorption.map_or(0.0, |it| it.kappa));
    let parts = sources(scene);
    let light = |ray: &Ray| {
        let length = ray.span.length();
        let fading = |s: f64| {
            let zeta = decay.map_or(1.0, |it| {
                it.alpha * (s + it.beta).powf(-f64::from(it.power))
            });
            zeta * (-kappa * length * s).exp()
        };
        let of_part = |part: &Source| {
            let mut breaks: Vec<f64> = (1..200).map(|k| f64::from(k) / 200.0).collect();
            breaks.extend((1..10).map(|k| 10_f64.powi(-k)));
            part.field.breaks(ray, &mut breaks);
            integrate(
                |s| fading(s) * plain.at(part, ray, s),
                &mut breaks,
                1.0,
                1e-11,
            )
            .value
        };
        parts.iter().map(of_part).sum()
    };
    rays().iter().map(light).collect()
}

#[test]
fn the_reference_is_the_definition() {
    for [fading, other] in fadings() {
        let scene = |fading| faded(&every_kind(Profile::Inverse, 0.01, None), fading);
        let expected = by_definition(&scene(fading));
        let worst = |found: Vec<f64>| {
            let pairs = found.iter().zip(&expected);
            pairs.fold(0.0, |most: f64, (a, b)| most.max((a / b - 1.0).abs()))
        };
        let error = worst(by_reference(&scene(fading)));
        assert!(error < REFERENCE_ERROR, "{fading:?}: {error:e}");
        assert!(worst(by_reference(&scene(other))) > 1e-3, "{other:?}");
    }
}

#[test]
fn every_kind_meets_every_tolerance_and_other_fadings_do_not() {
    let shapes = [
        (Profile::Inverse, 0.0, None),
        (Profile::InverseSquare, 0.05, None),
        (Profile::InverseCube, 0.1, None),
        (Profile::Inverse, 0.02, Some(0.7)),
        (Profile::Smeared, 0.1, None),
        (Profile::Gaussian, 0.2, None),
        (Profile::Inverse, 0.0, None),
        (Profile::InverseSquare, 0.0, None),
        (Profile::InverseSquare, 0.05, Some(0.6)),
    ];
    let mut own = renderer(common::device().lanes, "");
    // Each tolerance three times: every one is a program that takes long to compile.
    let tolerances = [&[1e-1, 1e-4], &[1e-2, 1e-5], &[1e-3, 1e-1]]
        .into_iter()
        .cycle();
    let cases = fadings().into_iter().zip(shapes).zip(tolerances);
    for (([fading, other], (profile, radius, reach)), tolerances) in cases {
        let mut scene = faded(&every_kind(profile, radius, reach), fading);
        let expected = by_reference(&scene);
        let others = by_reference(&faded(&scene, other));
        let worst = |found: &[[f64; 3]], expected: &[f64]| {
            let most = expected.iter().copied().fold(0.0, f64::max);
            let error = |([_, green, _], expected): (&[f64; 3], &f64)| {
                (green - expected).abs() / expected.max(LEAST_LIGHT * most)
            };
            found.iter().zip(expected).map(error).fold(0.0, f64::max)
        };
        for &tolerance in tolerances {
            scene.integration.method = Method::exact(tolerance);
            let found = own.integrate(&scene, &rays()).unwrap();
            let error = worst(&found, &expected);
            assert!(
                error <= tolerance.max(2e-5),
                "{fading:?}, {profile:?} at {tolerance:e}: {error:e}"
            );
            let error = worst(&found, &others);
            assert!(error > 1e-2, "{other:?} for {fading:?}: {error:e}");
        }
    }
}

/// A scene with depths, some of which hide all, as an image.
fn hidden(fading: (Option<Decay>, Option<Absorption>), size: u32) -> Scene {
    let mut scene = faded(&every_kind(Profile::Inverse, 0.02, None), fading);
    (scene.image.width, scene.image.height) = (size, size);
    (scene.beams, scene.cylinders, scene.curves, scene.paths) = Default::default();
    scene.integration.method = Method::default();
    let distance = scene.camera.eye.length();
    scene.depth = Some(common::depths(
        &scene,
        DepthAlong::Ray,
        |column, row| match column + row {
            ..60 => distance + 0.01 * f64::from(row),
            60..90 => f64::INFINITY,
            _ => 0.9 * distance,
        },
    ));
    scene
}

#[test]
fn hidden_images_meet_the_tolerance_by_tiles_and_by_pixels() {
    let mut renderer = renderer(common::device().lanes, "");
    let fading = (decay(2, 0.2), absorbing(0.5));
    let scene = hidden(fading, 96);
    let expected = reference::render(&scene).unwrap();
    for sampling in [Sampling::Pixels, Sampling::Tiles] {
        let scene = sampled(&at_tolerance(&scene, 1e-3), sampling);
        let found = difference(&renderer.render(&scene).unwrap(), &expected);
        assert!(meets(&found, 1e-3), "{sampling:?}: {found:?}");
        let other = faded(&scene, (decay(2, 0.2), absorbing(0.55)));
        let found = difference(&renderer.render(&other).unwrap(), &expected);
        assert!(!meets(&found, 1e-3), "{sampling:?}: {found:?}");
    }
}

#[test]
fn simpsons_rule_fades_as_the_reference_does() {
    let mut renderer = renderer(common::device().lanes, "");
    let mut scene = hidden((decay(1, 0.2), absorbing(0.5)), 40);
    scene.integration.method = Method::simpson(64);
    for depth in [scene.depth.clone(), None] {
        scene.depth = depth;
        let expected = reference::render_simpson(&scene, 64).unwrap();
        let found = difference(&renderer.render(&scene).unwrap(), &expected);
        assert!(found.max < 1e-4, "{found:?}");
    }
}

#[test]
fn what_does_not_fade_light_changes_no_bit() {
    let mut renderer = renderer(common::device().lanes, "");
    let mut draw = |fading| {
        let mut scene = faded(&every_kind(Profile::Inverse, 0.0, None), fading);
        (scene.curves, scene.beams, scene.tori, scene.paths) = Default::default();
        scene.integration.method = common::by(Sampling::Pixels);
        renderer.render(&scene).unwrap()
    };
    let plain = draw((None, None));
    let alpha = |alpha| {
        Some(Decay {
            power: 0,
            ..Decay::new(alpha, 0.4)
        })
    };
    assert_eq!(draw((None, absorbing(0.0))), plain);
    assert_eq!(draw((alpha(1.0), None)), plain);
    let halves = draw((alpha(0.5), None));
    let pairs = halves.as_slice().chunks(4).zip(plain.as_slice().chunks(4));
    assert!(
        pairs
            .into_iter()
            .all(|(half, whole)| half[1] == 0.5 * whole[1])
    );
    let square = draw((Some(Decay::new(0.3, 0.2)), None));
    assert_eq!(draw((decay(2, 0.2), absorbing(0.0))), square);
    assert_ne!(draw((decay(2, 0.2), absorbing(1e-3))), square);
}

#[test]
fn a_file_names_powers_and_absorption_and_a_wrong_one_its_place() {
    let head = "[camera]\neye = [0.0, -4.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\n";
    let read = |rest: &str| Scene::from_toml(&format!("{head}{rest}"));
    let scene =
        read("[decay]\nalpha = 1\nbeta = 0.5\npower = 3\n[absorption]\nkappa = 0.25\n").unwrap();
    let expected = Decay {
        power: 3,
        ..Decay::new(1.0, 0.5)
    };
    assert_eq!(
        (scene.decay, scene.absorption),
        (Some(expected), absorbing(0.25))
    );
    assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene);
    let plain = read("[decay]\nalpha = 1\nbeta = 0.5\n").unwrap();
    assert_eq!(plain.decay, Some(Decay::new(1.0, 0.5)));
    assert!(!plain.to_toml().unwrap().contains("power"));
    for (rest, words) in [
        (
            "[decay]\nalpha = 1\nbeta = 0.5\npower = 4\n",
            "scene:7:9: decay.power: 4; light decays by one of the powers 0, 1, 2 and 3",
        ),
        (
            "[decay]\nalpha = 1\nbeta = 0.5\npower = 1.5\n",
            "decay.power",
        ),
        (
            "[decay]\nalpha = 1\nbeta = 0.5\npower = -1\n",
            "decay.power",
        ),
        (
            "[absorption]\nkappa = -0.1\n",
            "scene:5:9: absorption.kappa: light that passes is absorbed",
        ),
        ("[absorption]\nkappa = nan\n", "absorption.kappa"),
        ("[absorption]\n", "absorption.kappa: required, but missing"),
        (
            "[[absorption]]\nkappa = 1\n",
            "a scene has one: write single brackets, [absorption]",
        ),
        (
            "[decay]\nalpha = 1e9\nbeta = 1e-9\npower = 3\n",
            "decay.beta: alpha / beta^3 next to a core",
        ),
    ] {
        let message = read(rest).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
}
