//! Paths against the definition: a field of the distance to the nearest point of all pieces, curved ones as they are,
//! sampled densely and integrated in float64.

use energywave::internals::{Integrand, Source, exact, integrate, sources};
use energywave::scene::{
    Curve, Decay, LightPath, Measure, Method, PathShape, Profile, Ray, Sampling, Segment,
};
use energywave::{Renderer, Scene, reference};
use fastrand::Rng;
use glam::DVec3;

use crate::common;
use crate::common::{at_tolerance, difference, meets, outer_lane_widths, renderer, sampled};
use crate::path_core::{at, distance, piece_count};

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

fn hard_rays() -> Vec<Ray> {
    let ray = |from: [f64; 3], to: [f64; 3]| Ray::between(from.into(), to.into());
    vec![
        ray([0.2, -3.0, 0.1], [0.3, 4.0, 0.2]),
        ray([-2.0, 0.05, 0.1], [3.0, 0.1, 0.0]),
        ray([-0.87, -2.0, -0.5], [-0.91, 2.0, -0.45]),
        ray([1.3, -2.0, 0.6], [0.2, 3.0, -1.0]),
    ]
}

/// Paths whose light changes along the core: by an intensity, by colours, by both.
fn lit_along() -> Vec<LightPath> {
    let with = |shape, intensity: Option<&[f64]>, colors: Option<&[DVec3]>| LightPath {
        intensity: intensity.map(<[f64]>::to_vec),
        colors: colors.map(<[DVec3]>::to_vec),
        color: DVec3::ONE,
        ..path(shape, false, Profile::InverseSquare)
    };
    let (strong, weak) = ([0.2, 1.0, 0.5, 0.9], [1.0, 0.1]);
    let colors = [
        DVec3::new(1.0, 0.3, 0.1),
        DVec3::new(0.1, 1.0, 0.6),
        DVec3::new(0.4, 0.2, 1.0),
    ];
    vec![
        with(PathShape::Polyline, Some(&strong), None),
        with(PathShape::Spline, Some(&weak), None),
        with(PathShape::Polyline, Some(&weak), Some(&colors)),
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

#[test]
fn light_along_a_path_is_linear_between_its_values_in_the_reference_too() {
    for lit in lit_along() {
        let scene = scene_of(lit.clone());
        // Where along the length each of many points is.
        let count = 20_000;
        let places = (0..=count).map(|k| {
            at(
                &lit,
                piece_count(&lit) as f64 * f64::from(k) / f64::from(count),
            )
        });
        let points: Vec<DVec3> = places.collect();
        let mut lengths = vec![0.0];
        for pair in points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + pair[0].distance(pair[1]));
        }
        let between = |values: &[f64], share: f64| {
            let x = share * (values.len() - 1) as f64;
            let k = (x as usize).min(values.len() - 2);
            values[k] * (1.0 - (x - k as f64)) + values[k + 1] * (x - k as f64)
        };
        for k in [0, 1234, 7777, 10_000, 15_151, 20_000] {
            let share = lengths[k] / lengths[lengths.len() - 1];
            let intensity = lit
                .intensity
                .as_deref()
                .map_or(1.0, |it| between(it, share));
            let green = lit.colors.as_deref().map_or(1.0, |colors| {
                let greens: Vec<f64> = colors.iter().map(|color| color.y).collect();
                between(&greens, share)
            });
            let light =
                |source: &Source| source.emission.y * source.field.sample(points[k]).intensity;
            let found: f64 = sources(&scene).iter().map(light).sum();
            // Products are linear between the values of both.
            let error = (found - intensity * green).abs();
            assert!(
                error < if lit.colors.is_some() { 0.1 } else { 3e-5 },
                "{k}: {found} {intensity} {green}"
            );
        }
    }
}

fn worst(renderer: &mut Renderer, scene: &Scene, tolerance: f64) -> f64 {
    let mut scene = scene.clone();
    scene.integration.method = Method::exact(tolerance);
    let found = renderer.integrate(&scene, &hard_rays()).unwrap();
    let errors = found.iter().zip(hard_rays()).map(|([_, green, _], ray)| {
        let light = |source: &Source| source.emission.y * exact(source, &ray, &integrand(), 1.0);
        let expected: f64 = sources(&scene).iter().map(light).sum();
        (green / expected - 1.0).abs()
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn rays_past_every_shape_meet_every_tolerance_on_one_lane_and_many_and_a_slack_search_does_not() {
    for lanes in outer_lane_widths() {
        let mut renderer = renderer(lanes, "");
        // Light that changes along the core jumps where the nearest part does: float32 finds that less exactly.
        let even = all_shapes().into_iter().map(|path| (path, 2e-5));
        let lit = lit_along()
            .into_iter()
            .map(|path| (path, common::WORST_PIXEL));
        for (path, least) in even.chain(lit) {
            for tolerance in [1e-1, 1e-3, 1e-5] {
                let error = worst(&mut renderer, &scene_of(path.clone()), tolerance);
                assert!(
                    error < tolerance.max(least),
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
        scene.image.width = 48;
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

/// Flat zigzags, each much smaller than a ray is long and dark a little beside it: where two pieces are equally near,
/// the next float32 of a ray's parameter is past the place.
fn zigzags() -> Scene {
    let mut rng = Rng::with_seed(6);
    let mut between = |from: f64, to: f64| from + (to - from) * rng.f64();
    let mut scene = common::empty_scene(64, 64);
    scene.camera.eye = DVec3::new(0.0, -5.0, 3.5);
    scene.camera.target = DVec3::ZERO;
    scene.camera.ray_length = Some(12.0);
    for _ in 0..10 {
        let center = DVec3::new(between(-1.5, 1.5), between(-1.5, 1.5), 0.0);
        let points =
            (0..8).map(|_| center + DVec3::new(between(-0.4, 0.4), between(-0.4, 0.4), 0.0));
        scene.paths.push(LightPath {
            radius: 0.01,
            reach: Some(0.1),
            ..LightPath::new(points.collect())
        });
    }
    scene
}

#[test]
fn equally_near_pieces_do_not_hold_a_ray_up_and_it_would_lose_light_where_they_did() {
    let mut scene = zigzags();
    scene.integration.method = Method::exact(1e-5);
    let scene = sampled(&scene, Sampling::Pixels);
    let truth = reference::render(&scene).unwrap();
    let most = truth.as_slice().iter().copied().fold(0.0, f32::max);
    let lost = |options: &str| {
        let image = renderer(common::device().lanes, options)
            .render(&scene)
            .unwrap();
        let pairs = image.as_slice().iter().zip(truth.as_slice());
        pairs
            .filter(|(value, truth)| (*value - *truth).abs() > 2e-5 * truth.max(1e-3 * most))
            .count()
    };
    let (own, standing) = (lost(""), lost("-DNEXT_FLOAT=0.0f"));
    assert_eq!(own, 0);
    assert!(standing > 4, "standing still lost {standing} values only");
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
