//! The first use of the freshly built kernel: a source of every kind, whose light the reference integrates by another
//! method. Some drivers miscompile kernels.

use glam::DVec3;

use super::points::PointLighter;
use crate::error::{Error, Result};
use crate::opencl::{Compute, Program};
use crate::reference;
use crate::scene::kinds::for_each_kind;
use crate::scene::{Camera, Profile, Scene, SourceKind};

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

/// Tests the kernel, unless that was done on this device before.
///
/// # Errors
/// [`Error::SelfTest`] if it computes wrong.
pub(super) fn self_test(
    lighter: &mut PointLighter,
    compute: &Compute,
    program: &Program,
) -> Result<()> {
    if !lighter.is_tested(compute) || program.was_tested() {
        return Ok(());
    }
    let scene = specimens();
    let (points, normals) = places();
    let found = lighter.light(compute, &scene, &points, &normals)?;
    let expected = reference::irradiance(&scene, &points, &normals)?;
    for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
        let most = expected.iter().copied().fold(0.0, f64::max);
        let off = found
            .iter()
            .zip(expected)
            .map(|(a, b)| (f64::from(*a) - b).abs());
        let off = off.fold(0.0, |most: f64, off| if off <= most { most } else { off });
        if off.is_nan() || off > LIMIT * most {
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
    Ok(())
}
