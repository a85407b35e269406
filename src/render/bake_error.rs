//! How exactly volumes show the scenes that they were baked from.

use glam::DVec3;

use super::Renderer;
use crate::error::Result;
use crate::image::ImageSize;
use crate::scene::{self, Measure, Ray, Scene, ViewPlane};
use crate::threads;
use crate::volume::{Grid, Volume};

/// Rays across the picture by which the error of a volume is measured, at most.
const MOST_ACROSS: u32 = 128;

/// A ray counts that has so much of the light that rays have on average.
const LEAST_SHARE: f64 = 1e-3;

/// How far the light of a volume is from that of its scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BakeError {
    /// The relative error that half of all rays have, and no others.
    pub median: f64,
    /// That which 99 % do not pass.
    pub many: f64,
    /// That which 99.9 % do not pass.
    pub most: f64,
    /// The greatest.
    pub worst: f64,
    /// How many rays count: those with at least a thousandth of the light that rays have on average.
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
        let (_, rays) = rays_of(&bare(scene), volume.grid());
        let mut found = vec![DVec3::ZERO; rays.len()];
        threads::for_each_chunk(&mut found, 64, |chunk, found| {
            for (found, ray) in found.iter_mut().zip(&rays[64 * chunk..]) {
                *found = volume.integral(ray.origin, ray.span);
            }
        });
        self.error_of(scene, &rays, &found)
    }

    /// Measures the same of a volume as this renderer draws it, however its cells are stored and interpolated. `grid`
    /// is the box that it was baked from, which it fills.
    ///
    /// # Errors
    /// As [`Renderer::render`] and [`Renderer::integrate`].
    pub fn drawn_error(
        &mut self,
        scene: &Scene,
        grid: &Grid,
        drawn: &scene::Volume,
    ) -> Result<Option<BakeError>> {
        let bare = bare(scene);
        let (size, rays) = rays_of(&bare, grid);
        let mut of_volume = Scene::new(bare.camera.clone());
        of_volume.image = size;
        of_volume.integration.measure = Measure::Length;
        of_volume.integration.volumes = bare.integration.volumes;
        of_volume.volumes.push(drawn.clone());
        let image = self.render(&of_volume)?;
        let pixels = image.as_slice().as_chunks::<4>().0.iter();
        let plane = ViewPlane::new(&bare.camera, size, bare.ray_length());
        let places =
            (0..size.height).flat_map(|row| (0..size.width).map(move |column| (column, row)));
        let in_box = pixels
            .zip(places)
            .filter(|(_, place)| crossed(&plane, grid, *place).is_some());
        let light =
            |[red, green, blue, _]: [f32; 4]| DVec3::from([red, green, blue].map(f64::from));
        let found: Vec<DVec3> = in_box.map(|(pixel, _)| light(*pixel)).collect();
        self.error_of(scene, &rays, &found)
    }

    /// Compares the light of rays with that of a scene.
    fn error_of(
        &mut self,
        scene: &Scene,
        rays: &[Ray],
        found: &[DVec3],
    ) -> Result<Option<BakeError>> {
        let exact = self.integrate(&bare(scene), rays)?;
        let exact: Vec<DVec3> = exact.into_iter().map(DVec3::from).collect();
        let all: f64 = exact.iter().map(|it| it.max_element()).sum();
        let least = LEAST_SHARE * all / exact.len().max(1) as f64;
        let counts = |exact: &DVec3| exact.max_element() > least;
        let both = exact.iter().zip(found).filter(|(exact, _)| counts(exact));
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
            many: at(0.99),
            most: at(0.999),
            worst,
            rays: errors.len(),
        }))
    }
}

/// Returns a scene whose light does not fade, by length, and is hidden by nothing.
fn bare(scene: &Scene) -> Scene {
    let mut bare = scene.clone();
    (bare.decay, bare.absorption, bare.depth) = (None, None, None);
    bare.integration.measure = Measure::Length;
    bare.camera.ray_length = Some(scene.ray_length());
    bare
}

/// Returns the parts of a picture's rays that are in a box, row by row, and its size.
fn rays_of(scene: &Scene, grid: &Grid) -> (ImageSize, Vec<Ray>) {
    let ImageSize { width, height } = scene.image;
    let across = MOST_ACROSS.min(width.max(height));
    let part = |edge: u32| (edge * across).div_ceil(width.max(height)).max(1);
    let size = ImageSize {
        width: part(width),
        height: part(height),
    };
    let plane = ViewPlane::new(&scene.camera, size, scene.ray_length());
    let pixels = (0..size.height).flat_map(|row| (0..size.width).map(move |column| (column, row)));
    (
        size,
        pixels
            .filter_map(|place| crossed(&plane, grid, place))
            .collect(),
    )
}

fn crossed(plane: &ViewPlane, grid: &Grid, (column, row): (u32, u32)) -> Option<Ray> {
    let ray = plane.ray(column, row);
    let [begin, end] = grid.crossed(ray.origin, ray.span)?;
    Some(Ray::between(ray.at(begin), ray.at(end)))
}
