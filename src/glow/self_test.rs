//! The first use of a freshly built kernel: a ball and a streak, whose light the host sums by the middles of many
//! stretches of each ray. Some drivers miscompile kernels.

use glam::DVec3;

use super::{Glow, GlowPlan};
use crate::error::{Error, Result};
use crate::image::ImageSize;
use crate::opencl::{Compute, Film, FilmFormat, Kernel, Program, RendererOptions};
use crate::scene::{Camera, Decay, LightElement, Measure, Scene};

/// No multiple of a block or a tile.
const SIZE: ImageSize = ImageSize {
    width: 39,
    height: 27,
};

/// The error that light may have, of the brightest: what sums of middles leave, and half floats.
const LIMIT: f64 = 2e-5;
const LIMIT_OF_HALVES: f64 = 1e-3;

/// Stretches of a ray.
const STRETCHES: u32 = 2000;

/// Tests a kernel, unless that was done on this device before.
///
/// # Errors
/// [`Error::SelfTest`] if it computes wrong.
pub(super) fn self_test(
    compute: &Compute,
    format: FilmFormat,
    options: &RendererOptions,
    (kernel, program): (Kernel, &Program),
) -> Result<Kernel> {
    let is_experiment = options.skips_self_test || compute.device().is_simulator;
    if is_experiment || program.was_tested() {
        return Ok(kernel);
    }
    let mut tester = Glow::new(options);
    tester.kernels.insert(format, kernel);
    for decay in [None, Some(Decay::new(0.5, 0.05))] {
        let scene = scene(decay);
        let plan = GlowPlan::Picture(tester.prepare(compute, &scene, None, format)?);
        let pixels = SIZE.pixels();
        let mut film = Film::in_format(compute, format, SIZE.width, SIZE.height)?;
        film.reserve_band(compute, pixels, 1)?;
        tester.draw(compute, &plan, 0..pixels as u32, &mut film)?;
        let mut found = vec![[0.0; 4]; pixels];
        film.read(compute, &mut found)?;
        tester.settle(compute)?;
        expect_right(compute, &scene, &found, format)?;
    }
    program.mark_tested();
    tester.kernels.remove(&format).ok_or_else(|| {
        Error::Unsupported("the kernel of particles was lost in its test".to_owned())
    })
}

/// Tests the kernel that integrates along listed rays, here those of the pixels, unless that was done on this device
/// before.
///
/// # Errors
/// [`Error::SelfTest`] if it computes wrong.
pub(super) fn test_along(
    compute: &Compute,
    options: &RendererOptions,
    (kernel, program): (Kernel, &Program),
) -> Result<Kernel> {
    let is_experiment = options.skips_self_test || compute.device().is_simulator;
    if is_experiment || program.was_tested() {
        return Ok(kernel);
    }
    let mut tester = Glow::new(options);
    tester.along.kernel = Some(kernel);
    for decay in [None, Some(Decay::new(0.5, 0.05))] {
        let scene = scene(decay);
        let plane = scene.view_plane();
        let pixels = 0..SIZE.pixels() as u32;
        let through = |index: u32| plane.ray(index % SIZE.width, index / SIZE.width);
        let rays: Vec<_> = pixels.clone().map(through).collect();
        let plan = GlowPlan::Rays(tester.along.prepare(compute, &scene, &rays)?);
        let mut film = Film::in_format(compute, FilmFormat::Floats, SIZE.width, SIZE.height)?;
        film.reserve_band(compute, rays.len(), 1)?;
        tester.draw(compute, &plan, pixels, &mut film)?;
        let mut found = vec![[0.0; 4]; rays.len()];
        film.read(compute, &mut found)?;
        tester.settle(compute)?;
        let measure = scene.integration.scale(plane.ray_length) as f32;
        let found: Vec<_> = found.iter().map(|it| it.map(|it| measure * it)).collect();
        expect_right(compute, &scene, &found, FilmFormat::Floats)?;
    }
    program.mark_tested();
    tester.along.kernel.ok_or_else(|| {
        Error::Unsupported("the kernel of particles along rays was lost in its test".to_owned())
    })
}

/// # Errors
/// [`Error::SelfTest`] if light is not what it is to be.
fn expect_right(
    compute: &Compute,
    scene: &Scene,
    found: &[[f32; 4]],
    format: FilmFormat,
) -> Result<()> {
    let device = compute.device();
    let wrong = |reason| Error::SelfTest {
        device: device.name.clone(),
        driver: format!("{} {}", device.platform, device.driver),
        reason,
    };
    difference(scene, found, format).map_or(Ok(()), |reason| Err(wrong(reason)))
}

const CENTER: DVec3 = DVec3::new(-0.4, 0.2, -0.1);
const RADIUS: f64 = 0.8;
const ENDS: [DVec3; 2] = [DVec3::new(0.1, -0.5, 0.5), DVec3::new(1.3, 0.8, 0.0)];
const THICK: f64 = 0.5;
const THIN: f64 = 0.3;

fn scene(decay: Option<Decay>) -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.5, -4.0, 1.0), DVec3::ZERO));
    scene.image = SIZE;
    scene.camera.ray_length = Some(6.0);
    scene.integration.measure = Measure::Length;
    scene.decay = decay;
    scene.light_elements.push(LightElement::Ball {
        center: CENTER,
        radius: RADIUS,
        light: DVec3::X,
    });
    scene.light_elements.push(LightElement::Streak {
        ends: ENDS,
        radii: [THICK, 0.5 * (THICK + THIN), THIN],
        light: DVec3::Y,
    });
    scene
}

/// Returns the light of ball and streak at a point.
fn light_at(place: DVec3) -> [f64; 2] {
    let axis = ENDS[1] - ENDS[0];
    let share = ((place - ENDS[0]).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
    let away = place.distance(ENDS[0] + share * axis);
    let of = |distance: f64, radius: f64| (1.0 - distance / radius).max(0.0).powi(2);
    [
        of(place.distance(CENTER), RADIUS),
        of(away, THICK + share * (THIN - THICK)),
    ]
}

/// Says where light is not what it is to be.
fn difference(scene: &Scene, found: &[[f32; 4]], format: FilmFormat) -> Option<String> {
    let plane = scene.view_plane();
    let expected = |index: usize| {
        let ray = plane.ray(index as u32 % SIZE.width, index as u32 / SIZE.width);
        let step = 1.0 / f64::from(STRETCHES);
        let mut sums = [0.0; 2];
        for stretch in 0..STRETCHES {
            let s = (f64::from(stretch) + 0.5) * step;
            let left = scene.decay.map_or(1.0, |decay| decay.at(s));
            let light = light_at(ray.at(s));
            (0..2).for_each(|it| sums[it] += step * plane.ray_length * left * light[it]);
        }
        sums
    };
    let all: Vec<[f64; 2]> = (0..found.len()).map(expected).collect();
    let most = all.as_flattened().iter().copied().fold(0.0, f64::max);
    let limit = match format {
        FilmFormat::Floats | FilmFormat::Image { has_halves: false } => LIMIT,
        _ => LIMIT_OF_HALVES,
    };
    for (index, (found, expected)) in found.iter().zip(&all).enumerate() {
        for (channel, expected) in expected.iter().enumerate() {
            let found = f64::from(found[channel]);
            let is_right = (found - expected).abs() <= limit * most;
            if !is_right {
                let what = ["a ball", "a streak"][channel];
                return Some(format!(
                    "the light of {what} along ray {index} is {found}; it is {expected}"
                ));
            }
        }
    }
    None
}
