//! The first use of a freshly built kernel: small volumes, stored and interpolated in either way, and one that is drawn
//! by bricks, whose light the reference integrates. Some drivers miscompile kernels.

use glam::DVec3;

use super::kernels::Form;
use super::{Textures, Turn};
use crate::error::{Error, Result};
use crate::image::ImageSize;
use crate::opencl::{Compute, Film, FilmFormat, Kernel, Program, RendererOptions};
use crate::reference;
use crate::scene::{Camera, Decay, Measure, Scene, Volume, VolumeInterpolation, VolumeMethod};
use crate::volume::{Storage, Texture};

/// No multiple of any number of lanes.
const SIZE: ImageSize = ImageSize {
    width: 11,
    height: 9,
};

const CELLS: [u32; 3] = [5, 4, 6];

/// Of a volume that is drawn by bricks.
const SMOOTH_CELLS: [u32; 3] = [33, 26, 24];

/// The error that light may have, of the brightest: what short pieces leave, and half floats.
const LIMIT: f32 = 5e-4;
const LIMIT_OF_HALVES: f32 = 2e-3;

/// Tests a kernel, unless that was done on this device before.
///
/// # Errors
/// [`Error::SelfTest`] if it computes wrong.
pub(super) fn self_test(
    compute: &Compute,
    form: Form,
    options: &RendererOptions,
    (kernel, program): (Kernel, &Program),
) -> Result<Kernel> {
    let is_experiment = options.skips_self_test || compute.device().is_simulator;
    if is_experiment || program.was_tested() {
        return Ok(kernel);
    }
    let mut tester = Textures::new(options);
    tester.kernels.insert(form, kernel);
    let turn = Turn {
        adds: false,
        is_unfinished: false,
    };
    let small = volumes()?.map(|volume| scene(volume, 0.05));
    for scene in small.into_iter().chain([scene(smooth()?, 1.0)]) {
        let plan = tester.prepare(compute, &scene, None, form)?;
        let pixels = SIZE.pixels();
        let mut film = Film::in_format(compute, form.0, SIZE.width, SIZE.height)?;
        film.reserve_band(compute, pixels, 1)?;
        tester.draw(compute, &plan, 0..pixels as u32, &mut film, turn)?;
        let mut found = vec![[0.0; 4]; pixels];
        film.read(compute, &mut found)?;
        tester.settle(compute)?;
        let expected = reference::render(&scene)?;
        if let Some(reason) = difference(&found, expected.as_slice(), form.0) {
            let device = compute.device();
            return Err(Error::SelfTest {
                device: device.name.clone(),
                driver: format!("{} {}", device.platform, device.driver),
                reason,
            });
        }
    }
    program.mark_tested();
    let lost = || Error::Unsupported("the kernel of volumes was lost in its test".to_owned());
    tester.kernels.remove(&form).ok_or_else(lost)
}

/// Makes one of emission, RGB and linear, and one of reciprocals, cubic.
fn volumes() -> Result<[Volume; 2]> {
    let count: u32 = CELLS.iter().product();
    let emission = (0..3 * count).map(|index| (index * 37 % 101) as f32 / 101.0);
    let emission = Texture::new(CELLS, emission.collect(), Storage::Emission)?;
    let [columns, rows, _] = CELLS;
    let distance2 = |index: u32| {
        let cell = [
            index % columns,
            index / columns % rows,
            index / columns / rows,
        ];
        DVec3::from(cell.map(f64::from)).distance_squared(DVec3::new(1.7, 1.2, 3.1)) as f32
    };
    let storage = Storage::Reciprocal { power: 2 };
    let reciprocals = Texture::new(CELLS, (0..count).map(distance2).collect(), storage)?;
    Ok([
        (emission, VolumeInterpolation::Linear),
        (reciprocals, VolumeInterpolation::Cubic),
    ]
    .map(|(texture, interpolation)| {
        let mut volume = Volume::new(texture);
        volume.size = DVec3::new(1.6, 1.9, 1.3);
        volume.rotation = DVec3::new(-20.0, 35.0, 70.0);
        volume.interpolation = interpolation;
        volume
    }))
}

/// Makes one that changes so little that steps are long, but for a lobe in a corner.
fn smooth() -> Result<Volume> {
    let [columns, rows, layers] = SMOOTH_CELLS;
    let light = |index: u32| {
        let cell = [
            index % columns,
            index / columns % rows,
            index / columns / rows,
        ];
        let [x, y, z] = cell.map(f64::from);
        let lobe = (-0.3 * DVec3::new(x - 30.0, y - 3.0, z - 3.0).length_squared()).exp();
        ((0.05 * x).sin() + 0.02 * y + (0.04 * z).cos() + lobe) as f32
    };
    let light = (0..columns * rows * layers).map(light).collect();
    let mut volume = Volume::new(Texture::new(SMOOTH_CELLS, light, Storage::Emission)?);
    volume.size = DVec3::new(1.9, 1.5, 1.4);
    volume.rotation = DVec3::new(10.0, -25.0, 40.0);
    Ok(volume)
}

fn scene(volume: Volume, step: f64) -> Scene {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.5, -4.0, 1.0), DVec3::ZERO));
    scene.image = SIZE;
    scene.camera.fov_y = 30.0;
    scene.integration.measure = Measure::Length;
    scene.integration.volumes = VolumeMethod::Ray { step };
    scene.decay = Some(Decay::new(0.5, 0.2));
    scene.volumes.push(volume);
    scene
}

/// Says where light is not what it is to be.
fn difference(found: &[[f32; 4]], expected: &[f32], format: FilmFormat) -> Option<String> {
    let expected = expected.as_chunks::<4>().0;
    let colors = expected.iter().flat_map(|pixel| &pixel[..3]);
    let most = colors.fold(0.0_f32, |most, it| most.max(*it));
    let limit = match format {
        FilmFormat::Floats | FilmFormat::Image { has_halves: false } => LIMIT,
        _ => LIMIT_OF_HALVES,
    };
    let is_right = |found: f32, expected: f32| (found - expected).abs() <= limit * most;
    let mut pixels = found.iter().zip(expected).enumerate();
    let wrong = pixels.find(|(_, (found, expected))| {
        !(0..3).all(|channel| is_right(found[channel], expected[channel]))
    });
    wrong.map(|(index, (found, expected))| {
        format!("the light of a volume along ray {index} is {found:?}; it is {expected:?}")
    })
}
