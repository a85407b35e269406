//! The matrices of an engine as a camera: `clip = projection * view * point`, points as columns. A pixel's ray holds
//! all points that the matrices put at the pixel's x / w and y / w.
//!
//! Let m_x, m_y, m_z and m_w be the rows of the product. A perspective projection has its eye where m_x, m_y and m_w
//! give 0, looks along m_w, and sees from there `(m_x, m_y, m_w)^-1 (x, y, 1)`; an orthographic one looks along m_z.

use glam::{DMat3, DMat4, DVec3, Vec4Swizzles};

use crate::image::{ClipDepth, ClipRange, axis_of, check_matrix, rows};
use crate::scene::values::{Checked, Fault};

/// Where y points to in clip space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ClipY {
    /// To the top of the picture: OpenGL, Direct3D, Metal, WebGPU.
    Up,
    /// To its bottom: Vulkan.
    Down,
}

/// A view matrix and a projection, as engines have them, for points as columns: `projection * view * point`.
///
/// Perspective with any off-centre, or orthographic; left- or right-handed, normal or reversed z, the far plane
/// anywhere. World units are those of the points that the view matrix takes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CameraMatrices {
    /// From world space to view space: rotation, translation, and a scale that is the same along all axes.
    pub view: DMat4,
    /// From view space to clip space.
    pub projection: DMat4,
    /// The range of the depths of clip space; `None`: see [`ClipDepth::new`].
    pub range: Option<ClipRange>,
    /// Where y points to in clip space; `None`: down if the projection turns the view's y round, else up, so that the
    /// view's y points up in the picture.
    pub y: Option<ClipY>,
}

/// How far a view matrix may be off a rotation and a scale.
const ROUNDED: f64 = 1e-4;

/// What matrices see.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    /// World space. Of an orthographic camera the point of the middle ray that is level with the view's origin.
    pub eye: DVec3,
    /// The axis of view, of length 1.
    pub forward: DVec3,
    /// From the eye to the middle of the picture at distance 1 along the axis; all rays go there if they are parallel.
    pub middle: DVec3,
    /// From there to where x of clip space is 1, and to the top of the picture.
    pub right: DVec3,
    pub up: DVec3,
    pub is_parallel: bool,
}

impl CameraMatrices {
    /// Takes both matrices, and whatever else they leave open at its default.
    #[must_use]
    pub fn new(view: DMat4, projection: DMat4) -> Self {
        Self {
            view,
            projection,
            range: None,
            y: None,
        }
    }

    /// Returns what depths of clip space are along the axis of view, world units.
    ///
    /// # Errors
    /// As [`ClipDepth::new`].
    pub fn clip_depth(&self) -> crate::Result<ClipDepth> {
        let depth = ClipDepth::new(self.projection, self.range)?;
        Ok(depth.in_units(self.view_units()))
    }

    /// Returns the same, read with another range, or says why it cannot be.
    #[cfg(feature = "files")]
    pub(in crate::scene) fn read_clip(
        &self,
        range: Option<ClipRange>,
    ) -> Result<ClipDepth, String> {
        let depth = ClipDepth::read(self.projection, range.or(self.range))?;
        Ok(depth.in_units(self.view_units()))
    }

    /// Returns how many units of view space are one of world space.
    fn view_units(&self) -> f64 {
        DMat3::from_mat4(self.view).determinant().abs().cbrt()
    }

    pub(super) fn check(&self) -> Checked {
        let of_view = |message: String| Fault::new("view", message);
        check_matrix(&self.view).map_err(of_view)?;
        let turn = DMat3::from_mat4(self.view) * (1.0 / self.view_units());
        let is_turn = (turn * turn.transpose()).abs_diff_eq(DMat3::IDENTITY, ROUNDED);
        let [.., last] = rows(&self.view);
        if last.xyz() != DVec3::ZERO || last.w != 1.0 {
            return Err(of_view(format!(
                "its last row is {}, not 0 0 0 1: give it by rows, for columns as in `view * point`; is it transposed, \
                 or a product with the projection?",
                last.to_array().map(|value| value.to_string()).join(" ")
            )));
        }
        if !is_turn {
            let message = "it does more than rotate, move and scale alike along all axes: a view matrix has no shear";
            return Err(of_view(message.to_owned()));
        }
        ClipDepth::read(self.projection, self.range)
            .map(|_| ())
            .map_err(|message| Fault::new("projection", message))
    }

    /// Returns what the matrices see; `None` if they cannot be read.
    pub(super) fn sight(&self) -> Option<Sight> {
        let depth = ClipDepth::read(self.projection, self.range).ok()?;
        let [x, y, z, w] = rows(&(self.projection * self.view));
        let turn = DMat3::from_mat4(self.view);
        let forward = (turn.transpose() * axis_of(&self.projection, &depth)).normalize();
        let is_down = match self.y {
            Some(y) => y == ClipY::Down,
            None => match depth.is_orthographic() {
                true => self.projection.row(1).y / self.projection.row(3).w < 0.0,
                false => self.projection.row(1).y < 0.0,
            },
        };
        let up = if is_down { -1.0 } else { 1.0 };
        if depth.is_orthographic() {
            let [x, y, z] = [x, y, z].map(|row| row / w.w);
            let back = DMat3::from_cols(x.xyz(), y.xyz(), z.xyz())
                .transpose()
                .inverse();
            let level = self.projection.row(2).w / self.projection.row(3).w;
            let eye = back * (DVec3::new(0.0, 0.0, level) - DVec3::new(x.w, y.w, z.w));
            return Some(Sight {
                eye,
                forward,
                middle: forward,
                right: back.x_axis,
                up: up * back.y_axis,
                is_parallel: true,
            });
        }
        let back = DMat3::from_cols(x.xyz(), y.xyz(), w.xyz())
            .transpose()
            .inverse();
        let unit = w.xyz().length();
        Some(Sight {
            eye: back * -DVec3::new(x.w, y.w, w.w),
            forward,
            middle: unit * back.z_axis,
            right: unit * back.x_axis,
            up: up * unit * back.y_axis,
            is_parallel: false,
        })
    }
}
