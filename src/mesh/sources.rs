//! The files of the kernels of meshes.

use crate::light::LIGHT_FILES;
use crate::opencl::{SHARED, SourceFile, Sources, embed};

/// What looks into a tree.
const TREE_FILES: &[SourceFile<'static>] = embed!("mesh/types.h", "mesh/trace.h");

const FILES: &[SourceFile<'static>] = embed!("mesh/mesh.cl", "mesh/rays.h", "mesh/shade.cl");

/// Returns them, and what all engines share.
pub(super) fn sources() -> Sources<'static> {
    let own = TREE_FILES.iter().chain(FILES);
    let files = SHARED.iter().chain(LIGHT_FILES).chain(own);
    Sources {
        files: files.copied().collect(),
        kinds: Vec::new(),
    }
}
