//! The light that space gives off in the cells of a grid, a layer of bricks at a time.

use std::ops::ControlFlow;

use glam::DVec3;

use super::Wave;
use super::kernels::{Rays, Task, Variant};
use super::pack::layout::{Cells, Launch};
use super::pack::{self, Anchor, Pixel};
use crate::error::{Error, Result};
use crate::opencl::{Argument, Compute, DeviceBuffer, FilmFormat, run_time};
use crate::scene::{Reduction, Scene};
use crate::volume::{BRICK, CellValue, Grid, Volume};

/// Rows are a multiple of this many cells.
const MOST_LANES: u32 = 16;

/// Samples of fields in a launch: desktop GPUs kill launches of seconds.
const MOST_SAMPLES: u64 = 1 << 28;

/// Work-items in a group; they share nothing.
const GROUP: usize = 16;

impl Wave {
    /// Samples the emission of a valid scene in the cells of a grid. `progress` hears the share that is done.
    ///
    /// # Errors
    /// As [`crate::Renderer::bake`].
    pub(crate) fn bake(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        (grid, value): (Grid, CellValue),
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Volume> {
        let mut volume = Volume::new(grid, value)?;
        let [_, rows, layers] = grid.cells();
        let task = self.prepare_cells(compute, scene, &grid)?;
        let mut cells = packed(&grid, value);
        let channels = cells.channels as usize;
        let mut values = vec![0.0; channels * cells.plane as usize];
        let buffer = DeviceBuffer::new(compute, "a layer of cells", values.len())?;
        for layer in 0..layers.div_ceil(BRICK) {
            let first = layer * BRICK;
            let height = BRICK.min(layers - first);
            cells.first[2] = (f64::from(first) * grid.cell() + low(&grid).z) as f32;
            cells.count = rows * height;
            cells.plane = cells.count * cells.stride;
            let values = &mut values[..channels * cells.plane as usize];
            self.launch_cells(compute, scene, task, &cells, &buffer)?;
            buffer.read(compute, values)?;
            volume.add_layer(layer, values, cells.stride as usize)?;
            if progress((first + height) as f32 / layers as f32).is_break() {
                return Err(Error::Interrupted);
            }
        }
        self.lists.settle(compute)?;
        Ok(volume)
    }

    /// Packs and uploads the sources as the middle of a grid sees them, and makes sure that the kernel is built.
    fn prepare_cells(&mut self, compute: &Compute, scene: &Scene, grid: &Grid) -> Result<Task> {
        let [low, high] = grid.bounds();
        let anchor = Anchor {
            origin: 0.5 * (low + high),
            reach: 0.5 * (high - low).length(),
            measure: 1.0,
            pixel: Pixel::None,
            tolerance: scene.integration.method.tolerance(),
            reduction: Reduction::Sum,
        };
        let stamp = self.packed.pack(scene, anchor);
        let facts = self.packed.facts(scene).clone();
        let task = Task {
            method: Variant::Simpson, // whose kernels sample fields
            kinds: self.packed.sources.counts().map(|count| count > 0),
            has_squares: facts.has_squares,
            has_shapes: facts.has_shapes,
            has_convolutions: facts.has_convolutions,
            fading: None,
            reduced: super::Reduced::Sum,
            has_series: self.packed.sources.rows.has_series,
            has_ends: false,
            has_footprints: false,
            has_depth: false,
            film: FilmFormat::Floats,
            rays: Rays::Cells,
        };
        let rule = self.rule_for(scene);
        if let Some(program) = self.kernels.prepare(compute, &self.options, task, &rule)? {
            self.self_test(compute, task, &program)?;
        }
        self.lists
            .upload_sources(compute, &self.packed.sources, stamp)?;
        Ok(task)
    }

    /// Launches the kernel over rows of cells, as many at a time as a launch may take, and waits for it.
    fn launch_cells(
        &mut self,
        compute: &Compute,
        scene: &Scene,
        task: Task,
        cells: &Cells,
        buffer: &DeviceBuffer<f32>,
    ) -> Result<()> {
        let counts = self.packed.sources.counts();
        let samples_of_row = u64::from(cells.stride)
            * u64::from(cells.parts).pow(3)
            * counts.iter().sum::<u64>().max(1);
        let at_once = (MOST_SAMPLES / samples_of_row).clamp(1, u64::from(cells.count)) as u32;
        let integrand = pack::integrand(scene, &self.rule_for(scene), 0);
        let launch = Launch {
            begin: Default::default(),
            end: counts.map(|count| count as u32),
            first_ball: Default::default(),
            first_count: 0,
        };
        let kernel = self.kernels.get(task)?;
        let group = kernel.group(compute, GROUP)?;
        let lists = self.lists.named(&self.packed.sources);
        for first in (0..cells.count).step_by(at_once as usize) {
            let end = (first + at_once).min(cells.count);
            let mut arguments: Vec<(&str, &dyn Argument)> = vec![
                ("cells", cells),
                ("first_row", &first),
                ("end_row", &end),
                ("integrand", &integrand),
                ("launch", &launch),
                ("values", buffer),
            ];
            arguments.extend(lists.iter().filter(|(name, _)| *name != "nodes"));
            let event = kernel.launch(compute, &arguments, (end - first) as usize, group)?;
            run_time(compute, &event)?;
        }
        Ok(())
    }
}

/// Returns the lowest corner of a grid, seen from its middle.
fn low(grid: &Grid) -> DVec3 {
    let [low, high] = grid.bounds();
    0.5 * (low - high)
}

/// Packs a layer of bricks of a grid, the first.
fn packed(grid: &Grid, value: CellValue) -> Cells {
    let [columns, rows, layers] = grid.cells();
    let count = rows * layers.min(BRICK);
    let stride = columns.next_multiple_of(MOST_LANES);
    let parts = value.parts();
    let first = low(grid);
    Cells {
        first: [first.x as f32, first.y as f32, first.z as f32, 0.0],
        step: grid.cell() as f32,
        floor2: value.floor2(grid.cell()) as f32,
        share: 1.0 / (parts as f32).powi(3),
        parts,
        columns,
        rows,
        count,
        stride,
        plane: count * stride,
        channels: if value == CellValue::Apart { 6 } else { 3 },
        padding0: 0,
        padding1: 0,
    }
}
