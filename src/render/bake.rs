//! The light that space gives off, sampled into volumes.

use std::ops::ControlFlow;

use super::{Renderer, RendererBackend};

use crate::error::{Error, Result};
use crate::reference::Emitter;
use crate::scene::{Profile, Reduction, Scene};
use crate::threads;
use crate::volume::{BRICK, CellValue, Grid, Storage, Volume};

/// Most places along an edge of a cell.
const MOST_PARTS: u32 = 16;

impl Scene {
    /// Returns what cells are best given: the emission in their middles where all cores have a thickness, else means of
    /// 4x4x4 places, because light has no end next to a core that has none.
    #[must_use]
    pub fn cell_value(&self) -> CellValue {
        let is_endless = |it: crate::scene::Falloff| it.radius == 0.0;
        match self.integration.softening == 0.0 && self.any_falloff(is_endless) {
            true => CellValue::Mean(4),
            false => CellValue::Center,
        }
    }

    /// Returns what cells are best given whose reciprocals are stored: apart what all but the strongest source give,
    /// where there are several and no two share a core, else the emission in their middles.
    #[must_use]
    pub fn reciprocal_cell_value(&self) -> CellValue {
        let sources = self.source_count();
        let mut is_bright = true;
        self.for_each_emission(&mut |emission| is_bright &= emission.min_element() >= 0.0);
        match sources > 1 && self.light_count() == sources && is_bright {
            true => CellValue::Apart,
            false => CellValue::Center,
        }
    }

    /// Returns whether any core is thinner than a cell with such an edge, world units: the middles of cells then meet
    /// it by chance.
    #[must_use]
    pub fn is_thinner_than(&self, cell: f64) -> bool {
        let softening = self.integration.softening;
        self.any_falloff(|it| 2.0 * it.radius.hypot(softening) < cell)
    }

    /// Returns the reciprocals that are the square of a distance near a core: of power 1 where all light falls off
    /// with its square, else 2.
    #[must_use]
    pub fn reciprocal(&self) -> Storage {
        let is_other = |it: crate::scene::Falloff| it.profile != Profile::InverseSquare;
        let power = if self.any_falloff(is_other) { 2 } else { 1 };
        Storage::Reciprocal { power }
    }

    /// Refuses what has no emission at a point.
    fn check_bake(&self, value: CellValue) -> Result<()> {
        let refuse = |message: &str| Err(Error::Unsupported(message.to_owned()));
        if self.integration.reduction == Reduction::Rms {
            return refuse(
                "with reduction \"rms\" points of space give off no light: bake a scene with \"sum\"",
            );
        }
        if self.has_particles() || !self.waves.is_empty() {
            return refuse("particles are not baked: bake the scene without them");
        }
        if self.has_points() {
            return refuse(
                "[[points]] are not baked: write them as [[sphere]], or bake the scene without them",
            );
        }
        if !self.volumes.is_empty() {
            return refuse("volumes are not baked: bake the scene without them");
        }
        if let CellValue::Mean(parts) = value
            && !(1..=MOST_PARTS).contains(&parts)
        {
            return refuse("means are of 1 to 16 places along an edge of a cell");
        }
        Ok(())
    }
}

impl Renderer {
    /// Samples the emission of a scene, colour times coefficient times field summed over its sources, in the cells of a
    /// grid: linear RGB, what a world unit of a ray's length gives off there. The light of a ray that does not fade,
    /// measured by length, is its integral. Decay, absorption, camera and depth play no part; surfaces give off no such
    /// light. Several devices leave it to their first.
    ///
    /// # Errors
    /// As [`Renderer::render`]; [`Error::OutOfMemory`] if a volume does not fit; [`Error::Unsupported`] for
    /// particles, for roots of squares, and for means of no or more than 16 places; [`Error::Interrupted`] if
    /// `progress`, which hears the share that is done, says so.
    pub fn bake(
        &mut self,
        scene: &Scene,
        grid: Grid,
        value: CellValue,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Volume> {
        self.check(scene)?;
        scene.check_bake(value)?;
        match &mut self.backend {
            RendererBackend::OpenCl(renderer) => renderer.bake(scene, (grid, value), progress),
            RendererBackend::Several(renderer) => {
                renderer.first().bake(scene, (grid, value), progress)
            }
            RendererBackend::Reference { .. } => bake_reference(scene, (grid, value), progress),
        }
    }
}

/// Samples in float64 on the host.
fn bake_reference(
    scene: &Scene,
    (grid, value): (Grid, CellValue),
    progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
) -> Result<Volume> {
    let emitter = Emitter::new(scene);
    let [columns, rows, layers] = grid.cells();
    let mut volume = Volume::new(grid, value)?;
    let columns = columns as usize;
    for layer in 0..layers.div_ceil(BRICK) {
        let first = layer * BRICK;
        let height = BRICK.min(layers - first);
        let plane = columns * (rows * height) as usize;
        let mut cells = vec![[[0.0_f32; 3]; 2]; plane];
        let is_apart = value == CellValue::Apart;
        threads::for_each_chunk(&mut cells, columns, |row, cells| {
            let (y, z) = (row as u32 % rows, first + row as u32 / rows);
            for (x, cell) in (0..).zip(cells) {
                cell[0] = emitter
                    .in_cell(&grid, value, [x, y, z])
                    .as_vec3()
                    .to_array();
                if is_apart {
                    cell[1] = emitter.rest_in_cell(&grid, [x, y, z]).as_vec3().to_array();
                }
            }
        });
        let channel = |at: usize| cells.iter().map(move |cell| cell[at / 3][at % 3]);
        let channels = if is_apart { 6 } else { 3 };
        let values: Vec<f32> = (0..channels).flat_map(channel).collect();
        volume.add_layer(layer, &values, columns)?;
        if progress((first + height) as f32 / layers as f32).is_break() {
            return Err(Error::Interrupted);
        }
    }
    Ok(volume)
}
