//! Metaballs: the surface on which the summed field of particles reaches a threshold (Blinn 1982; the field and the
//! test are those of Mishima, Tanaka, Sagawa 2008). They are no sources: they hide the light behind them.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::points::PointList;
use super::values::{Checked, Fault, LARGEST, positive, vector};

/// A surface of metaballs: where the sum of the particles' fields is the threshold. What lies behind it is hidden.
///
/// ```
/// use energywave::scene::{Lattice, Metaballs, PointList};
///
/// let points = PointList::lattice(&Lattice::new(4096, 0.4))?;
/// let block = Metaballs::new(points, 0.61);
/// assert_eq!(block.threshold, 0.765625);
/// # Ok::<(), energywave::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Metaballs {
    /// The particles.
    pub points: PointList,
    /// The radius h of all particles that have none of their own, world units: beyond it there is no field.
    pub radius: f64,
    /// The value of the summed field on the surface, T; positive.
    pub threshold: f64,
    /// How a particle's field falls off.
    pub kernel: MetaballKernel,
    /// How the surface is coloured.
    pub shading: MetaballShading,
    /// How the surface is found.
    pub method: MetaballMethod,
    /// Radiance of a surface that faces the light, linear RGB.
    pub color: DVec3,
    /// What is added to every position, world units.
    pub translate: DVec3,
}

/// How the field of a particle falls off with the distance r from it, up to its radius h.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum MetaballKernel {
    /// `(1 - r/h)^2`, of 2008.
    #[default]
    Cone,
    /// `(1 - r^2/h^2)^3`, whose surfaces are smoother.
    Smooth,
}

/// How a surface of metaballs is coloured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum MetaballShading {
    /// Ambient light, and by Lambert's law that of a lamp above the eye and to its left.
    #[default]
    Lit,
    /// The normal n, world space, as the colour `(n + 1) / 2` (2008, figure 8), times the colour.
    Normals,
}

/// How a surface of metaballs is found along a ray.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub enum MetaballMethod {
    /// The first place where the field reaches the threshold, without holes: steps that a bound of the field's growth
    /// allows.
    #[default]
    Exact,
    /// The procedure of 2008: samples in equal steps from one particle's cube to the next, of which some surfaces are
    /// missed.
    Sampling(MetaballSampling),
}

/// The procedure of 2008.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MetaballSampling {
    /// From a sample to the next within a cube, w, world units; `None`: an eighth of the radius.
    pub interval: Option<f64>,
    /// Samples of a ray, at most.
    pub samples: u32,
    /// How often the surface is sought between the last sample before it and the first within, by linear interpolation
    /// (eq. 5).
    pub refinements: u32,
}

impl Default for MetaballSampling {
    fn default() -> Self {
        Self {
            interval: None,
            samples: 32,
            refinements: 1,
        }
    }
}

/// The share of the light on a lit surface that comes from all around.
pub(crate) const AMBIENT: f64 = 0.1;

/// Where the lamp is that lights a surface, seen from there along the axes of the picture: to the right, down, along
/// the view; of any length.
pub(crate) const LAMP: DVec3 = DVec3::new(-0.55, -0.7, -0.7);

/// The threshold of 2008.
pub(super) const THRESHOLD_2008: f64 = 0.765_625;

impl Metaballs {
    /// Makes the surface of particles of one radius, with the threshold of 2008, found exactly, lit, white.
    #[must_use]
    pub fn new(points: PointList, radius: f64) -> Self {
        Self {
            points,
            radius,
            threshold: THRESHOLD_2008,
            kernel: MetaballKernel::default(),
            shading: MetaballShading::default(),
            method: MetaballMethod::default(),
            color: DVec3::ONE,
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

    pub(super) fn check(&self) -> Checked {
        positive("radius", self.radius)?;
        positive("threshold", self.threshold)?;
        vector("color", self.color)?;
        if self.color.min_element() < 0.0 {
            return Err(Fault::new(
                "color",
                "a surface takes no light away: channels are 0 or more",
            ));
        }
        vector("translate", self.translate)?;
        let (low, high) = self.points.bounds();
        let far = (low + self.translate)
            .abs()
            .max((high + self.translate).abs());
        if far.max_element() > LARGEST {
            return Err(Fault::new(
                "translate",
                format!("it moves particles beyond {LARGEST:e}"),
            ));
        }
        match self.method {
            MetaballMethod::Exact => Ok(()),
            MetaballMethod::Sampling(sampling) => sampling.check(),
        }
    }
}

impl MetaballSampling {
    pub(super) fn check(&self) -> Checked {
        if let Some(interval) = self.interval {
            positive("interval", interval)?;
        }
        for (key, value, least) in [
            ("samples", self.samples, 1),
            ("refinements", self.refinements, 0),
        ] {
            if !(least..=MOST_SAMPLES).contains(&value) {
                let message = format!("{value}; there are {least} to {MOST_SAMPLES}");
                return Err(Fault::new(key, message));
            }
        }
        Ok(())
    }
}

/// Samples of a ray, and refinements.
pub(super) const MOST_SAMPLES: u32 = 65536;
