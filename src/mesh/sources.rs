//! The files of the kernels of meshes.

use crate::opencl::{SHARED, SourceFile, Sources, embed};

/// What looks into a tree: other engines include it too.
pub(crate) const TREE_FILES: &[SourceFile<'static>] = embed!("mesh/types.h", "mesh/trace.h");

const FILES: &[SourceFile<'static>] = embed!("mesh/mesh.cl", "mesh/rays.h");

/// Returns them, and what all engines share.
pub(super) fn sources() -> Sources<'static> {
    let files = SHARED.iter().chain(TREE_FILES).chain(FILES);
    Sources {
        files: files.copied().collect(),
        kinds: Vec::new(),
    }
}
