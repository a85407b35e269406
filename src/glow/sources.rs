//! The files of the kernels that draw particles as light.

use crate::opencl::{SHARED, SourceFile, Sources, embed};

const FILES: &[SourceFile<'static>] = embed!(
    "glow/element.h",
    "glow/glow.cl",
    "glow/listed.h",
    "glow/near.h",
    "glow/pixels.h",
    "glow/rays.h",
    "glow/trace.cl",
    "glow/types.h",
);

/// Returns them, and what all engines share.
pub(super) fn sources() -> Sources<'static> {
    Sources {
        files: SHARED.iter().chain(FILES).copied().collect(),
        kinds: Vec::new(),
    }
}
