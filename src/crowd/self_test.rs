//! The first use of freshly built kernels: a crowd of each profile, with decay and without, whose light the reference
//! sums in float64, by another closed form than that of `cl/crowd/point.h`. Some drivers miscompile kernels.

use glam::DVec3;

use super::Crowd;
use super::kernels::Kernels;
use crate::error::{Error, Result};
use crate::image::{DepthAlong, DepthImage, ImageSize};
use crate::opencl::{Compute, Film, FilmFormat, Program, RendererOptions};
use crate::reference::light_of_points_up_to;
use crate::scene::{
    Antialias, Camera, Decay, Measure, Method, PointList, Points, Profile, Ray, Scene,
};

/// No multiple of a tile.
const SIZE: ImageSize = ImageSize {
    width: 43,
    height: 29,
};

/// Every so many pixels are looked at.
const EVERY: usize = 9;

/// So many that cells have more of them than nodes; some tiles are open to the end and some are not.
const COUNT: u32 = 5000;

/// The tolerance that is asked for; the error that a pixel may have, which is also for half floats.
const TOLERANCE: f64 = 1e-4;
const LIMIT: f64 = 20.0 * TOLERANCE;

/// Tests kernels, unless that was done on this device before.
///
/// # Errors
/// [`Error::SelfTest`] if they compute wrong.
pub(super) fn self_test(
    compute: &Compute,
    kind: (FilmFormat, bool),
    options: &RendererOptions,
    (kernels, program): (Kernels, &Program),
) -> Result<Kernels> {
    let is_experiment = options.skips_self_test || compute.device().is_simulator;
    if is_experiment || program.was_tested() {
        return Ok(kernels);
    }
    let mut tester = Crowd::new(options, Profile::Inverse);
    tester.kernels.insert(kind, kernels);
    for profile in [Profile::Inverse, Profile::InverseSquare] {
        tester.profile = profile;
        for decay in [None, Some(Decay::new(0.3, 0.2))] {
            let scene = scene(profile, decay, kind.1)?;
            let found = tester.light(compute, &scene, kind.0)?;
            if let Some(reason) = difference(&scene, &found) {
                let device = compute.device();
                return Err(Error::SelfTest {
                    device: device.name.clone(),
                    driver: format!("{} {}", device.platform, device.driver),
                    reason,
                });
            }
        }
    }
    program.mark_tested();
    tester.kernels.remove(&kind).ok_or_else(|| {
        Error::Unsupported("the kernels of crowds were lost in their test".to_owned())
    })
}

impl Crowd {
    /// Returns the light of a frame.
    fn light(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        format: FilmFormat,
    ) -> Result<Vec<[f32; 4]>> {
        let pixels = SIZE.pixels();
        let mut found = vec![[0.0; 4]; pixels];
        if let Some(plan) = self.plan(compute, scene, None, format)? {
            let mut film = Film::in_format(compute, format, SIZE.width, SIZE.height)?;
            film.reserve_band(compute, pixels, 1)?;
            self.draw(compute, &plan, 0..pixels as u32, &mut film)?;
            film.read(compute, &mut found)?;
            self.settle(compute)?;
        }
        Ok(found)
    }
}

fn scene(profile: Profile, decay: Option<Decay>, has_ends: bool) -> Result<Scene> {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.3, -4.0, 0.5), DVec3::ZERO));
    scene.image = SIZE;
    scene.camera.fov_y = 22.0;
    scene.camera.ray_length = Some(7.0);
    scene.integration.measure = Measure::Length;
    scene.integration.antialias = Antialias::None;
    scene.integration.method = Method::exact(TOLERANCE);
    scene.decay = decay;
    // Evenly in a cube: multiples of powers of the root of x^4 = x + 1 (Roberts 2018).
    let root = 1.220_744_084_605_759_5_f64;
    let share = |k: u32, power: i32| 2.0 * (f64::from(k) * root.powi(-power)).fract() - 1.0;
    let place = |k: u32| DVec3::new(share(k, 1), share(k, 2), share(k, 3));
    let light = |k: u32| [1.0, 0.2 + 0.2 * (k % 5) as f32, 0.5];
    let (places, lights) = ((0..COUNT).map(place), (0..COUNT).map(light));
    let list = PointList::with_lights(places.collect(), lights.collect())?;
    let mut points = Points::new(list);
    (points.profile, points.coefficient) = (profile, 1e-4);
    scene.points.push(points);
    if has_ends {
        // Steps of the width of a few pixels, within the crowd, before it, and nowhere.
        let end = |k: usize| match (k / 7) % 4 {
            0 => f32::INFINITY,
            1 => 3.7,
            2 => 2.1,
            _ => 3.0 + 0.02 * (k % SIZE.width as usize) as f32,
        };
        let depths = (0..SIZE.pixels()).map(end).collect();
        scene.depth = Some(DepthImage::new(SIZE, DepthAlong::Axis, depths)?);
    }
    Ok(scene)
}

/// Says where light is not what it is to be.
fn difference(scene: &Scene, found: &[[f32; 4]]) -> Option<String> {
    let plane = scene.view_plane();
    let pixels: Vec<usize> = (0..found.len()).step_by(EVERY).collect();
    let ray = |index: &usize| plane.ray(*index as u32 % SIZE.width, *index as u32 / SIZE.width);
    let end = |index: &usize, ray: &Ray| {
        let depth = scene.depth.as_ref();
        depth.map_or(1.0, |it| plane.end(ray, it.as_slice()[*index], it.along()))
    };
    let up_to = |index: &usize| {
        let ray = ray(index);
        (ray, end(index, &ray))
    };
    let rays: Vec<(Ray, f64)> = pixels.iter().map(up_to).collect();
    for (index, light) in pixels.into_iter().zip(light_of_points_up_to(scene, &rays)) {
        for (found, expected) in found[index].iter().zip(light) {
            let is_right = (f64::from(*found) - expected).abs() <= LIMIT * expected;
            if !is_right {
                return Some(format!(
                    "the light of a crowd along ray {index} is {found}; it is {expected}"
                ));
            }
        }
    }
    None
}
