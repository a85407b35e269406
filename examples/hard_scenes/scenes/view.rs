//! Cameras that look at a core from where it is hard: along it, level with it, through a point of it, from inside.

use energywave::Scene;
use energywave::image::{DepthAlong, DepthImage, ImageSize};
use energywave::scene::{Antialias, Camera, Decay, Measure, Method};
use glam::DVec3;

use super::dice::Dice;
use super::source::Core;

/// From where a camera looks at a core.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// Along the core, whose line passes through the eye, or nearly.
    Along,
    /// Level with a plane of the source.
    Level,
    /// Down on the middle of the source, along the normal of its plane.
    Down,
    /// From anywhere, the core's point in the middle of the image.
    Through,
    /// From anywhere, at anything near the source.
    Free,
    /// From within the source, or close beside its core.
    Inside,
}

/// All views.
pub const VIEWS: [View; 6] = [
    View::Along,
    View::Level,
    View::Down,
    View::Through,
    View::Free,
    View::Inside,
];

/// Makes a scene without sources; `look` points its camera.
pub fn empty(dice: &mut Dice) -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO));
    let size = |dice: &mut Dice| dice.of(&[33, 33, 33, 41, 36, 25, 9]);
    let width = size(dice);
    let height = if dice.one_in(3) { size(dice) } else { width };
    scene.image = ImageSize { width, height };
    scene.integration.method = Method::default();
    scene.integration.antialias = Antialias::None;
    if !dice.one_in(4) {
        scene.decay = Some(Decay::new(dice.spread(0.1, 1.0), dice.spread(0.02, 2.0)));
    }
    scene.integration.measure = match dice.one_in(3) {
        true => Measure::Length,
        false => Measure::Parameter,
    };
    scene
}

/// Points a scene's camera at a core.
pub fn look(dice: &mut Dice, scene: &mut Scene, core: &Core, view: View) {
    let away = core.size.max(0.05) * dice.spread(1.0, 6.0);
    let aside = dice.beside(core.level);
    let slight = core.level * (dice.slight() * core.size);
    let (eye, target) = match view {
        View::Along => {
            let start = dice.of(&[1.0, 1.0, 0.3, 1e-3]);
            let beside = dice.beside(core.tangent) * (dice.slight() * core.size);
            let eye = core.point - core.tangent * (away * start) + beside;
            (eye, eye + core.tangent * away)
        }
        View::Level => {
            let forth = dice.of(&[aside, core.level.cross(aside)]);
            let target = dice.of(&[core.point, core.middle, core.point + aside * core.size]);
            let target = target - core.level * (target - core.point).dot(core.level);
            (target - forth * away + slight, target)
        }
        View::Down => {
            let lift = dice.of(&[1.0, 1.0, -1.0, 0.1]);
            let eye = core.middle + core.level * (away * lift);
            let beside = aside * (dice.slight() * core.size);
            (eye + beside, core.middle + beside)
        }
        View::Through => (core.point - dice.direction() * away, core.point),
        View::Free => {
            let target = core.middle + dice.point(core.size);
            (target - dice.direction() * away, target)
        }
        View::Inside => {
            let close = core.size * dice.spread(1e-4, 0.5);
            let from = dice.of(&[core.middle, core.point]);
            let target = dice.of(&[core.point, core.point + aside * core.size, core.middle]);
            (from + dice.direction() * close, target)
        }
    };
    let camera = &mut scene.camera;
    (camera.eye, camera.target) = (eye, target);
    let ahead = target - eye;
    let fit = |up: DVec3| up.cross(ahead).length() > 1e-3 * ahead.length();
    let ups = [core.level, core.tangent, DVec3::Z, DVec3::X, aside];
    camera.up = ups.into_iter().find(|up| fit(*up)).unwrap_or(DVec3::Y);
    camera.fov_y = match view {
        View::Inside => dice.of(&[60.0, 90.0, 120.0, 150.0]),
        _ => dice.of(&[20.0, 45.0, 45.0, 70.0]),
    };
    let distance = ahead.length().max(0.1 * core.size);
    camera.near = distance * dice.spread(0.02, 0.8);
    camera.ray_length = Some(distance * dice.spread(0.5, 5.0));
}

/// Ends or begins the rays of the middle pixel at a core's point, exactly or nearly.
pub fn cut(dice: &mut Dice, scene: &mut Scene, core: &Core) {
    let camera = &mut scene.camera;
    let distance = (core.point - camera.eye).length();
    let nearly = distance * (1.0 + dice.of(&[0.0, 0.0, 1e-6, -1e-6, 1e-3, -1e-3, 0.1]));
    if dice.one_in(2) {
        camera.near = nearly;
    } else {
        camera.near = distance * dice.of(&[0.0625, 0.25, 0.5]);
        camera.ray_length = Some(nearly - camera.near);
    }
}

/// Makes sizes of images odd, so that a pixel looks at the camera's target.
pub fn odd(scene: &mut Scene) {
    scene.image.width |= 1;
    scene.image.height |= 1;
}

/// Hides the light behind walls, floors and steps, some of them right through a core.
pub fn hide(dice: &mut Dice, scene: &mut Scene, core: &Core) {
    let size = scene.image;
    let distance = (core.point - scene.camera.eye).length();
    let wall = distance * dice.of(&[1.0, 1.0, 0.999, 1.001, 0.7, 1.5]);
    let slant = dice.of(&[0.0, 0.01, 0.3, 1.0]);
    let has_step = dice.one_in(3);
    let depth = |column: u32, row: u32| {
        let (x, y) = (
            f64::from(column) / f64::from(size.width) - 0.5,
            f64::from(row) / f64::from(size.height) - 0.5,
        );
        let is_open = has_step && (column / 5 + row / 7).is_multiple_of(2);
        let floor = wall * (1.0 + slant * (x + 2.0 * y));
        if is_open {
            f32::INFINITY
        } else {
            floor.max(0.0) as f32
        }
    };
    let places = (0..size.height).flat_map(|row| (0..size.width).map(move |column| (column, row)));
    let values = places.map(|(column, row)| depth(column, row)).collect();
    let along = dice.of(&[DepthAlong::Ray, DepthAlong::Axis]);
    scene.depth = DepthImage::new(size, along, values).ok();
}
