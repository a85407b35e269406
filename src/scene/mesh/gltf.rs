//! Reads glTF 2.0 (Khronos 2021), as text with its buffers in files or within, or in one binary file: the triangles of
//! all nodes of the scene that is shown, where the nodes put them. Materials, cameras, lights and animations are passed
//! over, points and lines too; what would move or unpack corners is refused.

use std::fs;
use std::path::{Path, PathBuf};

use ::gltf::mesh::Mode;
use ::gltf::{Document, Gltf, Node, Primitive, Semantic};
use glam::{DMat4, DVec3, Mat4};

use super::buffers::{Buffers, DATA, plain};
use super::file::Read;
use super::list::MOST;
use crate::memory;
use crate::shown::shown;

/// Nodes stand in each other no deeper than this, and there are no more: files may name one again and again.
const DEEPEST: usize = 64;
const MOST_NODES: usize = 1 << 20;

/// Required extensions that move no corner begin so.
const HARMLESS: [&str; 4] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "EXT_texture_",
];

/// Bytes of the header of a binary file, and the word that it begins with.
const HEADER: usize = 12;
const MAGIC: &[u8] = b"glTF";

/// What is read, node by node.
struct Reader<'a> {
    buffers: Buffers<'a>,
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    nodes: usize,
}

pub(super) fn read(bytes: &[u8], folder: &Path) -> Read {
    check_header(bytes)?;
    let no_gltf = |error: ::gltf::Error| format!(": no glTF: {}", shown(&error.to_string()));
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(no_gltf)?;
    let mut json = document.into_json();
    for name in &json.extensions_required {
        if !HARMLESS.iter().any(|it| name.starts_with(it)) {
            return Err(format!(
                ": it requires the extension {}, which is not read; export it without",
                shown(name)
            ));
        }
    }
    json.extensions_required.clear();
    let document = Document::from_json(json).map_err(no_gltf)?;
    let mut reader = Reader {
        buffers: Buffers::open(&document, blob, folder)?,
        vertices: Vec::new(),
        triangles: Vec::new(),
        nodes: 0,
    };
    match document
        .default_scene()
        .or_else(|| document.scenes().next())
    {
        Some(scene) => {
            for node in scene.nodes() {
                reader.add_node(&node, DMat4::IDENTITY, 1)?;
            }
        }
        // All nodes that stand in no other.
        None => {
            let inside: Vec<usize> = document
                .nodes()
                .flat_map(|node| {
                    node.children()
                        .map(|child| child.index())
                        .collect::<Vec<_>>()
                })
                .collect();
            for node in document
                .nodes()
                .filter(|node| !inside.contains(&node.index()))
            {
                reader.add_node(&node, DMat4::IDENTITY, 1)?;
            }
        }
    }
    Ok((reader.vertices, reader.triangles))
}

/// Returns the files with buffers that a file of this name needs, as far as it can be read.
pub(in crate::scene) fn buffer_files(path: &Path) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let is_text = path
        .extension()
        .is_some_and(|it| it.eq_ignore_ascii_case("gltf"));
    let bytes = is_text.then(|| fs::read(path).ok()).flatten();
    let read = bytes.and_then(|bytes| Gltf::from_slice_without_validation(&bytes).ok());
    let uris = read.map_or(Vec::new(), |it| {
        let buffers = it.document.into_json().buffers.into_iter();
        buffers.filter_map(|buffer| buffer.uri).collect()
    });
    let uris = uris.iter().filter(|uri| !uri.starts_with(DATA));
    uris.map(|uri| folder.join(plain(uri))).collect()
}

/// Checks the length that a binary file says that it has.
fn check_header(bytes: &[u8]) -> Result<(), String> {
    if !bytes.starts_with(MAGIC) {
        return Ok(());
    }
    let length = bytes.get(8..HEADER).and_then(|it| it.try_into().ok());
    let length = length.map_or(0, |it| u32::from_le_bytes(it) as usize);
    match (HEADER..=bytes.len()).contains(&length) {
        true => Ok(()),
        false => Err(format!(
            ": it says that it has {length} bytes and has {}; it is cut off or damaged",
            bytes.len()
        )),
    }
}

impl Reader<'_> {
    fn add_node(&mut self, node: &Node<'_>, outer: DMat4, depth: usize) -> Result<(), String> {
        self.nodes += 1;
        if depth > DEEPEST || self.nodes > MOST_NODES {
            return Err(format!(
                ": its nodes stand in each other deeper than {DEEPEST}, or are more than {MOST_NODES}"
            ));
        }
        let own = Mat4::from_cols_array_2d(&node.transform().matrix()).as_dmat4();
        let place = outer * own;
        if let Some(mesh) = node.mesh() {
            if node.skin().is_some() {
                return Err(format!(
                    ": node {} has a skin, which is not read; export it without, as it stands",
                    node.index()
                ));
            }
            for primitive in mesh.primitives() {
                self.add_primitive(&primitive, place)
                    .map_err(|message| format!(": mesh {}: {message}", mesh.index()))?;
            }
        }
        for child in node.children() {
            self.add_node(&child, place, depth + 1)?;
        }
        Ok(())
    }

    fn add_primitive(&mut self, primitive: &Primitive<'_>, place: DMat4) -> Result<(), String> {
        let mode = primitive.mode();
        if !matches!(
            mode,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
        ) {
            return Ok(());
        }
        if primitive.morph_targets().next().is_some() {
            return Err(
                "it has morph targets, which are not read; export it as it stands".to_owned(),
            );
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            return Err("it has no positions".to_owned());
        };
        let positions = self.buffers.positions(&positions)?;
        let indices = match primitive.indices() {
            Some(indices) => self.buffers.indices(&indices)?,
            None => (0..positions.len() as u32).collect(),
        };
        if let Some(wrong) = indices.iter().find(|it| **it as usize >= positions.len()) {
            let count = positions.len();
            return Err(format!(
                "a triangle names vertex {wrong}, and there are {count}"
            ));
        }
        self.make_room(positions.len(), indices.len())?;
        let first = self.vertices.len() as u32;
        let placed = positions
            .iter()
            .map(|it| place.transform_point3(it.as_dvec3()));
        self.vertices.extend(placed);
        let corner = |index: usize| first + indices[index];
        match mode {
            Mode::Triangles => {
                let whole = indices.as_chunks::<3>().0;
                self.triangles
                    .extend(whole.iter().map(|it| it.map(|index| first + index)));
            }
            _ => self.triangles.extend((2..indices.len()).map(|last| {
                let begin = if mode == Mode::TriangleFan {
                    0
                } else {
                    last - 2
                };
                [corner(begin), corner(last - 1), corner(last)]
            })),
        }
        Ok(())
    }

    /// Refuses what would not fit: nodes may show a mesh again and again.
    fn make_room(&self, vertices: usize, indices: usize) -> Result<(), String> {
        let most = (self.vertices.len() + vertices).max(self.triangles.len() + indices);
        if most > MOST {
            return Err(format!("there may be {MOST} vertices and triangles"));
        }
        let bytes = 48 * vertices + 24 * indices;
        match memory::shortage(bytes as u64) {
            Some(shortage) => Err(format!("its triangles need more memory: {shortage}")),
            None => Ok(()),
        }
    }
}
