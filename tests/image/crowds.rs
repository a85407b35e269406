//! Crowds of points against the sum over all of them in float64, by the other closed form.

use energywave::image::ImageSize;
use energywave::scene::{
    Antialias, Camera, Crowd, Decay, Measure, PointList, Points, Profile, Ray,
};
use energywave::{Error, RadianceImage, Renderer, Scene};
use fastrand::Rng;
use glam::DVec3;

use crate::common;

/// What a crowd aims at: of 99.9 % of the pixels; no pixel is ten times as far off.
const TOLERANCE: f64 = 1e-3;

/// No multiple of a tile.
const SIZE: ImageSize = ImageSize {
    width: 99,
    height: 75,
};

/// So many pixels are looked at: every third, and those that hold a point.
const EVERY: usize = 3;

/// Returns points in a ball, a tenth of them in a clump.
fn cloud(count: u32, profile: Profile) -> Points {
    let mut rng = Rng::with_seed(8);
    let mut place = |k: u32| {
        let v = DVec3::from([(); 3].map(|()| 2.0 * rng.f64() - 1.0));
        match k % 10 {
            0 => 0.03 * v + DVec3::new(0.1, 0.2, 0.05),
            _ => v,
        }
    };
    let positions: Vec<DVec3> = (0..count).map(&mut place).collect();
    let lights = (0..count).map(|k| [1.0, 0.3 + 0.1 * (k % 7) as f32, 0.5]);
    let list = PointList::with_lights(positions, lights.collect()).unwrap();
    let mut points = Points::new(list);
    (points.profile, points.coefficient) = (profile, 1e-3);
    points
}

/// Returns a scene that is seen from so far, through an angle, degrees.
fn scene(from: f64, fov_y: f64, points: Points) -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.3, -from, 0.2), DVec3::ZERO));
    scene.camera.fov_y = fov_y;
    scene.camera.near = 0.2 * from;
    scene.camera.ray_length = Some(3.0 * from);
    scene.image = SIZE;
    scene.integration.antialias = Antialias::None;
    scene.decay = Some(Decay::new(0.1, 0.1));
    scene.points.push(points);
    scene
}

/// Returns the integral of zeta / d or zeta / d^2 along a ray, over s.
pub fn integral(ray: &Ray, point: DVec3, profile: Profile, decay: Option<Decay>) -> f64 {
    integral_up_to(ray, 1.0, point, profile, decay)
}

/// Returns the same up to an s.
pub fn integral_up_to(
    ray: &Ray,
    end: f64,
    point: DVec3,
    profile: Profile,
    decay: Option<Decay>,
) -> f64 {
    let from = ray.origin - point;
    let (a2, b2) = (ray.span.length_squared(), from.dot(ray.span));
    let beside2 = (from - ray.span * (b2 / a2))
        .length_squared()
        .max(1e-12 * a2);
    let foot = b2 / a2;
    let Some(Decay { alpha, beta, .. }) = decay else {
        let (l, d) = (a2.sqrt(), beside2.sqrt());
        let at = |s: f64| (s + foot) * l / d;
        return match profile {
            Profile::Inverse => (at(end).asinh() - at(0.0).asinh()) / l,
            _ => (at(end).atan() - at(0.0).atan()) / (d * l),
        };
    };
    // X(v) = a v^2 + 2 b v + A with v = -1 / (s + beta).
    let c2 = a2 * foot * foot + beside2;
    let (a, b) = (a2 * beta * beta - 2.0 * b2 * beta + c2, a2 * beta - b2);
    let (root, big) = ((a2 * beside2).sqrt(), a2);
    let primitive = |s: f64| {
        let v = -1.0 / (s + beta);
        let x = a * v * v + 2.0 * b * v + big;
        match profile {
            Profile::Inverse => x.sqrt() / a - b * a.powf(-1.5) * ((a * v + b) / root).asinh(),
            _ => {
                let angle = ((a * v + b) / root).atan();
                v / a - b / (a * a) * x.ln() + (2.0 * b * b - a * big) / (a * a * root) * angle
            }
        }
    };
    let difference = alpha * (primitive(end) - primitive(0.0));
    match profile {
        Profile::Inverse => -difference,
        _ => difference,
    }
}

/// Returns the sorted relative errors of some pixels.
fn errors(scene: &Scene, image: &RadianceImage) -> Vec<f64> {
    let plane = scene.view_plane();
    let points = &scene.points[0];
    let lights = points.points.lights().unwrap();
    let mut errors = Vec::new();
    for index in (0..SIZE.pixels()).step_by(EVERY) {
        let (column, row) = (index as u32 % SIZE.width, index as u32 / SIZE.width);
        let ray = plane.ray(column, row);
        let mut light = DVec3::ZERO;
        for (point, own) in points.points.positions().iter().zip(lights) {
            let it = integral(&ray, *point, points.profile, scene.decay);
            light += it * DVec3::from(own.map(f64::from));
        }
        let measure = match scene.integration.measure {
            Measure::Length => scene.ray_length(),
            _ => 1.0,
        };
        light *= measure * points.coefficient;
        let found = &image.as_slice()[4 * index..];
        let off = |channel: usize| (f64::from(found[channel]) / light[channel] - 1.0).abs();
        errors.push(off(0).max(off(1)).max(off(2)));
    }
    errors.sort_by(f64::total_cmp);
    errors
}

/// Says what is wrong with errors, if anything is.
fn fault(errors: &[f64]) -> Option<String> {
    let most = errors[errors.len() * 999 / 1000];
    let worst = errors[errors.len() - 1];
    let is_right = most <= TOLERANCE && worst <= 10.0 * TOLERANCE;
    (!is_right).then(|| format!("99.9 % within {most:.1e}, the worst {worst:.1e}"))
}

pub const PROFILES: [Profile; 2] = [Profile::Inverse, Profile::InverseSquare];

/// Returns a cloud seen through a telephoto lens, one that a wide lens sees, and one that is near.
fn scenes(profile: Profile) -> [Scene; 3] {
    let far = scene(4.0, 8.0, cloud(3000, profile));
    let mut wide = scene(2.5, 60.0, cloud(1500, profile));
    wide.decay = None;
    let mut near = scene(1.9, 50.0, cloud(1500, profile));
    near.integration.measure = Measure::Parameter;
    [far, wide, near]
}

#[test]
fn crowds_are_the_sum_of_their_points_on_one_lane_and_many() {
    for lanes in common::outer_lane_widths() {
        let mut renderer = common::renderer(lanes, "");
        for profile in PROFILES {
            for (index, scene) in scenes(profile).into_iter().enumerate() {
                let image = renderer.render(&scene).unwrap();
                let fault = fault(&errors(&scene, &image));
                assert_eq!(fault, None, "{lanes} lanes, {profile:?}, scene {index}");
                let again = renderer.render(&scene).unwrap();
                assert_eq!(image.as_slice(), again.as_slice(), "two frames differ");
                let mut apart = scene.clone();
                apart.integration.crowd = Crowd::Never;
                let is_crowd = renderer.render(&apart).unwrap().as_slice() != image.as_slice();
                assert!(
                    is_crowd || lanes != common::device().lanes,
                    "no crowd was drawn"
                );
            }
        }
    }
}

/// How far means over pixels may be from those of single points, of most pixels and of all: both are estimates.
const MEANS: [f64; 2] = [3e-3, 3e-2];

#[test]
fn pixels_that_are_means_are_those_of_single_points() {
    let mut renderer = common::renderer(common::device().lanes, "");
    for profile in PROFILES {
        for (fov_y, name) in [(8.0, "narrow"), (45.0, "wide")] {
            let mut scene = scene(4.0, fov_y, cloud(1500, profile));
            scene.integration.antialias = Antialias::Footprint;
            let together = renderer.render(&scene).unwrap();
            scene.integration.crowd = Crowd::Never;
            let apart = renderer.render(&scene).unwrap();
            let off = |(a, b): (&f32, &f32)| f64::from((a / b - 1.0).abs());
            let all = together.as_slice().iter().zip(apart.as_slice());
            let mut errors: Vec<f64> = all.filter(|(_, b)| **b > 0.0).map(off).collect();
            errors.sort_by(f64::total_cmp);
            let most = errors[errors.len() * 99 / 100];
            let worst = errors[errors.len() - 1];
            println!("{profile:?}, {name} pixels: 99 % {most:.1e}, worst {worst:.1e}");
            assert!(most > 1e-7, "no crowd was drawn");
            assert!(
                most < MEANS[0] && worst < MEANS[1],
                "{most:.1e} {worst:.1e}"
            );
        }
    }
}

#[test]
fn the_self_test_refuses_spoiled_kernels_of_crowds() {
    let scene = &scenes(Profile::Inverse)[0];
    for (spoiled, is_right) in [
        ("", true),
        ("-D ENOUGH_ALWAYS", false),
        ("-D ONE_DEPTH", false),
    ] {
        let mut options = common::options(common::device().lanes, spoiled);
        options.skips_self_test = false;
        let mut renderer = Renderer::with_options(&common::device(), &options).unwrap();
        match renderer.render(scene) {
            Ok(_) => assert!(is_right, "{spoiled}"),
            Err(error) => {
                assert!(matches!(error, Error::SelfTest { .. }), "{error}");
                assert!(!is_right, "{error}");
            }
        }
    }
}

#[test]
fn every_spoiled_build_of_crowds_is_found() {
    for spoiled in [
        "-D ENOUGH_ALWAYS",
        "-D ONE_DEPTH",
        "-D NO_BLOCK_LIGHT",
        "-D BLOCK(view)=0u",
        "-D MIDDLES_ONLY",
        "-D TWO_NODES",
        "-D LIMITS_ALWAYS",
    ] {
        let mut renderer = common::renderer(common::device().lanes, spoiled);
        let mut is_found = false;
        for profile in PROFILES {
            for scene in &scenes(profile)[..2] {
                let image = renderer.render(scene).unwrap();
                is_found |= fault(&errors(scene, &image)).is_some();
            }
        }
        assert!(is_found, "{spoiled}");
    }
}

#[test]
fn a_bright_point_in_a_crowd_and_parts_of_a_frame_are_right() {
    let mut renderer = common::renderer(common::device().lanes, "");
    for profile in PROFILES {
        let points = cloud(3000, profile);
        let mut lights = points.points.lights().unwrap().to_vec();
        lights[17] = [300.0, 50.0, 9.0];
        let positions = points.points.positions().to_vec();
        let list = PointList::with_lights(positions, lights).unwrap();
        let mut scene = scene(4.0, 25.0, points);
        scene.points[0].points = list;
        let image = renderer.render(&scene).unwrap();
        assert_eq!(fault(&errors(&scene, &image)), None, "{profile:?}");
        let row = 4 * SIZE.width as usize;
        let mut part = vec![0.0; 30 * row];
        renderer
            .render_rows(&scene, 20..50, &mut part, row)
            .unwrap();
        let off = part
            .iter()
            .zip(&image.as_slice()[20 * row..])
            .map(|(a, b)| (a / b - 1.0).abs());
        assert!(off.fold(0.0, f32::max) < 1e-3);
    }
}
