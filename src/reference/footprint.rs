//! The mean of light over a pixel's square, from many rays: a square is cut in quarters for as long as a core is near.

use glam::DVec3;

use super::{Source, Tracer};
use crate::scene::{Profile, Scene, ViewPlane};

/// Within so many pixels from a core a pixel is a mean; farther off where some light ends, towards which it curves all
/// the way.
const NEAR: f64 = 8.0;
const NEAR_END: f64 = 97.0;

/// A square is cut as long as a core, or the end of its light, is nearer than so many of its sides.
const CLEAR: f64 = 1.5;

/// Cuts at most; light begins so gently that fewer do at its end.
const MOST_CUTS: u32 = 7;
const MOST_CUTS_AT_END: u32 = 3;

/// So thick a core is at least, in pixels: the mean of 1/q^2 over a bare one is infinite.
const LEAST_THICKNESS: f64 = 1.0 / 64.0;

/// Half the side of a square times this is where each of its four rays passes (Gauss, Legendre).
const GAUSS: f64 = 0.577_350_269_189_625_8;

/// A pixel, and the light that is seen through it.
pub(super) struct PixelView<'a> {
    tracer: &'a Tracer,
    scene: &'a Scene,
    plane: &'a ViewPlane,
    index: usize,
    /// How thick cores are at least, world units.
    thickness: f64,
}

impl Tracer {
    pub(super) fn view<'a>(
        &'a self,
        scene: &'a Scene,
        plane: &'a ViewPlane,
        index: usize,
    ) -> PixelView<'a> {
        let mut view = PixelView {
            tracer: self,
            scene,
            plane,
            index,
            thickness: 0.0,
        };
        if self.integration.has_footprints() {
            view.thickness = LEAST_THICKNESS * view.clearance(view.center()).pixel;
        }
        view
    }
}

impl PixelView<'_> {
    /// Returns the pixel's linear RGB.
    pub(super) fn light(&self) -> DVec3 {
        let center = self.center();
        match self.is_mean() {
            true => self.mean_over(center, 1.0, 0),
            false => self.through(center, false),
        }
    }

    pub(super) fn is_mean(&self) -> bool {
        let ends = |source: &Source| {
            source.falloff.reach.is_some() || source.falloff.profile == Profile::Gaussian
        };
        let near = match self.tracer.sources.iter().any(ends) {
            true => NEAR_END,
            false => NEAR,
        };
        let has_footprints = self.tracer.integration.has_footprints();
        has_footprints && self.clearance(self.center()).core < near
    }

    /// Returns column and row.
    fn center(&self) -> (f64, f64) {
        let width = self.scene.image.width as usize;
        ((self.index % width) as f64, (self.index / width) as f64)
    }

    fn mean_over(&self, (column, row): (f64, f64), side: f64, cuts: u32) -> DVec3 {
        let clearance = self.clearance((column, row));
        let is_clear = clearance.core > CLEAR * side;
        let is_even = clearance.end > CLEAR * side || cuts >= MOST_CUTS_AT_END;
        let is_whole = is_clear && is_even || cuts == MOST_CUTS;
        let step = side * if is_whole { 0.5 * GAUSS } else { 0.25 };
        let parts = [(-step, -step), (step, -step), (-step, step), (step, step)];
        let parts = parts.map(|(right, below)| (column + right, row + below));
        let lights = parts.map(|part| match is_whole {
            true => self.through(part, true),
            false => self.mean_over(part, 0.5 * side, cuts + 1),
        });
        0.25 * lights.into_iter().sum::<DVec3>()
    }

    /// Returns the light along the ray through a place, which ends where the pixel's does; of those that a mean is made
    /// of if `is_part`.
    fn through(&self, (column, row): (f64, f64), is_part: bool) -> DVec3 {
        let ray = self.plane.ray_at(column, row);
        let end = self.scene.depth.as_ref().map_or(1.0, |depth| {
            let depth_here = depth.as_slice()[self.index];
            self.plane.end(&ray, depth_here, depth.along())
        });
        let mut integrand = self.tracer.integrand;
        if is_part {
            integrand.softening = integrand.softening.max(self.thickness);
        }
        let number = self.index as u32;
        self.tracer.radiance_of(&integrand, &ray, end, number)
    }

    /// Returns how far the ray through a place passes cores and the ends of their light.
    fn clearance(&self, (column, row): (f64, f64)) -> Clearance {
        let ray = self.plane.ray_at(column, row);
        let to_plane = ray.origin.distance(self.plane.eye);
        let pixel = self.plane.column_step.length();
        let mut least = Clearance {
            core: f64::INFINITY,
            end: f64::INFINITY,
            pixel: 0.0,
        };
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
                let pixel = pixel * growth;
                let distance = source.field.sample(ray.at(s)).distance2.sqrt();
                if let Some(reach) = source.falloff.reach {
                    least.end = least.end.min((distance - reach).abs() / pixel);
                }
                let softening = self.tracer.integrand.softening.max(self.thickness);
                let core = distance.hypot(source.falloff.radius.hypot(softening)) / pixel;
                if core < least.core {
                    (least.core, least.pixel) = (core, pixel);
                }
            }
        }
        least
    }
}

/// How many pixels a ray passes the nearest core, whose thickness keeps it away, and the nearest end of light; and the
/// side of a pixel at that core, world units.
struct Clearance {
    core: f64,
    end: f64,
    pixel: f64,
}
