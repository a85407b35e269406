//! Electric arcs: drawn as the reference draws them, like the core that they displace where they displace nothing.

use energywave::image::ImageSize;
use energywave::scene::{
    Camera, ElectricArc, Group, LightPath, Measure, Method, PathShape, Sampling, Segment,
};
use energywave::{Renderer, Scene, reference};
use glam::DVec3;

use crate::common::{self, difference, meets, renderer, sampled};

const TOLERANCE: f64 = 1e-3;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn scene() -> Scene {
    let mut scene = common::empty_scene(48, 36);
    scene.camera = Camera::new(v(0.2, -4.0, 0.8), DVec3::ZERO);
    scene.decay = None;
    scene.integration.measure = Measure::Length;
    scene.integration.method = Method::exact(TOLERANCE);
    scene
}

fn bolt(branches: u32) -> Segment {
    Segment {
        radius: 0.05,
        arc: Some(ElectricArc {
            seed: 3,
            branches,
            ..ElectricArc::new(0.25, 0.8)
        }),
        ..Segment::new(v(-1.2, 0.2, -0.6), v(1.1, -0.3, 0.7))
    }
}

fn of_bolt(bolt: Segment) -> Scene {
    let mut scene = scene();
    scene.segments.push(bolt);
    scene
}

fn of_loop() -> Scene {
    let mut scene = scene();
    scene.image = ImageSize {
        width: 24,
        height: 18,
    };
    let points = [
        v(-0.9, 0.1, -0.5),
        v(0.8, 0.3, -0.6),
        v(1.0, -0.3, 0.7),
        v(-0.8, 0.0, 0.6),
    ];
    scene.paths.push(LightPath {
        shape: PathShape::Spline,
        closed: true,
        // Of so few pixels a hundredth is much of a thin core.
        flatness: Some(2e-5),
        radius: 0.05,
        arc: Some(ElectricArc::new(0.15, 1.2)),
        ..LightPath::new(points.to_vec())
    });
    scene
}

fn draws(renderer: &mut Renderer, scene: &Scene) {
    let truth = reference::render(scene).unwrap();
    for sampling in [Sampling::Pixels, Sampling::Tiles] {
        let image = renderer.render(&sampled(scene, sampling)).unwrap();
        let found = difference(&image, &truth);
        println!("{sampling:?}: {found:?}");
        assert!(meets(&found, TOLERANCE), "by {sampling:?}: {found:?}");
    }
    let mut other = scene.clone();
    let arcs = other.segments.iter_mut().flat_map(|it| it.arc.iter_mut());
    let arcs = arcs.chain(other.paths.iter_mut().flat_map(|it| it.arc.iter_mut()));
    arcs.for_each(|arc| arc.seed += 1);
    let off = difference(&renderer.render(&other).unwrap(), &truth);
    assert!(off.max > 100.0 * TOLERANCE, "another seed passed: {off:?}");
}

#[test]
fn arcs_are_drawn_as_the_reference_draws_them_and_other_seeds_are_noticed() {
    let mut renderer = renderer(common::device().lanes, "");
    for scene in [of_bolt(bolt(3)), of_loop()] {
        draws(&mut renderer, &scene);
    }
}

#[test]
fn a_core_that_is_not_displaced_is_drawn_as_it_is_without_an_arc() {
    let even = of_bolt(Segment {
        arc: None,
        ..bolt(0)
    });
    let mut still = bolt(0);
    still.arc.as_mut().unwrap().amplitude = 0.0;
    let truth = reference::render(&even).unwrap();
    let found = difference(&reference::render(&of_bolt(still)).unwrap(), &truth);
    assert!(found.max < 1e-6, "{found:?}");
    let moved = difference(&reference::render(&of_bolt(bolt(0))).unwrap(), &truth);
    assert!(moved.max > 0.1, "{moved:?}");
}

#[test]
fn a_group_scales_the_kinks_with_the_core() {
    let small = {
        let mut small = bolt(2);
        let arc = small.arc.as_mut().unwrap();
        (small.from, small.to, small.radius) = (0.5 * small.from, 0.5 * small.to, 0.025);
        (arc.amplitude, arc.scale) = (0.125, 0.4);
        small
    };
    let mut grouped = scene();
    grouped
        .add_group(&Group {
            segments: vec![small],
            scale: 2.0,
            ..Group::default()
        })
        .unwrap();
    assert_eq!(grouped.segments[0], bolt(2));
}
