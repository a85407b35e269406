//! Balls and streaks of light: what a simulation gives off, or a host gives one by one. Their light ends at a distance.

use glam::DVec3;

use super::values::{Checked, Fault, positive, vector};

/// A ball or a streak of light: `light (1 - d/radius)^2` where d, the distance to a point or a segment, is less than
/// the radius; outside of it nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum LightElement {
    /// Around a point.
    Ball {
        /// World space.
        center: DVec3,
        /// World units, positive.
        radius: f64,
        /// Linear RGB: colour times coefficient, per world unit along a ray.
        light: DVec3,
    },
    /// Around a segment; the radius at a place is that of the nearest point of the segment.
    Streak {
        /// World space; they may be one point.
        ends: [DVec3; 2],
        /// At the first end, half way and at the second, linear between; world units, positive.
        radii: [f64; 3],
        /// Linear RGB: colour times coefficient, per world unit along a ray.
        light: DVec3,
    },
}

impl LightElement {
    pub(super) fn check(&self) -> Checked {
        let light = match self {
            Self::Ball {
                center,
                radius,
                light,
            } => {
                vector("center", *center)?;
                positive("radius", *radius)?;
                light
            }
            Self::Streak { ends, radii, light } => {
                ends.iter().try_for_each(|end| vector("ends", *end))?;
                radii
                    .iter()
                    .try_for_each(|radius| positive("radii", *radius))?;
                light
            }
        };
        vector("light", *light)?;
        match light.min_element() < 0.0 {
            true => Err(Fault::new(
                "light",
                "particles take no light away: 0 or more",
            )),
            false => Ok(()),
        }
    }
}
