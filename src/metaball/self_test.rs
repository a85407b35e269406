//! The first use of freshly built kernels: a single particle, whose surface is a sphere that the host knows. Some
//! drivers miscompile kernels.

use glam::DVec3;

use super::Surfaces;
use super::kernels::Kernels;
use super::plan::Variant;
use crate::error::{Error, Result};
use crate::image::ImageSize;
use crate::opencl::{Compute, Program, RendererOptions};
use crate::scene::{
    Camera, MetaballKernel, MetaballMethod, MetaballSampling, Metaballs, PointList, Scene,
};

/// No multiple of a block or a square.
const SIZE: ImageSize = ImageSize {
    width: 39,
    height: 27,
};

/// The error that a length may have, radii: what float32 leaves of it; of samples, what one interpolation does.
const LIMIT: f64 = 1e-4;
const SAMPLED_LIMIT: f64 = 5e-3;

/// Rays that pass the sphere's edge within this share of its radius may meet it or not.
const EDGE: f64 = 0.02;

/// Tests kernels, unless that was done on this device before.
///
/// # Errors
/// [`Error::SelfTest`] if they compute wrong.
pub(super) fn self_test(
    compute: &Compute,
    variant: Variant,
    options: &RendererOptions,
    (kernels, program): (Kernels, &Program),
) -> Result<Kernels> {
    let is_experiment = options.skips_self_test || compute.device().is_simulator;
    if is_experiment || program.was_tested() {
        return Ok(kernels);
    }
    let mut tester = Surfaces::new(options);
    tester.kernels.insert(variant, kernels);
    for scene in scenes(variant)? {
        let metaballs = &scene.metaballs[0];
        let of_center = match metaballs.kernel {
            MetaballKernel::Cone => 1.0 - metaballs.threshold.sqrt(),
            MetaballKernel::Smooth => (1.0 - metaballs.threshold.cbrt()).sqrt(),
        };
        let sphere = (
            metaballs.points.positions()[0],
            metaballs.radius * of_center,
        );
        // The lists of the tester decide which program is asked for.
        let seen = tester.draw_as(compute, &scene, variant)?;
        if let Some(reason) = difference(&scene, sphere, &seen) {
            let device = compute.device();
            return Err(Error::SelfTest {
                device: device.name.clone(),
                driver: format!("{} {}", device.platform, device.driver),
                reason,
            });
        }
    }
    program.mark_tested();
    tester.kernels.remove(&variant).ok_or_else(|| {
        Error::Unsupported("the kernels of metaballs were lost in their test".to_owned())
    })
}

/// A particle before the eye for each kernel and method that the program has.
fn scenes(variant: Variant) -> Result<Vec<Scene>> {
    let center = DVec3::new(0.1, 0.2, -0.1);
    let mut metaballs = Metaballs::new(PointList::new(vec![center])?, 1.5);
    metaballs.threshold = 0.3;
    let kernels = [
        (variant.has_cones, MetaballKernel::Cone),
        (variant.has_smooth, MetaballKernel::Smooth),
    ];
    let sampling = MetaballMethod::Sampling(MetaballSampling {
        interval: Some(0.05),
        samples: 1000,
        refinements: 3,
    });
    let methods = [
        (true, MetaballMethod::Exact),
        (variant.has_sampling, sampling),
    ];
    let mut scenes = Vec::new();
    for kernel in kernels
        .into_iter()
        .filter_map(|(is_there, it)| is_there.then_some(it))
    {
        for method in methods
            .into_iter()
            .filter_map(|(is_there, it)| is_there.then_some(it))
        {
            let mut scene = Scene::new(Camera::new(DVec3::new(0.5, -4.0, 1.0), center));
            scene.image = SIZE;
            metaballs.kernel = kernel;
            metaballs.method = method;
            scene.metaballs.push(metaballs.clone());
            scenes.push(scene);
        }
    }
    Ok(scenes)
}

/// Says where lengths are not those up to a sphere.
fn difference(scene: &Scene, (center, radius): (DVec3, f64), lengths: &[f32]) -> Option<String> {
    let plane = scene.view_plane();
    let metaballs = &scene.metaballs[0];
    let limit = match metaballs.method {
        MetaballMethod::Exact => LIMIT,
        MetaballMethod::Sampling(_) => SAMPLED_LIMIT,
    };
    for (index, &found) in lengths.iter().enumerate() {
        let (column, row) = (index as u32 % SIZE.width, index as u32 / SIZE.width);
        let direction = plane.ray(column, row).span.normalize();
        let closest = (center - plane.eye).dot(direction);
        let beside = (center - plane.eye - closest * direction).length() / radius;
        let is_right = match found.is_finite() {
            _ if (beside - 1.0).abs() < EDGE => true,
            true => {
                let expected = closest - radius * (1.0 - beside * beside).max(0.0).sqrt();
                beside < 1.0 && (f64::from(found) - expected).abs() < limit * metaballs.radius
            }
            false => beside > 1.0,
        };
        if !is_right {
            return Some(format!(
                "the length of ray {index} up to the sphere of a particle is {found}, and it passes {beside} of its \
                 radius from the middle"
            ));
        }
    }
    None
}

impl Surfaces {
    /// Draws by the kernels of a program that may do more than the scene needs.
    fn draw_as(&mut self, compute: &Compute, scene: &Scene, variant: Variant) -> Result<Vec<f32>> {
        let seen = self.draw_by(compute, scene, 1, Some(variant))?;
        Ok(seen.depth.as_slice().to_vec())
    }
}
