//! The files of the kernels that draw crowds.

use crate::opencl::{SHARED, SourceFile, Sources, embed};

const FILES: &[SourceFile<'static>] = embed!(
    "crowd/build.h",
    "crowd/cells.h",
    "crowd/draw.cl",
    "crowd/ends.h",
    "crowd/nodes.h",
    "crowd/point.h",
    "crowd/tiles.cl",
    "crowd/types.h",
);

/// Returns them, and what all engines share.
pub(super) fn sources() -> Sources<'static> {
    Sources {
        files: SHARED.iter().chain(FILES).copied().collect(),
        kinds: Vec::new(),
    }
}
