//! Sources whose light changes along the core, each with what the definition needs to know of it.

use energywave::Scene;
use energywave::scene::{
    Beam, Camera, Dashes, LightPath, Measure, Method, PathShape, Profile, Segment, Torus,
};
use glam::DVec3;

use crate::common;
use crate::path_core::{at, piece_count};

/// A scene of one source, and what the definition needs to know of that.
pub struct Case {
    pub name: &'static str,
    pub scene: Scene,
    /// From where to where the core is there, in shares of its length.
    pub runs: Vec<[f64; 2]>,
    /// A point of the core at a share of its length.
    pub at: Box<dyn Fn(f64) -> DVec3>,
    /// The emission's green and the radius at a share.
    pub lit: Box<dyn Fn(f64) -> (f64, f64)>,
    pub profile: Profile,
    pub reach: f64,
}

pub fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

pub fn scene() -> Scene {
    let mut scene = common::empty_scene(64, 48);
    scene.camera = Camera::new(v(0.2, -4.0, 0.8), DVec3::ZERO);
    scene.decay = None;
    scene.integration.measure = Measure::Length;
    scene.integration.method = Method::exact(1e-3);
    scene
}

/// Values at equal steps, linear between.
fn series(values: &'static [f64]) -> impl Fn(f64) -> f64 {
    move |share| {
        let x = share * (values.len() - 1) as f64;
        let k = (x as usize).min(values.len() - 2);
        values[k] + (values[k + 1] - values[k]) * (x - k as f64)
    }
}

pub fn cases() -> Vec<Case> {
    let (from, to) = (v(-1.3, 0.2, -0.3), v(1.1, -0.3, 0.5));
    let length = from.distance(to);
    let mut cone = scene();
    cone.segments.push(Segment {
        radii: Some(vec![0.02, 0.3]),
        taper_lengths: [0.5, 0.0],
        ..Segment::new(from, to)
    });
    let mut dashed = scene();
    dashed.segments.push(Segment {
        dashes: Some(Dashes {
            fill: 0.4,
            offset: 0.7,
            ..Dashes::new(3)
        }),
        colors: Some(vec![DVec3::ONE, v(0.5, 0.2, 1.0), v(0.1, 1.5, 0.4)]),
        radius: 0.05,
        reach: Some(0.6),
        peak: Some(1.0),
        ..Segment::new(from, to)
    });
    let peak_of_dashes = dashed.segments[0].radius;
    let (axis, start) = (v(0.2, -1.0, 0.4), v(1.0, 0.3, 1.0));
    let x = start - axis * (start.dot(axis) / axis.length_squared());
    let x = 0.9 * x.normalize();
    let y = axis.normalize().cross(x);
    let ring = move |degrees: f64| {
        let angle = degrees.to_radians();
        x * angle.cos() + y * angle.sin()
    };
    let mut part = scene();
    part.tori.push(Torus {
        axis,
        start: Some(start),
        sweep: Some([-40.0, 200.0]),
        intensity: Some(vec![0.2, 1.0, 0.5]),
        profile: Profile::Inverse,
        radius: 0.03,
        ..Torus::new(0.9)
    });
    let mut marks = scene();
    marks.tori.push(Torus {
        axis,
        start: Some(start),
        dashes: Some(Dashes::new(5)),
        radii: Some(vec![0.02, 0.2, 0.02]),
        reach: Some(0.5),
        ..Torus::new(0.9)
    });
    let spline = LightPath {
        shape: PathShape::Spline,
        radii: Some(vec![0.1, 0.02, 0.06]),
        profile: Profile::InverseCube,
        reach: Some(0.7),
        peak: Some(0.8),
        flatness: Some(1e-7),
        ..LightPath::new(vec![from, v(-0.4, 0.1, 0.5), v(0.3, -0.2, -0.4), to])
    };
    let mut thick = scene();
    thick.paths.push(spline.clone());
    let lengths = lengths_of(&spline);
    // A peak is met where the radii are named, and its coefficient is linear between.
    let coefficients =
        [0.1, 0.02, 0.06].map(|radius| 0.8 / across(Profile::InverseCube, radius, 0.7));
    let (tip, direction) = (v(-0.8, 0.3, -0.2), v(1.0, -0.2, 0.35));
    let along_beam = direction.normalize();
    let mut beam = scene();
    beam.beams.push(Beam {
        tip,
        series_length: Some(1.6),
        intensity: Some(vec![1.0, 0.3]),
        radii: Some(vec![0.01, 0.1, 0.03]),
        ..Beam::new(direction)
    });
    vec![
        Case {
            name: "a beam",
            scene: beam,
            runs: vec![[0.0, 1.0], [1.0, 50.0]],
            at: Box::new(move |share| tip + 1.6 * share * along_beam),
            lit: Box::new(|share| {
                let share = share.min(1.0);
                (
                    series(&[1.0, 0.3])(share),
                    series(&[0.01, 0.1, 0.03])(share),
                )
            }),
            profile: Profile::InverseSquare,
            reach: f64::INFINITY,
        },
        Case {
            name: "a cone with a taper",
            scene: cone,
            runs: vec![[0.0, 1.0]],
            at: Box::new(move |share| from.lerp(to, share)),
            lit: Box::new(move |share| ((share * length / 0.5).min(1.0), 0.02 + 0.28 * share)),
            profile: Profile::InverseSquare,
            reach: f64::INFINITY,
        },
        Case {
            name: "dashes of many colours",
            scene: dashed,
            runs: vec![
                [0.7 / 3.0, 1.1 / 3.0],
                [1.7 / 3.0, 2.1 / 3.0],
                [2.7 / 3.0, 1.0],
                [0.0, 0.1 / 3.0],
            ],
            at: Box::new(move |share| from.lerp(to, share)),
            lit: Box::new(move |share| {
                let coefficient = 1.0 / across(Profile::InverseSquare, peak_of_dashes, 0.6);
                (coefficient * series(&[1.0, 0.2, 1.5])(share), 0.05)
            }),
            profile: Profile::InverseSquare,
            reach: 0.6,
        },
        Case {
            name: "part of a ring",
            scene: part,
            runs: vec![[0.0, 1.0]],
            at: Box::new(move |share| ring(-40.0 + 240.0 * share)),
            lit: Box::new(|share| (series(&[0.2, 1.0, 0.5])(share), 0.03)),
            profile: Profile::Inverse,
            reach: f64::INFINITY,
        },
        Case {
            name: "a ring of dashes",
            scene: marks,
            runs: (0..5)
                .map(|k| [0.2 * f64::from(k), 0.2 * f64::from(k) + 0.1])
                .collect(),
            at: Box::new(move |share| ring(360.0 * share)),
            lit: Box::new(|share| (1.0, series(&[0.02, 0.2, 0.02])(share))),
            profile: Profile::InverseSquare,
            reach: 0.5,
        },
        Case {
            name: "a spline of changing thickness",
            scene: thick,
            runs: vec![[0.0, 1.0]],
            at: Box::new(move |share| {
                let place = lengths.partition_point(|length| *length <= share).max(1);
                let (before, after) = (lengths[place - 1], lengths[place.min(lengths.len() - 1)]);
                let between = if after > before {
                    (share - before) / (after - before)
                } else {
                    0.0
                };
                at(
                    &spline,
                    (place as f64 - 1.0 + between) * 3.0 / (lengths.len() - 1) as f64,
                )
            }),
            lit: Box::new(move |share| {
                let x = 2.0 * share;
                let k = (x as usize).min(1);
                let coefficient =
                    coefficients[k] + (coefficients[k + 1] - coefficients[k]) * (x - k as f64);
                (coefficient, series(&[0.1, 0.02, 0.06])(share))
            }),
            profile: Profile::InverseCube,
            reach: 0.7,
        },
    ]
}

/// The light across a core with a reach, by many midpoints.
fn across(profile: Profile, radius: f64, reach: f64) -> f64 {
    let count = 400_000;
    let step = reach / f64::from(count);
    let light = |k: u32| {
        let distance = (f64::from(k) + 0.5) * step;
        field(profile, reach, distance * distance, radius) * step
    };
    2.0 * (0..count).map(light).sum::<f64>()
}

/// Where many steps of equal parameter lie, in shares of a path's length.
fn lengths_of(path: &LightPath) -> Vec<f64> {
    let count = 20_000;
    let place = |k: usize| at(path, (piece_count(path) * k) as f64 / f64::from(count));
    let mut lengths = vec![0.0];
    for k in 1..=count as usize {
        lengths.push(lengths[k - 1] + place(k).distance(place(k - 1)));
    }
    let whole = lengths[count as usize];
    lengths.iter().map(|length| length / whole).collect()
}

pub fn field(profile: Profile, reach: f64, distance2: f64, radius: f64) -> f64 {
    let q2 = distance2 + radius * radius;
    let power = match profile {
        Profile::Inverse => -0.5,
        Profile::InverseSquare => -1.0,
        _ => -1.5,
    };
    q2.powf(power) * (1.0 - distance2 / (reach * reach)).max(0.0).powi(2)
}
