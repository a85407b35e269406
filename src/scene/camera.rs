//! The camera.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::values::{Checked, Fault, SMALLEST, direction, finite, positive, read_vector, vector};

/// A pinhole camera and the length of its rays.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Position of the eye.
    #[serde(deserialize_with = "read_vector")]
    pub eye: DVec3,
    /// The point looked at, in the middle of the image.
    #[serde(deserialize_with = "read_vector")]
    pub target: DVec3,
    /// The direction that is up in the image; need not be perpendicular to the view.
    #[serde(default = "plus_z", deserialize_with = "read_vector")]
    pub up: DVec3,
    /// Full vertical angle of view, degrees.
    #[serde(default = "default_fov_y")]
    pub fov_y: f64,
    /// Distance from the eye to the projection plane, where the rays begin, world units.
    #[serde(default = "default_near")]
    pub near: f64,
    /// Length of every ray, `|E - S|`, world units; `None`: one that passes all sources
    /// ([`Scene::ray_length`](super::Scene::ray_length)).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ray_length: Option<f64>,
}

// What is read of `[camera]`.
keys! { pub(super) CAMERA_KEYS;
    eye: VECTOR, WORLD, Required, "position of the eye";
    target: VECTOR, WORLD, Required, "the point looked at, in the middle of the image";
    up: VECTOR, NONE, Value("[0, 0, 1]"), "up in the image; need not be perpendicular to the view";
    fov_y: from_to(0.001, 179.9), DEGREES, Value("45"), "full vertical angle of view";
    near: POSITIVE, WORLD, Value("1"), "from the eye to the projection plane, where rays begin";
    ray_length: POSITIVE, WORLD, Otherwise("past all sources"), "the length of every ray";
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
        }
    }

    pub(super) fn check(&self) -> Checked {
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
        self.ray_length
            .map_or(Ok(()), |length| positive("ray_length", length))
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
