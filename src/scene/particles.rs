//! Particles as light: a list of points, each of which shines as far as its radius.

use std::ops::Range;

use glam::DVec3;

use super::points::PointList;
use super::values::{Checked, Fault, LARGEST, finite, positive, vector};
use super::{MetaballKernel, Scene};
use crate::error::SceneError;

/// Particles that shine: each gives off `coefficient kernel(r/h)`, up to its radius h, and nothing beyond. They hide
/// nothing.
///
/// ```
/// use energywave::scene::{Lattice, Particles, PointList};
///
/// let mut cloud = Particles::new(PointList::lattice(&Lattice::new(4096, 0.4))?, 0.6);
/// cloud.coefficient = 0.1;
/// # Ok::<(), energywave::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Particles {
    /// Where they are; weights multiply the light of each.
    pub points: PointList,
    /// The radius h of all particles that have none of their own, world units: their light ends there.
    pub radius: f64,
    /// What their light is multiplied with, 0 or more.
    pub coefficient: f64,
    /// Linear RGB.
    pub color: DVec3,
    /// How their light falls off.
    pub kernel: MetaballKernel,
    /// What is added to every position, world units.
    pub translate: DVec3,
}

impl Particles {
    /// Makes white particles of one radius and coefficient 1.
    #[must_use]
    pub fn new(points: PointList, radius: f64) -> Self {
        Self {
            points,
            radius,
            coefficient: 1.0,
            color: DVec3::ONE,
            kernel: MetaballKernel::default(),
            translate: DVec3::ZERO,
        }
    }

    /// Returns the greatest radius of its particles, world units.
    #[must_use]
    pub fn greatest_radius(&self) -> f64 {
        match self.points.sizes() {
            Some(sizes) => sizes.iter().map(|size| size.radius).fold(0.0, f64::max),
            None => self.radius,
        }
    }

    /// Calls `visit` with position, radius and light of every particle of a range.
    pub(crate) fn for_each(&self, range: Range<usize>, mut visit: impl FnMut(DVec3, f64, DVec3)) {
        let light = self.coefficient * self.color;
        let positions = self.points.positions()[range.clone()].iter();
        match self.points.sizes() {
            Some(sizes) => positions.zip(&sizes[range]).for_each(|(position, size)| {
                visit(*position + self.translate, size.radius, size.weight * light);
            }),
            None => positions.for_each(|position| {
                visit(*position + self.translate, self.radius, light);
            }),
        }
    }

    pub(super) fn check(&self) -> Checked {
        positive("radius", self.radius)?;
        finite("coefficient", self.coefficient)?;
        vector("color", self.color)?;
        for (key, least) in [
            ("coefficient", self.coefficient),
            ("color", self.color.min_element()),
        ] {
            if least < 0.0 {
                let message = format!("{least}; particles take no light away: 0 or more");
                return Err(Fault::new(key, message));
            }
        }
        vector("translate", self.translate)?;
        let (low, high) = self.points.bounds();
        let far = (low + self.translate)
            .abs()
            .max((high + self.translate).abs());
        if far.max_element() > LARGEST {
            let message = format!("it moves particles beyond {LARGEST:e}");
            return Err(Fault::new("translate", message));
        }
        Ok(())
    }
}

impl Scene {
    /// Returns whether particles are drawn as light: listed ones, elements, or those of waves.
    pub(crate) fn has_particles(&self) -> bool {
        let has_listed = self.particles.iter().any(|it| !it.points.is_empty());
        has_listed || !self.light_elements.is_empty() || !self.waves.is_empty()
    }

    pub(super) fn check_particles(&self) -> Result<(), SceneError> {
        for (index, particles) in self.particles.iter().enumerate() {
            let table = format!("particles[{index}]");
            particles.check().map_err(|fault| fault.of(&table))?;
        }
        for (index, element) in self.light_elements.iter().enumerate() {
            let fault = |fault: Fault| fault.of(&format!("light_elements[{index}]"));
            element.check().map_err(fault)?;
        }
        if self.has_particles() && self.integration.reduction != super::Reduction::Sum {
            let message = "particles add up: write \"sum\", or leave the particles out";
            return Err(SceneError::value("integration.reduction", message));
        }
        Ok(())
    }
}
