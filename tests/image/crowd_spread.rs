//! Crowds of points that leave trails, and of balls, against float64 of what each is.

use energywave::Scene;
use energywave::scene::{Antialias, Crowd, Decay, PointList, Points, Profile, Ray};
use fastrand::Rng;
use glam::DVec3;

use super::crowd_depths::put_boxes;
use super::crowd_truth::{FEWER_PIXELS, Shape, fault, scene};
use super::crowds::integral_up_to;
use crate::common;

const TOLERANCE: f64 = 1e-3;

/// Places and weights of Gauss-Legendre of five nodes, from 0 to 1.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_5),
    (0.230_765_344_947_158_4, 0.239_314_335_249_683_2),
    (0.5, 0.284_444_444_444_444_4),
    (0.769_234_655_052_841_6, 0.239_314_335_249_683_2),
    (0.953_089_922_969_332, 0.118_463_442_528_094_5),
];

fn sum(from: f64, to: f64, value: &mut dyn FnMut(f64) -> f64) -> f64 {
    let at = |(place, weight): &(f64, f64)| weight * value(from + (to - from) * place);
    (to - from) * GAUSS.iter().map(at).sum::<f64>()
}

/// Integrates what has a peak of such a width, in pieces that grow on both sides of it.
fn graded(from: f64, to: f64, peak: f64, width: f64, value: &mut dyn FnMut(f64) -> f64) -> f64 {
    let mut ends = vec![from, to, peak];
    let mut away = width;
    while away < to - from {
        ends.extend([peak - away, peak + away]);
        away *= 2.0;
    }
    ends.retain(|it| (from..=to).contains(it));
    ends.sort_by(f64::total_cmp);
    ends.windows(2)
        .map(|pair| sum(pair[0], pair[1], value))
        .sum()
}

/// Returns the light of a point that is spread, along a ray up to a share of it.
pub fn light_of_one(
    ray: &Ray,
    end: f64,
    points: &Points,
    index: usize,
    decay: Option<Decay>,
) -> f64 {
    let place = points.points.positions()[index];
    let plain = |place| integral_up_to(ray, end, place, Profile::Inverse, decay);
    if let Some(previous) = points.points.previous() {
        let (from, way) = (previous[index], place - previous[index]);
        let toward = ray.span.normalize();
        let across = |vector: DVec3| vector - vector.dot(toward) * toward;
        let (off, aside) = (across(from - ray.origin), across(way));
        let nearest = (-off.dot(aside) / aside.length_squared().max(1e-300)).clamp(0.0, 1.0);
        let mut value = |share: f64| plain(from + share * way);
        return match (off + nearest * aside).length() > 2.0 * way.length() {
            true => sum(0.0, 1.0, &mut value),
            false => graded(0.0, 1.0, nearest, 1e-3, &mut value),
        };
    }
    let radius = points.radius;
    if radius == 0.0 {
        return integral_up_to(ray, end, place, points.profile, decay);
    }
    let length = ray.span.length();
    let foot = (place - ray.origin).dot(ray.span) / (length * length);
    let beside = place.distance(ray.origin + foot * ray.span);
    if points.profile == Profile::Inverse {
        let aside = ray.span.normalize().any_orthonormal_vector();
        return plain(ray.origin + foot * ray.span + beside.hypot(radius) * aside);
    }
    if beside > 6.5 * radius {
        return plain(place);
    }
    let mut value = |s: f64| {
        let d = beside.hypot((s - foot) * length).max(1e-9 * radius);
        let fade = decay.map_or(1.0, |it| it.alpha / (s + it.beta).powi(2));
        fade * libm::erf(d / (2.0_f64.sqrt() * radius)) / d
    };
    graded(
        0.0,
        end,
        foot,
        0.5 * beside.max(radius) / length,
        &mut value,
    )
}

/// How light is spread.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Spread {
    /// Every way of its own, up to so long.
    Trails(f64),
    /// All fly together.
    Stream(f64),
    Smeared(f64),
    Thick(f64),
}

fn spread(mut scene: Scene, spread: Spread) -> Scene {
    let points = &mut scene.points[0];
    let mut rng = Rng::with_seed(21);
    let mut cube = || DVec3::from([(); 3].map(|()| 2.0 * rng.f64() - 1.0));
    let list = &points.points;
    let moved = |way: &mut dyn FnMut() -> DVec3| {
        let previous = list.positions().iter().map(|place| *place - way());
        list.clone().with_previous(previous.collect()).unwrap()
    };
    match spread {
        Spread::Trails(length) => points.points = moved(&mut || length * cube()),
        Spread::Stream(length) => {
            points.points = moved(&mut || length * DVec3::new(0.8, 0.5, 0.33));
        }
        Spread::Smeared(radius) => (points.profile, points.radius) = (Profile::Smeared, radius),
        Spread::Thick(radius) => points.radius = radius,
    }
    scene
}

fn faults(cases: &[(Shape, usize, Spread, bool)]) -> Vec<String> {
    let mut renderer = common::renderer(common::device().lanes, "");
    let mut faults = Vec::new();
    for (shape, count, kind, has_boxes) in cases {
        let mut scene = spread(scene(*shape, *count, Profile::Inverse, TOLERANCE), *kind);
        if *has_boxes {
            put_boxes(&mut scene, energywave::image::DepthAlong::Ray);
        }
        let image = renderer.render(&scene).unwrap();
        let many = match count {
            ..=1000 => FEWER_PIXELS,
            ..=3000 => FEWER_PIXELS / 2,
            _ => (FEWER_PIXELS * 3000 / count).max(6),
        };
        let name = format!("{shape:?} of {count}, {kind:?}, boxes: {has_boxes}");
        faults.extend(fault(&scene, image.as_slice(), TOLERANCE, many, &name));
    }
    faults
}

#[test]
fn trails_are_their_light_within_a_thousandth() {
    let cases = [
        (Shape::Ball, 600, Spread::Trails(0.3), false),
        (Shape::Ball, 3000, Spread::Trails(0.3), false),
        (Shape::Ball, 3000, Spread::Trails(0.02), false),
        (Shape::Ball, 3000, Spread::Stream(1.0), false),
        (Shape::Clumps, 3000, Spread::Stream(0.3), false),
        (Shape::Clumps, 1000, Spread::Trails(0.3), false),
        (Shape::HeavyTails, 3000, Spread::Trails(0.3), false),
        (Shape::OnePixel, 1000, Spread::Trails(0.1), false),
        (Shape::Inside, 3000, Spread::Trails(0.3), false),
        (Shape::AtPlane, 1000, Spread::Trails(0.3), false),
        (Shape::Ball, 30_000, Spread::Trails(0.1), false),
        (Shape::Clumps, 30_000, Spread::Stream(0.1), false),
        (Shape::Ball, 3000, Spread::Trails(0.3), true),
    ];
    assert_eq!(faults(&cases), Vec::<String>::new());
}

#[test]
fn a_million_trails_are_their_light_within_a_thousandth() {
    let cases = [(Shape::Ball, 1_000_000, Spread::Trails(0.01), false)];
    assert_eq!(faults(&cases), Vec::<String>::new());
}

#[test]
fn balls_are_their_light_within_a_thousandth() {
    let cases = [
        (Shape::Ball, 600, Spread::Smeared(0.1), false),
        (Shape::Ball, 3000, Spread::Smeared(0.03), false),
        (Shape::Ball, 3000, Spread::Smeared(0.003), false),
        (Shape::Clumps, 3000, Spread::Smeared(0.03), false),
        (Shape::Clumps, 1000, Spread::Smeared(0.2), false),
        (Shape::HeavyTails, 3000, Spread::Smeared(0.05), false),
        (Shape::Inside, 1000, Spread::Smeared(0.02), false),
        (Shape::AtPlane, 1000, Spread::Smeared(0.02), false),
        (Shape::Ball, 30_000, Spread::Smeared(0.03), false),
        (Shape::Clumps, 30_000, Spread::Smeared(0.03), false),
        (Shape::Ball, 3000, Spread::Smeared(0.05), true),
    ];
    assert_eq!(faults(&cases), Vec::<String>::new());
}

/// The controls: what is drawn of other trails and balls is not within the tolerance.
#[test]
fn other_trails_and_balls_are_found() {
    let mut renderer = common::renderer(common::device().lanes, "");
    let crowd = || scene(Shape::Clumps, 1000, Profile::Inverse, TOLERANCE);
    for (right, wrong) in [
        (Spread::Stream(0.3), None),
        (Spread::Stream(0.3), Some(Spread::Stream(0.27))),
        (Spread::Smeared(0.05), None),
        (Spread::Smeared(0.05), Some(Spread::Smeared(0.06))),
        (Spread::Smeared(0.05), Some(Spread::Thick(0.05))),
    ] {
        let drawn = wrong.map_or_else(crowd, |wrong| spread(crowd(), wrong));
        let image = renderer.render(&drawn).unwrap();
        let scene = spread(crowd(), right);
        let name = format!("{wrong:?} for {right:?}");
        let fault = fault(&scene, image.as_slice(), TOLERANCE, 100, &name);
        assert!(fault.is_some(), "{name} was not found");
    }
}

/// What is drawn by itself is the same light: of few points, of bright ones, and where nothing may be a crowd.
#[test]
fn trails_and_balls_apart_are_the_same() {
    let mut renderer = common::renderer(common::device().lanes, "");
    for kind in [
        Spread::Trails(0.3),
        Spread::Smeared(0.05),
        Spread::Thick(0.05),
    ] {
        let mut few = spread(scene(Shape::Ball, 40, Profile::Inverse, TOLERANCE), kind);
        let image = renderer.render(&few).unwrap();
        let fault = fault(&few, image.as_slice(), TOLERANCE, 200, "forty");
        assert_eq!(fault, None, "{kind:?}");
        few.integration.antialias = Antialias::Footprint;
        few.integration.crowd = Crowd::Never;
        assert!(renderer.render(&few).is_ok());
    }
    let points = PointList::new(vec![DVec3::ZERO; 2]).unwrap();
    let moved = points.with_previous(vec![DVec3::X, DVec3::ZERO]).unwrap();
    let mut square = scene(Shape::Ball, 1, Profile::InverseSquare, TOLERANCE);
    square.points[0].points = moved;
    let error = renderer.render(&square).unwrap_err().to_string();
    assert!(error.contains("points[0].previous"), "{error}");
}
