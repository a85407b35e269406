//! The light that space gives off, sampled into volumes.

use std::ops::ControlFlow;

use super::{Renderer, RendererBackend};
use glam::DVec3;

use crate::error::{Error, Result};
use crate::image::ImageSize;
use crate::reference::Emitter;
use crate::scene::{Measure, Profile, Ray, Reduction, Scene, ViewPlane};
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

/// Rays across the picture by which the error of a volume is measured, at most.
const MOST_ACROSS: u32 = 128;

/// A ray counts that has so much of the light of the brightest.
const LEAST_SHARE: f64 = 1e-3;

/// How far the light of a volume, interpolated linearly, is from that of its scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BakeError {
    /// The relative error that half of all rays have, and no others.
    pub median: f64,
    /// That which 99.9 % do not pass.
    pub most: f64,
    /// The greatest.
    pub worst: f64,
    /// How many rays count: those with at least a thousandth of the brightest one's light.
    pub rays: usize,
}

impl Renderer {
    /// Measures how exactly a volume shows its scene: along rays of the scene's camera, at most 128 across, as far as
    /// they are in the box, light without decay or absorption is compared with that of the cells, interpolated
    /// linearly. The error is that of the channel that is farthest off, relative to the brightest channel of the ray.
    /// `None`: no ray meets light in the box.
    ///
    /// # Errors
    /// As [`Renderer::integrate`].
    pub fn bake_error(&mut self, scene: &Scene, volume: &Volume) -> Result<Option<BakeError>> {
        let ImageSize { width, height } = scene.image;
        let across = MOST_ACROSS.min(width.max(height));
        let part = |edge: u32| (edge * across).div_ceil(width.max(height)).max(1);
        let size = ImageSize {
            width: part(width),
            height: part(height),
        };
        let mut bare = scene.clone();
        (bare.decay, bare.absorption, bare.depth) = (None, None, None);
        bare.integration.measure = Measure::Length;
        let plane = ViewPlane::new(&scene.camera, size, scene.ray_length());
        let pixels =
            (0..size.height).flat_map(|row| (0..size.width).map(move |column| (column, row)));
        let in_box = |(column, row)| {
            let ray = plane.ray(column, row);
            let [begin, end] = volume.grid().crossed(ray.origin, ray.span)?;
            Some(Ray::between(ray.at(begin), ray.at(end)))
        };
        let rays: Vec<Ray> = pixels.filter_map(in_box).collect();
        let exact = self.integrate(&bare, &rays)?;
        let mut found = vec![DVec3::ZERO; rays.len()];
        threads::for_each_chunk(&mut found, size.width as usize, |chunk, found| {
            let rays = &rays[chunk * size.width as usize..];
            for (found, ray) in found.iter_mut().zip(rays) {
                *found = volume.integral(ray.origin, ray.span);
            }
        });
        let exact: Vec<DVec3> = exact.into_iter().map(DVec3::from).collect();
        let brightest = exact.iter().map(|it| it.max_element()).fold(0.0, f64::max);
        let counts = |exact: &DVec3| exact.max_element() > LEAST_SHARE * brightest;
        let both = exact.iter().zip(&found).filter(|(exact, _)| counts(exact));
        let mut errors: Vec<f64> = both
            .map(|(exact, found)| (found - exact).abs().max_element() / exact.max_element())
            .collect();
        errors.sort_by(f64::total_cmp);
        let Some(&worst) = errors.last() else {
            return Ok(None);
        };
        let at =
            |share: f64| errors[((errors.len() as f64 * share) as usize).min(errors.len() - 1)];
        Ok(Some(BakeError {
            median: at(0.5),
            most: at(0.999),
            worst,
            rays: errors.len(),
        }))
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
        let mut cells = vec![[0.0_f32; 3]; plane];
        threads::for_each_chunk(&mut cells, columns, |row, cells| {
            let (y, z) = (row as u32 % rows, first + row as u32 / rows);
            for (x, cell) in (0..).zip(cells) {
                *cell = emitter
                    .in_cell(&grid, value, [x, y, z])
                    .as_vec3()
                    .to_array();
            }
        });
        let channel = |channel: usize| cells.iter().map(move |cell| cell[channel]);
        let values: Vec<f32> = (0..3).flat_map(channel).collect();
        volume.add_layer(layer, &values, columns)?;
        if progress((first + height) as f32 / layers as f32).is_break() {
            return Err(Error::Interrupted);
        }
    }
    Ok(volume)
}
