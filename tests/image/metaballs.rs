//! Surfaces of metaballs against float64 by another method: whole pictures, and what must be drawn, too.

use energywave::image::ClipRange;
use energywave::internals::see_surfaces;
use energywave::scene::{
    Camera, Lattice, MetaballKernel, MetaballMethod, MetaballSampling, Metaballs, PointList,
    PointSize,
};
use energywave::{Renderer, Scene};
use glam::{DMat4, DVec3};

use crate::common::metaballs::{H, block, blocks, errors, expect_true, scene_of, truth};
use crate::common::{self, options, outer_lane_widths};

fn renderer(extra: &str) -> Renderer {
    common::renderer(common::device().lanes, extra)
}

#[test]
fn surfaces_of_every_spacing_are_those_of_float64() {
    let mut renderer = renderer("");
    for (name, scene) in blocks() {
        let found = expect_true(name, &mut renderer, &scene);
        assert!(found.hits > 128 * 128 / 10, "{name}: {found:?}");
    }
}

#[test]
fn surfaces_are_the_same_on_one_lane_and_many() {
    let scene = block(0.45, 0.25);
    let truth = truth(&scene);
    for lanes in outer_lane_widths() {
        let mut renderer = Renderer::with_options(&common::device(), &options(lanes, "")).unwrap();
        let found = errors(&mut renderer, &scene, &truth);
        assert!(found.are_small(), "{lanes} lanes: {found:?}");
    }
}

/// What each spoiled build does, and a scene where that shows. Hits alone are blind to steps that are too long: lengths
/// show them, of the jittered block and of single balls.
#[test]
fn spoiled_builds_are_not() {
    let (jittered, balls) = (block(0.45, 0.25), block(0.61, 0.0));
    let far = {
        let mut scene = block(0.45, 0.25);
        scene.camera.eye *= 12.0;
        scene.camera.fov_y = 4.0;
        scene
    };
    for (spoil, scene) in [
        ("-DHALF_GROWTH", &jittered),
        ("-DHALF_GROWTH", &balls),
        ("-DSTEP_BEYOND", &balls),
        ("-DSTEP_BEYOND", &jittered),
        ("-DNARROW_CELLS", &jittered),
        ("-DSQUARED_DISTANCE", &far),
    ] {
        let found = errors(&mut renderer(spoil), scene, &truth(scene));
        assert!(!found.are_small(), "{spoil}: {found:?}");
    }
    expect_true("far", &mut renderer(""), &far);
}

#[test]
fn two_frames_are_equal_to_the_bit() {
    let (scene, other) = (block(0.45, 0.25), block(0.3, 0.1));
    let mut first = renderer("");
    let before = see_surfaces(&mut first, &scene).unwrap();
    see_surfaces(&mut first, &other).unwrap();
    for mut renderer in [first, renderer("")] {
        assert!(see_surfaces(&mut renderer, &scene).unwrap() == before);
    }
}

fn camera(eye: [f64; 3], target: [f64; 3]) -> Camera {
    Camera::new(eye.into(), target.into())
}

fn of_points(points: Vec<DVec3>, radius: f64) -> Metaballs {
    Metaballs::new(PointList::new(points).unwrap(), radius)
}

/// Points in a ball about the origin, which are no lattice.
fn cloud(count: u32, radius: f64) -> Vec<DVec3> {
    let mut random = fastrand::Rng::with_seed(7);
    let mut axis = || radius * (2.0 * random.f64() - 1.0);
    let points = std::iter::repeat_with(|| DVec3::new(axis(), axis(), axis()));
    points
        .filter(|point| point.length() < radius)
        .take(count as usize)
        .collect()
}

#[test]
fn what_is_out_of_the_ordinary_is_drawn_right() {
    let front = camera([0.0, -4.0, 0.5], [0.0, 0.0, 0.0]);
    let far_apart = |apart: f64| {
        let mut points = cloud(60, 1.0);
        points.extend(cloud(60, 1.0).iter().map(|point| point + apart * DVec3::Y));
        points
    };
    let around: Vec<DVec3> = cloud(900, 3.0);
    let mut sized = cloud(300, 1.2);
    sized.truncate(200);
    let sizes = (0..200).map(|k| PointSize {
        radius: 0.15 + 0.002 * f64::from(k),
        weight: 2.0 - 0.008 * f64::from(k),
    });
    let sizes = PointList::with_sizes(sized, sizes.collect()).unwrap();
    let mut smooth = of_points(cloud(300, 1.2), 0.5);
    smooth.kernel = MetaballKernel::Smooth;
    let mut moved = of_points(cloud(300, 1.2), 0.5);
    moved.translate = DVec3::new(0.5, 1e3, -0.25);
    let beside = camera([0.5, 1e3 - 4.0, 0.0], [0.5, 1e3, 0.0]);
    let mut low = of_points(cloud(300, 1.2), 0.5);
    low.threshold = 0.02;
    let mut wide = camera([0.0; 3], [0.0, 4.0, 0.0]);
    wide.fov_y = 130.0;
    let mut beside_eye = of_points(vec![DVec3::new(0.0, -0.2, 1.0)], 2.0);
    beside_eye.threshold = 0.3;
    let cases: Vec<(&str, Camera, Metaballs, bool)> = vec![
        (
            "one particle",
            front.clone(),
            of_points(vec![DVec3::ZERO], 2.0),
            true,
        ),
        (
            "coincident particles",
            front.clone(),
            of_points(vec![DVec3::new(0.1, 0.0, 0.2); 1000], 1.0),
            true,
        ),
        (
            "all in one cell",
            front.clone(),
            of_points(cloud(700, 0.02), 0.02),
            true,
        ),
        (
            "a radius larger than the scene",
            front.clone(),
            of_points(cloud(40, 0.5), 3.0),
            true,
        ),
        (
            "a radius below a pixel",
            front.clone(),
            of_points(cloud(2000, 1.0), 0.012),
            true,
        ),
        (
            "a threshold above any sum",
            front.clone(),
            Metaballs {
                threshold: 1e4,
                ..of_points(cloud(300, 1.0), 0.5)
            },
            false,
        ),
        ("a low threshold", front.clone(), low, true),
        (
            "particles around the eye",
            camera([0.02, 0.0, 0.0], [1.2, 4.0, 0.4]),
            of_points(around.clone(), 0.45),
            true,
        ),
        (
            "particles behind the eye",
            camera([0.0, -4.0, 0.0], [0.0, -8.0, 0.0]),
            of_points(cloud(300, 1.0), 0.5),
            false,
        ),
        ("a particle beside the eye", wide, beside_eye, true),
        (
            "clouds 100 radii apart",
            front.clone(),
            of_points(far_apart(60.0), H),
            true,
        ),
        (
            "clouds far apart",
            front.clone(),
            of_points(far_apart(1e6), H),
            true,
        ),
        ("the smooth kernel", front.clone(), smooth, true),
        (
            "radii and weights of their own",
            front.clone(),
            Metaballs::new(sizes, 9.0),
            true,
        ),
        ("particles that are moved", beside, moved, true),
    ];
    let mut renderer = renderer("-DCONES -DSMOOTH");
    for (name, camera, surface, is_seen) in cases {
        let scene = scene_of(camera, [surface]);
        let found = expect_true(name, &mut renderer, &scene);
        assert_eq!(found.hits > 0, is_seen, "{name}: {found:?}");
    }
}

#[test]
fn no_particle_is_no_surface_and_an_eye_within_one_sees_it_at_once() {
    let mut renderer = renderer("");
    let nothing = scene_of(
        camera([0.0, -4.0, 0.0], [0.0; 3]),
        [Metaballs::new(PointList::default(), H)],
    );
    let (lengths, light) = see_surfaces(&mut renderer, &nothing).unwrap();
    assert!(lengths.iter().all(|length| *length == f32::INFINITY));
    assert!(light.chunks(4).all(|pixel| pixel == [0.0, 0.0, 0.0, 1.0]));
    let within = scene_of(
        camera([0.0; 3], [0.0, 4.0, 0.0]),
        [of_points(cloud(200, 0.5), 1.0)],
    );
    let (lengths, _) = see_surfaces(&mut renderer, &within).unwrap();
    assert!(lengths.iter().all(|length| *length == 0.0));
}

#[test]
fn every_camera_sees_the_surfaces() {
    let mut renderer = renderer("");
    let eye = DVec3::new(2.0, -5.0, 3.0);
    let back = eye.normalize();
    let right = DVec3::Z.cross(back).normalize();
    let up = back.cross(right);
    let row = |axis: DVec3| axis.extend(-axis.dot(eye)).to_array();
    let view = DMat4::from_cols_array_2d(&[row(right), row(up), row(back), [0.0, 0.0, 0.0, 1.0]])
        .transpose();
    // By rows, depths from 0 to 1.
    let parallel = [
        [0.36, 0.0, 0.0, 0.1],
        [0.0, 0.48, 0.0, -0.05],
        [0.0, 0.0, -0.05, -0.02],
        [0.0, 0.0, 0.0, 1.0],
    ];
    let off_axis = [
        [1.8, 0.0, 0.3, 0.0],
        [0.0, 2.4, -0.4, 0.0],
        [0.0, 0.0, -1.03, -0.8],
        [0.0, 0.0, -1.0, 0.0],
    ];
    let surface = block(0.45, 0.25).metaballs[0].clone();
    for (name, projection) in [
        ("parallel rays", parallel),
        ("a projection off the axis", off_axis),
    ] {
        let projection = DMat4::from_cols_array_2d(&projection).transpose();
        let camera = Camera::from_clip(view, projection, ClipRange::ZeroToOne);
        expect_true(name, &mut renderer, &scene_of(camera, [surface.clone()]));
    }
    let mut wide = scene_of(camera([1.0, -3.2, 1.5], [0.0; 3]), [surface]);
    wide.camera.fov_y = 120.0;
    wide.image.height = 77;
    wide.camera.jitter = glam::DVec2::new(0.3, -0.4);
    expect_true("a wide view", &mut renderer, &wide);
}

/// Returns the share of rays that meet the surface and find nothing.
fn holes(renderer: &mut Renderer, scene: &Scene, samples: u32) -> f64 {
    let mut sampled = scene.clone();
    sampled.metaballs[0].method = MetaballMethod::Sampling(MetaballSampling {
        samples,
        ..MetaballSampling::default()
    });
    let (exact, _) = see_surfaces(renderer, scene).unwrap();
    let (found, _) = see_surfaces(renderer, &sampled).unwrap();
    let hits = exact.iter().filter(|length| length.is_finite()).count();
    let pairs = || exact.iter().zip(&found);
    let missed = pairs().filter(|(exact, found)| exact.is_finite() && found.is_infinite());
    assert!(pairs().all(|(exact, found)| exact.is_finite() || found.is_infinite()));
    missed.count() as f64 / hits as f64
}

#[test]
fn the_samples_of_2008_leave_holes_that_more_of_them_fill() {
    let mut renderer = renderer("");
    let scene = block(0.45, 0.25);
    let found = [8, 16, 32, 64].map(|samples| holes(&mut renderer, &scene, samples));
    println!("holes: {found:?}");
    assert!(found.is_sorted_by(|more, fewer| more >= fewer), "{found:?}");
    assert!(found[0] > 0.2 && found[3] < 0.01, "{found:?}");
    // Interpolation brings a sample onto the surface.
    let lengths = |refinements| {
        let mut scene = scene.clone();
        scene.metaballs[0].method = MetaballMethod::Sampling(MetaballSampling {
            samples: 64,
            refinements,
            ..MetaballSampling::default()
        });
        scene
    };
    let truth = truth(&scene);
    let off = [0, 1].map(|refinements| {
        errors(&mut renderer, &lengths(refinements), &truth)
            .lengths
            .0
    });
    assert!(off[0] > 0.05 && off[1] < 0.5 * off[0], "{off:?}");
}

#[test]
fn a_lattice_may_have_a_layer_that_is_begun() {
    let lattice = Lattice {
        columns: [3, 3],
        ..Lattice::new(13, 0.4)
    };
    let points = PointList::lattice(&lattice).unwrap();
    let scene: Scene = scene_of(
        camera([2.0, -3.0, 2.0], [0.0; 3]),
        [Metaballs::new(points, H)],
    );
    expect_true("a begun layer", &mut renderer(""), &scene);
}
