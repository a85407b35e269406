//! The first use of the freshly built kernels of light: a source of every kind, whose light the reference integrates by
//! another method. Some drivers miscompile kernels.

use glam::DVec3;

use super::Meshes;
use super::kernels::Shading;
use crate::error::{Error, Result};
use crate::opencl::{Compute, Program, RendererOptions};
use crate::reference;
use crate::scene::kinds::for_each_kind;
use crate::scene::{Camera, Lighting, Mesh, Profile, Scene, SourceKind, TriangleList};

/// The error that light may have, relative to it: what the kernel's rules leave where the horizon cuts a core.
const LIMIT: f64 = 5e-3;

macro_rules! define_specimens {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// Makes a scene with a source of each kind.
        fn specimens() -> Scene {
            let mut scene = Scene::new(Camera::new(-4.0 * DVec3::Y, DVec3::ZERO));
            let place = DVec3::new(0.2, -0.1, 0.3);
            $(scene.$list.push(<crate::scene::$Type as SourceKind>::specimen(place, Profile::InverseSquare));)*
            scene
        }
    };
}
for_each_kind!(define_specimens);

/// Makes a mesh above all that is tested.
fn hides_nothing() -> Result<Mesh> {
    let corners = [[0.0, 0.0, 8.0], [0.1, 0.0, 8.0], [0.0, 0.1, 8.0]];
    let triangles = TriangleList::new(corners.map(DVec3::from).to_vec(), vec![[0, 1, 2]])?;
    Ok(Mesh::new(triangles))
}

/// Points around the sources, each with its normal: some see all of a core, some a part of it.
fn places() -> (Vec<DVec3>, Vec<DVec3>) {
    let place = |k: u32| {
        let turn = 2.4 * f64::from(k);
        let height = f64::from(k % 5) - 2.0;
        let point = DVec3::new(2.5 * turn.cos(), 2.5 * turn.sin(), 0.8 * height);
        let normal = DVec3::new((1.7 * turn).sin(), 0.4 * height, (1.1 * turn).cos());
        (point, (normal - 0.5 * point).normalize())
    };
    (0..24).map(place).unzip()
}

/// Tests the kernels, unless that was done on this device before.
///
/// # Errors
/// [`Error::SelfTest`] if they compute wrong.
pub(super) fn shade_test(
    compute: &Compute,
    options: &RendererOptions,
    (shading, program, has_shadows): (Shading, &Program, bool),
) -> Result<Shading> {
    let is_experiment = options.skips_self_test || compute.device().is_simulator;
    if is_experiment || program.was_tested() {
        return Ok(shading);
    }
    let mut tester = Meshes::new(options);
    tester.shadings[usize::from(has_shadows)] = Some(shading);
    let mut scene = specimens();
    if has_shadows {
        scene.meshes.push(hides_nothing()?);
        scene.lighting = Some(Lighting {
            shadows: true,
            ..Lighting::default()
        });
    }
    let (points, normals) = places();
    let found = tester.irradiance(compute, &scene, &points, &normals)?;
    let expected = reference::irradiance(&scene, &points, &normals)?;
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        let most = expected.iter().copied().fold(0.0, f64::max);
        let mut pairs = found.iter().zip(expected);
        let is_right = |(a, b): (&f32, f64)| (f64::from(*a) - b).abs() <= LIMIT * most;
        if !pairs.all(is_right) {
            let device = compute.device();
            return Err(Error::SelfTest {
                device: device.name.clone(),
                driver: format!("{} {}", device.platform, device.driver),
                reason: format!(
                    "the light that cores cast on point {index} is {found:?}, not {expected:?}"
                ),
            });
        }
    }
    program.mark_tested();
    let lost = || Error::Unsupported("the kernels of light were lost in their test".to_owned());
    tester.shadings[usize::from(has_shadows)]
        .take()
        .ok_or_else(lost)
}
