//! Cameras of engines' matrices: points of cores show where glam projects them, by every sort of projection; whole
//! pictures are those of the reference, and a camera that looks at a point draws the same as its matrices.

use crate::common::engines::{SIZE, engine};
use crate::common::{self, difference, meets, renderer};
use energywave::image::{ClipRange, DepthAlong, ImageSize};
use energywave::scene::{Antialias, Camera, Method, Profile, Sampling, Segment, Sphere, Torus};
use energywave::{Scene, reference};
use fastrand::Rng;
use glam::dcamera as camera;
use glam::{DMat4, DVec2, DVec3};

/// How far a ray may pass a point that its place in the picture shows, pixels.
const BESIDE: f64 = 0.01;

/// How far the rays of two float64 cameras may be apart, pixels; and pictures of float32 rays, as shares.
const SAME_RAY: f64 = 1e-9;
const SAME_LIGHT: f64 = 2e-5;

/// Returns how far the ray through a place of the picture passes a point, in pixels as large as they are there.
fn beside(scene: &Scene, place: DVec2, point: DVec3) -> f64 {
    let plane = scene.view_plane();
    let steps = plane.column_step * place.x + plane.row_step * place.y;
    let from_eye = plane.first_pixel + steps;
    let direction = match plane.is_parallel {
        true => plane.forward,
        false => from_eye.normalize(),
    };
    let to_point = point - plane.eye - from_eye;
    let side = plane.row_step.length().min(plane.column_step.length());
    let growth = match plane.is_parallel {
        true => 1.0,
        false => (point - plane.eye).dot(plane.forward) / plane.near,
    };
    (to_point - direction * to_point.dot(direction)).length() / (side * growth)
}

fn within(random: &mut Rng) -> DVec2 {
    DVec2::new(random.f64() * 23.0, random.f64() * 15.0)
}

#[test]
fn points_show_where_their_matrices_project_them() {
    let mut random = Rng::with_seed(17);
    for round in 0..56 {
        let engine = engine(&mut random, round % 14);
        let scene = engine.scene();
        scene.validate().unwrap();
        for _ in 0..20 {
            let share = random.f64() * 0.9;
            let point = engine.point_at(within(&mut random), share);
            let found = beside(&scene, engine.place_of(point), point);
            assert!(found <= BESIDE, "{}: {found} pixels beside", engine.name);
        }
        let clip = engine.camera().matrices.unwrap().clip_depth().unwrap();
        let near = clip.near();
        assert!(
            (near / engine.near - 1.0).abs() < 1e-6 && scene.view_plane().near == near,
            "{}: rays begin at {near}, not at {}",
            engine.name,
            engine.near
        );
        let start = scene.view_plane().ray(3, 4).origin;
        let ndc = (engine.projection * engine.view).project_point3(start).z;
        let expected = if clip.is_reversed() {
            1.0
        } else {
            clip.range().low()
        };
        assert!((ndc - expected).abs() < 1e-6, "{}: {ndc}", engine.name);
    }
}

#[test]
fn a_transposed_matrix_is_refused_or_shows_points_elsewhere() {
    let mut random = Rng::with_seed(18);
    for round in 0..56 {
        let mut engine = engine(&mut random, round % 14);
        let point = engine.point_at(within(&mut random), 0.5);
        let place = engine.place_of(point);
        let projection = engine.projection;
        engine.projection = projection.transpose();
        let scene = engine.scene();
        let is_kept = projection.abs_diff_eq(engine.projection, 1e-9);
        if scene.validate().is_ok() && !is_kept {
            let found = beside(&scene, place, point);
            assert!(
                found > 10.0 * BESIDE,
                "{}: {found} pixels beside",
                engine.name
            );
        }
        engine.projection = projection;
        engine.view = engine.view.transpose();
        let refused = engine.scene().validate().unwrap_err().to_string();
        assert!(
            refused.contains("camera.view: its last row is"),
            "{refused}"
        );
    }
}

#[test]
fn the_brightest_pixel_is_the_one_whose_ray_a_jitter_leads_through_a_point() {
    let mut renderer = renderer(common::device().lanes, "");
    let mut random = Rng::with_seed(19);
    for round in 0..56 {
        let engine = engine(&mut random, round % 14);
        let place = within(&mut random);
        let point = engine.point_at(place, 0.4);
        let pixel = place.round();
        let mut scene = engine.scene();
        scene.spheres.push(Sphere {
            center: point,
            ..Sphere::default()
        });
        scene.camera.jitter = place - pixel;
        let drawn = renderer.render(&scene).unwrap();
        let light = |index: usize| drawn.as_slice()[4 * index];
        let brightest = (0..SIZE.pixels()).max_by(|a, b| light(*a).total_cmp(&light(*b)));
        let expected = pixel.y as usize * 24 + pixel.x as usize;
        assert_eq!(brightest, Some(expected), "{}: {pixel}", engine.name);
        // A ray so close to a core that its light is far beyond that of a hundredth of a pixel beside it.
        let mut moved = scene.clone();
        moved.camera.jitter += DVec2::new(2.0 * BESIDE, 0.0);
        let beside = renderer.render(&moved).unwrap().as_slice()[4 * expected];
        assert!(light(expected) > 2.0 * beside, "{}: {beside}", engine.name);
    }
}

/// Cores of several kinds, some with an end to their light, by a camera off its centre or by parallel rays.
fn picture(is_parallel: bool, sampling: Sampling) -> Scene {
    let view = camera::rh::view::look_at_mat4(DVec3::new(0.4, -4.0, 1.7), DVec3::ZERO, DVec3::Z);
    let projection = match is_parallel {
        true => camera::rh::proj::directx::orthographic(-1.9, 1.3, -1.2, 1.4, -0.5, 12.0),
        false => camera::rh::proj::directx::frustum(-0.5, 0.2, -0.15, 0.3, 0.9, 20.0),
    };
    let mut scene = Scene::new(Camera::from_clip(view, projection, ClipRange::ZeroToOne));
    scene.image = ImageSize {
        width: 130,
        height: 75,
    };
    scene.integration.antialias = Antialias::None;
    scene.integration.method = Method::Exact {
        tolerance: 1e-3,
        sampling,
    };
    for k in 0..12 {
        let turn = f64::from(k) * 0.9;
        scene.spheres.push(Sphere {
            center: DVec3::new(turn.sin(), 0.5 * turn.cos(), 0.1 * turn - 0.4),
            color: DVec3::new(1.0, 0.4, 0.2),
            reach: Some(0.25),
            ..Sphere::default()
        });
    }
    scene.tori.push(Torus {
        color: DVec3::new(0.2, 0.4, 1.0),
        profile: Profile::InverseSquare,
        ..Torus::new(0.7)
    });
    scene.segments.push(Segment {
        reach: Some(0.3),
        ..Segment::new(DVec3::new(-1.5, 0.3, -0.4), DVec3::new(1.2, -0.8, 0.6))
    });
    scene
}

#[test]
fn pictures_are_those_of_the_reference() {
    let mut renderer = renderer(common::device().lanes, "");
    for is_parallel in [false, true] {
        for sampling in [Sampling::Pixels, Sampling::Tiles] {
            let mut scene = picture(is_parallel, sampling);
            for along in [None, Some(DepthAlong::Axis), Some(DepthAlong::Ray)] {
                let wall = |column: u32, row: u32| match column + row {
                    ..90 => 4.0 + 0.01 * f64::from(row),
                    90..120 => f64::INFINITY,
                    _ => 3.8,
                };
                scene.depth = along.map(|along| common::depths(&scene, along, wall));
                let expected = reference::render(&scene).unwrap();
                let found = difference(&renderer.render(&scene).unwrap(), &expected);
                println!("parallel {is_parallel}, {sampling:?}, {along:?}: {found:?}");
                assert!(
                    meets(&found, 1e-3),
                    "{is_parallel} {sampling:?} {along:?}: {found:?}"
                );
            }
        }
    }
}

#[test]
fn without_the_room_around_them_parallel_rays_lose_light() {
    let scene = picture(true, Sampling::Tiles);
    let mut spoiled = renderer(common::device().lanes, "-DCONE_MARGIN=0.0f");
    let expected = reference::render(&scene).unwrap();
    let found = difference(&spoiled.render(&scene).unwrap(), &expected);
    assert!(!meets(&found, 1e-3), "{found:?}");
}

#[test]
fn a_camera_that_looks_draws_what_its_matrices_draw() {
    let mut looks = common::full_scene(40, 30);
    looks.integration.method = common::by(Sampling::Tiles);
    looks.camera.jitter = DVec2::new(0.3, -0.2);
    let look = looks.camera.clone();
    let aspect = 40.0 / 30.0;
    let fov_y = look.fov_y.to_radians();
    let view = camera::rh::view::look_at_mat4(look.eye, look.target, look.up);
    let mut renderer = renderer(common::device().lanes, "");
    let expected = renderer.render(&looks).unwrap();
    let mut by = |jitter: DVec2, projection: DMat4| {
        let mut scene = looks.clone();
        scene.camera = Camera {
            ray_length: look.ray_length,
            jitter,
            ..Camera::from_matrices(view, projection)
        };
        scene.camera.near = look.near;
        let (a, b) = (looks.view_plane(), scene.view_plane());
        let apart = (a.ray(7, 5).origin - b.ray(7, 5).origin).length();
        let found = difference(&renderer.render(&scene).unwrap(), &expected);
        (apart / a.row_step.length(), found)
    };
    let projection = camera::rh::proj::directx::perspective_infinite_reverse(fov_y, aspect, 0.1);
    let (apart, found) = by(look.jitter, projection);
    assert!(
        apart < SAME_RAY && found.max < SAME_LIGHT,
        "{apart} {found:?}"
    );
    // The same jitter in the projection, as engines have it.
    let shift = DVec3::new(-2.0 * 0.3 / 40.0, 2.0 * -0.2 / 30.0, 0.0);
    let moved = DMat4::from_translation(shift) * projection;
    let (apart, found) = by(DVec2::ZERO, moved);
    assert!(
        apart < SAME_RAY && found.max < SAME_LIGHT,
        "{apart} {found:?}"
    );
    let (apart, found) = by(DVec2::ZERO, projection);
    assert!(
        apart > 0.3 && found.max > 100.0 * SAME_LIGHT,
        "{apart} {found:?}"
    );
}
