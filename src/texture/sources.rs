//! The files of the kernel that draws volumes.

use crate::opencl::{SHARED, SourceFile, Sources, embed};

const FILES: &[SourceFile<'static>] =
    embed!("texture/texture.cl", "texture/cells.h", "texture/types.h");

/// Returns them, and what all engines share.
pub(super) fn sources() -> Sources<'static> {
    Sources {
        files: SHARED.iter().chain(FILES).copied().collect(),
        kinds: Vec::new(),
    }
}
