//! Particles as light against float64 by quadrature of the definition: whole pictures of balls and streaks.

use energywave::image::{DepthAlong, DepthImage, ImageSize};
use energywave::particle::Simulation;
use energywave::scene::{
    Absorption, Antialias, Camera, Collider, Decay, EmittedWave, Lattice, LightElement, Mesh,
    MetaballKernel, Metaballs, Particles, PointList, SimulationSettings, Sphere, TriangleList,
};
use energywave::{Device, RadianceImage, Renderer, Scene, reference};
use fastrand::Rng;
use glam::DVec3;

use crate::common::{self, options};

/// What float32 sums, depths and panels leave: of a pixel, and of the brightest that a single element gives.
pub const OF_PIXEL: f64 = 1e-5;
const OF_BRIGHTEST: f64 = 1e-6;

/// The same of streaks, whose radius changes and whose ends are slanted cuts.
pub const OF_STREAK: f64 = 3e-5;

/// What float32 leaves of streaks that are 130 radii away, of a pixel and of 1, where the brightest are 10.
const OF_FAR: f32 = 2e-4;

/// No multiple of a block or a tile.
pub const SIZE: ImageSize = ImageSize {
    width: 61,
    height: 45,
};

pub fn renderer(extra: &str) -> Renderer {
    common::renderer(common::device().lanes, extra)
}

fn scene_from(eye: DVec3) -> Scene {
    let mut scene = Scene::new(Camera::new(eye, DVec3::ZERO));
    scene.image = SIZE;
    scene.camera.near = 0.3;
    scene.camera.ray_length = Some(14.0);
    scene
}

/// A cloud of two kernels, and a lone particle whose rim is seen.
pub fn cloud(eye: DVec3) -> Scene {
    let mut scene = scene_from(eye);
    let lattice = Lattice {
        columns: [6, 6],
        jitter: 0.3,
        seed: 4,
        ..Lattice::new(150, 0.55)
    };
    let mut particles = Particles::new(PointList::lattice(&lattice).unwrap(), 0.6);
    particles.color = DVec3::new(1.0, 0.4, 0.2);
    scene.particles.push(particles.clone());
    particles.kernel = MetaballKernel::Smooth;
    particles.color = DVec3::new(0.1, 0.3, 1.0);
    particles.translate = DVec3::new(0.1, 0.2, -0.15);
    scene.particles.push(particles);
    let alone = PointList::new(vec![DVec3::new(2.9, 1.0, 1.6)]).unwrap();
    scene.particles.push(Particles::new(alone, 0.7));
    scene
}

/// Streaks in all directions, some along the rays, thick and thin, some with slanted sides.
pub fn streaks(eye: DVec3) -> Scene {
    let mut scene = scene_from(eye);
    let mut random = Rng::with_seed(7);
    let mut vector = |reach: f64| DVec3::from([0; 3].map(|_| reach * (2.0 * random.f64() - 1.0)));
    let mut share = Rng::with_seed(8);
    for index in 0..60 {
        let middle = vector(2.0);
        let axis = match index % 5 {
            0 => 0.6 * (middle - eye).normalize() + vector(1e-4),
            1 => 0.05 * vector(1.0),
            _ => vector(1.2),
        };
        let thick = 0.25 + 0.2 * share.f64();
        let radii = match index % 3 {
            0 => [thick; 3],
            1 => [thick, 0.6 * thick, 0.2 * thick],
            _ => [0.5 * thick, thick, 0.5 * thick],
        };
        let light = DVec3::new(share.f64(), share.f64(), share.f64());
        scene.light_elements.push(LightElement::Streak {
            ends: [middle - axis, middle + axis],
            radii,
            light,
        });
    }
    scene
}

/// A slanted surface through the middle.
fn hidden(mut scene: Scene) -> Scene {
    let depths = (0..SIZE.pixels()).map(|pixel| match pixel % SIZE.width as usize {
        column if column < 20 => f32::INFINITY,
        column => 7.5 + 0.06 * column as f32,
    });
    let depth = DepthImage::new(SIZE, DepthAlong::Axis, depths.collect()).unwrap();
    scene.depth = Some(depth);
    scene
}

/// The light of the brightest element.
fn brightest(scene: &Scene) -> f64 {
    let mut most: f64 = 0.0;
    let mut single = scene.clone();
    single.light_elements.clear();
    single.particles.clear();
    let alone = |scene: &Scene| reference::render(scene).unwrap();
    for element in &scene.light_elements {
        single.light_elements = vec![*element].into();
        most = most.max(peak(&alone(&single)));
    }
    single.light_elements.clear();
    let first = scene.particles.first().cloned();
    if let Some(mut particles) = first {
        // One that is as near as any.
        let near = |a: &&DVec3, b: &&DVec3| {
            let far = |p: &DVec3| p.distance(scene.camera.eye);
            far(a).total_cmp(&far(b))
        };
        let positions = particles.points.positions().iter();
        let nearest = *positions.min_by(near).unwrap();
        particles.points = PointList::new(vec![nearest]).unwrap();
        single.particles = vec![particles].into();
        most = most.max(peak(&alone(&single)));
    }
    most
}

fn peak(image: &RadianceImage) -> f64 {
    let colors = image.as_slice().as_chunks::<4>().0.iter();
    let most = colors.flat_map(|pixel| &pixel[..3]).copied();
    f64::from(most.fold(0.0, f32::max))
}

/// Returns the worst error, as a share of what it may be.
pub fn worst(renderer: &mut Renderer, scene: &Scene, truth: &RadianceImage, of_pixel: f64) -> f64 {
    let found = renderer.render(scene).unwrap();
    let floor = OF_BRIGHTEST / OF_PIXEL * of_pixel * brightest(scene);
    let pairs = found.as_slice().iter().zip(truth.as_slice());
    let error = |(found, truth): (&f32, &f32)| {
        let (found, truth) = (f64::from(*found), f64::from(*truth));
        (found - truth).abs() / (of_pixel * truth.abs() + floor)
    };
    pairs.map(error).fold(0.0, f64::max)
}

#[track_caller]
pub fn expect_true(name: &str, renderer: &mut Renderer, scene: &Scene, of_pixel: f64) {
    let truth = reference::render(scene).unwrap();
    assert!(peak(&truth) > 0.01, "{name}: the picture is dark");
    let worst = worst(renderer, scene, &truth, of_pixel);
    println!("{name}: {worst:.2} of what it may be");
    assert!(worst < 1.0, "{name}: {worst}");
}

pub const FAR: DVec3 = DVec3::new(3.0, -8.0, 3.0);
const WITHIN: DVec3 = DVec3::new(0.4, -0.9, 0.3);

fn fading(mut scene: Scene, power: u32, beta: f64) -> Scene {
    let mut decay = Decay::new(0.2, beta);
    decay.power = power;
    scene.decay = Some(decay);
    scene
}

#[test]
fn balls_are_those_of_float64() {
    let mut renderer = renderer("");
    let absorbed = {
        let mut scene = fading(cloud(FAR), 1, 0.1);
        scene.absorption = Some(Absorption { kappa: 0.3 });
        scene
    };
    for (name, scene) in [
        ("far", cloud(FAR)),
        ("within", cloud(WITHIN)),
        ("hidden", hidden(cloud(FAR))),
        ("decay, far", fading(cloud(FAR), 2, 0.1)),
        ("decay, within", fading(cloud(WITHIN), 2, 0.02)),
        ("decay, hidden", hidden(fading(cloud(FAR), 2, 0.5))),
        ("absorbed", absorbed),
    ] {
        expect_true(name, &mut renderer, &scene, OF_PIXEL);
    }
}

#[test]
fn streaks_are_those_of_float64() {
    let mut renderer = renderer("");
    for (name, scene) in [
        ("far", streaks(FAR)),
        ("within", streaks(WITHIN)),
        ("hidden", hidden(streaks(FAR))),
        ("decay", fading(streaks(FAR), 2, 0.1)),
    ] {
        expect_true(name, &mut renderer, &scene, OF_STREAK);
    }
}

#[test]
fn every_lane_width_sees_the_same() {
    let mut scene = streaks(FAR);
    scene.particles = cloud(FAR).particles;
    let truth = reference::render(&scene).unwrap();
    for lanes in [1, 8] {
        let device = common::device();
        let mut renderer = Renderer::with_options(&device, &options(lanes, "")).unwrap();
        let worst = worst(&mut renderer, &scene, &truth, OF_STREAK);
        assert!(worst < 1.0, "{lanes} lanes: {worst}");
    }
}

/// What each spoiled build does, and a scene where that shows.
#[test]
fn spoiled_builds_are_not() {
    for (spoil, scene, of_pixel) in [
        (
            "-DMOMENTS_EVERYWHERE",
            fading(cloud(WITHIN), 2, 0.02),
            OF_PIXEL,
        ),
        ("-DNEVER_CUT", hidden(cloud(FAR)), OF_PIXEL),
        ("-DNARROW", streaks(FAR), OF_STREAK),
        ("-DSQUARED_DISTANCE", far_away(), OF_PIXEL),
    ] {
        let truth = reference::render(&scene).unwrap();
        let mut renderer = renderer(spoil);
        let worst = worst(&mut renderer, &scene, &truth, of_pixel);
        println!("{spoil}: {worst:.1}");
        assert!(worst > 1.0, "{spoil}: {worst}");
    }
    let far = far_away();
    expect_true("far away", &mut renderer(""), &far, OF_PIXEL);
}

fn far_away() -> Scene {
    let mut scene = cloud(12.0 * FAR);
    scene.camera.fov_y = 4.0;
    scene.camera.ray_length = Some(140.0);
    scene
}

#[test]
fn frames_are_equal_to_the_bit_however_they_are_cut() {
    let mut scene = streaks(WITHIN);
    scene.particles = cloud(WITHIN).particles;
    scene.spheres.push(Sphere::default());
    let mut first = renderer("");
    let whole = first.render(&scene).unwrap();
    first.render(&cloud(FAR)).unwrap();
    for mut renderer in [first, renderer("")] {
        assert!(renderer.render(&scene).unwrap().as_slice() == whole.as_slice());
    }
    let mut lone = scene.clone();
    lone.spheres.clear();
    let mut renderer = renderer("");
    let whole = renderer.render(&lone).unwrap();
    let stride = 4 * SIZE.width as usize;
    let mut parts = vec![0.0; stride * SIZE.height as usize];
    for rows in [0..7, 7..8, 8..45] {
        let target = &mut parts[rows.start as usize * stride..rows.end as usize * stride];
        renderer.render_rows(&lone, rows, target, stride).unwrap();
    }
    assert!(parts == whole.as_slice());
}

#[test]
fn particles_add_to_the_wave_and_what_is_behind_the_rays_is_dark() {
    let mut renderer = renderer("");
    let mut scene = cloud(FAR);
    let particles = renderer.render(&scene).unwrap();
    scene.spheres.push(Sphere::default());
    let both = renderer.render(&scene).unwrap();
    scene.particles.clear();
    let wave = renderer.render(&scene).unwrap();
    let sums = particles.as_slice().iter().zip(wave.as_slice());
    for ((one, other), both) in sums.zip(both.as_slice()).filter(|(_, both)| **both != 1.0) {
        assert!((one + other - both).abs() <= 1e-6 * both);
    }
    // No particle, one behind the eye, one before the plane.
    for points in [vec![], vec![2.0 * FAR], vec![FAR * 0.99]] {
        let mut scene = scene_from(FAR);
        let points = PointList::new(points).unwrap();
        scene.particles.push(Particles::new(points, 0.1));
        assert_eq!(peak(&renderer.render(&scene).unwrap()), 0.0);
    }
}

/// A wave that hits a box, at a frame.
pub fn splash(frame: f64) -> Scene {
    let mut scene = Scene::new(Camera::new(
        DVec3::new(-120.0, -95.0, 50.0),
        -12.0 * DVec3::X,
    ));
    scene.image = SIZE;
    scene.integration.antialias = Antialias::None;
    scene
        .waves
        .push(EmittedWave::new(DVec3::new(-50.0, 0.0, 0.0), DVec3::X));
    scene.colliders.push(Collider::new_box(
        DVec3::X * 8.0,
        DVec3::new(8.0, 22.0, 22.0),
    ));
    let mut settings = SimulationSettings::default();
    settings.time = Some(frame);
    scene.simulation = Some(settings);
    scene
}

#[test]
fn waves_are_drawn_as_their_light_and_colliders_hide_it() {
    let mut renderer = renderer("");
    let scene = splash(70.5);
    let shown = renderer.render(&scene).unwrap();
    let mut simulation = Simulation::new(&scene).unwrap();
    let mut given = scene.clone();
    given.waves.clear();
    given.light_elements = simulation.light(70.5).unwrap().into();
    assert!(renderer.render(&given).unwrap().as_slice() == shown.as_slice());
    // Float64 sees the same before the box, whose surface the renderer of the reference shades as it does here.
    let mut exact = Renderer::new(&Device::reference()).unwrap();
    let truth = exact.render(&scene).unwrap();
    for (shown, truth) in shown.as_slice().iter().zip(truth.as_slice()) {
        assert!(
            (shown - truth).abs() < OF_FAR * (truth + 1.0),
            "{shown} {truth}"
        );
    }
    // Without the box, what was behind it shines, and its own radiance is gone.
    let mut open = given.clone();
    open.colliders[0].visible = false;
    let open = renderer.render(&open).unwrap();
    let count = |is_such: fn(f32, f32) -> bool| {
        let pairs = shown.as_slice().iter().zip(open.as_slice());
        pairs
            .filter(|(shown, open)| is_such(**shown, **open))
            .count()
    };
    assert!(count(|shown, open| shown > open + 0.03) > 100);
    assert!(count(|shown, open| shown < open - 0.03) > 10);
    // Another frame is another picture, and the first comes back to the bit.
    assert!(renderer.render(&splash(40.0)).unwrap().as_slice() != shown.as_slice());
    assert!(renderer.render(&scene).unwrap().as_slice() == shown.as_slice());
}

#[test]
fn colliders_of_triangles_are_seen_as_meshes_are() {
    let corners = [[-5.0, -20.0, -20.0], [-5.0, 20.0, -20.0], [-5.0, 0.0, 25.0]];
    let corners = corners.map(DVec3::from_array).to_vec();
    let mut mesh = Mesh::new(TriangleList::new(corners, vec![[0, 1, 2]]).unwrap());
    mesh.albedo = DVec3::new(0.2, 0.4, 0.6);
    let mut hit = splash(70.0);
    let mut collider = Collider::mesh(mesh.clone());
    collider.color = mesh.albedo;
    hit.colliders = vec![collider].into();
    let light = Simulation::new(&hit).unwrap().light(70.0).unwrap();
    let mut given = splash(70.0);
    given.waves.clear();
    given.colliders.clear();
    given.light_elements = light.into();
    for mut renderer in [renderer(""), Renderer::new(&Device::reference()).unwrap()] {
        let shown = renderer.render(&hit).unwrap();
        let dark = renderer.render(&given).unwrap();
        given.meshes.push(mesh.clone());
        assert!(renderer.render(&given).unwrap().as_slice() == shown.as_slice());
        given.meshes.clear();
        // Unseen, it hides nothing.
        assert!(dark.as_slice() != shown.as_slice());
        hit.colliders[0].visible = false;
        assert!(renderer.render(&hit).unwrap().as_slice() == dark.as_slice());
        hit.colliders[0].visible = true;
    }
}

#[test]
fn a_box_before_metaballs_and_behind_them_is_seen_where_it_is_nearest() {
    let mut renderer = renderer("");
    let mut scene = scene_from(FAR);
    scene.integration.antialias = Antialias::None;
    let points = PointList::new(vec![DVec3::ZERO]).unwrap();
    let mut ball = Metaballs::new(points, 3.0);
    ball.threshold = 0.25;
    scene.metaballs.push(ball);
    let of_ball = renderer.render(&scene).unwrap();
    let toward = FAR.normalize();
    let middle = |image: &RadianceImage| {
        let pixel = SIZE.pixels() / 2;
        f64::from(image.as_slice()[4 * pixel])
    };
    for (distance, hides) in [(3.0, true), (-3.0, false)] {
        let mut collider = Collider::sphere(distance * toward, 0.8);
        collider.color = DVec3::splat(5.0);
        scene.colliders = vec![collider].into();
        let both = middle(&renderer.render(&scene).unwrap());
        assert_eq!(both > 1.5, hides, "{distance}: {both}");
        assert_eq!((both - middle(&of_ball)).abs() < 1e-6, !hides, "{both}");
    }
}
