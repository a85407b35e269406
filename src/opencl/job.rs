//! One frame or one list of rays, packed, with what its launches may take.

use super::kernels::{Film, Rays, Task, Variant};
use super::launch::Output;
use super::pace::{Part, Work, source_count, source_counts};
use super::tiles;
use crate::pack::{Rule, Sources, layout};
use crate::scene::{Sampling, Scene};

/// Launches begin at multiples of this many rays: the same ones are always integrated side by side.
pub(super) const MOST_LANES: u32 = 16;

#[derive(Debug)]
pub(super) struct Job {
    pub view: layout::View,
    pub sources: Sources,
    pub work: Work,
    pub task: Task,
    tolerance: f64,
    /// Side of the largest tiles, pixels.
    first_tile_size: u32,
}

/// What is integrated.
pub(super) enum Wanted<'a> {
    Pixels(Output),
    Rays(&'a [layout::RayRecord]),
}

impl Wanted<'_> {
    pub(super) fn rays(&self) -> Option<&[layout::RayRecord]> {
        match self {
            Self::Rays(rays) => Some(rays),
            Self::Pixels(_) => None,
        }
    }
}

/// An image that is cut at multiples of so many rows is the same to the bit as in one piece.
pub(crate) fn grain_rows(scene: &Scene) -> u32 {
    match has_tiles(scene) {
        true => tiles::first_size(scene.image),
        false => MOST_LANES >> scene.image.width.trailing_zeros().min(4),
    }
}

fn has_tiles(scene: &Scene) -> bool {
    scene.sampling() == Sampling::Tiles && scene.source_count() > 0
}

impl Job {
    /// `units`: the device's compute units.
    pub(super) fn new(
        scene: &Scene,
        rule: Rule,
        view: layout::View,
        sources: Sources,
        wanted: &Wanted<'_>,
        units: u32,
    ) -> Self {
        let is_listed = wanted.rays().is_some();
        let view = layout::View {
            torus_threshold: rule.torus_threshold,
            curve_threshold: rule.curve_threshold,
            ..view
        };
        let task = Task {
            method: Variant::of(scene.integration.method, rule),
            kinds: source_counts(&sources).map(|count| count > 0),
            has_squares: sources.have_squares(),
            has_depth: scene.depth.is_some() && !is_listed,
            film: match wanted {
                Wanted::Pixels(Output::Image(_)) => Film::Image,
                Wanted::Pixels(Output::Halves(_)) => Film::Halves,
                Wanted::Pixels(_) | Wanted::Rays(_) => Film::Floats,
            },
            rays: match has_tiles(scene) {
                _ if is_listed => Rays::Listed,
                true => Rays::Tiles,
                false => Rays::Pixels,
            },
        };
        let first_tile_size = tiles::first_size(scene.image);
        let (grain, most_pixels, most_sources) = match task.rays {
            Rays::Tiles => (
                first_tile_size * view.width,
                tiles::MOST_PIXELS,
                tiles::MOST_SOURCES,
            ),
            Rays::Pixels | Rays::Listed => (MOST_LANES, u32::MAX, u64::MAX),
        };
        let work = Work {
            node_count: match task.method {
                Variant::Simpson => scene.integration.divisions + 1,
                Variant::Exact { nodes, .. } => 8 * nodes,
            },
            source_count: source_count(&sources),
            fewest_pixels: (256 * units).max(1024),
            grain,
            most_pixels,
            most_sources,
        };
        Self {
            view,
            sources,
            work,
            task,
            tolerance: scene.integration.tolerance,
            first_tile_size,
        }
    }

    /// The passes of a part; none where no tiles are wanted.
    pub(super) fn passes(&self, part: &Part) -> Vec<layout::TilePass> {
        match self.task.rays {
            Rays::Tiles => {
                let size = self.first_tile_size;
                tiles::passes(part, &self.sources, &self.view, size, self.tolerance)
            }
            Rays::Pixels | Rays::Listed => Vec::new(),
        }
    }
}
