//! The mean of light over a pixel's square, from many rays: a square is cut in quarters for as long as a core is near.

use glam::DVec3;

use super::{GAUSSIAN_END, Source, Tracer};
use crate::scene::{Profile, Ray, Scene, ViewPlane};

/// Within so many pixels from a core, or from where light ends, a pixel is a mean.
const NEAR: f64 = 8.0;

/// A square is cut as long as a core is nearer than so many of its sides.
const CLEAR: f64 = 1.5;

/// Cuts at most.
const MOST_CUTS: u32 = 6;

/// Half the side of a square times this is where each of its four rays passes (Gauss, Legendre).
const GAUSS: f64 = 0.577_350_269_189_625_8;

/// A pixel, and the light that is seen through it.
pub(super) struct PixelView<'a> {
    tracer: &'a Tracer,
    scene: &'a Scene,
    plane: &'a ViewPlane,
    index: usize,
}

impl Tracer {
    pub(super) fn view<'a>(
        &'a self,
        scene: &'a Scene,
        plane: &'a ViewPlane,
        index: usize,
    ) -> PixelView<'a> {
        PixelView {
            tracer: self,
            scene,
            plane,
            index,
        }
    }
}

impl PixelView<'_> {
    /// Returns the pixel's linear RGB.
    pub(super) fn light(&self) -> DVec3 {
        let center = self.center();
        match self.is_mean() {
            true => self.mean_over(center, 1.0, 0),
            false => self.through(center),
        }
    }

    pub(super) fn is_mean(&self) -> bool {
        let has_footprints = self.tracer.integration.has_footprints();
        has_footprints && self.clearance(self.center(), true) < NEAR
    }

    /// Returns column and row.
    fn center(&self) -> (f64, f64) {
        let width = self.scene.image.width as usize;
        ((self.index % width) as f64, (self.index / width) as f64)
    }

    fn mean_over(&self, (column, row): (f64, f64), side: f64, cuts: u32) -> DVec3 {
        let is_clear = self.clearance((column, row), false) > CLEAR * side;
        let is_whole = is_clear || cuts == MOST_CUTS;
        let step = side * if is_whole { 0.5 * GAUSS } else { 0.25 };
        let parts = [(-step, -step), (step, -step), (-step, step), (step, step)];
        let parts = parts.map(|(right, below)| (column + right, row + below));
        let lights = parts.map(|part| match is_whole {
            true => self.through(part),
            false => self.mean_over(part, 0.5 * side, cuts + 1),
        });
        0.25 * lights.into_iter().sum::<DVec3>()
    }

    /// Returns the light along the ray through a place, which ends where the pixel's does.
    fn through(&self, (column, row): (f64, f64)) -> DVec3 {
        let ray = self.plane.ray_at(column, row);
        let end = self.scene.depth.as_ref().map_or(1.0, |depth| {
            let depth_here = depth.as_slice()[self.index];
            self.plane.end(&ray, depth_here, depth.along())
        });
        self.tracer.radiance(&ray, end, self.index as u32)
    }

    /// Returns how many pixels the ray through a place passes the nearest core, or where light ends if `with_ends`; a
    /// core's thickness keeps it away.
    fn clearance(&self, (column, row): (f64, f64), with_ends: bool) -> f64 {
        let ray = self.plane.ray_at(column, row);
        let to_plane = ray.origin.distance(self.plane.eye);
        let pixel = self.plane.column_step.length();
        let mut least = f64::INFINITY;
        let mut places = Vec::new();
        for source in &self.tracer.sources {
            places.clear();
            source.field.breaks(&ray, &mut places);
            for s in &places {
                let s = s.clamp(0.0, 1.0);
                let growth = match self.plane.is_parallel {
                    true => 1.0,
                    false => (to_plane + s * self.plane.ray_length) / to_plane,
                };
                let pixel_there = pixel * growth;
                least = least.min(self.to_core(source, &ray, s, with_ends) / pixel_there);
            }
        }
        least
    }

    /// Returns how far a point of a ray is from a core, or from where its light ends, world units.
    fn to_core(&self, source: &Source, ray: &Ray, s: f64, with_ends: bool) -> f64 {
        let falloff = source.falloff;
        let distance = source.field.sample(ray.at(s)).distance2.sqrt();
        let thickness = falloff.radius.hypot(self.tracer.integrand.softening);
        let width = (falloff.profile == Profile::Gaussian).then_some(GAUSSIAN_END * falloff.radius);
        let to_end = |end: f64| (distance - end).abs();
        let ends = [falloff.reach, width].into_iter().flatten();
        let nearest_end = ends.map(to_end).fold(f64::INFINITY, f64::min);
        let to_core = distance.hypot(thickness);
        match with_ends {
            true => to_core.min(nearest_end),
            false => to_core,
        }
    }
}
