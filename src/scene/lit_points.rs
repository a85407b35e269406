//! Points of light in any number: `light / d` or `light / d^2` each, d the distance to the point (2015, eq. 2; Sakai
//! 2006). Where there are many, devices draw the crowd that they are, at a cost that hardly depends on their number.

use std::ops::Range;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::crowd_sight::Apart;
use super::points::PointList;
use super::values::{Checked, Fault, finite, vector};
use super::{Falloff, Profile, Scene, Segment, Sphere};
use crate::error::SceneError;

/// How the light of [`Points`](Points) is summed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Crowd {
    /// Together, within the tolerance, where they are many and what they are allows it; else as by `Never`.
    #[default]
    Auto,
    /// Each by itself.
    Never,
}

/// Points of light, each as a [`Sphere`] is: positions, and what each has of its own.
///
/// ```
/// use energywave::glam::DVec3;
/// use energywave::scene::{PointList, Points};
///
/// let places = (0..1000).map(|k| DVec3::new(0.001 * f64::from(k), 0.0, 0.0));
/// let mut sparks = Points::new(PointList::new(places.collect())?);
/// sparks.coefficient = 1e-3;
/// # Ok::<(), energywave::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Points {
    /// Where they are; lights of their own take the place of the colour, weights multiply it, and radii take the place
    /// of the radius.
    pub points: PointList,
    /// What the light of each is multiplied with.
    pub coefficient: f64,
    /// Linear RGB, of points that have no light of their own.
    pub color: DVec3,
    /// How their light falls off: `Inverse`, `InverseSquare` or `Smeared`. With trails ([`PointList::with_previous`]),
    /// `Inverse`.
    pub profile: Profile,
    /// How thick they are: `d^2 + radius^2` stands for `d^2`, of `Smeared` the standard deviation; world units, 0 for
    /// none.
    pub radius: f64,
    /// The distance at which their light ends, smoothly; world units. `None`: nowhere.
    pub reach: Option<f64>,
}

impl Points {
    /// Makes white points of coefficient 1 whose light falls off with the squared distance.
    #[must_use]
    pub fn new(points: PointList) -> Self {
        Self {
            points,
            coefficient: 1.0,
            color: DVec3::ONE,
            profile: Profile::default(),
            radius: 0.0,
            reach: None,
        }
    }

    /// Returns what tells them from others: the revision of the list, and all but the list.
    pub(crate) fn stamp(&self) -> (u64, Self) {
        let others = Self {
            points: PointList::default(),
            ..*self
        };
        (self.points.revision(), others)
    }

    /// Returns the light of a point: linear RGB times all that it is multiplied with.
    pub(crate) fn light(&self, index: usize) -> DVec3 {
        let weight = self.points.sizes().map_or(1.0, |it| it[index].weight);
        let own = self.points.own_light(index).map(|it| it.map(f64::from));
        self.coefficient * weight * own.map_or(self.color, DVec3::from)
    }

    /// Calls `visit` with place and light of each of some points that have no weights.
    #[inline]
    pub(crate) fn for_each(&self, range: Range<usize>, mut visit: impl FnMut(DVec3, DVec3)) {
        let (own, common) = (self.coefficient, self.coefficient * self.color);
        self.points.for_each(range, |place, light| match light {
            Some([red, green, blue]) => {
                let light = DVec3::new(red.into(), green.into(), blue.into());
                visit(place, own * light);
            }
            None => visit(place, common),
        });
    }

    /// Returns how thick a point is.
    pub(crate) fn radius(&self, index: usize) -> f64 {
        self.points
            .sizes()
            .map_or(self.radius, |it| it[index].radius)
    }

    /// Adds a point as a source of its own; one that moved lights all of its way.
    pub(super) fn add_apart(&self, index: usize, apart: &mut Apart) {
        let (place, color) = (self.points.position(index), self.light(index));
        let previous = self.points.previous_position(index);
        if let Some(previous) = previous.filter(|it| *it != place) {
            apart.segments.push(Segment {
                coefficient: 1.0 / place.distance(previous),
                color,
                profile: Profile::Convolution,
                ..Segment::new(previous, place)
            });
            return;
        }
        apart.spheres.push(Sphere {
            center: place,
            coefficient: 1.0,
            color,
            profile: self.profile,
            radius: self.radius(index),
            reach: self.reach,
            ..Sphere::default()
        });
    }

    pub(super) fn check(&self) -> Checked {
        finite("coefficient", self.coefficient)?;
        vector("color", self.color)?;
        use Profile::{Inverse, InverseSquare, Smeared};
        if !matches!(self.profile, Inverse | InverseSquare | Smeared) {
            let message = "points have the profile \"inverse\", \"inverse-square\" or \"smeared\"; others: [[sphere]]";
            return Err(Fault::new("profile", message));
        }
        let is_thick = self.radius > 0.0 || self.reach.is_some() || self.points.sizes().is_some();
        if self.points.has_trails() && (is_thick || self.profile != Inverse) {
            let message = "trails are of points of the profile \"inverse\", without radius and reach: of others light \
                           is not added up along lines";
            return Err(Fault::new("previous", message));
        }
        let falloff = Falloff {
            profile: self.profile,
            radius: if self.points.is_empty() {
                self.radius
            } else {
                self.radius(0)
            },
            reach: self.reach,
        };
        falloff.check()
    }
}

impl Scene {
    /// Returns whether it has points of light.
    pub(crate) fn has_points(&self) -> bool {
        self.points.iter().any(|it| !it.points.is_empty())
    }

    pub(super) fn check_points(&self) -> Result<(), SceneError> {
        for (index, points) in self.points.iter().enumerate() {
            let table = format!("points[{index}]");
            points.check().map_err(|fault| fault.of(&table))?;
        }
        Ok(())
    }

    /// Returns the scene with each of its points a source of its own.
    pub(crate) fn with_points_apart(&self) -> Self {
        self.with_crowds(false).unwrap_or_else(|| self.clone())
    }
}
