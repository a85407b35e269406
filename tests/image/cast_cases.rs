//! Sources that cast light, each with the places of its core by definition.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use energywave::Scene;
use energywave::scene::{
    Beam, BeamEnd, Camera, Curve, Cylinder, Dashes, LightPath, Lighting, PathShape, Profile,
    Segment, Sphere, Torus,
};
use glam::DVec3;

/// Within which light grows no more.
pub const RADIUS: f64 = 1e-3;

/// A place of a core, from a number between 0 and 1 and the point that is lit, and its light times what it stands for.
pub type Place = Box<dyn Fn(f64, DVec3) -> (DVec3, DVec3)>;

pub struct Case {
    pub name: &'static str,
    pub scene: Scene,
    pub place: Place,
    /// Where an end is.
    pub end: f64,
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

pub fn cases() -> Vec<Case> {
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
