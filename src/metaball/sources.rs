//! The files of the metaballs' kernels.

use crate::opencl::{SHARED, SourceFile, Sources, embed};

const FILES: &[SourceFile<'static>] = embed!(
    "metaball/cells.h",
    "metaball/draw.cl",
    "metaball/field.h",
    "metaball/march.h",
    "metaball/metaball.cl",
    "metaball/near.h",
    "metaball/search.h",
    "metaball/sort.cl",
    "metaball/types.h",
);

/// Returns them, and what all engines share.
pub(super) fn sources() -> Sources<'static> {
    Sources {
        files: SHARED.iter().chain(FILES).copied().collect(),
        kinds: Vec::new(),
    }
}
