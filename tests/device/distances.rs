//! The distance to the core of every kind of source against float64, on every lane width.

use crate::common;
use crate::common::lane_widths;
use crate::device_functions::{ANCHOR, Bench};
use energywave::internals::pack::Sources;
use energywave::internals::{self, KINDS};
use energywave::scene::{LightPath, Segment};
use energywave::{Ray, Scene};
use glam::DVec3;

/// World units, for coordinates up to 10: a dozen roundings of 6e-7 each.
const DISTANCE_ERROR: f64 = 4e-6;

/// Worst error of the distance to a scene's only source, over random points of random rays; world units.
fn distance_error(bench: &Bench, kernel: &str, scene: &Scene, seed: u64) -> f64 {
    const COUNT: usize = 320;
    let mut random = fastrand::Rng::with_seed(seed);
    let mut point = |reach: f64| DVec3::from([0; 3].map(|_| reach * (2.0 * random.f64() - 1.0)));
    let rays: Vec<Ray> = (0..COUNT)
        .map(|_| Ray::between(point(3.0), point(6.0)))
        .collect();
    let ss: Vec<f32> = (0..COUNT).map(|_| random.f32()).collect();
    let packed = Sources::new(scene, &ANCHOR);
    let source: &[f32] = match kernel {
        "sphere_distance" => bytemuck::cast_slice(&packed.spheres),
        "cylinder_distance" => bytemuck::cast_slice(&packed.cylinders),
        "beam_distance" => bytemuck::cast_slice(&packed.beams),
        "torus_distance" => bytemuck::cast_slice(&packed.tori),
        "segment_distance" => bytemuck::cast_slice(&packed.segments),
        "curve_distance" => bytemuck::cast_slice(&packed.curves),
        "path_distance" => bytemuck::cast_slice(&packed.paths),
        other => panic!("no sources for {other}"),
    };
    let column = |part: fn(&Ray) -> f64| rays.iter().map(|r| part(r) as f32).collect::<Vec<f32>>();
    let inputs = [
        column(|r| r.origin.x),
        column(|r| r.origin.y),
        column(|r| r.origin.z),
        column(|r| r.span.x),
        column(|r| r.span.y),
        column(|r| r.span.z),
        ss.clone(),
    ];
    let names = ["ox", "oy", "oz", "dx", "dy", "dz", "ss"];
    let mut rows = packed.rows.list.clone();
    rows.push([0.0; 4]);
    let mut lists = vec![("first", source), ("rows", bytemuck::cast_slice(&rows))];
    lists.extend(names.into_iter().zip(inputs.iter().map(Vec::as_slice)));
    let found = &bench.run(kernel, &lists, COUNT, &["result"])[0];
    // Of a beam's parts one is lit.
    let sources = internals::sources(scene);
    let distance = |point| {
        let samples = sources.iter().map(|source| source.field.sample(point));
        samples
            .filter(|sample| sample.intensity > 0.0)
            .map(|sample| sample.distance2.sqrt())
            .sum::<f64>()
    };
    let error = |i: usize| {
        let expected = distance(rays[i].at(f64::from(ss[i])));
        let error = (f64::from(found[i]) - expected).abs();
        if error.is_nan() { f64::INFINITY } else { error }
    };
    (0..COUNT).map(error).fold(0.0, f64::max)
}

/// A kernel of tests/cl/functions.cl and scenes of one source for it.
fn distance_cases() -> Vec<(&'static str, Scene)> {
    let empty = || common::empty_scene(1, 1);
    let mut cases = Vec::new();
    let mut scene = empty();
    scene.spheres.push(common::sphere([0.4, 0.3, 0.5], 1.0));
    cases.push(("sphere_distance", scene));
    for direction in [[1.0, 0.2, 0.1], [0.0, 0.0, -3.0]] {
        let mut scene = empty();
        scene
            .cylinders
            .push(common::cylinder([0.1, 0.6, 0.2], direction));
        cases.push(("cylinder_distance", scene));
    }
    // Far behind its tip a beam is a point, far ahead of it a line.
    for (tip, direction) in [
        ([6.0, 0.9, 0.8], [1.0, 0.1, 0.2]),
        ([-6.0, -0.9, -0.8], [1.0, 0.1, 0.2]),
    ] {
        let mut scene = empty();
        scene.beams.push(energywave::scene::Beam {
            tip: tip.into(),
            profile: energywave::scene::Profile::Inverse,
            coefficient: 1.0,
            ..energywave::scene::Beam::new(direction.into())
        });
        cases.push(("beam_distance", scene));
    }
    for (axis, radius) in [
        ([0.0, 0.0, 1.0], 0.9),
        ([1.0, -2.0, 0.3], 3.0),
        ([0.3, 0.2, 0.1], 0.01),
    ] {
        let mut scene = empty();
        scene
            .tori
            .push(common::torus([0.2, -0.3, 0.1], axis, radius));
        cases.push(("torus_distance", scene));
    }
    for shape in common::CURVE_SHAPES {
        let mut scene = empty();
        scene.curves.push(common::curve(shape, None));
        cases.push(("curve_distance", scene));
    }
    // Nearest to an end, or in between; and a point.
    for (from, to) in [
        ([6.0, 0.9, 0.8], [7.0, 1.0, 1.0]),
        ([-9.0, -1.2, -1.4], [9.0, 0.6, 2.2]),
        ([0.3, 0.2, 0.1], [0.3, 0.2, 0.1]),
    ] {
        let mut scene = empty();
        scene.segments.push(Segment {
            profile: energywave::scene::Profile::Inverse,
            coefficient: 1.0,
            ..Segment::new(from.into(), to.into())
        });
        cases.push(("segment_distance", scene));
    }
    let points = [
        [-1.2, 0.3, 0.8],
        [0.4, -0.5, 0.1],
        [1.0, 0.7, -0.4],
        [2.5, 0.1, 0.3],
    ];
    let mut scene = empty();
    scene.paths.push(LightPath {
        profile: energywave::scene::Profile::Inverse,
        coefficient: 1.0,
        ..LightPath::new(points.map(DVec3::from).to_vec())
    });
    cases.push(("path_distance", scene));
    for kind in KINDS {
        let kernel = format!("{kind}_distance");
        assert!(
            cases.iter().any(|(name, _)| *name == kernel),
            "no case of {kind}"
        );
    }
    cases
}

#[test]
fn the_distance_to_every_core_matches_float64() {
    for lanes in lane_widths() {
        let bench = Bench::new(lanes, "");
        for (seed, (kernel, scene)) in distance_cases().iter().enumerate() {
            let error = distance_error(&bench, kernel, scene, seed as u64);
            assert!(
                error < DISTANCE_ERROR,
                "{lanes} lanes, {kernel}, seed {seed}: {error:e}"
            );
        }
    }
}

#[test]
fn a_spoiled_field_is_noticed_by_every_distance() {
    let bench = Bench::new(8, common::BROKEN_FIELDS);
    for (seed, (kernel, scene)) in distance_cases().iter().enumerate() {
        let error = distance_error(&bench, kernel, scene, seed as u64);
        assert!(
            error > DISTANCE_ERROR,
            "{kernel}, seed {seed}: the spoiled build passed: {error:e}"
        );
    }
}
