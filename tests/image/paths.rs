//! Paths against the definition: a field of the distance to the nearest point of all pieces, curved ones as they are,
//! sampled densely and integrated in float64.

use energywave::internals::{Integrand, exact, integrate, sources};
use energywave::scene::{
    Curve, Decay, LightPath, Measure, Method, PathShape, Profile, Ray, Sampling, Segment,
};
use energywave::{Renderer, Scene, reference};
use fastrand::Rng;
use glam::DVec3;

use crate::common;
use crate::common::{at_tolerance, difference, lane_widths, meets, renderer, sampled};

/// The definition's own error, by its samples of the core and along the ray.
const DEFINITION_ERROR: f64 = 2e-6;

/// Sums of the same float32 terms in another order.
const ROUNDING: f64 = 2e-5;

fn decay() -> Decay {
    Decay::new(0.1, 0.1)
}

fn integrand() -> Integrand {
    Integrand {
        decay: Some(decay()),
        absorption: None,
        softening: 0.0,
    }
}

const POINTS: [[f64; 3]; 7] = [
    [-1.4, 0.1, 0.2],
    [-0.9, 0.4, -0.5],
    [-0.4, -0.3, 0.6],
    [0.1, 0.2, -0.2],
    [0.5, -0.2, 0.5],
    [1.0, 0.3, 0.1],
    [1.3, 0.0, -0.4],
];

fn path(shape: PathShape, closed: bool, profile: Profile) -> LightPath {
    let count = if closed { 6 } else { 7 };
    LightPath {
        shape,
        closed,
        profile,
        color: DVec3::new(0.3, 1.0, 0.6),
        ..LightPath::new(
            POINTS[..count]
                .iter()
                .map(|point| DVec3::from(*point))
                .collect(),
        )
    }
}

fn all_shapes() -> Vec<LightPath> {
    let shapes = [
        PathShape::Polyline,
        PathShape::Spline,
        PathShape::Quadratic,
        PathShape::Cubic,
    ];
    let profiles = [Profile::Inverse, Profile::InverseSquare];
    let closed = [false, true].into_iter().zip(profiles);
    closed
        .flat_map(|(closed, profile)| shapes.map(|shape| path(shape, closed, profile)))
        .collect()
}

/// A Bezier curve by de Casteljau's construction.
fn casteljau(points: &[DVec3], t: f64) -> DVec3 {
    let mut points = points.to_vec();
    while points.len() > 1 {
        points = points
            .windows(2)
            .map(|pair| pair[0].lerp(pair[1], t))
            .collect();
    }
    points[0]
}

/// A point of a path: `place` counts its pieces.
fn at(path: &LightPath, place: f64) -> DVec3 {
    let count = path.points.len() as i64;
    let point = |k: i64| match path.closed {
        true => path.points[k.rem_euclid(count) as usize],
        // Beyond an end it goes on as straight as it came.
        false if k < 0 => 2.0 * path.points[0] - path.points[1],
        false if k >= count => {
            2.0 * path.points[count as usize - 1] - path.points[count as usize - 2]
        }
        false => path.points[k as usize],
    };
    let piece = (place.floor() as i64).min(piece_count(path) as i64 - 1);
    let t = place - piece as f64;
    let bezier = |degree: i64| {
        let controls: Vec<DVec3> = (0..=degree).map(|k| point(degree * piece + k)).collect();
        casteljau(&controls, t)
    };
    match path.shape {
        PathShape::Quadratic => bezier(2),
        PathShape::Cubic => bezier(3),
        PathShape::Spline => {
            let [a, b, c, d] = [-1, 0, 1, 2].map(|k| point(piece + k));
            // Catmull, Rom 1974, in the form of their matrix.
            0.5 * (2.0 * b
                + (c - a) * t
                + (2.0 * a - 5.0 * b + 4.0 * c - d) * t * t
                + (3.0 * b - a - 3.0 * c + d) * t * t * t)
        }
        _ => bezier(1),
    }
}

fn piece_count(path: &LightPath) -> usize {
    let step = match path.shape {
        PathShape::Quadratic => 2,
        PathShape::Cubic => 3,
        _ => 1,
    };
    (path.points.len() - usize::from(!path.closed)) / step
}

/// The distance to the nearest of many samples, refined beside the nearest few.
fn distance(path: &LightPath, point: DVec3) -> f64 {
    const SAMPLES: usize = 40;
    let count = piece_count(path) * SAMPLES;
    let to = |k: usize| at(path, k as f64 / SAMPLES as f64).distance(point);
    let sampled: Vec<f64> = (0..=count).map(to).collect();
    let nearest = sampled.iter().copied().fold(f64::INFINITY, f64::min);
    let mut least = nearest;
    for k in (0..=count).filter(|k| sampled[*k] < nearest + 0.05) {
        let beside = |k: f64| (k / SAMPLES as f64).clamp(0.0, piece_count(path) as f64);
        let (mut from, mut to) = (beside(k as f64 - 1.0), beside(k as f64 + 1.0));
        for _ in 0..60 {
            let (left, right) = (from + (to - from) / 3.0, to - (to - from) / 3.0);
            match at(path, left).distance(point) < at(path, right).distance(point) {
                true => to = right,
                false => from = left,
            }
        }
        least = least.min(at(path, 0.5 * (from + to)).distance(point));
    }
    least
}

fn hard_rays() -> Vec<Ray> {
    let ray = |from: [f64; 3], to: [f64; 3]| Ray::between(from.into(), to.into());
    vec![
        ray([0.2, -3.0, 0.1], [0.3, 4.0, 0.2]),
        ray([-2.0, 0.05, 0.1], [3.0, 0.1, 0.0]),
        ray([-0.9, -2.0, -0.5], [-0.9, 2.0, -0.45]),
        ray([1.3, -2.0, 0.6], [0.2, 3.0, -1.0]),
    ]
}

fn scene_of(path: LightPath) -> Scene {
    let mut scene = common::empty_scene(32, 32);
    scene.decay = Some(decay());
    scene.paths.push(path);
    scene
}

#[test]
fn the_reference_is_the_definition_and_another_shape_is_noticed() {
    for path in all_shapes() {
        let mut others: f64 = 0.0;
        for ray in hard_rays() {
            let field = |s: f64| match path.profile {
                Profile::InverseSquare => distance(&path, ray.at(s)).powi(-2),
                _ => 1.0 / distance(&path, ray.at(s)),
            };
            let mut breaks: Vec<f64> = (1..20).map(|k| f64::from(k) / 20.0).collect();
            let expected = integrate(|s| field(s) * decay().at(s), &mut breaks, 1.0, 1e-6).value;
            let value = |path: &LightPath| {
                exact(
                    &sources(&scene_of(path.clone()))[0],
                    &ray,
                    &integrand(),
                    1.0,
                )
            };
            let error = (value(&path) / expected - 1.0).abs();
            assert!(error < DEFINITION_ERROR, "{path:?} {ray:?}: {error:e}");
            let other = LightPath {
                points: path.points.iter().map(|point| 1.001 * *point).collect(),
                ..path.clone()
            };
            others = f64::max(others, (value(&other) / expected - 1.0).abs());
        }
        assert!(others > 10.0 * DEFINITION_ERROR, "{others:e}");
    }
}

fn worst(renderer: &mut Renderer, scene: &Scene, tolerance: f64) -> f64 {
    let mut scene = scene.clone();
    scene.integration.method = Method::exact(tolerance);
    let found = renderer.integrate(&scene, &hard_rays()).unwrap();
    let errors = found.iter().zip(hard_rays()).map(|([_, green, _], ray)| {
        let expected = exact(&sources(&scene)[0], &ray, &integrand(), 1.0);
        (green / expected - 1.0).abs()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn rays_past_every_shape_meet_every_tolerance_on_every_lane_width_and_a_slack_search_does_not() {
    for lanes in lane_widths() {
        let mut renderer = renderer(lanes, "");
        for path in all_shapes() {
            for tolerance in [1e-1, 1e-3, 1e-5] {
                let error = worst(&mut renderer, &scene_of(path.clone()), tolerance);
                assert!(
                    error < tolerance.max(2e-5),
                    "{lanes} lanes, {path:?}, {tolerance:e}: {error:e}"
                );
            }
        }
    }
    // Another part takes over only where it is nearer by more than half.
    let slack = &mut renderer(8, "-DPATH_SLACK=1.0f");
    let spoiled = worst(
        slack,
        &scene_of(path(PathShape::Polyline, false, Profile::InverseSquare)),
        1e-3,
    );
    assert!(spoiled > 1e-2, "the spoiled build passed: {spoiled:e}");
}

#[test]
fn images_by_pixels_and_by_tiles_meet_the_tolerance() {
    let mut renderer = renderer(common::device().lanes, "");
    for (k, shape) in [PathShape::Polyline, PathShape::Spline]
        .into_iter()
        .enumerate()
    {
        let mut scene = scene_of(path(shape, k == 1, Profile::InverseSquare));
        scene.integration.method = Method::exact(1e-3);
        scene.image.width = 72;
        scene.paths[0].flatness = Some(1e-6);
        if k == 0 {
            (scene.paths[0].radius, scene.paths[0].reach) = (0.02, Some(0.9));
            scene.decay = None;
        }
        let truth = reference::render(&scene).unwrap();
        for sampling in [Sampling::Pixels, Sampling::Tiles] {
            let scene = sampled(&at_tolerance(&scene, 1e-3), sampling);
            let image = renderer.render(&scene).unwrap();
            let found = match k {
                // The last light before a reach is measured by what is worth seeing.
                0 => {
                    let pairs = image.as_slice().iter().zip(truth.as_slice());
                    let most = truth.as_slice().iter().copied().fold(0.0, f32::max);
                    let dark = pairs.clone().filter(|(_, truth)| **truth == 0.0);
                    assert!(
                        dark.clone().count() > 100 && dark.clone().all(|(value, _)| *value == 0.0)
                    );
                    let errors = pairs.map(|(value, truth)| {
                        f64::from((value - truth).abs() / truth.abs().max(1e-4 * most))
                    });
                    let worst = errors.fold(0.0, f64::max);
                    assert!(worst < 1e-2, "{sampling:?}: {worst:e}");
                    continue;
                }
                _ => difference(&image, &truth),
            };
            assert!(meets(&found, 1e-3), "{shape:?} by {sampling:?}: {found:?}");
        }
    }
}

#[test]
fn a_path_of_one_piece_is_a_segment_or_a_curve_and_joints_in_a_straight_line_do_not_show() {
    let mut renderer = renderer(common::device().lanes, "");
    let light = |renderer: &mut Renderer, scene: &Scene| {
        let mut scene = scene.clone();
        scene.integration.method = Method::exact(1e-5);
        let rays = renderer.integrate(&scene, &hard_rays()).unwrap();
        rays.into_iter()
            .map(|[_, green, _]| green)
            .collect::<Vec<_>>()
    };
    let [a, b, c] = [POINTS[0], POINTS[2], POINTS[5]].map(DVec3::from);
    let mut segment = common::empty_scene(8, 8);
    segment.segments.push(Segment::new(a, c));
    let mut curve = common::empty_scene(8, 8);
    curve.curves.push(Curve::new([a, b, c]));
    let straight = LightPath::new(vec![a, a.lerp(c, 0.3), a.lerp(c, 0.4), c]);
    let quadratic = LightPath {
        shape: PathShape::Quadratic,
        ..LightPath::new(vec![a, b, c])
    };
    for (path, other, allowed) in [(straight, segment, ROUNDING), (quadratic, curve, 5e-5)] {
        let mut scene = common::empty_scene(8, 8);
        scene.paths.push(path);
        let expected = light(&mut renderer, &other);
        for (found, expected) in light(&mut renderer, &scene).iter().zip(&expected) {
            let error = (found / expected - 1.0).abs();
            assert!(error < allowed, "{error:e}: {:?}", scene.paths[0]);
        }
        scene.paths[0].points[1].z += 0.01;
        let moved = light(&mut renderer, &scene);
        assert!(
            moved
                .iter()
                .zip(&expected)
                .any(|(a, b)| (a / b - 1.0).abs() > 10.0 * allowed)
        );
    }
}

/// The largest step of the light from one to the next of many rays that run beside a core.
fn largest_step(renderer: &mut Renderer, scene: &Scene, rays: &[Ray]) -> f64 {
    let light = renderer.integrate(scene, rays).unwrap();
    let steps = light
        .windows(2)
        .map(|pair| (pair[1][1] / pair[0][1] - 1.0).abs());
    steps.fold(0.0, f64::max)
}

#[test]
fn a_joint_is_no_brighter_than_what_lies_beside_it_and_that_of_curves_which_add_is() {
    let [a, b, c, d, e] = [[-1.2, 0.0], [-0.6, 0.8], [0.0, 0.5], [0.6, 0.2], [1.2, 0.6]]
        .map(|[x, z]| DVec3::new(x, 0.0, z));
    let two = LightPath {
        shape: PathShape::Quadratic,
        ..LightPath::new(vec![a, b, c, d, e])
    };
    let rays: Vec<Ray> = (0..1200)
        .map(|k| {
            let place = 0.4 + 1.2 * f64::from(k) / 1200.0;
            let tangent = at(&two, place + 1e-6) - at(&two, place - 1e-6);
            let beside = at(&two, place) + 0.02 * tangent.cross(DVec3::Y).normalize();
            Ray::between(beside - 3.0 * DVec3::Y, beside + 3.0 * DVec3::Y)
        })
        .collect();
    let mut scene = common::empty_scene(8, 8);
    scene.decay = None;
    scene.integration.measure = Measure::Length;
    scene.integration.method = Method::exact(1e-5);
    let mut added = scene.clone();
    added.curves.extend([[a, b, c], [c, d, e]].map(Curve::new));
    scene.paths.push(two);
    let mut renderer = renderer(common::device().lanes, "");
    let of_path = largest_step(&mut renderer, &scene, &rays);
    assert!(of_path < 1e-3, "{of_path:e}");
    let of_curves = largest_step(&mut renderer, &added, &rays);
    assert!(of_curves > 5e-3, "{of_curves:e}");
}

#[test]
fn a_thousand_pieces_are_searched_as_well_as_five_and_levels_are_as_good_as_the_finest() {
    let mut random = Rng::with_seed(5);
    let mut points = vec![DVec3::new(-1.5, 0.0, 0.0)];
    for k in 1..=1000 {
        let jitter = DVec3::from([0; 3].map(|_| 0.1 * random.f64() - 0.05));
        points.push(DVec3::new(-1.5 + 0.003 * f64::from(k), 0.0, 0.0) + jitter);
    }
    let mut renderer = renderer(common::device().lanes, "");
    let long = LightPath {
        profile: Profile::Inverse,
        color: DVec3::ONE,
        ..LightPath::new(points)
    };
    let error = worst(&mut renderer, &scene_of(long), 1e-3);
    assert!(error < 1e-3, "{error:e}");
    let mut fine = path(PathShape::Spline, false, Profile::Inverse);
    fine.flatness = Some(1e-6);
    let error = worst(&mut renderer, &scene_of(fine.clone()), 1e-4);
    assert!(error < 1e-4, "{error:e}");
    fine.flatness = Some(0.05);
    let rough = worst(&mut renderer, &scene_of(fine), 1e-4);
    assert!(rough > 1e-3, "flatness does nothing: {rough:e}");
}
