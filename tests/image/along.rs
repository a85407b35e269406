//! Cores along which light changes, against the definition: the nearest of many points of the core, each with a share
//! of its length, at which series are looked up; integrated in float64.

use energywave::internals::{Integrand, Source, exact, integrate, sources};
use energywave::scene::{
    Camera, Dashes, Group, LightPath, Measure, Method, PathShape, Profile, Ray, Rotation, Sampling,
    Segment, Torus,
};
use energywave::{Renderer, Scene, reference};
use glam::{DQuat, DVec3};

use crate::common;
use crate::common::{at_tolerance, difference, lane_widths, meets, renderer, sampled};
use crate::path_core::{at, piece_count};

/// The definition's own error, by its samples of the core.
const DEFINITION_ERROR: f64 = 2e-5;

/// Points of a core that the definition takes.
const POINTS: usize = 2400;

/// A scene of one source, and what the definition needs to know of that.
struct Case {
    name: &'static str,
    scene: Scene,
    /// From where to where the core is there, in shares of its length.
    runs: Vec<[f64; 2]>,
    /// A point of the core at a share of its length.
    at: Box<dyn Fn(f64) -> DVec3>,
    /// The emission's green and the radius at a share.
    lit: Box<dyn Fn(f64) -> (f64, f64)>,
    profile: Profile,
    reach: f64,
}

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn scene() -> Scene {
    let mut scene = common::empty_scene(64, 48);
    scene.camera = Camera::new(v(0.2, -4.0, 0.8), DVec3::ZERO);
    scene.decay = None;
    scene.integration.measure = Measure::Length;
    scene.integration.method = Method::exact(1e-3);
    scene
}

/// Values at equal steps, linear between.
fn series(values: &'static [f64]) -> impl Fn(f64) -> f64 {
    move |share| {
        let x = share * (values.len() - 1) as f64;
        let k = (x as usize).min(values.len() - 2);
        values[k] + (values[k + 1] - values[k]) * (x - k as f64)
    }
}

fn cases() -> Vec<Case> {
    let (from, to) = (v(-1.3, 0.2, -0.3), v(1.1, -0.3, 0.5));
    let length = from.distance(to);
    let mut cone = scene();
    cone.segments.push(Segment {
        radii: Some(vec![0.02, 0.3]),
        taper_lengths: [0.5, 0.0],
        ..Segment::new(from, to)
    });
    let mut dashed = scene();
    dashed.segments.push(Segment {
        dashes: Some(Dashes {
            fill: 0.4,
            offset: 0.7,
            ..Dashes::new(3)
        }),
        colors: Some(vec![DVec3::ONE, v(0.5, 0.2, 1.0), v(0.1, 1.5, 0.4)]),
        radius: 0.05,
        reach: Some(0.6),
        peak: Some(1.0),
        ..Segment::new(from, to)
    });
    let peak_of_dashes = dashed.segments[0].radius;
    let (axis, start) = (v(0.2, -1.0, 0.4), v(1.0, 0.3, 1.0));
    let x = start - axis * (start.dot(axis) / axis.length_squared());
    let x = 0.9 * x.normalize();
    let y = axis.normalize().cross(x);
    let ring = move |degrees: f64| {
        let angle = degrees.to_radians();
        x * angle.cos() + y * angle.sin()
    };
    let mut part = scene();
    part.tori.push(Torus {
        axis,
        start: Some(start),
        sweep: Some([-40.0, 200.0]),
        intensity: Some(vec![0.2, 1.0, 0.5]),
        profile: Profile::Inverse,
        radius: 0.03,
        ..Torus::new(0.9)
    });
    let mut marks = scene();
    marks.tori.push(Torus {
        axis,
        start: Some(start),
        dashes: Some(Dashes::new(5)),
        radii: Some(vec![0.02, 0.2, 0.02]),
        reach: Some(0.5),
        ..Torus::new(0.9)
    });
    let spline = LightPath {
        shape: PathShape::Spline,
        radii: Some(vec![0.1, 0.02, 0.06]),
        profile: Profile::InverseCube,
        reach: Some(0.7),
        peak: Some(0.8),
        flatness: Some(1e-7),
        ..LightPath::new(vec![from, v(-0.4, 0.1, 0.5), v(0.3, -0.2, -0.4), to])
    };
    let mut thick = scene();
    thick.paths.push(spline.clone());
    let lengths = lengths_of(&spline);
    // A peak is met where the radii are named, and its coefficient is linear between.
    let coefficients =
        [0.1, 0.02, 0.06].map(|radius| 0.8 / across(Profile::InverseCube, radius, 0.7));
    vec![
        Case {
            name: "a cone with a taper",
            scene: cone,
            runs: vec![[0.0, 1.0]],
            at: Box::new(move |share| from.lerp(to, share)),
            lit: Box::new(move |share| ((share * length / 0.5).min(1.0), 0.02 + 0.28 * share)),
            profile: Profile::InverseSquare,
            reach: f64::INFINITY,
        },
        Case {
            name: "dashes of many colours",
            scene: dashed,
            runs: vec![
                [0.7 / 3.0, 1.1 / 3.0],
                [1.7 / 3.0, 2.1 / 3.0],
                [2.7 / 3.0, 1.0],
                [0.0, 0.1 / 3.0],
            ],
            at: Box::new(move |share| from.lerp(to, share)),
            lit: Box::new(move |share| {
                let coefficient = 1.0 / across(Profile::InverseSquare, peak_of_dashes, 0.6);
                (coefficient * series(&[1.0, 0.2, 1.5])(share), 0.05)
            }),
            profile: Profile::InverseSquare,
            reach: 0.6,
        },
        Case {
            name: "part of a ring",
            scene: part,
            runs: vec![[0.0, 1.0]],
            at: Box::new(move |share| ring(-40.0 + 240.0 * share)),
            lit: Box::new(|share| (series(&[0.2, 1.0, 0.5])(share), 0.03)),
            profile: Profile::Inverse,
            reach: f64::INFINITY,
        },
        Case {
            name: "a ring of dashes",
            scene: marks,
            runs: (0..5)
                .map(|k| [0.2 * f64::from(k), 0.2 * f64::from(k) + 0.1])
                .collect(),
            at: Box::new(move |share| ring(360.0 * share)),
            lit: Box::new(|share| (1.0, series(&[0.02, 0.2, 0.02])(share))),
            profile: Profile::InverseSquare,
            reach: 0.5,
        },
        Case {
            name: "a spline of changing thickness",
            scene: thick,
            runs: vec![[0.0, 1.0]],
            at: Box::new(move |share| {
                let place = lengths.partition_point(|length| *length <= share).max(1);
                let (before, after) = (lengths[place - 1], lengths[place.min(lengths.len() - 1)]);
                let between = if after > before {
                    (share - before) / (after - before)
                } else {
                    0.0
                };
                at(
                    &spline,
                    (place as f64 - 1.0 + between) * 3.0 / (lengths.len() - 1) as f64,
                )
            }),
            lit: Box::new(move |share| {
                let x = 2.0 * share;
                let k = (x as usize).min(1);
                let coefficient =
                    coefficients[k] + (coefficients[k + 1] - coefficients[k]) * (x - k as f64);
                (coefficient, series(&[0.1, 0.02, 0.06])(share))
            }),
            profile: Profile::InverseCube,
            reach: 0.7,
        },
    ]
}

/// The light across a core with a reach, by many midpoints.
fn across(profile: Profile, radius: f64, reach: f64) -> f64 {
    let count = 400_000;
    let step = reach / f64::from(count);
    let light = |k: u32| {
        let distance = (f64::from(k) + 0.5) * step;
        field(profile, reach, distance * distance, radius) * step
    };
    2.0 * (0..count).map(light).sum::<f64>()
}

/// Where many steps of equal parameter lie, in shares of a path's length.
fn lengths_of(path: &LightPath) -> Vec<f64> {
    let count = 20_000;
    let place = |k: usize| at(path, (piece_count(path) * k) as f64 / f64::from(count));
    let mut lengths = vec![0.0];
    for k in 1..=count as usize {
        lengths.push(lengths[k - 1] + place(k).distance(place(k - 1)));
    }
    let whole = lengths[count as usize];
    lengths.iter().map(|length| length / whole).collect()
}

fn field(profile: Profile, reach: f64, distance2: f64, radius: f64) -> f64 {
    let q2 = distance2 + radius * radius;
    let power = match profile {
        Profile::Inverse => -0.5,
        Profile::InverseSquare => -1.0,
        _ => -1.5,
    };
    q2.powf(power) * (1.0 - distance2 / (reach * reach)).max(0.0).powi(2)
}

/// Light at a point of space: that of the nearest of all lines between neighbours of many points; `shift` spoils where
/// series are looked up.
fn definition(case: &Case, core: &[Vec<(DVec3, f64)>], point: DVec3, shift: f64) -> f64 {
    let mut nearest = (f64::INFINITY, 0.0);
    for pair in core.iter().flat_map(|run| run.windows(2)) {
        let [(a, share_a), (b, share_b)] = [pair[0], pair[1]];
        if a.distance_squared(point) > (nearest.0.sqrt() + a.distance(b)).powi(2) {
            continue;
        }
        let along = (b - a).dot(point - a) / (b - a).length_squared();
        let along = along.clamp(0.0, 1.0);
        let distance2 = a.lerp(b, along).distance_squared(point);
        if distance2 < nearest.0 {
            nearest = (distance2, share_a + (share_b - share_a) * along);
        }
    }
    let (green, radius) = (case.lit)((nearest.1 + shift).min(1.0));
    green * field(case.profile, case.reach, nearest.0, radius)
}

fn core_of(case: &Case) -> Vec<Vec<(DVec3, f64)>> {
    let count = POINTS / case.runs.len();
    let run = |[from, to]: &[f64; 2]| {
        let share = |k: usize| from + (to - from) * k as f64 / count as f64;
        (0..=count)
            .map(|k| ((case.at)(share(k)), share(k)))
            .collect()
    };
    case.runs.iter().map(run).collect()
}

fn rays() -> Vec<Ray> {
    vec![
        Ray::between(v(0.2, -3.0, 0.1), v(0.3, 4.0, 0.2)),
        Ray::between(v(-2.0, 0.05, 0.1), v(3.0, 0.1, 0.0)),
        Ray::between(v(-0.87, -2.0, -0.25), v(-0.91, 2.0, -0.15)),
        Ray::between(v(1.2, -2.0, 0.6), v(0.9, 3.0, 0.35)),
    ]
}

fn integrand() -> Integrand {
    Integrand {
        decay: None,
        absorption: None,
        softening: 0.0,
    }
}

fn green(scene: &Scene, ray: &Ray) -> f64 {
    let light = |source: &Source| source.emission.y * exact(source, ray, &integrand(), 1.0);
    sources(scene).iter().map(light).sum()
}

#[test]
fn the_reference_is_the_definition_and_another_share_is_noticed() {
    for case in cases() {
        let core = core_of(&case);
        let mut spoiled: f64 = 0.0;
        for ray in rays() {
            let expected = |shift: f64| {
                let mut breaks: Vec<f64> = (1..40).map(|k| f64::from(k) / 40.0).collect();
                let light = |s: f64| definition(&case, &core, ray.at(s), shift);
                integrate(light, &mut breaks, 1.0, 1e-6).value * ray.span.length()
            };
            let found = green(&case.scene, &ray) * ray.span.length();
            let error = |expected: f64| (found - expected).abs() / expected.max(1e-3);
            let own = error(expected(0.0));
            assert!(
                own < DEFINITION_ERROR,
                "{}, {ray:?}: {found:e}, {own:e}",
                case.name
            );
            spoiled = spoiled.max(error(expected(0.01)));
        }
        assert!(
            spoiled > 10.0 * DEFINITION_ERROR,
            "{}: {spoiled:e}",
            case.name
        );
    }
}

fn worst(renderer: &mut Renderer, scene: &Scene, tolerance: f64) -> f64 {
    let scene = at_tolerance(scene, tolerance);
    let found = renderer.integrate(&scene, &rays()).unwrap();
    let errors = found.iter().zip(rays()).map(|([_, found, _], ray)| {
        let expected = green(&scene, &ray) * ray.span.length();
        (found - expected).abs() / expected.max(1e-3)
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn rays_meet_every_tolerance_on_every_lane_width_and_thinner_cores_are_noticed() {
    for lanes in lane_widths() {
        let mut renderer = renderer(lanes, "");
        let tolerances: &[f64] = match lanes == common::device().lanes {
            true => &[1e-1, 1e-3, 1e-5],
            false => &[1e-3],
        };
        for case in cases() {
            for &tolerance in tolerances {
                let error = worst(&mut renderer, &case.scene, tolerance);
                assert!(
                    error < tolerance.max(common::WORST_PIXEL),
                    "{lanes} lanes, {}, {tolerance:e}: {error:e}",
                    case.name
                );
            }
        }
    }
    let even = &mut renderer(8, "-DDOUBLED=1.9f");
    let spoiled = worst(even, &cases()[0].scene, 1e-3);
    assert!(spoiled > 5e-3, "the spoiled build passed: {spoiled:e}");
}

#[test]
fn images_by_pixels_and_by_tiles_meet_the_tolerance() {
    let mut renderer = renderer(common::device().lanes, "");
    for case in cases() {
        let truth = reference::render(&case.scene).unwrap();
        let most = truth.as_slice().iter().copied().fold(0.0, f32::max);
        for sampling in [Sampling::Pixels, Sampling::Tiles] {
            let scene = sampled(&at_tolerance(&case.scene, 1e-3), sampling);
            let image = renderer.render(&scene).unwrap();
            if case.reach.is_infinite() {
                let found = difference(&image, &truth);
                assert!(
                    meets(&found, 1e-3),
                    "{} by {sampling:?}: {found:?}",
                    case.name
                );
                continue;
            }
            // The last light before a reach is measured by what is worth seeing.
            let pairs = image.as_slice().iter().zip(truth.as_slice());
            let dark = pairs.clone().filter(|(_, truth)| **truth == 0.0);
            assert!(dark.clone().count() > 100 && dark.clone().all(|(value, _)| *value == 0.0));
            let errors = pairs.map(|(value, truth)| {
                f64::from((value - truth).abs() / truth.abs().max(1e-4 * most))
            });
            let worst = errors.fold(0.0, f64::max);
            assert!(worst < 1e-2, "{} by {sampling:?}: {worst:e}", case.name);
        }
    }
}

#[test]
fn a_group_turns_where_a_ring_begins() {
    let part = Torus {
        sweep: Some([20.0, 130.0]),
        ..Torus::new(0.9)
    };
    let turn = Rotation {
        axis: v(0.3, 1.0, 0.2),
        angle: 140.0,
    };
    let mut turned = scene();
    turned
        .add_group(&Group {
            tori: vec![part.clone()],
            rotate: Some(turn),
            ..Group::default()
        })
        .unwrap();
    let rotation = DQuat::from_axis_angle(turn.axis.normalize(), turn.angle.to_radians());
    let middle = rotation * (0.9 * v(75_f64.to_radians().cos(), 75_f64.to_radians().sin(), 0.0));
    let through = |point: DVec3| Ray::between(point - 2.0 * DVec3::Y, point + 2.0 * DVec3::Y);
    let (lit, dark) = (
        green(&turned, &through(middle)),
        green(&turned, &through(-middle)),
    );
    assert!(lit > 1e3 * dark, "{lit} {dark}");
}
