//! What a caller may choose of a renderer.

#[cfg(feature = "kernel-cache")]
use super::KernelCache;
use super::SlowStart;
use crate::error::{Error, Result};

/// Choices of a renderer; the default suits the device.
///
/// ```
/// let mut options = energywave::RendererOptions::default();
/// options.lanes = Some(8);
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct RendererOptions {
    /// Rays that a work-item carries side by side: 1, 4, 8 or 16; `None`: what suits the device.
    pub lanes: Option<u32>,
    /// Work-items that share a tile, no more than 16 divided by the lanes, or 32 of one lane: 1, 2, 4, 8, 16 or 32;
    /// `None`: 32 in the form of a GPU if it runs as many in step, else 16, 1 in that of a CPU (see
    /// [`Device::form`](crate::Device::form)).
    pub tile_workers: Option<u32>,
    /// Whether the method `exact` counts its samples, for [`FrameCost::samples`](crate::FrameCost::samples).
    pub counts_samples: bool,
    /// Whether kernels may draw without having shown, at their first use on a device, that they compute correctly.
    pub skips_self_test: bool,
    /// Whether the cells of volumes lie in 3D images where the device has such; `None`: on GPUs. Else in buffers.
    pub volume_images: Option<bool>,
    /// Whether what was built is kept on disk for the next start.
    #[cfg(feature = "kernel-cache")]
    pub cache: KernelCache,
    /// Who is told of kernels whose first launch does not end; `None`: nobody.
    pub slow_start: Option<SlowStart>,
    /// Further options for the OpenCL compiler, which may change what kernels do: see `internals`.
    pub(crate) compiler_options: String,
}

impl RendererOptions {
    /// # Errors
    /// [`Error::Unsupported`] for numbers that kernels cannot be built for.
    pub(crate) fn check(&self) -> Result<()> {
        let wrong = |what: &str, found: u32, right: &str| {
            let message = format!("renderer options: {found} {what}; {right}");
            Err(Error::Unsupported(message))
        };
        match (self.lanes, self.tile_workers) {
            (Some(lanes), _) if ![1, 4, 8, 16].contains(&lanes) => {
                wrong("lanes", lanes, "1, 4, 8 or 16")
            }
            (_, Some(workers)) if ![1, 2, 4, 8, 16, 32].contains(&workers) => {
                wrong("work-items a tile", workers, "1, 2, 4, 8, 16 or 32")
            }
            _ => Ok(()),
        }
    }
}
