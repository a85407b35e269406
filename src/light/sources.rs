//! The files of the kernels of light that waves cast.

use crate::opencl::{SHARED, SourceFile, Sources, embed};

const FILES: &[SourceFile<'static>] = embed!(
    "light/curve.h",
    "light/irradiance.h",
    "light/line.h",
    "light/points.cl",
    "light/ring.h",
    "light/stretch.h",
    "light/types.h",
);

/// Returns them, and what all engines share.
pub(super) fn sources() -> Sources<'static> {
    Sources {
        files: SHARED.iter().chain(FILES).copied().collect(),
        kinds: Vec::new(),
    }
}
