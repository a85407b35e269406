//! `[[collider]]` of a scene file: a table that has one of the shapes.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{MeshTable, SceneFile};
use crate::error::SceneError;
use crate::scene::colors::read_color;
use crate::scene::simulation::GRAY;
use crate::scene::values::{Fault, read_some_vector, read_vector};
use crate::scene::{Collider, ColliderShape, List, Rotation};

fn gray() -> DVec3 {
    GRAY
}

fn seen() -> bool {
    true
}

/// A collider as a file describes it: one of its shapes.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ColliderTable {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    r#box: Option<BoxTable>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sphere: Option<SphereTable>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    plane: Option<PlaneTable>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mesh: Option<MeshTable>,
    #[serde(default = "seen")]
    visible: bool,
    #[serde(default = "gray", deserialize_with = "read_color")]
    color: DVec3,
}

// What is read of `[[collider]]`.
keys! { pub(in crate::scene) COLLIDER_KEYS;
    box: Table("collider.box"), NONE, Otherwise("sphere, plane or mesh"), "a box";
    sphere: Table("collider.sphere"), NONE, Otherwise("box, plane or mesh"), "a ball";
    plane: Table("collider.plane"), NONE, Otherwise("box, sphere or mesh"), "all that lies behind a plane";
    mesh: Table("mesh"), NONE, Otherwise("box, sphere or plane"), "triangles, without an albedo";
    visible: Flag, NONE, Value("true"), "whether it is seen";
    color: Color, "linear RGB", Value("[0.25, 0.25, 0.25]"), "the colour, where it is seen";
}

#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct BoxTable {
    #[serde(default, deserialize_with = "read_vector")]
    center: DVec3,
    #[serde(deserialize_with = "read_vector")]
    half: DVec3,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rotation: Option<Rotation>,
}

// What is read of its `box`.
keys! { pub(in crate::scene) BOX_KEYS;
    center: VECTOR, WORLD, Value("[0, 0, 0]"), "its middle";
    half: VECTOR, WORLD, Required, "half of its edges, each positive";
    rotation: Table("rotate"), NONE, Otherwise("not turned"), "a turn about its middle";
}

#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct SphereTable {
    #[serde(default, deserialize_with = "read_vector")]
    center: DVec3,
    radius: f64,
}

// What is read of its `sphere`.
keys! { pub(in crate::scene) SPHERE_KEYS;
    center: VECTOR, WORLD, Value("[0, 0, 0]"), "its middle";
    radius: POSITIVE, WORLD, Required, "how large it is";
}

#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct PlaneTable {
    #[serde(default, deserialize_with = "read_vector")]
    point: DVec3,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_some_vector"
    )]
    normal: Option<DVec3>,
}

// What is read of its `plane`.
keys! { pub(in crate::scene) PLANE_KEYS;
    point: VECTOR, WORLD, Value("[0, 0, 0]"), "a point of it";
    normal: VECTOR, NONE, Value("[0, 0, 1]"), "where it faces, of any length but zero";
}

impl ColliderTable {
    /// Makes the collider; a file of its mesh is from `folder`.
    fn collider(&self, index: usize, folder: &Path) -> Result<Collider, SceneError> {
        let fault = |message: &str| Fault::new("", message).of(&format!("collider[{index}]"));
        let shape = match (&self.r#box, &self.sphere, &self.plane, &self.mesh) {
            (Some(it), None, None, None) => ColliderShape::Box {
                center: it.center,
                half: it.half,
                rotation: it.rotation,
            },
            (None, Some(it), None, None) => ColliderShape::Sphere {
                center: it.center,
                radius: it.radius,
            },
            (None, None, Some(it), None) => ColliderShape::Plane {
                point: it.point,
                normal: it.normal.unwrap_or(DVec3::Z),
            },
            (None, None, None, Some(it)) => ColliderShape::Mesh(it.open_collider(index, folder)?),
            (None, None, None, None) => {
                let message = "it has no shape: write box = { half = [1.0, 1.0, 1.0] }, sphere = { radius = 1.0 }, \
                    plane = { normal = [0.0, 0.0, 1.0] } or mesh = { file = \"ship.obj\" }";
                return Err(fault(message));
            }
            _ => {
                let message = "it has several shapes, of which a collider has one: write a [[collider]] for each";
                return Err(fault(message));
            }
        };
        Ok(Collider {
            shape,
            visible: self.visible,
            color: self.color,
        })
    }

    /// Makes a collider's table as it is written.
    pub(super) fn of(collider: &Collider) -> Self {
        let mut table = Self {
            r#box: None,
            sphere: None,
            plane: None,
            mesh: None,
            visible: collider.visible,
            color: collider.color,
        };
        match &collider.shape {
            &ColliderShape::Box {
                center,
                half,
                rotation,
            } => {
                table.r#box = Some(BoxTable {
                    center,
                    half,
                    rotation,
                });
            }
            &ColliderShape::Sphere { center, radius } => {
                table.sphere = Some(SphereTable { center, radius });
            }
            ColliderShape::Mesh(mesh) => table.mesh = Some(MeshTable::of_collider(mesh)),
            &ColliderShape::Plane { point, normal } => {
                table.plane = Some(PlaneTable {
                    point,
                    normal: Some(normal),
                });
            }
        }
        table
    }
}

impl ColliderTable {
    /// Returns the files that its mesh is in, which are from `folder`.
    pub(super) fn files(&self, folder: &Path) -> Vec<PathBuf> {
        let mesh = self.mesh.as_ref();
        mesh.map_or(Vec::new(), |mesh| mesh.files(folder))
    }

    /// Takes the triangles that another table has read, if it names the same.
    pub(super) fn share(&mut self, other: &Self) {
        if let (Some(mesh), Some(other)) = (&mut self.mesh, &other.mesh) {
            mesh.share(other);
        }
    }
}

impl SceneFile {
    /// Makes the colliders; files of meshes are from `folder`.
    pub(super) fn colliders(&self, folder: &Path) -> Result<List<Collider>, SceneError> {
        let tables = self.collider.iter().enumerate();
        let made = tables.map(|(index, table)| table.collider(index, folder));
        made.collect()
    }
}
