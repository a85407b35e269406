//! The tree of boxes around the triangles of all meshes of a scene, built on the host: clusters of neighbours along a
//! space-filling curve (Meister, Bittner 2018: PLOC, by `obvhs`). It is float32, seen from the middle of all, and the
//! same for every camera.

use std::sync::Arc;

use glam::{DVec3, Vec3A};
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use super::pack::{MeshTriangle, TreeNode, packed_normal};
use crate::error::{Error, Result};
use crate::memory;
use crate::opencl::{Argument, Compute, UploadedShared};
use crate::scene::Mesh;

/// A deeper tree would overflow the stack of boxes that wait, `TREE_STACK` of `cl/mesh/trace.h`.
const DEEPEST: usize = 62;

/// Triangles of a leaf, at most, and what one more box costs, triangles.
const LEAF: u32 = 8;
const BOX_COST: f32 = 3.0;

/// The share of boxes that are put elsewhere, where that makes the tree better.
const MOVED: f32 = 0.02;

/// Bytes that a triangle takes while a tree is built.
const BYTES: u64 = 400;

/// The margin, of the greatest coordinate: places on a surface lie beside it by less.
const MARGIN: f32 = 4e-6;

/// Triangles of meshes with boxes around them.
#[derive(Debug, Clone, Default)]
pub struct Tree {
    /// From where positions are given, world space.
    pub origin: DVec3,
    /// Its boxes; the first is around all.
    pub nodes: Arc<Vec<TreeNode>>,
    /// In the order of the tree.
    pub triangles: Arc<Vec<MeshTriangle>>,
    /// The least corner of the box around all, from the origin.
    pub low: DVec3,
    /// The greatest.
    pub high: DVec3,
    /// What lies nearer to an end of a ray does not hide it, world units.
    pub margin: f32,
}

impl Boundable for MeshTriangle {
    fn aabb(&self) -> Aabb {
        let a = Vec3A::new(self.a_x, self.a_y, self.a_z);
        let b = Vec3A::new(self.b_x, self.b_y, self.b_z);
        let c = Vec3A::new(self.c_x, self.c_y, self.c_z);
        Aabb::new(a.min(b).min(c), a.max(b).max(c))
    }
}

impl Tree {
    /// Builds that of the meshes of a valid scene; without a mesh, it is empty.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`] if the host has too little for it.
    pub fn new(meshes: &[Mesh]) -> Result<Self> {
        let count: usize = meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        if let Some(shortage) = memory::shortage(count as u64 * BYTES) {
            let message = format!("{count} triangles of meshes: {shortage}");
            return Err(Error::OutOfMemory(message));
        }
        if count == 0 {
            return Ok(Self::default());
        }
        let placed: Vec<Vec<DVec3>> = meshes.iter().map(Mesh::placed_vertices).collect();
        let (low, high) = bounds(meshes, &placed);
        let origin = 0.5 * (low + high);
        let mut triangles = Vec::with_capacity(count);
        for (number, (mesh, placed)) in (0..).zip(meshes.iter().zip(&placed)) {
            let corners = mesh.triangles.triangles().iter();
            let corners = corners.map(|it| it.map(|corner| placed[corner as usize] - origin));
            triangles.extend(corners.map(|corners| packed(number, corners)));
        }
        drop(placed);
        let mut nodes = clustered(&mut triangles);
        if depth(&nodes) > DEEPEST {
            nodes = halved(&mut triangles);
        }
        let (low, high) = (low - origin, high - origin);
        let far = low.abs().max(high.abs()).max_element() as f32;
        Ok(Self {
            origin,
            nodes: Arc::new(nodes),
            triangles: Arc::new(triangles),
            low,
            high,
            margin: MARGIN * far,
        })
    }
}

/// Returns the box around the corners of all triangles.
fn bounds(meshes: &[Mesh], placed: &[Vec<DVec3>]) -> (DVec3, DVec3) {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for (mesh, placed) in meshes.iter().zip(placed) {
        for corner in mesh.triangles.triangles().iter().flatten() {
            let corner = placed[*corner as usize];
            (low, high) = (low.min(corner), high.max(corner));
        }
    }
    (low, high)
}

fn packed(mesh: u32, corners: [DVec3; 3]) -> MeshTriangle {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize_or(DVec3::Z);
    let [a, b, c] = corners.map(|it| it.as_vec3());
    MeshTriangle {
        a_x: a.x,
        a_y: a.y,
        a_z: a.z,
        mesh,
        b_x: b.x,
        b_y: b.y,
        b_z: b.z,
        normal: packed_normal(normal),
        c_x: c.x,
        c_y: c.y,
        c_z: c.z,
        padding: 0,
    }
}

/// Builds a tree of neighbours, and puts triangles into its order.
fn clustered(triangles: &mut Vec<MeshTriangle>) -> Vec<TreeNode> {
    let numbers: Vec<u32> = (0..triangles.len() as u32).collect();
    let mut builder = PlocBuilder::with_capacity(triangles.len());
    let distance = PlocSearchDistance::Low;
    let mut tree = builder.build(distance, &triangles[..], numbers, SortPrecision::U64, 2);
    drop(builder);
    ReinsertionOptimizer::default().run(&mut tree, MOVED, None);
    collapse(&mut tree, LEAF, BOX_COST);
    if !tree.nodes[0].is_leaf() {
        tree.reorder_in_stack_traversal_order();
    }
    let order = tree.primitive_indices.iter();
    *triangles = order.map(|index| triangles[*index as usize]).collect();
    let nodes = tree.nodes.iter().map(|node| TreeNode {
        low_x: node.min.x,
        low_y: node.min.y,
        low_z: node.min.z,
        first: node.first_index,
        high_x: node.max.x,
        high_y: node.max.y,
        high_z: node.max.z,
        count: node.prim_count,
    });
    nodes.collect()
}

/// Returns how many boxes stand in each other, at most.
fn depth(nodes: &[TreeNode]) -> usize {
    let mut deepest = 0;
    let mut waiting = vec![(0_u32, 1_usize)];
    while let Some((number, depth)) = waiting.pop() {
        deepest = deepest.max(depth);
        let node = &nodes[number as usize];
        if node.count == 0 {
            waiting.extend([(node.first, depth + 1), (node.first + 1, depth + 1)]);
        }
    }
    deepest
}

/// Builds a tree by halves, no deeper than there are bits in a number: worse, but for triangles of which the other is
/// too deep. Puts triangles into its order.
fn halved(triangles: &mut [MeshTriangle]) -> Vec<TreeNode> {
    let mut nodes = vec![<TreeNode as bytemuck::Zeroable>::zeroed()];
    let mut waiting = vec![(0_usize, 0_usize, triangles.len())];
    while let Some((number, begin, end)) = waiting.pop() {
        let inside = &mut triangles[begin..end];
        let around = inside
            .iter()
            .map(Boundable::aabb)
            .reduce(|a, b| a.union(&b));
        let around = around.unwrap_or_else(Aabb::empty);
        let is_leaf = inside.len() <= LEAF as usize;
        nodes[number] = TreeNode {
            low_x: around.min.x,
            low_y: around.min.y,
            low_z: around.min.z,
            first: if is_leaf { begin } else { nodes.len() } as u32,
            high_x: around.max.x,
            high_y: around.max.y,
            high_z: around.max.z,
            count: if is_leaf { inside.len() as u32 } else { 0 },
        };
        if !is_leaf {
            let axis = around.largest_axis();
            let middle = inside.len() / 2;
            inside.select_nth_unstable_by(middle, |a, b| {
                let center = |it: &MeshTriangle| it.aabb().center_axis(axis);
                center(a).total_cmp(&center(b))
            });
            let first = nodes.len();
            nodes.extend([nodes[number]; 2]);
            waiting.extend([
                (first, begin, begin + middle),
                (first + 1, begin + middle, end),
            ]);
        }
    }
    nodes
}

impl Default for UploadedTree {
    fn default() -> Self {
        Self::new()
    }
}

/// A tree on a device.
#[derive(Debug)]
pub struct UploadedTree {
    nodes: UploadedShared<TreeNode>,
    triangles: UploadedShared<MeshTriangle>,
    size: u32,
    margin: f32,
}

impl UploadedTree {
    /// Makes a place for one.
    #[must_use]
    pub fn new() -> Self {
        Self {
            nodes: UploadedShared::new("the boxes of meshes"),
            triangles: UploadedShared::new("the triangles of meshes"),
            size: 0,
            margin: 0.0,
        }
    }

    /// Makes the device's tree this one, if it is another.
    ///
    /// # Errors
    /// As [`UploadedShared::upload`].
    pub fn upload(&mut self, compute: &Compute, tree: &Tree) -> Result<()> {
        self.size = tree.nodes.len() as u32;
        self.margin = tree.margin;
        if tree.nodes.is_empty() {
            return Ok(());
        }
        self.nodes.upload(compute, Some(&tree.nodes))?;
        self.triangles.upload(compute, Some(&tree.triangles))
    }

    /// Waits for copies under way.
    ///
    /// # Errors
    /// [`Error::Device`] if a copy failed.
    pub fn settle(&mut self, compute: &Compute) -> Result<()> {
        self.nodes.settle(compute)?;
        self.triangles.settle(compute)
    }

    /// Returns what kernels have as `TREE_PARAMETERS`.
    pub fn arguments(&self) -> [(&str, &dyn Argument); 4] {
        [
            ("tree_nodes", self.nodes.argument()),
            ("tree_triangles", self.triangles.argument()),
            ("tree_size", &self.size),
            ("tree_margin", &self.margin),
        ]
    }
}
