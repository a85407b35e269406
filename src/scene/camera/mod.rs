//! The camera: a pinhole that looks at a point, or the matrices of an engine.

mod matrices;
mod table;

use glam::{DMat4, DVec2, DVec3};
use serde::{Deserialize, Serialize};

pub use matrices::{CameraMatrices, ClipY};

use super::values::{Checked, Fault, SMALLEST, direction, finite, positive, vector};
use crate::image::{ClipRange, ImageSize};
#[cfg(feature = "files")]
pub(super) use table::CAMERA_KEYS;
use table::CameraTable;
#[cfg(feature = "files")]
pub(super) use table::{read_matrix, write_matrix};

/// A camera and the length of its rays: a pinhole at `eye` that looks at `target`, or whatever `matrices` project.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "CameraTable", into = "CameraTable")]
pub struct Camera {
    /// Position of the eye.
    pub eye: DVec3,
    /// The point looked at, in the middle of the image.
    pub target: DVec3,
    /// The direction that is up in the image; need not be perpendicular to the view.
    pub up: DVec3,
    /// Full vertical angle of view, degrees.
    pub fov_y: f64,
    /// Distance from the eye, along the axis of view, to the projection plane, where the rays begin, world units. Of an
    /// orthographic camera it may be negative.
    pub near: f64,
    /// Length of every ray, `|E - S|`, world units; `None`: one that passes all sources
    /// ([`Scene::ray_length`](super::Scene::ray_length)).
    pub ray_length: Option<f64>,
    /// Where in its pixel each ray passes, from the pixel's centre to the right and down, pixels: -1 to 1.
    pub jitter: DVec2,
    /// What projects in the place of `eye`, `target`, `up` and `fov_y`, which then nobody looks at.
    pub matrices: Option<CameraMatrices>,
}

/// Where the rays of a camera begin, for pixels of an image.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// World space.
    pub eye: DVec3,
    /// The axis of view, of length 1.
    pub forward: DVec3,
    /// From the eye to the centre of the pixel in column 0, row 0.
    pub first_pixel: DVec3,
    pub column_step: DVec3,
    pub row_step: DVec3,
    pub is_parallel: bool,
}

impl Camera {
    /// Makes a camera at `eye` that looks at `target`: +z up, 45 degrees, projection plane at 1.
    #[must_use]
    pub fn new(eye: DVec3, target: DVec3) -> Self {
        Self {
            eye,
            target,
            up: plus_z(),
            fov_y: default_fov_y(),
            near: default_near(),
            ray_length: None,
            jitter: DVec2::ZERO,
            matrices: None,
        }
    }

    /// Makes a camera of an engine's matrices, for points as columns (`projection * view * point`): perspective or
    /// orthographic, as [`CameraMatrices`] says. Rays begin at the near plane: where depths of clip space are least, or
    /// greatest with reversed z. Matrices that cannot be read are a fault of the scene ([`super::Scene::validate`]).
    ///
    /// A matrix cannot tell in every case whether its depths go from 0 or from -1 to 1, see
    /// [`ClipDepth::new`](crate::image::ClipDepth::new): for OpenGL's use [`Camera::from_clip`].
    #[must_use]
    pub fn from_matrices(view: DMat4, projection: DMat4) -> Self {
        Self::projecting(CameraMatrices::new(view, projection))
    }

    /// Makes a camera as [`Camera::from_matrices`] does, of matrices whose depths have this range.
    #[must_use]
    pub fn from_clip(view: DMat4, projection: DMat4, range: ClipRange) -> Self {
        Self::projecting(CameraMatrices {
            range: Some(range),
            ..CameraMatrices::new(view, projection)
        })
    }

    /// Makes a camera whose rays begin at the near plane of matrices.
    fn projecting(matrices: CameraMatrices) -> Self {
        Self {
            near: matrices
                .clip_depth()
                .map_or(default_near(), |depth| depth.near()),
            matrices: Some(matrices),
            ..Self::new(DVec3::ZERO, -DVec3::Z)
        }
    }

    /// Returns where the rays of an image's pixels begin.
    pub(super) fn grid(&self, image: ImageSize) -> Grid {
        let (width, height) = (f64::from(image.width), f64::from(image.height));
        let mut grid = match self.matrices.and_then(|matrices| matrices.sight()) {
            Some(sight) => {
                let scale = if sight.is_parallel { 1.0 } else { self.near };
                let right = scale * sight.right;
                let up = scale * sight.up;
                let corner = right * (1.0 / width - 1.0) + up * (1.0 - 1.0 / height);
                Grid {
                    eye: sight.eye,
                    forward: sight.forward,
                    first_pixel: self.near * sight.middle + corner,
                    column_step: right * (2.0 / width),
                    row_step: up * (-2.0 / height),
                    is_parallel: sight.is_parallel,
                }
            }
            None => self.looking_grid(image),
        };
        if self.jitter != DVec2::ZERO {
            grid.first_pixel += self.jitter.x * grid.column_step + self.jitter.y * grid.row_step;
        }
        grid
    }

    fn looking_grid(&self, image: ImageSize) -> Grid {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(self.up).normalize();
        let up = right.cross(forward);
        let half_height = self.near * (self.fov_y.to_radians() / 2.0).tan();
        let pixel = 2.0 * half_height / f64::from(image.height);
        let middle_column = (f64::from(image.width) - 1.0) / 2.0;
        let middle_row = (f64::from(image.height) - 1.0) / 2.0;
        let column_step = right * pixel;
        let row_step = -up * pixel;
        Grid {
            eye: self.eye,
            forward,
            first_pixel: forward * self.near - column_step * middle_column - row_step * middle_row,
            column_step,
            row_step,
            is_parallel: false,
        }
    }

    /// Returns position and axis of view, world space.
    pub(super) fn eye_and_axis(&self) -> (DVec3, DVec3) {
        match self.matrices.and_then(|matrices| matrices.sight()) {
            Some(sight) => (sight.eye, sight.forward),
            None => (self.eye, (self.target - self.eye).normalize()),
        }
    }

    /// Returns how high the picture is so far from the eye, world units.
    pub(super) fn height_at(&self, distance: f64) -> f64 {
        match self.matrices.and_then(|matrices| matrices.sight()) {
            Some(sight) if sight.is_parallel => 2.0 * sight.up.length(),
            Some(sight) => 2.0 * distance * sight.up.length(),
            None => 2.0 * distance * (0.5 * self.fov_y.to_radians()).tan(),
        }
    }

    /// Returns the least side of a pixel at distance 1 along the axis of view, world units, and whether it is that
    /// everywhere.
    pub(crate) fn pixel_at_1(&self, image: ImageSize) -> (f64, bool) {
        let (width, height) = (f64::from(image.width), f64::from(image.height));
        match self.matrices.and_then(|matrices| matrices.sight()) {
            Some(sight) => {
                let (across, down) = (sight.right.length() / width, sight.up.length() / height);
                (2.0 * across.min(down), sight.is_parallel)
            }
            None => (self.height_at(1.0) / height, false),
        }
    }

    pub(super) fn check(&self) -> Checked {
        match &self.matrices {
            Some(matrices) => self.check_matrices(matrices)?,
            None => self.check_look()?,
        }
        let strays = |pixels: &f64| !(-1.0..=1.0).contains(pixels);
        if let Some(pixels) = self.jitter.to_array().into_iter().find(strays) {
            let message = format!("{pixels}: a jitter stays within a pixel, -1 to 1");
            return Err(Fault::new("jitter", message));
        }
        self.ray_length
            .map_or(Ok(()), |length| positive("ray_length", length))
    }

    fn check_matrices(&self, matrices: &CameraMatrices) -> Checked {
        matrices.check()?;
        let Some(sight) = matrices.sight() else {
            return Ok(());
        };
        match sight.is_parallel {
            true => finite("near", self.near)?,
            false => positive("near", self.near)?,
        }
        let lengths = [sight.eye, sight.middle, sight.right, sight.up];
        match lengths.iter().all(|v| vector("view", *v).is_ok()) {
            true => Ok(()),
            false => {
                let message = "it sees what is beyond 1e9, what float32 devices can integrate: see to its numbers";
                Err(Fault::new("projection", message))
            }
        }
    }

    fn check_look(&self) -> Checked {
        vector("eye", self.eye)?;
        vector("target", self.target)?;
        direction("up", self.up)?;
        finite("fov_y", self.fov_y)?;
        if !(0.001..=179.9).contains(&self.fov_y) {
            let message = "must lie between 0.001 and 179.9 degrees";
            return Err(Fault::new("fov_y", message));
        }
        positive("near", self.near)?;
        let view = self.target - self.eye;
        if view.length() < SMALLEST {
            let message = "the same point as camera.eye: there is no view direction";
            return Err(Fault::new("target", message));
        }
        if view.normalize().cross(self.up.normalize()).length() < 1e-6 {
            return Err(Fault::new("up", self.parallel_up(view)));
        }
        Ok(())
    }

    /// Says that `up` is parallel to the view, and which would not be; scenes often leave it out.
    fn parallel_up(&self, view: DVec3) -> String {
        let other = match view.normalize().z.abs() > 0.7 {
            true => "[0.0, 1.0, 0.0]",
            false => "[0.0, 0.0, 1.0]",
        };
        let default = match self.up == plus_z() {
            true => "[0, 0, 1], the default, is ",
            false => "",
        };
        format!("{default}parallel to the view direction; write another, such as up = {other}")
    }
}

fn default_fov_y() -> f64 {
    45.0
}

fn default_near() -> f64 {
    1.0
}

fn plus_z() -> DVec3 {
    DVec3::Z
}
