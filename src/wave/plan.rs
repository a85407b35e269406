//! The plan of a frame, or of a list of rays: which kernel, what it is told, and what its launches may take. It says
//! what is to be done; `dispatch` does it.

use super::kernels::{Rays, Task, Variant};
use super::pack::layout::{Integrand, Launch, TilePass, View};
use super::partition::{self, Counts, Part, Work};
use super::tiles::{self, Tolerance};
use crate::image::ImageSize;
use crate::opencl::RawMemory;
use crate::scene::{Sampling, Scene};

/// Launches begin at multiples of this many rays: the same ones are always integrated side by side.
pub(super) const MOST_LANES: u32 = 16;

#[derive(Debug)]
pub(crate) struct Plan {
    /// `None`: the rays are listed.
    pub(super) view: Option<View>,
    pub(super) integrand: Integrand,
    /// Width and height of the image in pixels, or number of rays and 1.
    pub(super) size: (u32, u32),
    pub(super) counts: Counts,
    pub(super) work: Work,
    pub(super) task: Task,
    /// Depths of others on the device; `None`: the scene's, if it has any.
    pub(super) depths: Option<RawMemory>,
    tolerance: Tolerance,
}

/// Returns the rows at whose multiples an image may be cut and still be, to the bit, the same as in one piece.
pub(crate) fn grain_rows(scene: &Scene, has_both_signs: bool) -> u32 {
    match has_tiles(scene, has_both_signs) {
        true => tiles::first_size(scene.image),
        false => MOST_LANES >> scene.image.width.trailing_zeros().min(4),
    }
}

/// Returns whether integrals are taken by tiles.
pub(super) fn has_tiles(scene: &Scene, has_both_signs: bool) -> bool {
    scene.integration.method.sampling() == Sampling::Tiles
        && !has_both_signs
        && scene.source_count() > 0
}

impl Plan {
    /// Makes the plan of a task; `units` are the device's compute units.
    pub(super) fn new(
        task: Task,
        view: Option<View>,
        integrand: Integrand,
        counts: Counts,
        image: ImageSize,
        tolerance: Tolerance,
        units: u32,
    ) -> Self {
        let first_tile_size = match task.rays {
            Rays::Tiles => tiles::first_size(image),
            Rays::Pixels | Rays::Listed | Rays::Cells => 0,
        };
        let (grain, most_pixels, most_sources) = match task.rays {
            Rays::Tiles => (
                first_tile_size * image.width,
                tiles::most_pixels(counts.iter().sum()),
                tiles::MOST_SOURCES,
            ),
            Rays::Pixels | Rays::Listed | Rays::Cells => (MOST_LANES, u32::MAX, u64::MAX),
        };
        let work = Work {
            node_count: match task.method {
                Variant::Simpson | Variant::Jittered => integrand.node_count,
                Variant::Exact { nodes, .. } => 8 * nodes,
            },
            source_count: counts.iter().sum(),
            fewest_pixels: (256 * units).max(1024),
            grain,
            most_pixels,
            most_sources,
            first_tile_size,
        };
        Self {
            view,
            integrand,
            size: (image.width, image.height),
            counts,
            work,
            task,
            depths: None,
            tolerance,
        }
    }

    /// Returns the number that the pixels of a band are a multiple of.
    pub(crate) fn grain(&self) -> u32 {
        self.work.grain
    }

    /// Returns which sources a part takes.
    pub(super) fn launch(&self, part: &Part) -> Launch {
        partition::launch(part, &self.counts)
    }

    /// Returns whether no launch has drawn a part's pixels before, and whether none will afterwards.
    pub(super) fn place_of(&self, part: &Part) -> (bool, bool) {
        let is_first = part.sources.start == 0;
        (is_first, part.sources.end >= self.work.source_count)
    }

    /// Returns the passes over the tiles of a part; none where no tiles are wanted.
    pub(super) fn passes(&self, part: &Part) -> Vec<TilePass> {
        match (self.task.rays, &self.view) {
            (Rays::Tiles, Some(view)) => {
                let side = |[x, y, z, _]: [f32; 4]| glam::Vec3::new(x, y, z).length();
                let pixel_step = side(view.row_step).max(side(view.column_step));
                let (size, tolerance) = (self.work.first_tile_size, self.tolerance);
                let width = (view.width, pixel_step);
                tiles::passes(part, &self.counts, width, size, tolerance)
            }
            _ => Vec::new(),
        }
    }
}
