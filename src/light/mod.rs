//! The light that waves cast on surfaces.
//!
//! Cores emit light evenly in all directions, a point its intensity I, every other core one per length, I': a place P
//! of a surface with the normal n has the irradiance `integral over all cores of I' max(0, n.y) / |y|^3`, y from P to
//! the core. [`Lighting`](crate::scene::Lighting) says how; what intensity a coefficient stands for, docs/method.md.

mod lights;
pub(crate) mod pack;
mod proxies;
mod sources;

pub(crate) use lights::{Lights, definitions};
pub use proxies::{CapsuleLight, proxies};
pub(crate) use sources::LIGHT_FILES;

use glam::DVec3;

use crate::Device;
use crate::Renderer;
use crate::error::Result;
use crate::scene::Scene;

/// Returns the irradiance, linear RGB, of points of surfaces with these normals, of any length but zero, as the best
/// device finds it: see [`Renderer::irradiance`], which keeps what it built.
///
/// # Errors
/// As there, and as [`Device::best`].
pub fn irradiance(scene: &Scene, points: &[DVec3], normals: &[DVec3]) -> Result<Vec<[f32; 3]>> {
    Renderer::new(&Device::best()?)?.irradiance(scene, points, normals)
}
