//! What waves of particles hit: solids whose surface is a formula, and meshes.

use glam::DVec3;

use crate::scene::values::{Checked, Fault, direction, finite, positive, vector};
use crate::scene::{Mesh, Rotation};

/// A solid that waves of particles hit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Collider {
    /// What it is.
    pub shape: ColliderShape,
    /// Whether it is seen.
    pub visible: bool,
    /// Linear RGB, where it is seen; in files also `"#rrggbb"`, sRGB.
    pub color: DVec3,
}

/// What a [`Collider`] is.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ColliderShape {
    /// A box.
    Box {
        /// Its middle.
        center: DVec3,
        /// Half of its edges along its own axes, world units, positive.
        half: DVec3,
        /// A turn about its middle; `None`: its edges lie along the axes of the world.
        rotation: Option<Rotation>,
    },
    /// A ball.
    Sphere {
        /// Its middle.
        center: DVec3,
        /// World units, positive.
        radius: f64,
    },
    /// All that lies behind a plane.
    Plane {
        /// A point of the plane.
        point: DVec3,
        /// Where it faces, of any length but zero.
        normal: DVec3,
    },
    /// Triangles, which are hit from both sides. Where it is seen, the collider's colour takes the place of its albedo,
    /// 0 to 1.
    Mesh(Mesh),
}

impl Collider {
    /// Makes one that is seen.
    #[must_use]
    pub fn new(shape: ColliderShape) -> Self {
        Self {
            shape,
            visible: true,
            color: GRAY,
        }
    }

    /// Makes a box along the axes of the world.
    #[must_use]
    pub fn new_box(center: DVec3, half: DVec3) -> Self {
        Self::new(ColliderShape::Box {
            center,
            half,
            rotation: None,
        })
    }

    /// Makes a ball.
    #[must_use]
    pub fn sphere(center: DVec3, radius: f64) -> Self {
        Self::new(ColliderShape::Sphere { center, radius })
    }

    /// Makes all that lies behind a plane.
    #[must_use]
    pub fn plane(point: DVec3, normal: DVec3) -> Self {
        Self::new(ColliderShape::Plane { point, normal })
    }

    /// Makes one of triangles.
    #[must_use]
    pub fn mesh(mesh: Mesh) -> Self {
        Self::new(ColliderShape::Mesh(mesh))
    }

    /// Returns its mesh, if it is one, as it is seen.
    pub(crate) fn seen_mesh(&self) -> Option<Mesh> {
        match &self.shape {
            ColliderShape::Mesh(mesh) if self.visible => Some(Mesh {
                albedo: self.color,
                ..mesh.clone()
            }),
            _ => None,
        }
    }

    pub(crate) fn is_seen_mesh(&self) -> bool {
        self.visible && matches!(self.shape, ColliderShape::Mesh(_))
    }

    pub(super) fn check(&self) -> Checked {
        vector("color", self.color)?;
        match &self.shape {
            ColliderShape::Box {
                center,
                half,
                rotation,
            } => {
                vector("box.center", *center)?;
                half.to_array()
                    .into_iter()
                    .try_for_each(|half| positive("box.half", half))?;
                rotation.map_or(Ok(()), |turn| {
                    direction("box.rotation.axis", turn.axis)?;
                    finite("box.rotation.angle", turn.angle)
                })
            }
            ColliderShape::Sphere { center, radius } => {
                vector("sphere.center", *center)?;
                positive("sphere.radius", *radius)
            }
            ColliderShape::Plane { point, normal } => {
                vector("plane.point", *point)?;
                direction("plane.normal", *normal)
            }
            ColliderShape::Mesh(mesh) => {
                let of_mesh = |fault: Fault| fault.within("mesh");
                mesh.check().map_err(of_mesh)?;
                if self.color.min_element() < 0.0 || self.color.max_element() > 1.0 {
                    let message = "of a mesh it is the share of light that it throws back: 0 to 1";
                    return Err(Fault::new("color", message));
                }
                Ok(())
            }
        }
    }
}

/// The colour of one that names none.
pub(in crate::scene) const GRAY: DVec3 = DVec3::splat(0.25);
