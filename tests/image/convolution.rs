//! Segments all of whose points add their light, `profile = "convolution"`, against the definition: the integral along
//! a ray of the integral over the core of 1/r, both taken in float64 without a closed form.

use energywave::image::DepthAlong;
use energywave::internals::{Integrand, exact, integrate, sources};
use energywave::scene::{Absorption, Decay, Method, Profile, Ray, Sampling, Segment};
use energywave::{Renderer, Scene, reference};
use fastrand::Rng;
use glam::DVec3;

use crate::common::random::random_view;
use crate::common::{self, at_tolerance, difference, meets, outer_lane_widths, renderer, sampled};

/// The reference's own error, and that of the definition's integrals below.
const REFERENCE_ERROR: f64 = 1e-7;

/// How much light may bend from a step of 1e-3 along a core to the next: what float32 does to it.
const SMOOTH: f64 = 3e-6;

fn added(from: DVec3, to: DVec3, radius: f64) -> Segment {
    Segment {
        profile: Profile::Convolution,
        radius,
        ..Segment::new(from, to)
    }
}

fn scene_of(segments: Vec<Segment>) -> Scene {
    let mut scene = common::empty_scene(32, 32);
    scene.decay = None;
    scene.integration.method = Method::exact(1e-3);
    scene.segments.extend(segments);
    scene
}

fn integrand_of(scene: &Scene) -> Integrand {
    Integrand {
        decay: scene.decay,
        absorption: scene.absorption,
        softening: scene.integration.softening,
    }
}

/// The field at a point, summed over the core.
fn field(segment: &Segment, point: DVec3, floor: f64) -> f64 {
    let span = segment.to - segment.from;
    let length = span.length();
    let thick2 = segment.radius * segment.radius + floor * floor;
    let of_point = |share: f64| {
        let core = segment.from + span * share;
        length / (point.distance_squared(core) + thick2).sqrt()
    };
    let foot = (point - segment.from).dot(span) / (length * length);
    integrate(of_point, &mut vec![foot], 1.0, 1e-11).value
}

/// The integral over s in `[0,1]`, cut at 40 places, next to the closest approaches, and at the ends' planes.
fn by_definition(segment: &Segment, ray: &Ray, scene: &Scene) -> f64 {
    let length = ray.span.length();
    let integrand = |s: f64| {
        let decay = scene.decay.map_or(1.0, |decay| {
            decay.alpha / (s + decay.beta).powi(decay.power as i32)
        });
        let kappa = scene.absorption.map_or(0.0, |it| it.kappa);
        field(segment, ray.at(s), 1e-6 * length) * decay * (-kappa * s * length).exp()
    };
    let mut breaks: Vec<f64> = (1..40).map(|k| f64::from(k) / 40.0).collect();
    let direction = (segment.to - segment.from).normalize();
    for end in [segment.from, segment.to] {
        breaks.push(ray.nearest_to(end));
        breaks.push((end - ray.origin).dot(direction) / ray.span.dot(direction));
    }
    let across = ray.span.cross(direction);
    let to_line = (segment.from - ray.origin).cross(direction);
    breaks.push(to_line.dot(across) / across.length_squared());
    breaks.retain(|s| s.is_finite());
    integrate(integrand, &mut breaks, 1.0, 1e-9).value
}

/// Rays past the segment from (-1, 0, 0) to (1, 0, 0): across it, beside its ends, level with their planes, along it,
/// all but along it, through it, within it, beyond it, and far away.
fn hard_rays() -> Vec<Ray> {
    let ray = |from: [f64; 3], to: [f64; 3]| Ray::between(from.into(), to.into());
    vec![
        ray([0.2, -3.0, 0.1], [0.3, 4.0, 0.2]),
        ray([-1.0, -3.0, 0.5], [-1.0, 3.0, 0.5]),
        ray([1.0, -3.0, 1e-3], [1.0, 3.0, 1e-3]),
        ray([-4.0, 0.02, 0.0], [5.0, 0.02, 0.0]),
        ray([-4.0, 0.001, 0.0], [5.0, 0.002, 0.001]),
        ray([-4.0, 0.0, 0.0], [5.0, 0.0, 0.0]),
        ray([-4.0, 0.0, 0.3], [-1.2, 0.0, 0.3]),
        ray([0.5, -2.0, 1e-4], [0.5, 2.0, -1e-4]),
        ray([0.5, -2.0, 0.0], [0.5, 2.0, 0.0]),
        ray([-1.001, -2.0, 2e-4], [-1.001, 2.0, 2e-4]),
        ray([4.0, 0.3, 0.2], [-3.0, -0.2, 0.1]),
        ray([0.0, 0.5, 0.0], [0.1, 0.6, 0.0]),
        ray([-0.5, 0.001, 0.0], [0.5, 0.001, 0.0]),
        ray([300.0, -200.0, 40.0], [310.0, 200.0, -20.0]),
    ]
}

/// What the light of the hard rays fades by.
fn fadings() -> [(Option<Decay>, Option<Absorption>); 4] {
    let steep = Decay {
        power: 3,
        ..Decay::new(0.2, 0.2)
    };
    [
        (None, None),
        (Some(Decay::new(0.1, 0.1)), None),
        (Some(steep), None),
        (Some(Decay::new(0.5, 0.4)), Some(Absorption { kappa: 0.6 })),
    ]
}

fn faded(segment: &Segment, (decay, absorption): (Option<Decay>, Option<Absorption>)) -> Scene {
    let mut scene = scene_of(vec![segment.clone()]);
    (scene.decay, scene.absorption) = (decay, absorption);
    scene
}

#[test]
fn rays_meet_the_definition_at_every_tolerance_and_on_one_lane_and_many() {
    let mut own = renderer(common::device().lanes, "");
    let mut others: Vec<Renderer> = outer_lane_widths()
        .into_iter()
        .map(|lanes| renderer(lanes, ""))
        .collect();
    for radius in [0.0, 0.1] {
        let segment = added(-DVec3::X, DVec3::X, radius);
        for fading in fadings() {
            let mut scene = faded(&segment, fading);
            let integrand = integrand_of(&scene);
            let expected: Vec<f64> = hard_rays()
                .iter()
                .map(|ray| {
                    let expected = by_definition(&segment, ray, &scene);
                    let value = exact(&sources(&scene)[0], ray, &integrand, 1.0);
                    let error = (value / expected - 1.0).abs();
                    assert!(error < REFERENCE_ERROR, "{ray:?} {fading:?}: {error:e}");
                    expected
                })
                .collect();
            let errors = |renderer: &mut Renderer, scene: &Scene| -> Vec<f64> {
                let found = renderer.integrate(scene, &hard_rays()).unwrap();
                let pairs = found.iter().zip(&expected);
                pairs
                    .map(|([_, green, _], expected)| (green / expected - 1.0).abs())
                    .collect()
            };
            for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
                scene.integration.method = Method::exact(tolerance);
                let found = errors(&mut own, &scene);
                let most = tolerance.max(2e-5);
                let is_met = found.iter().all(|error| *error <= most);
                assert!(is_met, "{radius} {fading:?} {tolerance:e}: {found:?}");
            }
            scene.integration.method = Method::exact(1e-3);
            if fading == (None, None) {
                for renderer in &mut others {
                    let found = errors(renderer, &scene);
                    assert!(found.iter().all(|error| *error <= 1e-3), "{found:?}");
                }
            }
            scene.segments[0].to.x += 0.02;
            let found = errors(&mut own, &scene);
            let missed = found.iter().filter(|error| **error > 1e-3).count();
            assert!(missed >= 10, "a longer segment passed: {found:?}");
        }
    }
}

/// One to four segments that add up, and one that does not, in a view of any kind, with or without depths.
fn random_scene(seed: u64) -> Scene {
    let mut random = Rng::with_seed(4100 + seed);
    let mut scene = random_view(&mut random, 48);
    for _ in 0..random.u32(1..5) {
        let mut point = || DVec3::from([0; 3].map(|_| 2.0 * random.f64() - 1.0));
        let (from, to) = (point(), point());
        let short = from + 1e-3 * to;
        let radius = if random.bool() {
            0.0
        } else {
            0.1 * random.f64()
        };
        let to = if random.u32(0..5) == 0 { short } else { to };
        scene.segments.push(added(from, to, radius));
    }
    scene.segments.push(Segment::new(DVec3::Z, 1.5 * DVec3::Z));
    let distance = scene.camera.eye.length() + random.f64();
    let is_open = seed.is_multiple_of(2);
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
    scene
}

#[test]
fn random_images_meet_the_tolerance_by_tiles_and_by_pixels() {
    let mut renderer = renderer(common::device().lanes, "");
    for seed in 0..12 {
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
}

/// The light of scenes along rays, to a tight tolerance.
fn lights(renderer: &mut Renderer, scene: &Scene, rays: &[Ray]) -> Vec<f64> {
    let scene = at_tolerance(scene, 1e-6);
    let found = renderer.integrate(&scene, rays).unwrap();
    found.iter().map(|[_, green, _]| *green).collect()
}

#[test]
fn segments_end_to_end_are_one_and_light_neither_jumps_nor_bends_there() {
    let mut renderer = renderer(common::device().lanes, "");
    let (begin, joint, end) = (-DVec3::X, DVec3::new(0.3, 0.0, 0.0), DVec3::X);
    let one = scene_of(vec![added(begin, end, 0.0)]);
    let two = scene_of(vec![added(begin, joint, 0.0), added(joint, end, 0.0)]);
    // Past the joint and its plane at a small distance, a step of 1e-3 at a time.
    let beside: Vec<Ray> = (-20..=20)
        .map(|k| {
            let x = joint.x + 1e-3 * f64::from(k);
            Ray::between(DVec3::new(x, -3.0, 0.01), DVec3::new(x, 3.0, 0.01))
        })
        .collect();
    let rays: Vec<Ray> = beside.iter().copied().chain(hard_rays()).collect();
    let whole = lights(&mut renderer, &one, &rays);
    let parts = lights(&mut renderer, &two, &rays);
    for ((whole, parts), ray) in whole.iter().zip(&parts).zip(&rays) {
        assert!(
            (parts / whole - 1.0).abs() < 1e-5,
            "{ray:?}: {parts}, not {whole}"
        );
    }
    let bend = |lights: &[f64]| {
        let bends = lights
            .windows(3)
            .map(|at| ((at[0] + at[2]) / at[1] - 2.0).abs());
        bends.fold(0.0, f64::max)
    };
    let most = bend(&parts[..beside.len()]);
    assert!(most < SMOOTH, "light bends by {most:e} along the core");
    // The nearest point's fields add up to a knot instead.
    let mut nearest = two.clone();
    for segment in nearest.segments.iter_mut() {
        segment.profile = Profile::Inverse;
    }
    let knot = bend(&lights(&mut renderer, &nearest, &beside));
    assert!(
        knot > 100.0 * SMOOTH,
        "only {knot:e} along the nearest points"
    );
}

#[test]
fn along_a_core_light_brightens_less_than_that_of_the_nearest_point() {
    let mut renderer = renderer(common::device().lanes, "");
    let half = 2.0 * DVec3::X;
    let rays = [DVec3::Y, DVec3::X].map(|along| {
        let aside = 0.1 * DVec3::Z;
        Ray::between(aside - 6.0 * along, aside + 6.0 * along)
    });
    let mut brightening = |profile| {
        let mut scene = scene_of(vec![added(-half, half, 0.0)]);
        scene.segments[0].profile = profile;
        let found = lights(&mut renderer, &scene, &rays);
        found[1] / found[0]
    };
    let (added, nearest) = (
        brightening(Profile::Convolution),
        brightening(Profile::Inverse),
    );
    assert!(
        (added - 1.75).abs() < 0.01 && (nearest - 5.1).abs() < 0.05,
        "{added} {nearest}"
    );
}

#[test]
fn what_has_no_sum_over_its_core_is_refused() {
    let head = "[camera]\neye = [0.0, -4.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\n";
    let segment =
        "[[segment]]\nfrom = [0.0, 0.0, 0.0]\nto = [1.0, 0.0, 0.0]\nprofile = \"convolution\"\n";
    let read = |rest: &str| Scene::from_toml(&format!("{head}{rest}"));
    let scene = read(&format!("{segment}radius = 0.1\n")).unwrap();
    assert_eq!(scene.segments[0], added(DVec3::ZERO, DVec3::X, 0.1));
    for (rest, words) in [
        (
            "[[sphere]]\nprofile = \"convolution\"\n".to_owned(),
            "scene:5:11: sphere[0].profile: adds up the light of a [[segment]]",
        ),
        (
            format!("{segment}reach = 2.0\n"),
            "scene:8:9: segment[0].reach: light that is added up over a core has no end",
        ),
        (
            format!("{segment}radius = 0.1\npeak = 1.0\n[integration]\nmeasure = \"length\"\n"),
            "scene:9:8: segment[0].peak: light that is added up over a core has no limit",
        ),
        (format!("{segment}radius = -0.1\n"), "segment[0].radius"),
    ] {
        let message = read(&rest).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
}
