//! `[[mesh]]` of a scene file: triangles, listed or in a file, and where they are put.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::error::SceneError;
use crate::scene::colors::read_color;
use crate::scene::mesh::{ALBEDO, buffer_files};
use crate::scene::values::{read_vector, read_vectors};
use crate::scene::{Mesh, Rotation, TriangleList};

/// A mesh as a file describes it.
#[derive(Debug, Clone, Deserialize, Serialize)]
#[serde(
    default,
    deny_unknown_fields,
    expecting = "a table, such as { file = \"ship.obj\" }"
)]
pub(super) struct MeshTable {
    #[serde(
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "read_vectors"
    )]
    vertices: Vec<DVec3>,
    /// Whole numbers, of each triangle three.
    #[serde(
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "read_vectors"
    )]
    triangles: Vec<DVec3>,
    /// From the folder of the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<PathBuf>,
    scale: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    rotate: Option<Rotation>,
    #[serde(deserialize_with = "read_vector")]
    translate: DVec3,
    #[serde(
        skip_serializing_if = "Option::is_none",
        deserialize_with = "read_some_color"
    )]
    albedo: Option<DVec3>,
    /// Its triangles, once they were read; the tables of all times share them as long as they name the same.
    #[serde(skip)]
    list: Arc<OnceLock<TriangleList>>,
}

// What is read of `[[mesh]]`.
keys! { pub(in crate::scene) MESH_KEYS;
    vertices: Vectors(0, None), WORLD, Otherwise("file"), "where corners are";
    triangles: Vectors(0, None), NONE, Otherwise("file"), "the numbers of three corners, from 0 on, for each triangle";
    file: File, NONE, Otherwise("vertices and triangles"), "triangles: .obj (Wavefront), .gltf, .glb (glTF 2.0)";
    scale: POSITIVE, NONE, Value("1"), "what all positions are multiplied with";
    rotate: Table("rotate"), NONE, Otherwise("not turned"), "a turn about the origin, after the scale";
    translate: VECTOR, WORLD, Value("[0, 0, 0]"), "where the origin is put";
    albedo: Color, NONE, Value("[0.8, 0.8, 0.8]"), "the share of light that it throws back";
}

impl Default for MeshTable {
    fn default() -> Self {
        Self {
            vertices: Vec::new(),
            triangles: Vec::new(),
            file: None,
            scale: 1.0,
            rotate: None,
            translate: DVec3::ZERO,
            albedo: None,
            list: Arc::default(),
        }
    }
}

fn read_some_color<'de, D: serde::Deserializer<'de>>(reader: D) -> Result<Option<DVec3>, D::Error> {
    read_color(reader).map(Some)
}

impl MeshTable {
    /// Returns its file, which is from `folder`, and those that this one names.
    pub(super) fn files(&self, folder: &Path) -> Vec<PathBuf> {
        let file = self.file.as_ref().map(|file| folder.join(file));
        let named = file.as_deref().map_or(Vec::new(), buffer_files);
        file.into_iter().chain(named).collect()
    }

    /// Makes a mesh as it is written.
    pub(super) fn of(mesh: &Mesh) -> Self {
        let list = &mesh.triangles;
        let file = list.file().map(Path::to_owned);
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        if file.is_none() {
            vertices = list.vertices().to_vec();
            let indices = list.triangles().iter();
            triangles = indices.map(|it| it.map(f64::from).into()).collect();
        }
        Self {
            vertices,
            triangles,
            file,
            scale: mesh.scale,
            rotate: mesh.rotate,
            translate: mesh.translate,
            albedo: Some(mesh.albedo),
            list: Arc::default(),
        }
    }

    /// Takes the triangles that another table has read, if it names the same.
    pub(super) fn share(&mut self, other: &Self) {
        let is_same = self.file == other.file
            && self.triangles == other.triangles
            && self.vertices == other.vertices;
        if is_same {
            self.list = Arc::clone(&other.list);
        }
    }

    /// Makes the mesh; its file is from `folder`.
    pub(super) fn open(&self, index: usize, folder: &Path) -> Result<Mesh, SceneError> {
        let table = format!("mesh[{index}]");
        let mesh = self.open_at(&table, folder)?;
        mesh.check().map_err(|fault| fault.of(&table))?;
        Ok(mesh)
    }

    /// Makes the mesh of a table of this key, which is not checked yet.
    fn open_at(&self, table: &str, folder: &Path) -> Result<Mesh, SceneError> {
        let list = match self.list.get() {
            Some(list) => list.clone(),
            None => {
                let list = self.read(folder).map_err(|fault| SceneError {
                    key: format!("{table}.{}", fault.key),
                    ..fault
                })?;
                self.list.get_or_init(|| list).clone()
            }
        };
        Ok(Mesh {
            triangles: list,
            scale: self.scale,
            rotate: self.rotate,
            translate: self.translate,
            albedo: self.albedo.unwrap_or(ALBEDO),
        })
    }

    /// Makes that of a collider, whose colour is the collider's.
    pub(super) fn open_collider(&self, index: usize, folder: &Path) -> Result<Mesh, SceneError> {
        let table = format!("collider[{index}].mesh");
        if self.albedo.is_some() {
            let message = "the colour of a collider is its `color`, beside `mesh`: write it there";
            return Err(SceneError::value(format!("{table}.albedo"), message));
        }
        self.open_at(&table, folder)
    }

    /// Makes that of a collider as it is written.
    pub(super) fn of_collider(mesh: &Mesh) -> Self {
        Self {
            albedo: None,
            ..Self::of(mesh)
        }
    }

    fn read(&self, folder: &Path) -> Result<TriangleList, SceneError> {
        let is_listed = !self.vertices.is_empty() || !self.triangles.is_empty();
        let list = match &self.file {
            Some(_) if is_listed => {
                let message = "`vertices` and `triangles` say already what the mesh is; write those or a file";
                return Err(SceneError::value("file", message));
            }
            Some(file) => TriangleList::from_file(folder.join(file)),
            None => TriangleList::new(self.vertices.clone(), self.indices()?),
        };
        list.map_err(|error| match error {
            crate::Error::Scene(fault) => fault,
            other => SceneError::value("file", other.to_string()),
        })
    }

    /// Returns the triangles as they are numbered.
    fn indices(&self) -> Result<Vec<[u32; 3]>, SceneError> {
        let is_index = |it: f64| it.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&it);
        let mut triangles = Vec::with_capacity(self.triangles.len());
        for (index, corners) in self.triangles.iter().enumerate() {
            let corners = corners.to_array();
            if let Some(wrong) = corners.into_iter().find(|it| !is_index(*it)) {
                let message = format!(
                    "triangle {index} names vertex {wrong}; they have whole numbers, from 0 on"
                );
                return Err(SceneError::value("triangles", message));
            }
            triangles.push(corners.map(|it| it as u32));
        }
        Ok(triangles)
    }
}
