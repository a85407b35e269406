//! Holds the light that waves cast on surfaces to its definition: sums of random places of each core, and the float64
//! reference.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use energywave::scene::{
    Beam, BeamEnd, Camera, Curve, Cylinder, Dashes, LightPath, Lighting, PathShape, Profile,
    Segment, Sphere, Torus,
};
use energywave::{Renderer, Scene, reference};
use glam::DVec3;

use super::common::{device, renderer};

/// Within which light grows no more.
const RADIUS: f64 = 1e-3;

/// Points of surfaces for each source.
const POINTS: usize = 200;

/// The error that light may have against sums of random places: the model's bar.
const MOST: f64 = 1e-2;

/// The standard error of such a sum.
const STANDARD_ERROR: f64 = 2e-3;

/// What is dark for both: a share of what would fall on a surface that faces each place of the core.
const DARK: f64 = 1e-4;

/// The error that the kernel may have against the reference: of one point in a hundred, and of all.
const USUAL: f64 = 5e-3;

/// A place of a core, from a number between 0 and 1 and the point that is lit, and its light times what it stands for.
type Place = Box<dyn Fn(f64, DVec3) -> (DVec3, DVec3)>;

struct Case {
    name: &'static str,
    scene: Scene,
    place: Place,
    /// Where an end is.
    end: f64,
}

fn scene() -> Scene {
    let mut scene = Scene::new(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO));
    let mut lighting = Lighting::default();
    lighting.radius = Some(RADIUS);
    lighting.gain = 2.0;
    scene.lighting = Some(lighting);
    scene
}

fn case(name: &'static str, add: impl Fn(&mut Scene), place: Place) -> Case {
    let mut scene = scene();
    add(&mut scene);
    let end = if name == "a line" { 0.1 } else { 1e-9 };
    Case {
        name,
        scene,
        place,
        end,
    }
}

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

const COLOR: DVec3 = DVec3::new(1.0, 0.5, 0.25);

/// Gain and coefficient.
const STRONG: f64 = 2.0 * 3.0;

fn lerp(values: &[DVec3], s: f64) -> DVec3 {
    let at = s * (values.len() - 1) as f64;
    let k = (at as usize).min(values.len() - 2);
    values[k].lerp(values[k + 1], at - k as f64)
}

/// A straight core from one point to another, of a light per length at each share of it.
fn straight(from: DVec3, to: DVec3, light: impl Fn(f64) -> DVec3 + 'static) -> Place {
    Box::new(move |x, _| (from.lerp(to, x), light(x) * from.distance(to)))
}

/// A line from a point on, or in both directions: even in the angle that it is seen in.
fn line(point: DVec3, direction: DVec3, begins: bool, light: DVec3) -> Place {
    let direction = direction.normalize();
    Box::new(move |x, seen_from| {
        let nearest = (seen_from - point).dot(direction);
        let distance = (point + nearest * direction).distance(seen_from).max(1e-6);
        let begin = match begins {
            true => (-nearest / distance).atan(),
            false => -FRAC_PI_2,
        };
        let angle = begin + x * (FRAC_PI_2 - begin);
        let t = nearest + distance * angle.tan();
        let per_x = (FRAC_PI_2 - begin) * distance / angle.cos().powi(2);
        (point + t * direction, light * per_x)
    })
}

fn cases() -> Vec<Case> {
    let (from, to) = (v(-0.8, 0.1, 0.3), v(0.9, -0.2, -0.1));
    let light = STRONG * COLOR;
    let colors = [v(1.0, 0.2, 0.0), v(0.1, 1.0, 0.4), v(0.3, 0.0, 1.0)];
    let mut cases = vec![
        case(
            "a point",
            |scene| {
                scene.spheres.push(Sphere {
                    center: to,
                    coefficient: 3.0,
                    color: COLOR,
                    ..Sphere::default()
                });
            },
            Box::new(move |_, _| (to, light)),
        ),
        case(
            "a line",
            |scene| {
                scene.cylinders.push(Cylinder {
                    point: from,
                    coefficient: 3.0,
                    color: COLOR,
                    profile: Profile::Inverse,
                    ..Cylinder::new(v(1.0, 0.3, -0.2))
                });
            },
            line(from, v(1.0, 0.3, -0.2), false, light / PI),
        ),
        case(
            "a half-line",
            |scene| {
                scene.beams.push(Beam {
                    tip: from,
                    coefficient: 3.0,
                    color: COLOR,
                    end: BeamEnd::Cap(Some(7.0)),
                    ..Beam::new(v(1.0, 0.3, -0.2))
                });
            },
            line(from, v(1.0, 0.3, -0.2), true, light / PI),
        ),
        case(
            "a segment",
            |scene| {
                scene.segments.push(Segment {
                    coefficient: 3.0,
                    color: COLOR,
                    ..Segment::new(from, to)
                });
            },
            straight(from, to, move |_| light / PI),
        ),
        case(
            "a segment of colours that tapers",
            |scene| {
                scene.segments.push(Segment {
                    coefficient: 3.0,
                    colors: Some(colors.to_vec()),
                    taper_lengths: [0.5 * from.distance(to), 0.0],
                    ..Segment::new(from, to)
                });
            },
            straight(from, to, move |s| {
                // Series meet at their knots, and are linear between.
                STRONG / PI * lerp(&[DVec3::ZERO, colors[1], colors[2]], s)
            }),
        ),
        case(
            "a ring",
            |scene| {
                scene.tori.push(Torus {
                    axis: v(0.2, -0.3, 1.0),
                    coefficient: 3.0,
                    color: COLOR,
                    ..Torus::new(0.9)
                });
            },
            circle(v(0.2, -0.3, 1.0), v(1.0, 0.0, 0.0), [0.0, TAU], move |_| {
                light / PI
            }),
        ),
        case(
            "a part of a ring with colours",
            |scene| {
                scene.tori.push(Torus {
                    axis: v(0.2, -0.3, 1.0),
                    coefficient: 3.0,
                    start: Some(v(0.0, 1.0, 0.0)),
                    sweep: Some([30.0, 250.0]),
                    colors: Some(colors.to_vec()),
                    ..Torus::new(0.9)
                });
            },
            circle(
                v(0.2, -0.3, 1.0),
                v(0.0, 1.0, 0.0),
                [30.0, 250.0].map(f64::to_radians),
                move |s| STRONG / PI * lerp(&colors, s),
            ),
        ),
    ];
    cases.extend(curved_cases());
    cases
}

fn circle(
    axis: DVec3,
    start: DVec3,
    angles: [f64; 2],
    light: impl Fn(f64) -> DVec3 + 'static,
) -> Place {
    let axis = axis.normalize();
    let x = (start - start.dot(axis) * axis).normalize();
    let y = axis.cross(x);
    Box::new(move |s, _| {
        let angle = angles[0] + s * (angles[1] - angles[0]);
        let place = 0.9 * (angle.cos() * x + angle.sin() * y);
        (place, 0.9 * (angles[1] - angles[0]) * light(s))
    })
}

fn curved_cases() -> Vec<Case> {
    let points = [v(-1.1, 0.3, 0.2), v(0.3, 1.2, -0.9), v(0.8, -0.6, 0.5)];
    let series = vec![1.0, 0.2, 2.0, 0.5];
    let bent = move |weight: fn(f64) -> f64| -> Place {
        Box::new(move |t, _| {
            let [a, b, c] = points;
            let place = a * (1.0 - t).powi(2) + 2.0 * t * (1.0 - t) * b + t * t * c;
            let velocity = 2.0 * (1.0 - t) * (b - a) + 2.0 * t * (c - b);
            (place, STRONG / PI * weight(t) * velocity.length() * COLOR)
        })
    };
    let corners = vec![v(-1.0, 0.2, 0.0), v(0.1, -0.7, 0.6), v(0.7, 0.4, -0.3)];
    let dashed = corners.clone();
    vec![
        case(
            "a curve",
            |scene| {
                scene.curves.push(Curve {
                    coefficient: 3.0,
                    color: COLOR,
                    ..Curve::new(points)
                });
            },
            bent(|_| 1.0),
        ),
        case(
            "a curve with a series",
            |scene| {
                scene.curves.push(Curve {
                    coefficient: 3.0,
                    color: COLOR,
                    intensity: Some(series.clone()),
                    ..Curve::new(points)
                });
            },
            bent(|t| energywave::internals::b_spline(&[1.0, 0.2, 2.0, 0.5], t)),
        ),
        case(
            "a chain with dashes",
            |scene| {
                scene.paths.push(LightPath {
                    coefficient: 3.0,
                    color: COLOR,
                    dashes: Some(Dashes::new(3)),
                    ..LightPath::new(corners.clone())
                });
            },
            Box::new(move |x, _| {
                let lengths = [0, 1].map(|k: usize| dashed[k].distance(dashed[k + 1]));
                let whole = lengths[0] + lengths[1];
                // Three dashes, each half of a third of the length.
                let share = (3.0 * x).floor() / 3.0 + 0.5 * (x - (3.0 * x).floor() / 3.0);
                let length = share * whole;
                let place = match length < lengths[0] {
                    true => dashed[0].lerp(dashed[1], length / lengths[0]),
                    false => dashed[1].lerp(dashed[2], (length - lengths[0]) / lengths[1]),
                };
                (place, 0.5 * whole * STRONG / PI * COLOR)
            }),
        ),
        case(
            "a smooth chain",
            |scene| {
                scene.paths.push(LightPath {
                    coefficient: 3.0,
                    color: COLOR,
                    shape: PathShape::Cubic,
                    ..LightPath::new(vec![points[0], points[1], v(-0.9, -0.8, 0.4), points[2]])
                });
            },
            Box::new(move |t, _| {
                let [a, b, c, d] = [points[0], points[1], v(-0.9, -0.8, 0.4), points[2]];
                let u = 1.0 - t;
                let place =
                    u * u * u * a + 3.0 * t * u * u * b + 3.0 * t * t * u * c + t * t * t * d;
                let velocity =
                    3.0 * u * u * (b - a) + 6.0 * t * u * (c - b) + 3.0 * t * t * (d - c);
                (place, STRONG / PI * velocity.length() * COLOR)
            }),
        ),
    ]
}

fn direction(random: &mut fastrand::Rng) -> DVec3 {
    loop {
        let it = DVec3::from([0; 3].map(|_| 2.0 * random.f64() - 1.0));
        if it.length() < 1.0 && it.length() > 0.1 {
            return it.normalize();
        }
    }
}

/// Points around a core, each with a normal: anywhere, next to the core, in line with its ends, and such that the
/// horizon cuts it.
fn places(case: &Case) -> (Vec<DVec3>, Vec<DVec3>) {
    let mut random = fastrand::Rng::with_seed(0x5eed);
    let mut points = Vec::new();
    let mut normals = Vec::new();
    for k in 0..POINTS {
        // Not where lines go to infinity.
        let place = |x: f64| (case.place)(0.05 + 0.9 * x, DVec3::ZERO).0;
        let (on_core, other) = (place(random.f64()), place(random.f64()));
        let way = direction(&mut random);
        let point = match k % 4 {
            0 => 2.0 * random.f64() * way,
            1 => on_core + 1e-3 * (0.5 + 2.0 * random.f64()) * way,
            2 => {
                // Beyond an end, in line with it.
                let (end, _) = (case.place)(case.end, DVec3::ZERO);
                let (inside, _) = (case.place)(case.end + 1e-4, DVec3::ZERO);
                end + (end - inside).normalize_or(way) * (0.02 + random.f64()) + 1e-4 * way
            }
            _ => on_core + 0.5 * random.f64() * way,
        };
        let normal = match k % 8 {
            0..4 => direction(&mut random),
            // The horizon goes through a place of the core.
            _ => (direction(&mut random))
                .cross(other - point)
                .normalize_or(way),
        };
        points.push(point);
        normals.push(normal);
    }
    (points, normals)
}

/// Returns the sum over random places of a core, one in each of many equal parts, and its standard error; and what
/// falls on a surface that faces each place.
fn random_sum(case: &Case, point: DVec3, normal: DVec3) -> (DVec3, DVec3, f64) {
    const SUMS: usize = 12;
    let mut random = fastrand::Rng::with_seed(7);
    let mut strata = 1000;
    loop {
        let (mut sums, mut facing) = (Vec::new(), 0.0);
        for _ in 0..SUMS {
            let mut sum = DVec3::ZERO;
            for k in 0..strata {
                let x = (f64::from(k) + random.f64()) / f64::from(strata);
                let (place, light) = (case.place)(x, point);
                let y = place - point;
                let distance2 = y.length_squared() + RADIUS * RADIUS;
                sum += light * y.dot(normal).max(0.0) / distance2.powf(1.5);
                facing += light.max_element() / distance2 / f64::from(strata);
            }
            sums.push(sum / f64::from(strata));
        }
        let count = SUMS as f64;
        let mean = sums.iter().copied().sum::<DVec3>() / count;
        let squares = sums
            .iter()
            .map(|sum| (*sum - mean).powf(2.0))
            .sum::<DVec3>();
        let error = (squares / (count * (count - 1.0))).powf(0.5);
        let most = (STANDARD_ERROR * mean).max(DVec3::splat(0.1 * DARK * facing / count));
        if error.cmple(most).all() {
            return (mean, error, facing / count);
        }
        strata *= 4;
        assert!(strata < 1 << 24, "{}: {error} of {mean}", case.name);
    }
}

/// Returns the errors of found light, relative to what is expected, dark places aside.
fn errors(found: &[[f32; 3]], expected: &[DVec3], facing: &[f64], dark: f64) -> Vec<f64> {
    let error = |((found, expected), facing): ((&[f32; 3], &DVec3), &f64)| {
        let found = DVec3::from(found.map(f64::from));
        let off = (found - *expected).abs() - DVec3::splat(dark * facing);
        (off / expected.max(DVec3::splat(1e-30)))
            .max_element()
            .max(0.0)
    };
    found.iter().zip(expected).zip(facing).map(error).collect()
}

fn worst(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |most, error| match *error <= most {
        true => most,
        false => *error, // or it is no number
    })
}

#[test]
fn every_core_casts_the_light_of_its_places() {
    let mut on_device = Renderer::new(&device()).unwrap();
    let mut spoiled =
        ["-DFACING(n,y)=length(y)", "-DWITHOUT_HORIZON"].map(|spoil| (spoil, renderer(1, spoil)));
    for case in cases() {
        let (points, normals) = places(&case);
        let sums = points
            .iter()
            .zip(&normals)
            .map(|(point, normal)| random_sum(&case, *point, *normal));
        let (expected, facing): (Vec<DVec3>, Vec<f64>) =
            sums.map(|(mean, _, facing)| (mean, facing)).unzip();
        let found = on_device
            .irradiance(&case.scene, &points, &normals)
            .unwrap();
        let of_sums = errors(&found, &expected, &facing, DARK);
        let truth = reference::irradiance(&case.scene, &points, &normals).unwrap();
        let truth: Vec<DVec3> = truth.into_iter().map(DVec3::from).collect();
        let of_truth = errors(&found, &truth, &facing, DARK);
        let mut fine = errors(&found, &truth, &facing, 0.01 * DARK);
        fine.sort_by(f64::total_cmp);
        let mut sorted = of_truth.clone();
        sorted.sort_by(f64::total_cmp);
        let single: Vec<[f32; 3]> = truth.iter().map(|it| it.as_vec3().to_array()).collect();
        let reference_off = worst(&errors(&single, &expected, &facing, DARK));
        println!(
            "{}: off random sums by {:.1e}, the reference by {reference_off:.1e}; off the reference by {:.1e} in the \
             middle, {:.1e} of 95 in 100, and by {:.1e} of 99, {:.1e} at most, but for what is dark",
            case.name,
            worst(&of_sums),
            fine[POINTS / 2],
            fine[POINTS * 95 / 100 - 1],
            sorted[POINTS * 99 / 100 - 1],
            worst(&of_truth)
        );
        assert!(reference_off < MOST, "{}", case.name);
        assert!(worst(&of_sums) < MOST, "{}", case.name);
        assert!(
            worst(&of_truth) < MOST && sorted[POINTS * 99 / 100 - 1] < USUAL,
            "{}",
            case.name
        );
        for (spoil, spoiled) in &mut spoiled {
            let found = spoiled.irradiance(&case.scene, &points, &normals).unwrap();
            let off = worst(&errors(&found, &expected, &facing, DARK));
            assert!(
                off >= MOST || off.is_nan(),
                "{}, {spoil}: {off:.1e}",
                case.name
            );
        }
    }
}
