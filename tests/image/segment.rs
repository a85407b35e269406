//! Segments against the definition: 1 over the distance to the nearest point between the ends, or its square,
//! integrated in float64 without a closed form.

use crate::common;
use crate::common::random::random_view;
use crate::common::{at_tolerance, difference, meets, outer_lane_widths, renderer, sampled};
use energywave::internals::{exact, integrate, sources};
use energywave::scene::{Decay, Method, Profile, Ray, Sampling, Segment, Sphere};
use energywave::{Renderer, Scene, reference};
use fastrand::Rng;
use glam::DVec3;

const PROFILES: [Profile; 2] = [Profile::Inverse, Profile::InverseSquare];

/// The reference's own error, and that of the definition's integral below.
const REFERENCE_ERROR: f64 = 1e-8;

/// Sums of the same float32 terms in another order.
const ROUNDING: f64 = 3e-6;

fn segment(from: [f64; 3], to: [f64; 3], profile: Profile) -> Segment {
    Segment {
        coefficient: 1.3,
        color: DVec3::new(0.3, 1.0, 0.6),
        profile,
        ..Segment::new(from.into(), to.into())
    }
}

/// The distance from a point to the nearest of the points from one end to the other.
fn distance(segment: &Segment, point: DVec3) -> f64 {
    let span = segment.to - segment.from;
    let share = match span.length_squared() {
        0.0 => 0.0,
        square => ((point - segment.from).dot(span) / square).clamp(0.0, 1.0),
    };
    point.distance(segment.from + span * share)
}

/// The integral over s in `[0,1]` by the definition, cut at 200 places and wherever the distance is least between them.
fn by_definition(segment: &Segment, ray: &Ray, decay: Option<Decay>) -> f64 {
    let of = |s: f64| distance(segment, ray.at(s)).max(1e-6 * ray.span.length());
    let mut breaks: Vec<f64> = (1..200).map(|k| f64::from(k) / 200.0).collect();
    for k in 1..200 {
        let (mut from, mut to) = (f64::from(k - 1) / 200.0, f64::from(k + 1) / 200.0);
        for _ in 0..80 {
            let (left, right) = (from + (to - from) / 3.0, to - (to - from) / 3.0);
            let is_left = of(left) < of(right);
            (from, to) = if is_left { (from, right) } else { (left, to) };
        }
        breaks.push(0.5 * (from + to));
    }
    let field = |s: f64| match segment.profile {
        Profile::InverseSquare => of(s).powi(-2),
        _ => 1.0 / of(s),
    };
    let integrand = |s: f64| field(s) * decay.map_or(1.0, |decay| decay.at(s));
    integrate(integrand, &mut breaks, 1.0, 1e-11).value
}

/// Rays past the segment from (-1, 0, 0) to (1, 0, 0): across it, beside its ends, level with their planes, along it,
/// beside it and beyond, and close to it.
fn hard_rays() -> Vec<Ray> {
    let ray = |from: [f64; 3], to: [f64; 3]| Ray::between(from.into(), to.into());
    vec![
        ray([0.2, -3.0, 0.1], [0.3, 4.0, 0.2]),
        ray([-1.0, -3.0, 0.5], [-1.0, 3.0, 0.5]),
        ray([1.0, -3.0, 1e-3], [1.0, 3.0, 1e-3]),
        ray([-4.0, 0.02, 0.0], [5.0, 0.02, 0.0]),
        ray([-4.0, 0.0, 0.3], [-1.2, 0.0, 0.3]),
        ray([1.5, -2.0, 0.4], [6.0, 3.0, -0.2]),
        ray([0.5, -2.0, 1e-4], [0.5, 2.0, -1e-4]),
        ray([-1.001, -2.0, 2e-4], [-1.001, 2.0, 2e-4]),
        ray([4.0, 0.3, 0.2], [-3.0, -0.2, 0.1]),
        ray([0.0, 0.5, 0.0], [0.1, 0.6, 0.0]),
    ]
}

fn scene_of(segment: Segment, decay: Option<Decay>) -> Scene {
    let mut scene = common::empty_scene(32, 32);
    scene.decay = decay;
    scene.segments.push(segment);
    scene
}

fn decays() -> [Option<Decay>; 3] {
    [(0.1, 0.1), (0.5, 2.0)]
        .map(|(alpha, beta)| Some(Decay::new(alpha, beta)))
        .into_iter()
        .chain([None])
        .collect::<Vec<_>>()
        .try_into()
        .unwrap()
}

#[test]
fn the_reference_is_the_definition_and_a_moved_end_is_noticed() {
    let ends = [
        ([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ([0.3, 0.1, 0.2], [0.3, 0.1, 0.2]),
    ];
    for ((from, to), profile) in ends.into_iter().flat_map(|e| PROFILES.map(|p| (e, p))) {
        for (decay, ray) in decays()
            .into_iter()
            .flat_map(|d| hard_rays().into_iter().map(move |r| (d, r)))
        {
            let one = segment(from, to, profile);
            let expected = by_definition(&one, &ray, decay);
            let value = |segment: Segment| {
                let scene = scene_of(segment, decay);
                let integrand = energywave::internals::Integrand {
                    decay,
                    absorption: None,
                    softening: 0.0,
                };
                exact(&sources(&scene)[0], &ray, &integrand, 1.0)
            };
            let error = (value(one.clone()) / expected - 1.0).abs();
            assert!(
                error < REFERENCE_ERROR,
                "{one:?} {ray:?} {decay:?}: {error:e}"
            );
            let moved = Segment {
                to: one.to + DVec3::new(0.0, 0.01, 0.01),
                from: one.from - DVec3::new(0.0, 0.02, 0.01),
                ..one
            };
            assert!((value(moved) / expected - 1.0).abs() > REFERENCE_ERROR);
        }
    }
}

/// The segment of the hard rays, and their integrals.
struct Known {
    scene: Scene,
    expected: Vec<f64>,
}

fn known(profile: Profile, decay: Option<Decay>) -> Known {
    let one = segment([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], profile);
    let light = one.coefficient * one.color.y;
    let integral = |ray: &Ray| light * by_definition(&one, ray, decay);
    Known {
        expected: hard_rays().iter().map(integral).collect(),
        scene: scene_of(one, decay),
    }
}

/// The worst error of the hard rays, relative to the definition.
fn worst(renderer: &mut Renderer, known: &Known, tolerance: f64) -> f64 {
    let mut scene = known.scene.clone();
    scene.integration.method = Method::exact(tolerance);
    let found = renderer.integrate(&scene, &hard_rays()).unwrap();
    let pairs = found.iter().zip(&known.expected);
    let errors = pairs.map(|([_, green, _], expected)| (green / expected - 1.0).abs());
    errors.fold(0.0, f64::max)
}

#[test]
fn hard_rays_meet_every_tolerance_on_one_lane_and_many_and_a_spoiled_closed_form_does_not() {
    let ways = PROFILES.into_iter().flat_map(|p| decays().map(|d| (p, d)));
    let all: Vec<Known> = ways.map(|(profile, decay)| known(profile, decay)).collect();
    for lanes in outer_lane_widths() {
        let mut renderer = renderer(lanes, "");
        for known in &all {
            for tolerance in [1e-1, 1e-3, 1e-5] {
                let error = worst(&mut renderer, known, tolerance);
                let allowed = tolerance.max(2e-5);
                let what = &known.scene.segments[0];
                assert!(
                    error < allowed,
                    "{lanes} lanes, {what:?}, {tolerance:e}: {error:e}"
                );
            }
        }
    }
    let plain = known(Profile::Inverse, None);
    let spoiled = worst(&mut renderer(8, "-DHALF_LN_2=0.35f"), &plain, 1e-3);
    assert!(spoiled > 1e-3, "the spoiled build passed: {spoiled:e}");
}

/// One to four segments in a view of any kind.
fn random_scene(seed: u64) -> Scene {
    let mut random = Rng::with_seed(900 + seed);
    let mut scene = random_view(&mut random, 48);
    for _ in 0..random.u32(1..5) {
        let mut point = || DVec3::from([0; 3].map(|_| 2.0 * random.f64() - 1.0));
        let (from, to) = (point(), point());
        let short = from + 1e-3 * to;
        scene.segments.push(Segment {
            coefficient: 0.5 + random.f64(),
            profile: PROFILES[random.usize(0..2)],
            ..Segment::new(from, if random.u32(0..5) == 0 { short } else { to })
        });
    }
    if random.bool() {
        let distance = (scene.camera.eye.length() + random.f64()) as f32;
        scene.depth = Some(common::depths(
            &scene,
            energywave::image::DepthAlong::Ray,
            |column, row| match column + row {
                ..40 => f64::from(distance) + 0.01 * f64::from(row),
                40..60 => f64::INFINITY,
                _ => 0.9 * f64::from(distance),
            },
        ));
    }
    scene
}

#[test]
fn random_images_meet_the_tolerance_by_tiles_and_by_pixels_with_and_without_depth() {
    let mut renderer = renderer(common::device().lanes, "");
    for seed in 0..10 {
        let scene = random_scene(seed);
        let expected = reference::render(&scene).unwrap();
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
            for sampling in [Sampling::Pixels, Sampling::Tiles] {
                let scene = sampled(&at_tolerance(&scene, tolerance), sampling);
                let image = renderer.render(&scene).unwrap();
                let found = difference(&image, &expected);
                assert!(
                    meets(&found, tolerance),
                    "seed {seed}, {tolerance:e}, {sampling:?}: {found:?}"
                );
            }
        }
    }
    let scene = random_scene(0);
    let mut broken = common::renderer(8, common::BROKEN_FIELDS);
    let simpson = |scene: &Scene| {
        let mut scene = scene.clone();
        scene.integration.method = Method::simpson(256);
        scene
    };
    let right = renderer.render(&simpson(&scene)).unwrap();
    let wrong = broken.render(&simpson(&scene)).unwrap();
    assert!(difference(&right, &common::simpson_reference(&simpson(&scene))).p999 < 1e-4);
    assert!(
        difference(&wrong, &right).max > 5e-3,
        "the spoiled field passed"
    );
}

#[test]
fn ends_that_coincide_make_a_point_and_a_long_one_a_line() {
    let mut renderer = renderer(common::device().lanes, "");
    for profile in PROFILES {
        let mut draw = |add: &dyn Fn(&mut Scene)| {
            let mut scene = common::empty_scene(33, 21);
            scene.integration.method = common::by(Sampling::Pixels);
            add(&mut scene);
            renderer.render(&scene).unwrap()
        };
        let place = [0.2, -0.1, 0.3];
        let point = draw(&|scene| scene.segments.push(segment(place, place, profile)));
        let sphere = draw(&|scene| {
            scene.spheres.push(Sphere {
                center: place.into(),
                coefficient: 1.3,
                color: DVec3::new(0.3, 1.0, 0.6),
                profile,
                ..Sphere::default()
            });
        });
        let found = difference(&point, &sphere);
        assert!(found.max < ROUNDING, "{profile:?}: {found:?}");

        let along = DVec3::new(0.9, 0.3, -0.4);
        let long = draw(&|scene| {
            let (from, to) = (
                DVec3::from(place) - 1e3 * along,
                DVec3::from(place) + 1e3 * along,
            );
            scene
                .segments
                .push(segment(from.into(), to.into(), profile));
        });
        let line = draw(&|scene| {
            scene.cylinders.push(energywave::scene::Cylinder {
                point: place.into(),
                coefficient: 1.3,
                color: DVec3::new(0.3, 1.0, 0.6),
                profile,
                ..energywave::scene::Cylinder::new(along)
            });
        });
        let found = difference(&long, &line);
        assert!(found.max < 1e-4, "{profile:?}: {found:?}");
        assert!(difference(&long, &point).max > 0.1);
    }
}

#[test]
fn a_file_names_its_keys_and_a_wrong_one_its_place() {
    let scene = "[camera]\neye = [0.0, -4.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\n[[segment]]\nfrom = [0.0, 0.0, 0.0]\n";
    let read = |rest: &str| Scene::from_toml(&format!("{scene}{rest}"));
    let whole = read("to = [1.0, 0.0, 0.0]\nprofile = \"inverse-square\"\n").unwrap();
    assert_eq!(whole.segments[0].to, DVec3::X);
    for (rest, words) in [
        ("", "scene:4:1: segment[0].to: required, but missing"),
        (
            "to = [1.0, nan, 0.0]\n",
            "6:6: segment[0].to: NaN is not a finite number",
        ),
        ("to = [1.0, 0.0]\n", "expected three numbers, found 2"),
        (
            "to = [1.0, 0.0, 0.0]\nmajor_radius = 1.0\n",
            "unknown field `major_radius`",
        ),
    ] {
        let message = read(rest).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
}
