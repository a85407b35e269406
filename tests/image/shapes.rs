//! How fields fall off: every profile, with a radius and a reach, for every kind of source. The truth is the
//! definition, summed along rays in float64; beyond its reach a source adds exactly nothing.

use energywave::image::{DepthAlong, compare};
use energywave::internals::{Integrand, exact, sources};
use energywave::scene::{
    Beam, Cylinder, Decay, Measure, Method, Profile, Ray, Sampling, Segment, Sphere, Torus,
};
use energywave::{RadianceImage, Renderer, Scene, reference};
use fastrand::Rng;
use glam::DVec3;

use crate::common::random::{KINDS, add_source, random_view};
use crate::common::{self, at_tolerance, meets, renderer, sampled};

/// How a field falls off, as the tests name it.
#[derive(Debug, Clone, Copy)]
struct Shape {
    profile: Profile,
    radius: f64,
    reach: Option<f64>,
}

const fn shape(profile: Profile, radius: f64, reach: Option<f64>) -> Shape {
    Shape {
        profile,
        radius,
        reach,
    }
}

const SHAPES: [Shape; 9] = [
    shape(Profile::Inverse, 0.05, None),
    shape(Profile::InverseSquare, 0.05, None),
    shape(Profile::InverseCube, 0.05, None),
    shape(Profile::Gaussian, 0.2, None),
    shape(Profile::Smeared, 0.1, None),
    shape(Profile::Inverse, 0.02, Some(0.7)),
    shape(Profile::InverseSquare, 0.05, Some(0.6)),
    shape(Profile::InverseCube, 0.1, Some(0.5)),
    shape(Profile::Gaussian, 0.2, Some(0.5)),
];

/// What the definition's sums miss; the reference is better.
const SUM_ERROR: f64 = 1e-7;

/// Pixels below this share of the brightest are measured by it: the last light of a Gaussian and of a reach.
const LEAST_LIGHT: f64 = 1e-6;

/// Gives every source of a scene a shape.
fn shaped(mut scene: Scene, shape: Shape) -> Scene {
    let Shape {
        profile,
        radius,
        reach,
    } = shape;
    macro_rules! set {
        ($($list:ident),*) => {
            $(for source in &mut *scene.$list {
                (source.profile, source.radius, source.reach) = (profile, radius, reach);
            })*
        };
    }
    set!(spheres, cylinders, beams, tori, curves, segments);
    scene
}

/// The distance of a point from a core.
type Distance = fn(DVec3) -> f64;

/// One source of every kind whose distance is plain, of coefficient 1, and that distance.
fn plain_kinds() -> Vec<(Scene, Distance)> {
    let scene = |add: &dyn Fn(&mut Scene)| {
        let mut scene = common::empty_scene(32, 32);
        add(&mut scene);
        macro_rules! set {
            ($($list:ident),*) => {
                $(scene.$list.iter_mut().for_each(|source| source.coefficient = 1.0);)*
            };
        }
        set!(spheres, cylinders, beams, tori, segments);
        scene
    };
    vec![
        (scene(&|it| it.spheres.push(Sphere::default())), |p| {
            p.length()
        }),
        (
            scene(&|it| {
                it.cylinders.push(Cylinder::new(DVec3::X));
            }),
            |p| p.y.hypot(p.z),
        ),
        (scene(&|it| it.tori.push(Torus::new(0.9))), |p| {
            (p.x.hypot(p.y) - 0.9).hypot(p.z)
        }),
        (
            scene(&|it| {
                it.beams.push(Beam::new(DVec3::X));
            }),
            |p| DVec3::new(p.x.min(0.0), p.y, p.z).length(),
        ),
        (
            scene(&|it| it.segments.push(Segment::new(-DVec3::X, DVec3::X))),
            |p| DVec3::new((p.x.abs() - 1.0).max(0.0), p.y, p.z).length(),
        ),
    ]
}

fn rays() -> Vec<Ray> {
    let ray = |from: [f64; 3], to: [f64; 3]| Ray::between(from.into(), to.into());
    vec![
        ray([0.2, -3.0, 0.1], [0.3, 4.0, 0.2]),
        ray([0.4, -2.0, 0.3], [0.1, 3.0, -0.2]),
        ray([-3.0, 0.3, 0.2], [4.0, -0.1, 0.1]),
        ray([0.9, -2.0, 0.05], [0.7, 2.0, -0.1]),
        ray([-0.1, 0.1, 2.0], [0.1, 0.0, -2.0]),
        ray([0.1, 0.2, 0.1], [1.5, 0.4, 0.3]),
    ]
}

/// Sums a field of coefficient 1 along a ray, by Simpson's rule in very many steps.
fn by_definition(shape: Shape, distance: fn(DVec3) -> f64, ray: &Ray, decay: Option<Decay>) -> f64 {
    const STEPS: usize = 400_000;
    let field = |s: f64| {
        let d = distance(ray.at(s));
        let q = d.hypot(shape.radius);
        let width = 2.0_f64.sqrt() * shape.radius;
        let profile = match shape.profile {
            Profile::Inverse => 1.0 / q,
            Profile::InverseSquare => 1.0 / (q * q),
            Profile::InverseCube => 1.0 / (q * q * q),
            Profile::Gaussian => (-(d / width) * (d / width)).exp(),
            _ => libm::erf(d / width) / d,
        };
        let window = shape.reach.map_or(1.0, |reach| {
            let t = d / reach;
            if t < 1.0 {
                (1.0 - t * t) * (1.0 - t * t)
            } else {
                0.0
            }
        });
        let zeta = decay.map_or(1.0, |it| it.alpha / ((s + it.beta) * (s + it.beta)));
        profile * window * zeta
    };
    let step = 1.0 / STEPS as f64;
    let pairs = (0..STEPS / 2).map(|k| {
        let s = 2.0 * k as f64 * step;
        field(s) + 4.0 * field(s + step) + field(s + 2.0 * step)
    });
    pairs.sum::<f64>() * step / 3.0
}

#[test]
fn the_device_and_the_reference_meet_the_definition_of_every_shape() {
    let mut own = renderer(common::device().lanes, "");
    let mut scalar = renderer(1, "");
    let mut spoiled = renderer(8, "-DGAUSSIAN_END=1.5f -Dwindow2=1.0f");
    let mut misses = 0;
    let decay_of = |number: usize| (number % 2 == 1).then_some(Decay::new(0.2, 0.3));
    let some = (0..SHAPES.len()).map(|number| (number, decay_of(number)));
    // Without a decay these have closed forms.
    let others = [3, 5, 7].map(|number| (number, None));
    for (number, decay) in some.chain(others) {
        let shape = SHAPES[number];
        // All kinds in one scene: every scene is a program.
        let mut scene = common::empty_scene(32, 32);
        scene.decay = decay;
        let mut expected = vec![0.0; rays().len()];
        for (one, distance) in plain_kinds() {
            let one = shaped(one, shape);
            let parts = sources(&one);
            let integrand = Integrand {
                decay,
                absorption: None,
                softening: 0.0,
            };
            let sums = rays()
                .iter()
                .map(|ray| by_definition(shape, distance, ray, decay))
                .collect::<Vec<f64>>();
            let most = sums.iter().fold(0.0, |most: f64, value| most.max(*value));
            for ((ray, sum), total) in rays().iter().zip(&sums).zip(&mut expected) {
                let integral = |part| exact(part, ray, &integrand, 1.0);
                let error = (parts.iter().map(integral).sum::<f64>() - sum).abs();
                assert!(
                    error <= SUM_ERROR * most,
                    "{parts:?} {ray:?}: {error:e} of {sum:e}"
                );
                *total += sum;
            }
            scene.spheres.extend(one.spheres.iter().cloned());
            scene.cylinders.extend(one.cylinders.iter().cloned());
            scene.beams.extend(one.beams.iter().cloned());
            scene.tori.extend(one.tori.iter().cloned());
            scene.segments.extend(one.segments.iter().cloned());
        }
        let mut worst = |renderer: &mut Renderer, tolerance: f64| {
            scene.integration.method = Method::exact(tolerance);
            let found = renderer.integrate(&scene, &rays()).unwrap();
            let pairs = found.iter().zip(&expected);
            let errors = pairs.map(|([_, green, _], expected)| (green / expected - 1.0).abs());
            errors.fold(0.0, f64::max)
        };
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
            let error = worst(&mut own, tolerance);
            assert!(
                error <= tolerance.max(2e-5),
                "{shape:?} at {tolerance:e}: {error:e}"
            );
        }
        if number < 2 {
            continue; // a closed form
        }
        let error = worst(&mut scalar, 1e-3);
        assert!(error <= 1e-3, "{shape:?}, 1 lane: {error:e}");
        misses += usize::from(worst(&mut spoiled, 1e-3) > 1e-3);
    }
    assert!(misses >= 5, "only {misses} of the spoiled scenes miss");
}

/// A source of every kind, of one shape, and depths.
fn random_scene(seed: u64, shape: Shape) -> Scene {
    let mut random = Rng::with_seed(7000 + seed);
    let mut scene = random_view(&mut random, 40);
    for kind in KINDS {
        add_source(&mut random, kind, &mut scene);
    }
    let distance = scene.camera.eye.length() + random.f64();
    let is_open = random.bool();
    scene.depth = Some(common::depths(
        &scene,
        DepthAlong::Ray,
        |column, row| match column + row {
            _ if is_open => f64::INFINITY,
            ..40 => distance + 0.01 * f64::from(row),
            40..60 => f64::INFINITY,
            _ => 0.9 * distance,
        },
    ));
    shaped(scene, shape)
}

/// Adds to both images what the faintest pixels are measured by.
fn lifted(image: &RadianceImage, by: f32) -> RadianceImage {
    let mut lifted = image.clone();
    for pixel in lifted.as_mut_slice().chunks_exact_mut(4) {
        pixel[..3].iter_mut().for_each(|value| *value += by);
    }
    lifted
}

fn found(image: &RadianceImage, expected: &RadianceImage) -> energywave::image::Difference {
    let values = expected.as_slice().chunks_exact(4).flat_map(|p| &p[..3]);
    let most = values.fold(0.0_f32, |most, value| most.max(*value));
    let by = (LEAST_LIGHT as f32 * most).max(f32::MIN_POSITIVE);
    compare(&lifted(image, by), &lifted(expected, by)).unwrap()
}

#[test]
fn random_scenes_of_every_shape_meet_the_tolerance_by_tiles_and_by_pixels() {
    let mut renderer = renderer(common::device().lanes, "");
    for seed in 0..7 {
        let shape = SHAPES[2 + seed as usize];
        let scene = random_scene(seed, shape);
        let expected = reference::render(&scene).unwrap();
        // In turn: each pair is a program, of which every shape would have four.
        let mut ways = [Sampling::Pixels, Sampling::Tiles];
        ways.rotate_left(seed as usize % 2);
        for (tolerance, sampling) in [1e-3, 1e-5].into_iter().zip(ways) {
            let scene = sampled(&at_tolerance(&scene, tolerance), sampling);
            let image = renderer.render(&scene).unwrap();
            let found = found(&image, &expected);
            assert!(
                meets(&found, tolerance),
                "seed {seed}, {shape:?}, {tolerance:e}, {sampling:?}: {found:?}"
            );
        }
    }
}

/// Sparks of light, some far smaller than a tile.
fn sparks() -> Scene {
    let mut random = Rng::with_seed(3);
    let mut scene = common::empty_scene(160, 120);
    scene.integration.method = Method::default();
    for _ in 0..60 {
        let reach = 0.01 * 20.0_f64.powf(random.f64());
        scene.spheres.push(Sphere {
            center: DVec3::from([0; 3].map(|_| 2.4 * random.f64() - 1.2)),
            profile: Profile::Inverse,
            radius: 0.2 * reach,
            reach: Some(reach),
            coefficient: 1.0,
            ..Sphere::default()
        });
    }
    scene
}

#[test]
fn beyond_its_reach_a_source_is_black_and_no_spark_is_lost_between_nodes() {
    let mut renderer = renderer(common::device().lanes, "");
    let scene = sparks();
    let expected = reference::render(&scene).unwrap();
    for sampling in [Sampling::Pixels, Sampling::Tiles] {
        let image = renderer.render(&sampled(&scene, sampling)).unwrap();
        let found = found(&image, &expected);
        assert!(meets(&found, 1e-3), "{sampling:?}: {found:?}");
        let (mut lit, mut dark) = (0, 0);
        let pixels = image.as_slice().chunks_exact(4);
        for (pixel, expected) in pixels.zip(expected.as_slice().chunks_exact(4)) {
            match expected[1] {
                0.0 => dark += usize::from(pixel[1] == 0.0),
                value if value > 1e-6 => lit += usize::from(pixel[1] > 0.0),
                _ => {}
            }
        }
        let count = |is_wanted: fn(f32) -> bool| {
            let pixels = expected.as_slice().chunks_exact(4);
            pixels.filter(|pixel| is_wanted(pixel[1])).count()
        };
        assert_eq!(dark, count(|value| value == 0.0), "{sampling:?}");
        assert_eq!(lit, count(|value| value > 1e-6), "{sampling:?}");
        assert!(dark > 5000 && lit > 1000, "{dark} dark, {lit} lit");
    }
    // Tiles that take no account of where light ends lose sparks; so do those that ask for it in their middle alone.
    for spoil in ["-DMOST_BETWEEN=-1e9f", "-DCONE_MARGIN=0.0f"] {
        let mut blind = self::renderer(8, spoil);
        let image = blind.render(&sampled(&scene, Sampling::Tiles)).unwrap();
        assert!(!meets(&found(&image, &expected), 1e-3), "{spoil}");
    }
}

#[test]
fn simpsons_rule_sums_shapes_as_the_reference_does() {
    let mut renderer = renderer(common::device().lanes, "");
    for shape in SHAPES {
        let mut scene = shaped(common::full_scene(31, 17), shape);
        let divisions = 64;
        scene.integration.method = Method::Simpson { divisions };
        let expected = reference::render_simpson(&scene, divisions).unwrap();
        let image = renderer.render(&scene).unwrap();
        let found = found(&image, &expected);
        assert!(found.max < 1e-4, "{shape:?}: {found:?}");
    }
}

#[test]
fn a_peak_is_the_light_straight_across_a_core_whatever_the_worlds_scale() {
    let mut renderer = renderer(common::device().lanes, "");
    for shape in &SHAPES[1..] {
        if shape.profile == Profile::Smeared {
            continue; // no reach here: its light has no limit
        }
        for scale in [0.01, 1.0, 100.0] {
            let mut scene = common::empty_scene(8, 8);
            scene.integration.method = Method::exact(1e-4);
            scene.integration.measure = Measure::Length;
            scene.decay = None;
            scene.spheres.push(Sphere {
                profile: shape.profile,
                radius: scale * shape.radius,
                reach: shape.reach.map(|reach| scale * reach),
                peak: Some(0.7),
                ..Sphere::default()
            });
            let ends = [-1e3, 1e3].map(|y| DVec3::new(0.0, scale * y, 0.0));
            let across = Ray::between(ends[0], ends[1]);
            let [[_, found, _]] = renderer.integrate(&scene, &[across]).unwrap()[..] else {
                panic!("one ray");
            };
            // What lies beyond the ends of the ray is missing.
            assert!(
                (found - 0.7).abs() < 1e-3 * 0.7,
                "{shape:?}, {scale}: {found}"
            );
        }
    }
}
