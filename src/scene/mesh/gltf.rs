//! Reads glTF 2.0 (Khronos 2021), as text with its buffers in files or within, or in one binary file: the triangles of
//! all nodes of the scene that is shown, where the nodes put them. Materials, cameras, lights and animations are passed
//! over, points and lines too; what would move or unpack corners is refused. Nothing in a file is believed: gltf's own
//! check takes the numbers of accessors for right, so only its structs are used here, and every number is looked up.

use std::fs;
use std::path::{Path, PathBuf};

use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Index, Node, Root};
use glam::{DMat4, DQuat, DVec3, Mat4};

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

/// The word that a binary file begins with, and what its parts are.
const MAGIC: &[u8] = b"glTF";
const JSON: &[u8] = b"JSON";
const BINARY: &[u8] = b"BIN\0";

/// What is read, node by node.
struct Reader<'a> {
    document: &'a Root,
    buffers: Buffers<'a>,
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    nodes: usize,
}

pub(super) fn read(bytes: &[u8], folder: &Path) -> Read {
    let (text, binary) = parts(bytes)?;
    let document = Root::from_slice(text);
    let document = document.map_err(|it| format!(": no glTF: {}", shown(&it.to_string())))?;
    for name in &document.extensions_required {
        if !HARMLESS.iter().any(|it| name.starts_with(it)) {
            return Err(format!(
                ": it requires the extension {}, which is not read; export it without",
                shown(name)
            ));
        }
    }
    let mut reader = Reader {
        document: &document,
        buffers: Buffers::open(&document, binary, folder)?,
        vertices: Vec::new(),
        triangles: Vec::new(),
        nodes: 0,
    };
    let shown_scene = document.scene.as_ref().map_or(0, Index::value);
    match document.scenes.get(shown_scene) {
        Some(scene) => {
            for node in &scene.nodes {
                reader.add_node(node, DMat4::IDENTITY, 1)?;
            }
        }
        // All nodes that stand in no other.
        None => {
            let children = document
                .nodes
                .iter()
                .filter_map(|node| node.children.as_ref());
            let mut is_inside = vec![false; document.nodes.len()];
            for child in children.flatten() {
                if let Some(it) = is_inside.get_mut(child.value()) {
                    *it = true;
                }
            }
            for number in (0..document.nodes.len()).filter(|number| !is_inside[*number]) {
                reader.add_node(&Index::new(number as u32), DMat4::IDENTITY, 1)?;
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
    let read = bytes.and_then(|bytes| Root::from_slice(&bytes).ok());
    let buffers = read.map_or(Vec::new(), |it| it.buffers);
    let uris = buffers.iter().filter_map(|buffer| buffer.uri.as_deref());
    let uris = uris.filter(|uri| !uri.starts_with(DATA));
    uris.map(|uri| folder.join(plain(uri))).collect()
}

/// Returns the text of a file, and of a binary one its other part.
fn parts(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let number = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|it| it.try_into().ok());
        word.map(|it| u32::from_le_bytes(it) as usize)
    };
    if !bytes.starts_with(MAGIC) {
        return Ok((bytes, None));
    }
    match number(4) {
        Some(2) => {}
        version => return Err(format!(": version {} of glTF, not 2", version.unwrap_or(0))),
    }
    let found = bytes.len();
    let length = number(8).unwrap_or(usize::MAX);
    if length > found {
        return Err(format!(
            ": it says that it has {length} bytes and has {found}; it is cut off or damaged"
        ));
    }
    let (mut text, mut binary, mut at) = (None, None, 12);
    while let (Some(size), Some(kind)) = (number(at), bytes.get(at + 4..at + 8)) {
        let part = bytes.get(at + 8..(at + 8).saturating_add(size));
        let part = part.ok_or(": a part of it reaches beyond its end; it is damaged")?;
        match kind {
            JSON if text.is_none() => text = Some(part),
            BINARY if binary.is_none() => binary = Some(part),
            _ => {}
        }
        at += 8 + size;
    }
    Ok((text.ok_or(": it has no text of glTF")?, binary))
}

impl Reader<'_> {
    fn add_node(&mut self, number: &Index<Node>, outer: DMat4, depth: usize) -> Result<(), String> {
        self.nodes += 1;
        if depth > DEEPEST || self.nodes > MOST_NODES {
            return Err(format!(
                ": its nodes stand in each other deeper than {DEEPEST}, or are more than {MOST_NODES}"
            ));
        }
        let document = self.document;
        let number = number.value();
        let node = document.nodes.get(number);
        let node = node.ok_or_else(|| format!(": there is no node {number}"))?;
        let place = outer * placement(node);
        if let Some(mesh) = &node.mesh {
            if node.skin.is_some() {
                return Err(format!(
                    ": node {number} has a skin, which is not read; export it without, as it stands"
                ));
            }
            let mesh = mesh.value();
            let found = document.meshes.get(mesh);
            let found = found.ok_or_else(|| format!(": there is no mesh {mesh}"))?;
            for primitive in &found.primitives {
                self.add_primitive(primitive, place)
                    .map_err(|message| format!(": mesh {mesh}: {message}"))?;
            }
        }
        for child in node.children.iter().flatten() {
            self.add_node(child, place, depth + 1)?;
        }
        Ok(())
    }

    fn add_primitive(&mut self, primitive: &Primitive, place: DMat4) -> Result<(), String> {
        let mode = match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => {
                mode
            }
            _ => return Ok(()),
        };
        if primitive.targets.as_ref().is_some_and(|it| !it.is_empty()) {
            return Err(
                "it has morph targets, which are not read; export it as it stands".to_owned(),
            );
        }
        let positions = primitive
            .attributes
            .get(&Checked::Valid(Semantic::Positions));
        let positions = positions.ok_or("it has no positions")?;
        let positions = self.buffers.positions(positions.value())?;
        let indices = match &primitive.indices {
            Some(indices) => self.buffers.indices(indices.value())?,
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
        let placed = positions.iter();
        let placed = placed.map(|it| place.transform_point3(it.as_dvec3()));
        self.vertices.extend(placed);
        let corner = |index: usize| first + indices[index];
        match mode {
            Mode::Triangles => {
                let whole = indices.as_chunks::<3>().0.iter();
                let whole = whole.map(|it| it.map(|index| first + index));
                self.triangles.extend(whole);
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

/// Returns where a node is put in the one around it.
fn placement(node: &Node) -> DMat4 {
    if let Some(columns) = &node.matrix {
        return Mat4::from_cols_array(columns).as_dmat4();
    }
    let vector =
        |it: Option<[f32; 3]>, absent| it.map_or(absent, |it| DVec3::from(it.map(f64::from)));
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |it| {
        DQuat::from_array(it.0.map(f64::from)).normalize()
    });
    DMat4::from_scale_rotation_translation(
        vector(node.scale, DVec3::ONE),
        rotation,
        vector(node.translation, DVec3::ZERO),
    )
}
