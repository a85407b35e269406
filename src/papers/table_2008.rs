//! The speed table of Mishima, Tanaka, Sagawa 2008: metaballs in layers of 24 by 24, by number and by size of the
//! picture; exactly, and by the paper's own procedure.

use std::time::Duration;

use glam::DVec3;

use super::{Speed, measure};
use crate::error::Result;
use crate::image::ImageSize;
use crate::render::Renderer;
use crate::scene::{
    Antialias, Camera, Lattice, MetaballMethod, MetaballSampling, Metaballs, PointList, Scene,
};

/// The radius of 2008, world units.
const RADIUS: f64 = 0.61;

/// Between particles, world units: the paper does not say it. Here the surface has pits, which it needs samples for.
const SPACING: f64 = 0.45;

/// A cell of the table, seen from far or from near.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell2008 {
    /// How many particles there are.
    pub particles: u32,
    /// Width and height, pixels.
    pub resolution: u32,
    /// Whether the surface fills the picture, or about a fifth of it. The paper does not say how it is seen.
    pub is_near: bool,
    /// Frames a second that the paper reports (NVIDIA GeForce 8800 GTX), by 32 samples of a ray.
    pub paper_fps: f64,
}

/// Particles and resolutions of the table, with the frames a second that the paper reports: rows by resolution.
pub const PARTICLES_2008: [u32; 3] = [4096, 16384, 65536];
const RESOLUTIONS: [u32; 3] = [128, 256, 512];
const PAPER_FPS: [[f64; 3]; 3] = [[60.0, 37.0, 12.0], [35.0, 21.0, 7.0], [11.0, 10.0, 3.0]];

/// Returns the table, each cell from far and from near.
#[must_use]
pub fn table_2008() -> Vec<Cell2008> {
    let mut cells = Vec::new();
    for (row, resolution) in RESOLUTIONS.into_iter().enumerate() {
        for (column, particles) in PARTICLES_2008.into_iter().enumerate() {
            for is_near in [false, true] {
                cells.push(Cell2008 {
                    particles,
                    resolution,
                    is_near,
                    paper_fps: PAPER_FPS[row][column],
                });
            }
        }
    }
    cells
}

/// The ways of the table: exactly, and by samples in steps of h/8 and h/16.
#[must_use]
pub fn methods_2008() -> [MetaballMethod; 3] {
    let sampling = |share: f64, samples| {
        MetaballMethod::Sampling(MetaballSampling {
            interval: Some(RADIUS / share),
            samples,
            refinements: 1,
        })
    };
    [MetaballMethod::Exact, sampling(8.0, 32), sampling(16.0, 64)]
}

/// What was measured of a cell.
#[derive(Debug)]
pub struct Speed2008 {
    /// Of whole frames.
    pub speed: Speed,
    /// The part of the rays that meet the surface.
    pub hit: f64,
    /// The part of those that the method misses.
    pub holes: f64,
    /// Time in which particles were sorted into cells, a frame.
    pub sort: Duration,
    /// Places of a ray at which the summed field was taken, and fields of particles that were added up for it.
    pub passes: f64,
    /// See `passes`. A ray counts those of all rays that are side by side with it in one vector.
    pub pairs: f64,
}

impl Cell2008 {
    /// Makes the cell's scene.
    ///
    /// # Errors
    /// None.
    pub fn scene(&self, method: MetaballMethod) -> Result<Scene> {
        let lattice = Lattice {
            jitter: 0.25,
            seed: 1,
            ..Lattice::new(self.particles, SPACING)
        };
        let toward_eye = DVec3::new(0.3, -0.95, 0.75).normalize();
        let distance = match (self.is_near, self.particles) {
            (true, _) => 13.0,
            (false, ..=4096) => 42.0,
            (false, ..=16384) => 57.0,
            (false, _) => 96.0,
        };
        let mut camera = Camera::new(distance * toward_eye, DVec3::ZERO);
        camera.fov_y = 30.0;
        let mut scene = Scene::new(camera);
        scene.image = ImageSize {
            width: self.resolution,
            height: self.resolution,
        };
        scene.integration.antialias = Antialias::None;
        scene.metaballs.push(Metaballs {
            method,
            ..Metaballs::new(PointList::lattice(&lattice)?, RADIUS)
        });
        Ok(scene)
    }

    /// Measures the cell by a method; a second renderer, which counts samples, counts a frame's.
    ///
    /// # Errors
    /// As [`measure`].
    pub fn measure(
        &self,
        (renderer, counting): (&mut Renderer, &mut Renderer),
        method: MetaballMethod,
        time: Duration,
    ) -> Result<Speed2008> {
        let scene = self.scene(method)?;
        counting.see_surfaces(&scene)?;
        let counts = counting.surface_counts();
        let per_ray = |count: u64| count as f64 / scene.image.pixels() as f64;
        let speed = measure(renderer, &scene, time)?;
        let sort = renderer.surface_sorting();
        let mut lengths = |method| -> Result<Vec<f32>> {
            let (seen, _) = renderer.see_surfaces(&self.scene(method)?)?;
            Ok(seen.depth.as_slice().to_vec())
        };
        let (exact, found) = (lengths(MetaballMethod::Exact)?, lengths(method)?);
        let hits = exact.iter().filter(|length| length.is_finite()).count();
        let missed = exact.iter().zip(&found);
        let missed = missed.filter(|(exact, found)| exact.is_finite() && found.is_infinite());
        Ok(Speed2008 {
            speed,
            hit: hits as f64 / exact.len() as f64,
            holes: missed.count() as f64 / hits.max(1) as f64,
            sort,
            passes: per_ray(counts.passes),
            pairs: per_ray(counts.pairs),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_has_every_cell_from_far_and_from_near() {
        let cells = table_2008();
        assert_eq!(cells.len(), 18);
        let of = |particles, resolution| {
            let is_it =
                |cell: &&Cell2008| (cell.particles, cell.resolution) == (particles, resolution);
            cells
                .iter()
                .filter(is_it)
                .map(|cell| cell.paper_fps)
                .collect::<Vec<_>>()
        };
        assert_eq!(of(4096, 128), [60.0; 2]);
        assert_eq!(of(65536, 128), [12.0; 2]);
        assert_eq!(of(4096, 512), [11.0; 2]);
        for method in methods_2008() {
            let scene = cells[0].scene(method).unwrap();
            scene.validate().unwrap();
            assert_eq!(scene.metaballs[0].points.len(), 4096);
        }
    }
}
