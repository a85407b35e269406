//! Volumes of a scene: light that cells of a texture give off, in a box that may be turned.

use std::borrow::Cow;

use glam::{DMat3, DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::values::{Checked, Fault, LARGEST, finite, vector};
use super::{Reduction, Scene, ViewPlane};
use crate::error::SceneError;
use crate::volume::Texture;

/// How thick the plate of a billboard is, of its longer edge.
const THICKNESS: f64 = 1e-2;

/// How cells are interpolated.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum VolumeInterpolation {
    /// By the eight cells around a point.
    Linear,
    /// By 64 of them (Catmull, Rom 1974).
    #[default]
    Cubic,
}

/// What is drawn of a volume.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum VolumeShape {
    /// Its cells, where they are.
    #[default]
    Volume,
    /// One picture of them on a plate that always faces the view: what games had before, to compare with.
    Billboard,
}

/// A volume in a scene: what its cells give off, coefficient times colour times that of the texture. It hides nothing
/// and casts no light.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Volume {
    /// What its cells hold.
    pub texture: Texture,
    /// The middle of its box, world space.
    pub center: DVec3,
    /// The edges of its box, world units.
    pub size: DVec3,
    /// Turns about x, then y, then z through the middle, degrees.
    pub rotation: DVec3,
    /// What its light is multiplied with, 0 or more.
    pub coefficient: f64,
    /// Linear RGB, 0 or more.
    pub color: DVec3,
    /// How its cells are interpolated.
    pub interpolation: VolumeInterpolation,
    /// What is drawn of it.
    pub shape: VolumeShape,
    /// Its axes, where its rotation is not what says them.
    pub(super) turned: Option<DMat3>,
}

impl Volume {
    /// Makes a white one of coefficient 1: where its texture says, else a box about the origin whose longest edge is 2,
    /// of cubic cells.
    #[must_use]
    pub fn new(texture: Texture) -> Self {
        let cells = DVec3::from(texture.cells().map(f64::from));
        let [center, size] = texture
            .place()
            .unwrap_or([DVec3::ZERO, 2.0 / cells.max_element() * cells]);
        Self {
            texture,
            center,
            size,
            rotation: DVec3::ZERO,
            coefficient: 1.0,
            color: DVec3::ONE,
            interpolation: VolumeInterpolation::default(),
            shape: VolumeShape::default(),
            turned: None,
        }
    }

    /// Returns what is drawn from a view: of a billboard, a thin plate that faces it.
    fn as_seen(&self, plane: &ViewPlane) -> Cow<'_, Self> {
        if self.shape == VolumeShape::Volume {
            return Cow::Borrowed(self);
        }
        let (right, up) = (plane.column_step.normalize(), -plane.row_step.normalize());
        let thickness = THICKNESS * self.size.x.max(self.size.z);
        Cow::Owned(Self {
            texture: self.texture.picture().clone(),
            size: DVec3::new(self.size.x, thickness, self.size.z),
            coefficient: self.coefficient * self.size.y / thickness,
            shape: VolumeShape::Volume,
            turned: Some(DMat3::from_cols(right, up.cross(right), up)),
            ..self.clone()
        })
    }

    /// Returns what is drawn of all volumes of a scene from a view, each without a rest: that is drawn as another.
    pub(crate) fn all_as_seen(list: &[Self], plane: &ViewPlane) -> Vec<Self> {
        let mut seen = Vec::with_capacity(list.len());
        for volume in list {
            let volume = volume.as_seen(plane).into_owned();
            let rest = volume.texture.rest().map(|rest| Self {
                texture: rest.clone().in_color(volume.texture.color()),
                ..volume.clone()
            });
            seen.push(volume);
            seen.extend(rest);
        }
        seen
    }

    /// Returns whether it is the plate of a billboard, which slices may miss.
    pub(crate) fn is_plate(&self) -> bool {
        self.turned.is_some()
    }

    /// Returns what the light of its cells is multiplied with, linear RGB.
    pub(crate) fn emission(&self) -> DVec3 {
        self.coefficient * self.color * self.texture.color()
    }

    /// Returns the axes of its box in the world, as columns.
    pub(crate) fn axes(&self) -> DMat3 {
        if let Some(axes) = self.turned {
            return axes;
        }
        let [x, y, z] = self.rotation.to_array().map(f64::to_radians);
        let turn =
            DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x);
        DMat3::from_quat(turn)
    }

    /// Returns what takes a vector of the world to cells.
    pub(crate) fn to_cells(&self) -> DMat3 {
        let per_unit = DVec3::from(self.texture.cells().map(f64::from)) / self.size;
        DMat3::from_diagonal(per_unit) * self.axes().transpose()
    }

    /// Returns the radius of the ball around its box, world units.
    pub(crate) fn radius(&self) -> f64 {
        0.5 * self.size.length()
    }

    pub(super) fn check(&self) -> Checked {
        vector("center", self.center)?;
        vector("size", self.size)?;
        if self.size.min_element() < 1e-9 {
            let message = format!("{}; a box has edges above 0", self.size);
            return Err(Fault::new("size", message));
        }
        if self.center.abs().max_element() + self.radius() > LARGEST {
            return Err(Fault::new(
                "center",
                format!("the box lies beyond {LARGEST:e}"),
            ));
        }
        vector("rotation", self.rotation)?;
        finite("coefficient", self.coefficient)?;
        vector("color", self.color)?;
        vector("file", self.texture.color())?;
        for (key, least) in [
            ("coefficient", self.coefficient),
            ("color", self.color.min_element()),
            ("file", self.texture.color().min_element()),
        ] {
            if least < 0.0 {
                let message = format!("{least}; volumes take no light away: 0 or more");
                return Err(Fault::new(key, message));
            }
        }
        Ok(())
    }
}

impl Scene {
    pub(super) fn check_volumes(&self) -> Result<(), SceneError> {
        for (index, volume) in self.volumes.iter().enumerate() {
            let fault = |fault: Fault| fault.of(&format!("volume[{index}]"));
            volume.check().map_err(fault)?;
        }
        self.integration
            .volumes
            .check()
            .map_err(|fault| fault.of("integration"))?;
        if !self.volumes.is_empty() && self.integration.reduction != Reduction::Sum {
            let message = "the light of volumes adds up: write \"sum\", or leave the volumes out";
            return Err(SceneError::value("integration.reduction", message));
        }
        Ok(())
    }
}
