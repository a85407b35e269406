//! What a frame of a crowd enqueues: cells of points, tiles that take the light of cells, and pixels that take that of
//! tiles.

use opencl3::event::Event;

use super::COUNTS;
use super::buffers::Buffers;
use super::kernels::Kernels;
use super::pack::CrowdView;
use crate::error::Result;
use crate::opencl::{Argument, Compute, Handle, Kernel};

/// What a launch belongs to.
#[derive(Debug, Clone, Copy)]
pub(super) enum Stage {
    Cells,
    Tiles,
    Pixels,
}

/// What launches need.
pub(super) struct Enqueue<'a> {
    pub compute: &'a Compute,
    pub view: &'a CrowdView,
    pub buffers: &'a Buffers,
    pub lanes: u32,
    pub group: usize,
    pub under_way: &'a mut Vec<(Stage, Handle<Event>)>,
}

impl Enqueue<'_> {
    pub(super) fn launch(
        &mut self,
        stage: Stage,
        kernel: &Kernel,
        arguments: &[(&str, &dyn Argument)],
        items: usize,
    ) -> Result<()> {
        let arguments: Vec<(&str, &dyn Argument)> = arguments
            .iter()
            .copied()
            .chain([("view", self.view as &dyn Argument)])
            .collect();
        let group = kernel.group(self.compute, self.group)?;
        let event = kernel.launch(self.compute, &arguments, items.max(1), group)?;
        self.under_way.push((stage, event));
        Ok(())
    }

    /// Enqueues all that comes before pixels.
    pub(super) fn light_tiles(&mut self, kernels: &Kernels, depths: &dyn Argument) -> Result<()> {
        let (view, buffers) = (self.view, self.buffers);
        let ranges = ("ranges", buffers.ranges.argument());
        if let Some(find_ends) = &kernels.find_ends {
            let shares = ("shares", buffers.shares.argument());
            let tiles = view.tile_columns * view.height.div_ceil(8);
            self.launch(
                Stage::Tiles,
                find_ends,
                &[("depths", depths), shares, ranges],
                tiles as usize,
            )?;
        }
        let cells = |level: u32| view.cells(level);
        let peaks = ("peaks", buffers.peaks.argument());
        let levels = ("levels", buffers.levels.argument());
        let starts = ("starts", buffers.starts.argument());
        let sources = ("sources", buffers.sources.argument());
        let codes = ("cells", buffers.cells.argument());
        let numbers = ("numbers", buffers.numbers.argument());
        let nodes = ("nodes", buffers.nodes.argument());
        let planes = ("planes", buffers.planes.argument());
        let counts = ("counts", buffers.counts.argument());
        let is_wanted = ("is_wanted", buffers.is_wanted.argument());
        let all = view.cells_below(view.top + 1);
        self.launch(
            Stage::Cells,
            &kernels.clear,
            &[counts, is_wanted],
            all.max(COUNTS),
        )?;
        let items = (view.sources as usize).div_ceil(self.lanes as usize);
        self.launch(Stage::Cells, &kernels.find_peaks, &[codes, sources], items)?;
        self.launch(
            Stage::Cells,
            &kernels.sum_cells,
            &[starts, sources, peaks, levels],
            cells(0),
        )?;
        for level in 1..=view.top {
            let level_argument = ("level", &level as &dyn Argument);
            self.launch(
                Stage::Cells,
                &kernels.sum_quarters,
                &[level_argument, peaks, levels],
                cells(level),
            )?;
        }
        let base = ("level", &view.base as &dyn Argument);
        let [is_flat, is_deep] = [&0_u32, &1_u32].map(|it| ("has_depths", it as &dyn Argument));
        let laid = [
            base, is_deep, starts, codes, sources, numbers, is_wanted, nodes, planes,
        ];
        self.launch(Stage::Cells, &kernels.lay_sources, &laid, cells(view.base))?;
        for level in view.base + 1..=view.top {
            let laid = [
                ("level", &level as &dyn Argument),
                starts,
                numbers,
                nodes,
                planes,
            ];
            self.launch(Stage::Cells, &kernels.lay_quarters, &laid, cells(level))?;
        }
        let mut first = 0_u32;
        let limits = ("limits", buffers.limits.argument());
        for level in (0..=view.top).rev() {
            let argument = ("level", &level as &dyn Argument);
            if level < view.shallow {
                let nodes = ("nodes", buffers.limits.argument());
                let laid = [
                    argument, is_flat, starts, codes, sources, numbers, is_wanted, nodes, planes,
                ];
                self.launch(Stage::Cells, &kernels.lay_sources, &laid, cells(level))?;
            }
            let tiles = view.tile_count(level);
            let next = first + tiles as u32;
            let arguments = [
                argument,
                ("first_slot", &first),
                ("next_slot", &next),
                ("roots", buffers.roots.argument()),
                starts,
                ("places", buffers.cells.argument()),
                sources,
                peaks,
                levels,
                nodes,
                limits,
                ("rest", buffers.rest.argument()),
                numbers,
                planes,
                ("tiles", buffers.tiles.argument()),
                ("values", buffers.values.argument()),
                ("owners", buffers.owners.argument()),
                is_wanted,
                counts,
                ranges,
                ("ends_of_tiles", buffers.ends.argument()),
            ];
            self.launch(Stage::Tiles, &kernels.light_tiles, &arguments, tiles)?;
            first = next;
        }
        Ok(())
    }
}
