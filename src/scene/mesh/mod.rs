//! Meshes: triangles that hide the light behind them. They are no sources. What a mesh is made of is shared by its
//! clones and never changes, so that scenes with a million triangles are copied, compared and moved at once.

#[cfg(feature = "files")]
mod buffers;
#[cfg(feature = "files")]
mod file;
#[cfg(feature = "files")]
mod gltf;
mod halves;
mod list;
#[cfg(feature = "files")]
mod obj;

use glam::DVec3;

#[cfg(feature = "files")]
pub(super) use gltf::buffer_files;
pub(crate) use halves::{Halves, Triangle};
pub use list::TriangleList;

use super::group::{Placement, Rotation};
use super::values::{Checked, Fault, LARGEST, direction, finite, positive, vector};

/// A surface of triangles, seen from both sides. What lies behind it is hidden.
///
/// ```
/// use energywave::glam::DVec3;
/// use energywave::scene::{Mesh, TriangleList};
///
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
/// let mesh = Mesh::new(TriangleList::new(corners, vec![[0, 1, 2]])?);
/// assert_eq!(mesh.triangles.len(), 1);
/// # Ok::<(), energywave::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Its corners and triangles, in a space of their own.
    pub triangles: TriangleList,
    /// What all positions are multiplied with; positive.
    pub scale: f64,
    /// A turn about the origin, after the scale.
    pub rotate: Option<Rotation>,
    /// Where the origin is put, after the turn; world units.
    pub translate: DVec3,
    /// The share of light that it throws back, linear RGB, 0 to 1.
    pub albedo: DVec3,
}

/// The albedo of a mesh that names none.
pub(super) const ALBEDO: DVec3 = DVec3::splat(0.8);

impl Mesh {
    /// Makes a grey mesh that stands where its positions say.
    #[must_use]
    pub fn new(triangles: TriangleList) -> Self {
        Self {
            triangles,
            scale: 1.0,
            rotate: None,
            translate: DVec3::ZERO,
            albedo: ALBEDO,
        }
    }

    /// Returns its vertices where they are put, world space.
    pub(crate) fn placed_vertices(&self) -> Vec<DVec3> {
        let place = Placement::new(self.scale, self.rotate, self.translate);
        let vertices = self.triangles.vertices().iter();
        vertices.map(|vertex| place.point(*vertex)).collect()
    }

    pub(super) fn check(&self) -> Checked {
        if self.triangles.is_empty() {
            let message = "it has no triangle: give `vertices` and `triangles`, or a `file`";
            return Err(Fault::new("triangles", message));
        }
        positive("scale", self.scale)?;
        vector("translate", self.translate)?;
        if let Some(rotation) = &self.rotate {
            direction("rotate.axis", rotation.axis)?;
            finite("rotate.angle", rotation.angle)?;
        }
        vector("albedo", self.albedo)?;
        if self.albedo.min_element() < 0.0 || self.albedo.max_element() > 1.0 {
            let message = "a surface throws back no less than nothing and no more than all: 0 to 1";
            return Err(Fault::new("albedo", message));
        }
        let (low, high) = self.triangles.bounds();
        let far = self.scale * low.abs().max(high.abs()).length();
        if far + self.translate.abs().max_element() > LARGEST {
            let message = format!("it moves corners beyond {LARGEST:e}");
            return Err(Fault::new("translate", message));
        }
        Ok(())
    }
}
