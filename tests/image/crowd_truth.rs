//! Crowds of every shape and number against the sum over all points in float64: what a tolerance promises of them.

use energywave::Scene;
use energywave::image::ImageSize;
use energywave::scene::{Antialias, Camera, Decay, Measure, Method, PointList, Points, Profile};
use fastrand::Rng;
use glam::DVec3;

use super::crowd_spread::light_of_one;
use super::crowds::PROFILES;
use crate::common;

/// No multiple of a tile.
pub const SIZE: ImageSize = ImageSize {
    width: 190,
    height: 107,
};

/// One in which many cells of 8 pixels have a point.
pub const LARGE: ImageSize = ImageSize {
    width: 950,
    height: 531,
};

/// So many points fill that.
pub const FILLING: usize = 20_000;

/// Wide pixels, and so many points that next ones have a form of their own.
const MEDIUM: ImageSize = ImageSize {
    width: 640,
    height: 357,
};
pub const MANY: usize = 51_000;

/// So many pixels anywhere are looked at, and so many that hold a point, of crowds of a thousand.
pub const PIXELS: usize = 1500;

/// Of larger crowds, fewer: truth is a sum over all points.
pub const FEWER_PIXELS: usize = 500;

/// Of a hundred thousand and more, so many that all their sums have this many terms.
const FEWEST_TERMS: usize = 30_000_000;

/// How points lie and shine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    Ball,
    /// Half of them in 20 clumps smaller than a pixel.
    Clumps,
    /// A disc that is seen from its edge.
    Edge,
    /// All on one ray, as far apart as a ball's.
    OnePixel,
    /// A cluster, and another three times as far behind it.
    Behind,
    /// Three levels of clusters of eight.
    Fractal,
    /// Brightnesses whose mean is that of few (Pareto 1.2).
    HeavyTails,
    /// Every other takes light away.
    Signs,
    /// On all sides of the view, and behind the eye, but none near it.
    AllAround,
    /// The eye is among them, the projection plane close to it.
    Inside,
    /// The projection plane goes through their middle.
    AtPlane,
}

fn place(shape: Shape, rng: &mut Rng, clumps: &[DVec3]) -> DVec3 {
    let mut cube = || DVec3::from([(); 3].map(|()| 2.0 * rng.f64() - 1.0));
    let mut ball = || loop {
        let place = cube();
        if place.length_squared() <= 1.0 {
            return place;
        }
    };
    let place = ball();
    match shape {
        Shape::Clumps if rng.bool() => clumps[rng.usize(0..20)] + 1e-3 * place,
        Shape::Edge => place * DVec3::new(1.0, 1.0, 1e-3),
        Shape::OnePixel => DVec3::new(1e-3 * place.x, place.y, 1e-3 * place.z),
        Shape::Behind if rng.bool() => 0.8 * place + DVec3::new(0.3, 8.0, 0.2),
        Shape::Behind => 0.3 * place,
        Shape::Fractal => {
            let corner = |rng: &mut Rng| clumps[rng.usize(0..8)];
            corner(rng) + 0.38 * (corner(rng) + 0.38 * (corner(rng) + 0.38 * place))
        }
        Shape::AllAround => {
            let place = 9.0 * place;
            let eye = DVec3::new(0.0, -4.0, 0.0);
            match place.distance(eye) < 2.5 {
                true => eye + (place - eye).normalize() * 3.0,
                false => place,
            }
        }
        Shape::Inside => 3.0 * place + DVec3::new(0.2, -3.0, 0.1),
        Shape::AtPlane => place + DVec3::new(0.1, -3.0, 0.1),
        _ => place,
    }
}

fn cloud(shape: Shape, count: usize, profile: Profile) -> Points {
    let mut rng = Rng::with_seed(5);
    let mut clumps: Vec<DVec3> = Vec::new();
    for _ in 0..20 {
        clumps.push(DVec3::from([(); 3].map(|()| 1.4 * rng.f64() - 0.7)));
    }
    let mut positions = Vec::with_capacity(count);
    let mut lights = Vec::with_capacity(count);
    for index in 0..count {
        positions.push(place(shape, &mut rng, &clumps));
        let own = match shape {
            Shape::HeavyTails => (1.0 - rng.f32()).powf(-1.0 / 1.2),
            Shape::Signs if index % 2 == 1 => -0.7,
            _ => 1.0,
        };
        lights.push([own, own * (0.3 + 0.6 * rng.f32()), 0.2 * own]);
    }
    let mut points = Points::new(PointList::with_lights(positions, lights).unwrap());
    (points.profile, points.coefficient) = (profile, 1.0 / count as f64);
    points
}

pub fn scene(shape: Shape, count: usize, profile: Profile, tolerance: f64) -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO));
    scene.camera.near = match shape {
        Shape::Inside => 0.05,
        _ => 1.0,
    };
    scene.camera.ray_length = Some(12.0);
    scene.image = match count {
        FILLING => LARGE,
        MANY => MEDIUM,
        _ => SIZE,
    };
    scene.integration.antialias = Antialias::None;
    scene.integration.measure = Measure::Parameter;
    scene.integration.method = Method::exact(tolerance);
    scene.decay = Some(Decay::new(0.1, 0.1));
    scene.points.push(cloud(shape, count, profile));
    scene
}

/// Returns pixels anywhere, and as many that hold a point, as far as there are.
fn pixels(scene: &Scene, many: usize) -> [Vec<usize>; 2] {
    let (plane, ImageSize { width, height }) = (scene.view_plane(), scene.image);
    let anywhere = (0..many).map(|k| k * scene.image.pixels() / many).collect();
    let mut with_point = Vec::new();
    let forward = plane.forward;
    for point in scene.points[0].points.positions() {
        let way = *point - plane.eye;
        let ahead = way.dot(forward);
        if ahead <= 0.0 {
            continue;
        }
        let on_plane = way * (plane.near / ahead) - plane.first_pixel;
        let along = |step: DVec3| on_plane.dot(step) / step.length_squared();
        let (column, row) = (
            along(plane.column_step).round(),
            along(plane.row_step).round(),
        );
        let is_in = |place: f64, size: u32| (0.0..f64::from(size)).contains(&place);
        if is_in(column, width) && is_in(row, height) {
            with_point.push(row as usize * width as usize + column as usize);
        }
        if with_point.len() == many {
            break;
        }
    }
    [anywhere, with_point]
}

/// Returns what the light of a pixel is, and of how much light that is the sum.
pub fn truth(scene: &Scene, pixel: usize) -> (DVec3, DVec3) {
    let plane = scene.view_plane();
    let width = scene.image.width;
    let ray = plane.ray(pixel as u32 % width, pixel as u32 / width);
    let end = scene.depth.as_ref().map_or(1.0, |depth| {
        plane.end(&ray, depth.as_slice()[pixel], depth.along())
    });
    let points = &scene.points[0];
    let (mut light, mut all) = (DVec3::ZERO, DVec3::ZERO);
    let lights = points.points.lights().unwrap();
    for (index, own) in lights.iter().enumerate() {
        let it = light_of_one(&ray, end, points, index, scene.decay);
        let own = it * DVec3::from(own.map(f64::from));
        light += own;
        all += own.abs();
    }
    (light * points.coefficient, all * points.coefficient)
}

/// Says what is wrong with a picture, if anything is, and prints its errors.
pub fn fault(
    scene: &Scene,
    image: &[f32],
    tolerance: f64,
    many: usize,
    name: &str,
) -> Option<String> {
    let mut said = Vec::new();
    for (where_, pixels) in ["anywhere", "with a point"].iter().zip(pixels(scene, many)) {
        if pixels.is_empty() {
            continue;
        }
        let half = pixels.len().div_ceil(2);
        let of = |pixels: &[usize]| -> Vec<f64> {
            let error = |pixel: &usize| {
                let (light, all) = truth(scene, *pixel);
                let found = &image[4 * pixel..];
                let off = |k: usize| (f64::from(found[k]) - light[k]).abs() / all[k].max(1e-300);
                off(0).max(off(1)).max(off(2))
            };
            pixels.iter().map(error).collect()
        };
        let mut errors = std::thread::scope(|scope| {
            let other = scope.spawn(|| of(&pixels[half..]));
            let mut errors = of(&pixels[..half]);
            errors.extend(other.join().unwrap());
            errors
        });
        errors.sort_by(f64::total_cmp);
        // Of less than a thousand pixels one may be the thousandth.
        let last = errors.len() - 1;
        let most = errors[(errors.len() * 999 / 1000).min(last.saturating_sub(1))];
        let (middle, worst) = (errors[errors.len() / 2], errors[last]);
        println!("{name}, {where_}: median {middle:.1e}, 99.9 % {most:.1e}, worst {worst:.1e}");
        if !(most <= tolerance && worst <= 10.0 * tolerance) {
            said.push(format!(
                "{where_}: 99.9 % within {most:.1e}, the worst {worst:.1e}"
            ));
        }
    }
    (!said.is_empty()).then(|| format!("{name}: {}", said.join("; ")))
}

/// Draws crowds, and returns what is wrong with their pictures.
fn faults(cases: &[(Shape, usize, f64)]) -> Vec<String> {
    let mut renderer = common::renderer(common::device().lanes, "");
    let mut faults = Vec::new();
    for (shape, count, tolerance) in cases {
        for profile in PROFILES {
            let scene = scene(*shape, *count, profile, *tolerance);
            let image = renderer.render(&scene).unwrap();
            let many = match count {
                ..=3000 => PIXELS,
                ..=60_000 => FEWER_PIXELS,
                _ => FEWEST_TERMS / count,
            };
            let name = format!("{shape:?} of {count}, {profile:?}, {tolerance:e}");
            faults.extend(fault(&scene, image.as_slice(), *tolerance, many, &name));
        }
    }
    faults
}

#[test]
fn crowds_of_every_shape_are_within_a_thousandth() {
    let shapes = [
        Shape::Ball,
        Shape::Clumps,
        Shape::Edge,
        Shape::OnePixel,
        Shape::Behind,
        Shape::Fractal,
        Shape::HeavyTails,
        Shape::Signs,
        Shape::AllAround,
        Shape::Inside,
        Shape::AtPlane,
    ];
    let cases = shapes.map(|shape| (shape, 1000, 1e-3));
    assert_eq!(faults(&cases), Vec::<String>::new());
}

#[test]
fn crowds_of_one_of_two_and_of_many_are_within_a_thousandth() {
    let cases = [
        (Shape::Ball, FILLING, 1e-3),
        (Shape::Ball, MANY, 1e-3),
        (Shape::Ball, 1, 1e-3),
        (Shape::Ball, 2, 1e-3),
        (Shape::Ball, 30_000, 1e-3),
        (Shape::Clumps, 30_000, 1e-3),
        (Shape::HeavyTails, 30_000, 1e-3),
        (Shape::Inside, 30_000, 1e-3),
        (Shape::AtPlane, 30_000, 1e-3),
    ];
    assert_eq!(faults(&cases), Vec::<String>::new());
}

#[test]
fn a_hundred_thousand_and_a_million_points_are_within_a_thousandth() {
    let cases = [
        (Shape::Ball, 100_000, 1e-3),
        (Shape::Clumps, 100_000, 1e-3),
        (Shape::HeavyTails, 100_000, 1e-3),
        (Shape::Ball, 1_000_000, 1e-3),
    ];
    assert_eq!(faults(&cases), Vec::<String>::new());
}

#[test]
fn crowds_keep_looser_and_tighter_tolerances() {
    let cases = [
        (Shape::Ball, 3000, 1e-2),
        (Shape::Clumps, 3000, 1e-2),
        (Shape::Ball, 3000, 1e-4),
        (Shape::Clumps, 3000, 1e-4),
    ];
    assert_eq!(faults(&cases), Vec::<String>::new());
}

/// Of a lens that has all points around its image, and of one that has most of them far beside.
#[test]
fn crowds_in_narrow_lenses_are_within_a_thousandth() {
    let mut renderer = common::renderer(common::device().lanes, "");
    let mut faults = Vec::new();
    for (fov_y, count) in [(10.0, 1000), (10.0, 30_000), (2.0, 30_000)] {
        for profile in PROFILES {
            let mut scene = scene(Shape::Ball, count, profile, 1e-3);
            scene.camera.fov_y = fov_y;
            let image = renderer.render(&scene).unwrap();
            let name = format!("{fov_y} degrees, {count}, {profile:?}");
            faults.extend(fault(&scene, image.as_slice(), 1e-3, FEWER_PIXELS, &name));
        }
    }
    assert_eq!(faults, Vec::<String>::new());
}
