//! Cores of many pieces all of whose points add their light, against the definition: the sum of 1/r over many points of
//! the core, integrated along rays in float64.

use energywave::internals::{Integrand, Source, exact, integrate, sources};
use energywave::scene::{
    Dashes, LightPath, Measure, Method, PathShape, Profile, Ray, Sampling, Segment, Torus,
};
use energywave::{Renderer, Scene, reference};
use glam::DVec3;

use crate::common::{self, at_tolerance, difference, meets, outer_lane_widths, renderer, sampled};
use crate::path_core::{at, piece_count};

/// The definition's own error, by its points.
const DEFINITION_ERROR: f64 = 1e-5;

const POINTS: u32 = 30_000;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn empty() -> Scene {
    let mut scene = common::empty_scene(48, 36);
    scene.decay = None;
    scene.integration.measure = Measure::Length;
    scene.integration.method = Method::exact(1e-3);
    scene
}

/// A scene, and points of its core, each with the length that it stands for times what light is multiplied with.
type Case = (Scene, Vec<(DVec3, f64)>);

/// Takes the middles of equal steps of a parameter.
fn summed(at: impl Fn(f64) -> DVec3, light: impl Fn(f64) -> f64) -> Vec<(DVec3, f64)> {
    let corners: Vec<DVec3> = (0..=POINTS)
        .map(|k| at(f64::from(k) / f64::from(POINTS)))
        .collect();
    let lengths: Vec<f64> = corners
        .windows(2)
        .map(|pair| pair[0].distance(pair[1]))
        .collect();
    let whole: f64 = lengths.iter().sum();
    let mut before = 0.0;
    let mut points = Vec::new();
    for (pair, length) in corners.windows(2).zip(lengths) {
        let share = (before + 0.5 * length) / whole;
        points.push((0.5 * (pair[0] + pair[1]), length * light(share)));
        before += length;
    }
    points
}

fn between(values: &[f64], share: f64) -> f64 {
    let x = share * (values.len() - 1) as f64;
    let k = (x as usize).min(values.len() - 2);
    values[k] + (values[k + 1] - values[k]) * (x - k as f64)
}

fn cases() -> Vec<Case> {
    let corners = [
        [-1.2, 0.3, 0.2],
        [-0.5, -0.2, -0.6],
        [0.2, 0.3, 0.7],
        [1.1, -0.1, -0.1],
    ]
    .map(DVec3::from);
    let path = |shape, intensity: Option<&[f64]>| LightPath {
        shape,
        closed: shape == PathShape::Spline,
        intensity: intensity.map(<[f64]>::to_vec),
        profile: Profile::Convolution,
        ..LightPath::new(corners.to_vec())
    };
    let of_path = |path: LightPath| {
        let pieces = piece_count(&path) as f64;
        let light = |share| {
            path.intensity
                .as_deref()
                .map_or(1.0, |values| between(values, share))
        };
        let points = summed(|share| at(&path, pieces * share), light);
        let mut scene = empty();
        scene.paths.push(path.clone());
        (scene, points)
    };
    let mut ring = empty();
    ring.tori.push(Torus {
        sweep: Some([-20.0, 250.0]),
        radius: 0.05,
        profile: Profile::Convolution,
        ..Torus::new(0.8)
    });
    let on_ring = |share: f64| {
        let angle = (-20.0 + 270.0 * share).to_radians();
        0.8 * v(angle.cos(), angle.sin(), 0.0)
    };
    let (from, to) = (v(-1.0, 0.2, 0.4), v(1.2, -0.3, -0.2));
    let mut dashed = empty();
    dashed.segments.push(Segment {
        dashes: Some(Dashes::new(2)),
        taper_lengths: [0.0, 1.5],
        profile: Profile::Convolution,
        ..Segment::new(from, to)
    });
    let over = 1.5 / from.distance(to);
    let dash = move |share: f64| match (share * 4.0) as u32 % 2 {
        0 => ((1.0 - share) / over).min(1.0),
        _ => 0.0,
    };
    vec![
        of_path(path(PathShape::Polyline, Some(&[0.2, 1.0, 0.5, 0.9]))),
        of_path(path(PathShape::Spline, None)),
        (ring, summed(on_ring, |_| 1.0)),
        (dashed, summed(move |share| from.lerp(to, share), dash)),
    ]
}

fn rays() -> Vec<Ray> {
    vec![
        Ray::between(v(0.2, -3.0, 0.1), v(0.3, 4.0, 0.2)),
        Ray::between(v(-2.0, 0.05, 0.1), v(3.0, 0.1, 0.0)),
        Ray::between(v(-0.87, -2.0, -0.5), v(-0.91, 2.0, -0.45)),
        Ray::between(v(0.2, -2.0, -3.0), v(0.9, 1.0, 2.0)),
    ]
}

fn light(scene: &Scene, ray: &Ray) -> f64 {
    let integrand = Integrand {
        decay: None,
        absorption: None,
        softening: 0.0,
    };
    let of = |source: &Source| source.emission.y * exact(source, ray, &integrand, 1.0);
    sources(scene).iter().map(of).sum()
}

#[test]
fn the_reference_is_the_definition_and_less_light_is_noticed() {
    for (scene, points) in cases() {
        let radius = scene.tori.first().map_or(0.0, |ring| ring.radius);
        for ray in rays() {
            let field = |s: f64| {
                let of =
                    |(point, light): &(DVec3, f64)| light / point.distance(ray.at(s)).hypot(radius);
                points.iter().map(of).sum()
            };
            let mut breaks: Vec<f64> = (1..12).map(|k| f64::from(k) / 12.0).collect();
            let expected = integrate(field, &mut breaks, 1.0, 1e-6).value;
            let error = |found: f64| (found / expected - 1.0).abs();
            let own = error(light(&scene, &ray));
            assert!(own < DEFINITION_ERROR, "{scene:?} {ray:?}: {own:e}");
            assert!(error(1.001 * light(&scene, &ray)) > 10.0 * DEFINITION_ERROR);
        }
    }
}

fn worst(renderer: &mut Renderer, scene: &Scene, tolerance: f64) -> f64 {
    let found = renderer
        .integrate(&at_tolerance(scene, tolerance), &rays())
        .unwrap();
    let errors = found
        .iter()
        .zip(rays())
        .map(|([_, green, _], ray)| (green / (light(scene, &ray) * ray.span.length()) - 1.0).abs());
    errors.fold(0.0, f64::max)
}

#[test]
fn rays_meet_every_tolerance_and_light_that_does_not_grow_is_noticed() {
    for lanes in outer_lane_widths() {
        let mut renderer = renderer(lanes, "");
        let tolerances: &[f64] = match lanes == common::device().lanes {
            true => &[1e-1, 1e-3, 1e-5],
            false => &[1e-3],
        };
        for (scene, _) in cases() {
            for &tolerance in tolerances {
                let error = worst(&mut renderer, &scene, tolerance);
                assert!(
                    error < tolerance.max(2e-5),
                    "{lanes} lanes, {tolerance:e}: {error:e}, {scene:?}"
                );
            }
        }
    }
    let spoiled = worst(&mut renderer(8, "-DOF_GROWTH=0.0f"), &cases()[0].0, 1e-3);
    assert!(spoiled > 5e-3, "the spoiled build passed: {spoiled:e}");
}

#[test]
fn images_by_pixels_and_by_tiles_meet_the_tolerance() {
    let mut renderer = renderer(common::device().lanes, "");
    // The reference takes curved pieces by quadrature within quadrature.
    for (scene, _) in cases()
        .into_iter()
        .filter(|(scene, _)| scene.tori.is_empty())
    {
        let mut scene = scene;
        if let Some(path) = scene.paths.first_mut() {
            path.shape = PathShape::Polyline;
            path.intensity = path.intensity.take().map(|_| vec![0.2, 1.0]);
        }
        let truth = reference::render(&scene).unwrap();
        for sampling in [Sampling::Pixels, Sampling::Tiles] {
            let image = renderer.render(&sampled(&scene, sampling)).unwrap();
            let found = difference(&image, &truth);
            assert!(meets(&found, 1e-3), "{sampling:?}: {found:?}");
        }
    }
}

#[test]
fn light_does_not_jump_where_the_nearest_point_does() {
    // A hairpin, whose arms are of different brightness.
    let hairpin = |profile| {
        let mut scene = empty();
        scene.integration.method = Method::exact(1e-4);
        scene.paths.push(LightPath {
            intensity: Some(vec![1.0, 0.5, 0.2]),
            profile,
            ..LightPath::new(vec![
                v(-1.0, 0.0, 0.3),
                v(1.0, 0.0, 0.0),
                v(-1.0, 0.0, -0.3),
            ])
        });
        scene
    };
    let across: Vec<Ray> = (0..400)
        .map(|k| {
            let z = -0.02 + 1e-4 * f64::from(k);
            Ray::between(v(-0.6, -2.0, z), v(-0.6, 2.0, z))
        })
        .collect();
    let largest_step = |scene: &Scene| {
        let light = renderer(common::device().lanes, "")
            .integrate(scene, &across)
            .unwrap();
        let steps = light
            .windows(2)
            .map(|pair| (pair[1][1] / pair[0][1] - 1.0).abs());
        steps.fold(0.0, f64::max)
    };
    let (added, nearest) = (
        largest_step(&hairpin(Profile::Convolution)),
        largest_step(&hairpin(Profile::Inverse)),
    );
    assert!(added < 1e-3 && nearest > 0.1, "{added:e} {nearest:e}");
}
