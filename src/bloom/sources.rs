//! The files of the bloom's kernels.

use crate::opencl::{SHARED, SourceFile, Sources, embed};

const FILES: &[SourceFile<'static>] = embed!(
    "bloom/bloom.cl",
    "bloom/double.h",
    "bloom/halve.h",
    "bloom/step.h",
);

/// Returns them, and what all engines share.
pub(super) fn sources() -> Sources<'static> {
    Sources {
        files: SHARED.iter().chain(FILES).copied().collect(),
        kinds: Vec::new(),
    }
}
