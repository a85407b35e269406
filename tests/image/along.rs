//! Cores along which light changes, against the definition: the nearest of many points of the core, each with a share
//! of its length, at which series are looked up; integrated in float64.

use energywave::internals::{Integrand, Source, exact, integrate, sources};
use energywave::scene::{
    Camera, Curve, Group, LightPath, PathShape, Ray, Rotation, Sampling, Segment, Torus,
};
use energywave::{Renderer, Scene, reference};
use glam::{DQuat, DVec3};

use crate::along_cases::{Case, cases, field, scene, v};
use crate::common;
use crate::common::{at_tolerance, difference, meets, outer_lane_widths, renderer, sampled};

/// The definition's own error, by its samples of the core.
const DEFINITION_ERROR: f64 = 2e-5;

/// Points of a core that the definition takes.
const POINTS: usize = 1200;

/// What a ray may be off where the light of a curved core jumps with the nearest part, which float32 finds within 4e-6
/// of the squared distance (docs/accuracy.md).
const WHERE_LIGHT_JUMPS: f64 = 4e-4;

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
    let (green, radius) = (case.lit)(nearest.1 + shift);
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
                sources(&case.scene)[0].field.breaks(&ray, &mut breaks);
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
            if spoiled == 0.0 {
                spoiled = error(expected(0.01));
            }
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
fn rays_meet_every_tolerance_on_one_lane_and_many_and_thinner_cores_are_noticed() {
    for lanes in outer_lane_widths() {
        let mut renderer = renderer(lanes, "");
        let tolerances: &[f64] = match lanes == common::device().lanes {
            true => &[1e-1, 1e-3, 1e-5],
            false => &[1e-3],
        };
        for case in cases() {
            for &tolerance in tolerances {
                let error = worst(&mut renderer, &case.scene, tolerance);
                assert!(
                    error < tolerance.max(WHERE_LIGHT_JUMPS),
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

#[test]
fn a_curve_of_many_colours_is_a_path_of_one_curve() {
    let points = [v(-1.0, 0.2, 0.1), v(0.1, -0.3, 1.2), v(1.1, 0.1, -0.4)];
    let colors = Some(vec![v(1.0, 0.2, 0.1), v(0.1, 0.4, 1.0)]);
    let (mut curve, mut path) = (scene(), scene());
    curve.curves.push(Curve {
        colors: colors.clone(),
        ..Curve::new(points)
    });
    path.paths.push(LightPath {
        shape: PathShape::Quadratic,
        colors,
        ..LightPath::new(points.to_vec())
    });
    let mut renderer = renderer(common::device().lanes, "");
    let found = renderer.render(&curve).unwrap();
    assert_eq!(found.as_slice(), renderer.render(&path).unwrap().as_slice());
    let bare = Curve::new(points);
    curve.curves[0] = bare;
    assert_ne!(
        found.as_slice(),
        renderer.render(&curve).unwrap().as_slice()
    );
}

#[test]
fn parts_at_a_sharp_corner_do_not_take_turns_until_the_steps_are_spent() {
    let mut scene = scene();
    (scene.image.width, scene.image.height) = (96, 96);
    scene.camera = Camera::new(v(0.0, -6.0, 0.0), DVec3::ZERO);
    scene.camera.fov_y = 10.0;
    scene.paths.push(LightPath {
        intensity: Some(vec![1.0, 0.3]),
        radius: 0.016,
        reach: Some(0.05),
        peak: Some(1.0),
        ..LightPath::new(vec![
            v(-0.3, 0.0, 0.2),
            v(0.2, 0.0, 0.1),
            v(-0.1, 0.1, -0.1),
        ])
    });
    let scene = sampled(&at_tolerance(&scene, 1e-3), Sampling::Pixels);
    let truth = reference::render(&scene).unwrap();
    let lanes = common::device().lanes;
    let worst = |options: &str| {
        let image = renderer(lanes, options).render(&scene).unwrap();
        let pairs = image.as_slice().iter().zip(truth.as_slice());
        pairs
            .map(|(value, truth)| (value - truth).abs())
            .fold(0.0, f32::max)
    };
    let (own, slack) = (worst(""), worst("-DNEXT_FLOAT=0.0f"));
    let hasty = worst("-DPATH_SLACK=1e-8f -DNEXT_FLOAT=0.0f");
    assert!(
        own.max(slack) < 1e-3 && hasty > 0.1,
        "{own:e} {slack:e} {hasty:e}"
    );
}

#[test]
fn a_core_that_thins_to_nothing_has_its_peak_where_it_is_thick_and_is_finite_where_it_is_not() {
    let mut scene = scene();
    scene.segments.push(Segment {
        radii: Some(vec![0.0, 0.1, 0.0]),
        reach: Some(0.4),
        peak: Some(2.0),
        ..Segment::new(v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0))
    });
    let through = |x: f64| Ray::between(v(x, -2.0, 0.0), v(x, 2.0, 0.0));
    let rays = [0.0, 0.5, -0.9, 1.0].map(through);
    let mut renderer = renderer(common::device().lanes, "");
    let found = renderer
        .integrate(&at_tolerance(&scene, 1e-4), &rays)
        .unwrap();
    let light: Vec<f64> = found.iter().map(|[_, green, _]| *green).collect();
    assert!((light[0] / 2.0 - 1.0).abs() < 1e-3, "{light:?}");
    // Between the values the coefficient is linear, and light across a thinner core is brighter than that.
    assert!(
        light[1] > 1.5 && light[1] < 3.0 && light[2] > 0.1 && light[3] == 0.0,
        "{light:?}"
    );
}
