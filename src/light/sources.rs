//! The files of what waves cast, for kernels that shade surfaces.

use crate::opencl::{SourceFile, embed};

/// What finds the light that waves cast: engines of surfaces include it.
pub(crate) const LIGHT_FILES: &[SourceFile<'static>] = embed!(
    "light/curve.h",
    "light/irradiance.h",
    "light/line.h",
    "light/ring.h",
    "light/stretch.h",
    "light/types.h",
);
