//! Where the sources of a group are put.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use crate::scene::values::{
    Checked, Fault, direction, finite, read_some_vector, read_vector, vector,
};

/// Copies that a group makes.
const MOST_COPIES: u32 = 10_000;

/// A turn about an axis through the origin.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// Of any length but zero.
    #[serde(deserialize_with = "read_vector")]
    pub axis: DVec3,
    /// Degrees, counterclockwise where the axis points at the viewer.
    pub angle: f64,
}

// What is read of `rotate`.
keys! { pub(in crate::scene) ROTATION_KEYS;
    axis: VECTOR, NONE, Required, "of any length but zero";
    angle: ANY, DEGREES, Required, "counterclockwise where the axis points at the viewer";
}

/// Copies of a group: number k, from 0 on, is turned by k times the angle about the axis through the group's origin,
/// then moved by k times the step.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Repeat {
    /// How many there are, 1 to 10000.
    pub count: u32,
    /// Degrees from one to the next; `None`: as many as share a full turn evenly. It needs an axis.
    #[serde(default)]
    pub angle: Option<f64>,
    /// Of any length but zero; `None`: they are not turned.
    #[serde(default, deserialize_with = "read_some_vector")]
    pub axis: Option<DVec3>,
    /// World units, in the group's own space.
    #[serde(default, deserialize_with = "read_vector")]
    pub step: DVec3,
}

// What is read of `repeat`.
keys! { pub(in crate::scene) REPEAT_KEYS;
    count: Whole(1, MOST_COPIES), NONE, Required, "how many copies there are";
    axis: VECTOR, NONE, Otherwise("not turned"), "copy k, from 0 on, is turned about it by k times the angle";
    angle: ANY, DEGREES, Otherwise("360 / count"), "from one copy to the next; needs an axis";
    step: VECTOR, WORLD, Value("[0, 0, 0]"), "copy k is then moved by k times this";
}

impl Repeat {
    /// Makes copies that share a full turn about an axis evenly.
    #[must_use]
    pub fn around(count: u32, axis: DVec3) -> Self {
        Self {
            count,
            angle: None,
            axis: Some(axis),
            step: DVec3::ZERO,
        }
    }

    /// Makes copies in a row.
    #[must_use]
    pub fn along(count: u32, step: DVec3) -> Self {
        Self {
            count,
            angle: None,
            axis: None,
            step,
        }
    }

    /// Returns where a copy is put.
    pub(super) fn placement(&self, copy: u32) -> Placement {
        let k = f64::from(copy);
        let angle = self.angle.unwrap_or(360.0 / f64::from(self.count));
        Placement {
            scale: 1.0,
            rotation: self
                .axis
                .map_or(DQuat::IDENTITY, |axis| turn(axis, k * angle)),
            translation: k * self.step,
        }
    }

    pub(super) fn check(&self) -> Checked {
        if !(1..=MOST_COPIES).contains(&self.count) {
            let message = format!("{} copies; give from 1 to {MOST_COPIES}", self.count);
            return Err(Fault::new("repeat.count", message));
        }
        vector("repeat.step", self.step)?;
        self.axis
            .map_or(Ok(()), |axis| direction("repeat.axis", axis))?;
        self.angle
            .map_or(Ok(()), |angle| finite("repeat.angle", angle))?;
        match (self.angle, self.axis) {
            (Some(_), None) => {
                let message = "an angle needs an axis: give one, such as axis = [0.0, 0.0, 1.0]";
                Err(Fault::new("repeat.angle", message))
            }
            (None, None) if self.step == DVec3::ZERO && self.count > 1 => {
                let message = "all copies would lie on each other: give an axis or a step";
                Err(Fault::new("repeat", message))
            }
            _ => Ok(()),
        }
    }
}

/// Where a source of a group is put: scaled, then rotated, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Placement {
    pub scale: f64,
    rotation: DQuat,
    translation: DVec3,
}

impl Placement {
    pub(super) const NONE: Self = Self {
        scale: 1.0,
        rotation: DQuat::IDENTITY,
        translation: DVec3::ZERO,
    };

    /// Makes that of a group.
    pub(in crate::scene) fn new(scale: f64, rotate: Option<Rotation>, translation: DVec3) -> Self {
        Self {
            scale,
            rotation: rotate.map_or(DQuat::IDENTITY, |it| turn(it.axis, it.angle)),
            translation,
        }
    }

    pub(crate) fn point(&self, point: DVec3) -> DVec3 {
        self.rotation * (self.scale * point) + self.translation
    }

    /// Turns a direction, whose length stays.
    pub(crate) fn direction(&self, direction: DVec3) -> DVec3 {
        self.rotation * direction
    }

    /// Puts what this puts by another.
    pub(super) fn then(&self, other: &Self) -> Self {
        Self {
            scale: other.scale * self.scale,
            rotation: other.rotation * self.rotation,
            translation: other.point(self.translation),
        }
    }
}

/// Makes the turn about an axis by an angle in degrees.
fn turn(axis: DVec3, degrees: f64) -> DQuat {
    DQuat::from_axis_angle(axis.normalize(), degrees.to_radians())
}
