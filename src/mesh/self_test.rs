//! The first use of freshly built kernels: a square across the view, whose lengths the host knows. Some drivers
//! miscompile kernels.

use glam::DVec3;

use super::Meshes;
use super::kernels::Kernels;
use crate::error::{Error, Result};
use crate::image::ImageSize;
use crate::opencl::{Compute, Program, RendererOptions};
use crate::scene::{Camera, Mesh, Scene, TriangleList};

/// No multiple of a block.
const SIZE: ImageSize = ImageSize {
    width: 39,
    height: 27,
};

/// Rays across a pixel.
const ACROSS: u32 = 2;

/// The error that a length may have: what float32 leaves of it.
const LIMIT: f64 = 1e-5;

/// Tests kernels, unless that was done on this device before.
///
/// # Errors
/// [`Error::SelfTest`] if they compute wrong.
pub(super) fn self_test(
    compute: &Compute,
    options: &RendererOptions,
    (kernels, program): (Kernels, &Program),
) -> Result<Kernels> {
    let is_experiment = options.skips_self_test || compute.device().is_simulator;
    if is_experiment || program.was_tested() {
        return Ok(kernels);
    }
    let mut scene = Scene::new(Camera::new(DVec3::new(0.1, -4.0, 0.3), DVec3::ZERO));
    scene.image = SIZE;
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let corners = corners.map(|[x, z]| DVec3::new(x, 0.5 * x, z)).to_vec();
    let square = TriangleList::new(corners, vec![[0, 1, 2], [0, 2, 3]])?;
    scene.meshes.push(Mesh::new(square));
    let mut tester = Meshes::new(options);
    tester.kernels = Some(kernels);
    let depth = tester.trace(compute, &scene, ACROSS)?;
    let light = tester.shade(compute, &scene, &depth)?;
    if let Some(reason) = difference(&scene, depth.as_slice(), &light) {
        let device = compute.device();
        return Err(Error::SelfTest {
            device: device.name.clone(),
            driver: format!("{} {}", device.platform, device.driver),
            reason,
        });
    }
    program.mark_tested();
    let lost = || Error::Unsupported("the kernels of meshes were lost in their test".to_owned());
    tester.kernels.take().ok_or_else(lost)
}

/// Says where lengths are not those up to the square, or light is not where it is.
fn difference(scene: &Scene, lengths: &[f32], light: &[f32]) -> Option<String> {
    let (grid, plane) = scene.ray_grid(ACROSS);
    let normal = DVec3::new(-0.5, 1.0, 0.0);
    for (index, &found) in lengths.iter().enumerate() {
        let (column, row) = (index as u32 % grid.width, index as u32 / grid.width);
        let direction = plane.ray(column, row).span.normalize();
        let expected = -plane.eye.dot(normal) / direction.dot(normal);
        let place = plane.eye + expected * direction;
        let beside = place.x.abs().max(place.z.abs());
        let is_right = match found.is_finite() {
            _ if (beside - 1.0).abs() < 1e-4 => true,
            true => beside < 1.0 && (f64::from(found) / expected - 1.0).abs() < LIMIT,
            false => beside > 1.0,
        };
        let pixel = (row / ACROSS * SIZE.width + column / ACROSS) as usize;
        let is_lit = light[4 * pixel] > 0.0 || !found.is_finite();
        if !is_right || !is_lit {
            return Some(format!(
                "the length of ray {index} up to a square is {found}, with light {}, and should be {expected}, at \
                 {beside} of the way from its middle to its edge",
                light[4 * pixel]
            ));
        }
    }
    None
}
