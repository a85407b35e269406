//! Roots of integrals of squares (`reduction = "rms"`) against their definition in float64.

use crate::common::{self, difference, meets, renderer};
use energywave::image::{DepthAlong, Difference};
use energywave::scene::{
    Absorption, Beam, Camera, Curve, Cylinder, Decay, Falloff, LightPath, Measure, Method, Profile,
    Reduction, Sampling, Segment, Sphere, Torus,
};
use energywave::{Device, RadianceImage, Ray, Renderer, Scene, reference};
use glam::DVec3;

/// A scene that takes the root of a light, without any.
fn empty() -> Scene {
    let mut scene = common::empty_scene(48, 40);
    scene.integration.measure = Measure::Length;
    scene.integration.reduction = Reduction::Rms;
    scene.integration.method = Method::default();
    scene.decay = None;
    scene
}

const COLOR: DVec3 = DVec3::new(0.9, 0.4, 0.2);

/// A scene of one source of a kind, of a colour and a coefficient.
type One = fn() -> Scene;

macro_rules! one {
    ($list:ident, $source:expr) => {
        || {
            let mut scene = empty();
            let mut source = $source;
            (source.coefficient, source.color) = (1.7, COLOR);
            scene.$list.push(source);
            scene
        }
    };
}

const SPHERE: One = one!(
    spheres,
    Sphere {
        center: DVec3::new(0.3, 0.2, 0.1),
        ..Sphere::default()
    }
);
const CYLINDER: One = one!(cylinders, Cylinder::new(DVec3::new(1.0, 0.3, 0.2)));
const BEAM: One = one!(beams, Beam::new(DVec3::new(1.0, 0.4, 0.3)));
const TORUS: One = one!(tori, Torus::new(0.9));
const CURVE: One = one!(curves, Curve::new(common::CURVE_SHAPES[0].map(DVec3::from)));
const SEGMENT: One = one!(
    segments,
    Segment::new(DVec3::new(-0.8, -0.6, 0.1), DVec3::new(0.9, 0.7, 0.3))
);
const PATH: One = one!(paths, {
    let points = [(-0.9, -0.3), (-0.2, 0.5), (0.3, -0.1), (0.9, 0.6)];
    LightPath::new(points.map(|(x, z)| DVec3::new(x, 0.3 * x, z)).to_vec())
});

const fn falloff(profile: Profile, radius: f64, reach: Option<f64>) -> Falloff {
    Falloff {
        profile,
        radius,
        reach,
    }
}

/// The square has a closed form.
const CLOSED: [Falloff; 2] = [
    falloff(Profile::Inverse, 0.0, None),
    falloff(Profile::Inverse, 0.08, None),
];

/// Every sample is squared.
const SQUARED: [Falloff; 7] = [
    falloff(Profile::Inverse, 0.05, Some(0.7)),
    falloff(Profile::InverseSquare, 0.0, None),
    falloff(Profile::InverseSquare, 0.08, None),
    falloff(Profile::InverseSquare, 0.05, Some(0.6)),
    falloff(Profile::InverseCube, 0.08, None),
    falloff(Profile::Gaussian, 0.2, Some(0.9)),
    falloff(Profile::Smeared, 0.1, None),
];

/// Gives the one source of a scene a falloff.
fn shaped(mut scene: Scene, falloff: Falloff) -> Scene {
    macro_rules! set {
        ($($list:ident),*) => {
            $(for source in &mut *scene.$list {
                source.profile = falloff.profile;
                (source.radius, source.reach) = (falloff.radius, falloff.reach);
            })*
        };
    }
    set!(spheres, cylinders, beams, tori, curves, segments, paths);
    scene
}

fn device() -> Renderer {
    renderer(common::device().lanes, "")
}

/// Pixels below this share of the brightest are measured by it: the last light of a Gaussian and of a reach.
const LEAST_LIGHT: f64 = 1e-6;

fn lifted(image: &RadianceImage, by: f32) -> RadianceImage {
    let mut lifted = image.clone();
    let values = lifted.as_mut_slice().iter_mut();
    values.for_each(|value| *value += by);
    lifted
}

/// How far a scene is off what is expected of it.
fn off(renderer: &mut Renderer, scene: &Scene, expected: &RadianceImage) -> Difference {
    let colors = expected.as_slice().chunks_exact(4).flat_map(|p| &p[..3]);
    let most = colors.fold(0.0_f32, |most, value| most.max(*value));
    let by = LEAST_LIGHT as f32 * most;
    let image = renderer.render(scene).unwrap();
    difference(&lifted(&image, by), &lifted(expected, by))
}

/// Adds what misses its tolerance.
fn add_missed(scene: &Scene, sampling: Sampling, tolerances: &[f64], missed: &mut Vec<String>) {
    let mut renderer = device();
    let expected = reference::render(scene).unwrap();
    let mut scene = scene.clone();
    for tolerance in tolerances {
        scene.integration.method = Method::Exact {
            tolerance: *tolerance,
            sampling,
        };
        let found = off(&mut renderer, &scene, &expected);
        if !meets(&found, *tolerance) {
            missed.push(format!(
                "{sampling:?}, {tolerance:e}: {found:?}, {}",
                scene.to_toml().unwrap()
            ));
        }
    }
}

#[test]
fn every_kind_and_falloff_meets_every_tolerance_by_tiles() {
    let mut missed = Vec::new();
    let tolerances = [1e-2, 1e-3, 1e-4, 1e-5];
    for one in [SPHERE, CYLINDER, BEAM, TORUS, CURVE, SEGMENT, PATH] {
        for falloff in SQUARED {
            add_missed(
                &shaped(one(), falloff),
                Sampling::Tiles,
                &tolerances,
                &mut missed,
            );
        }
    }
    for one in [SEGMENT, TORUS] {
        for falloff in CLOSED {
            add_missed(
                &shaped(one(), falloff),
                Sampling::Tiles,
                &tolerances,
                &mut missed,
            );
        }
    }
    assert!(missed.is_empty(), "{}: {missed:#?}", missed.len());
}

#[test]
fn pixels_with_depths_and_fading_meet_every_tolerance() {
    let mut missed = Vec::new();
    for falloff in [CLOSED[1], SQUARED[2]] {
        let mut scene = shaped(SEGMENT(), falloff);
        add_missed(
            &scene,
            Sampling::Pixels,
            &[1e-2, 1e-3, 1e-4, 1e-5],
            &mut missed,
        );
        scene.decay = Some(Decay::new(0.1, 0.3));
        let wall = |column: u32, _| if column < 20 { 3.6 } else { 9.0 };
        scene.depth = Some(common::depths(&scene, DepthAlong::Ray, wall));
        add_missed(&scene, Sampling::Tiles, &[1e-3, 1e-5], &mut missed);
        scene.depth = None;
        scene.absorption = Some(Absorption { kappa: 0.3 });
        add_missed(&scene, Sampling::Pixels, &[1e-3, 1e-5], &mut missed);
        scene.decay = Some(Decay {
            power: 0,
            ..Decay::new(0.3, 0.3)
        });
        scene.absorption = None;
        scene.integration.measure = Measure::Parameter;
        add_missed(&scene, Sampling::Pixels, &[1e-3, 1e-5], &mut missed);
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
fn every_lane_width_takes_roots() {
    let mut scene = shaped(SPHERE(), SQUARED[3]);
    scene.integration.method = common::by(Sampling::Pixels);
    let expected = reference::render(&scene).unwrap();
    for lanes in common::lane_widths() {
        let found = off(&mut renderer(lanes, ""), &scene, &expected);
        assert!(meets(&found, 1e-3), "{lanes} lanes: {found:?}");
    }
}

#[test]
fn spoiled_kernels_and_the_sum_miss() {
    let scene = shaped(SEGMENT(), SQUARED[2]);
    let expected = reference::render(&scene).unwrap();
    let mut spoiled = renderer(common::device().lanes, common::BROKEN_FIELDS);
    let found = off(&mut spoiled, &scene, &expected);
    assert!(!meets(&found, 1e-3), "{found:?}");
    let mut sum = scene.clone();
    sum.integration.reduction = Reduction::Sum;
    let found = off(&mut device(), &sum, &expected);
    assert!(!meets(&found, 0.1), "{found:?}");
}

#[test]
fn sums_of_samples_have_roots_too() {
    let mut scene = shaped(SEGMENT(), SQUARED[2]);
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    for method in [
        Method::simpson(64),
        Method::Jittered {
            divisions: 64,
            seed: 2,
        },
    ] {
        scene.integration.method = method;
        let expected = reference.render(&scene).unwrap();
        let found = off(&mut device(), &scene, &expected).max;
        assert!(found < common::WORST_PIXEL, "{method:?}: {found:e}");
    }
}

/// The root of the integral of the square of 1/d along a ray, d the distance to the points of a line along x from -2 to
/// 2: by Simpson's rule in very many steps.
fn by_definition(ray: &Ray) -> f64 {
    const STEPS: u32 = 400_000;
    let square = |k: u32| {
        let place = ray.at(f64::from(k) / f64::from(STEPS));
        let d = DVec3::new((place.x.abs() - 2.0).max(0.0), place.y, place.z).length();
        1.0 / (d * d)
    };
    let pairs = (0..STEPS / 2).map(|k| square(2 * k) + 4.0 * square(2 * k + 1) + square(2 * k + 2));
    (pairs.sum::<f64>() * ray.span.length() / (3.0 * f64::from(STEPS))).sqrt()
}

#[test]
fn seen_along_a_segment_brightens_less_than_its_sum_does() {
    let mut scene = empty();
    scene.camera = Camera::new(DVec3::new(0.0, -9.0, 0.0), DVec3::ZERO);
    scene.segments.push(Segment {
        profile: Profile::Inverse,
        ..Segment::new(-2.0 * DVec3::X, 2.0 * DVec3::X)
    });
    scene.integration.method = Method::exact(1e-5);
    // 12 long through the middle, 0.1 beside it.
    let beside = 0.1 * DVec3::Z;
    let rays = [DVec3::Y, DVec3::X].map(|way| Ray::between(beside - 6.0 * way, beside + 6.0 * way));
    for mut renderer in [device(), Renderer::new(&Device::reference()).unwrap()] {
        let mut ratio = |reduction| {
            scene.integration.reduction = reduction;
            let light = renderer.integrate(&scene, &rays).unwrap();
            if reduction == Reduction::Rms {
                for (light, ray) in light.iter().zip(&rays) {
                    let error = (light[0] / by_definition(ray) - 1.0).abs();
                    assert!(error < 2e-5, "{light:?}: {error:e}");
                }
            }
            light[1][0] / light[0][0]
        };
        let (rms, sum) = (ratio(Reduction::Rms), ratio(Reduction::Sum));
        assert!((rms - 3.7).abs() < 0.05, "{rms}");
        assert!((sum - 5.1).abs() < 0.05, "{sum}");
    }
}

#[test]
fn a_light_keeps_its_colour_sign_and_measure() {
    let mut renderer = device();
    let mut light = |change: &dyn Fn(&mut Scene)| {
        let mut scene = shaped(SPHERE(), CLOSED[1]);
        change(&mut scene);
        let image = renderer.render(&scene).unwrap();
        image.pixel(20, 20).unwrap().map(f64::from)
    };
    let plain = light(&|_| ());
    let is_near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 1e-5;
    assert!(is_near(plain[1] / plain[0], COLOR.y / COLOR.x));
    let negative = light(&|scene| scene.spheres[0].coefficient *= -3.0);
    assert!(
        is_near(negative[0], -3.0 * plain[0]),
        "{negative:?} {plain:?}"
    );
    let by_parameter = light(&|scene| scene.integration.measure = Measure::Parameter);
    let length = shaped(SPHERE(), CLOSED[1]).ray_length();
    assert!(is_near(plain[0], by_parameter[0] * length.sqrt()));
}

#[test]
fn beyond_its_reach_a_root_is_black() {
    let scene = shaped(SPHERE(), SQUARED[3]);
    for sampling in [Sampling::Pixels, Sampling::Tiles] {
        let mut scene = scene.clone();
        scene.integration.method = common::by(sampling);
        let image = device().render(&scene).unwrap();
        assert_eq!(image.pixel(0, 0), Some([0.0, 0.0, 0.0, 1.0]));
        let lit = image.as_slice().chunks(4).filter(|pixel| pixel[0] > 0.0);
        assert!((50..1000).contains(&lit.count()));
    }
}
