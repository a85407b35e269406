//! What a frame cost.

use std::time::Duration;

/// What a frame cost. The numbers mean the same for every engine, device and method.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct FrameCost {
    /// Time that the device worked on kernels; of several devices, the longest.
    pub kernel: Duration,
    /// The part of that which meshes took: what rays meet of them, if that was not kept, and their light.
    pub meshes: Duration,
    /// What crowds of points took.
    pub crowds: CrowdCost,
    /// Integrals: pairs of a ray and a source.
    pub integrals: u64,
    /// Samples of fields. 0 where they were not counted: the method `exact` takes as many as it needs and counts them
    /// only if [`RendererOptions::counts_samples`](crate::RendererOptions::counts_samples) is set.
    pub samples: u64,
    /// Launches of kernels.
    pub launches: u32,
}

/// What the stages of drawing crowds of points took, if points were sorted anew.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct CrowdCost {
    /// On the host: points are seen from the eye, sorted, and put where the device reads them.
    pub sorting: Duration,
    /// In kernels: light is laid on the nodes of cells.
    pub cells: Duration,
    /// In kernels: tiles take the light of cells.
    pub tiles: Duration,
    /// In kernels: pixels take the light of tiles, and of points next to them.
    pub pixels: Duration,
    /// Memory that they take besides the list itself, bytes: buffers on the device, of several the one that has most,
    /// and what points are sorted in on the host. It is kept for the next frame.
    pub bytes: u64,
}

impl CrowdCost {
    fn both(self, other: Self, both: impl Fn(Duration, Duration) -> Duration) -> Self {
        Self {
            sorting: both(self.sorting, other.sorting),
            cells: both(self.cells, other.cells),
            tiles: both(self.tiles, other.tiles),
            pixels: both(self.pixels, other.pixels),
            bytes: self.bytes.max(other.bytes),
        }
    }
}

impl FrameCost {
    /// Adds the cost of what was drawn after this.
    pub(crate) fn then(self, other: Self) -> Self {
        Self {
            kernel: self.kernel + other.kernel,
            meshes: self.meshes + other.meshes,
            crowds: self.crowds.both(other.crowds, |own, other| own + other),
            ..self.beside(other)
        }
    }

    /// Adds the cost of a part that was drawn beside this one, by another device.
    pub(crate) fn beside(self, other: Self) -> Self {
        Self {
            kernel: self.kernel.max(other.kernel),
            meshes: self.meshes.max(other.meshes),
            crowds: self.crowds.both(other.crowds, Duration::max),
            integrals: self.integrals + other.integrals,
            samples: self.samples + other.samples,
            launches: self.launches + other.launches,
        }
    }
}
