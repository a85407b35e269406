//! Points that move: each has a place where it was, and its light lies along the way from there.

use std::sync::Arc;

use glam::DVec3;

use super::rows::Places;
use super::{Origin, PointList, Points};
use crate::error::{Error, Result, SceneError};
use crate::scene::list::new_revision;
use crate::scene::values::LARGEST;

impl PointList {
    /// Gives each point of light the place where it was, world units: its light lies evenly along the straight way from
    /// there, as of a spark that is photographed while it flies. A point that has not moved stays one.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) if there is not one place for every position, or a coordinate is not a
    /// finite number or beyond 1e9.
    pub fn with_previous(self, previous: Vec<DVec3>) -> Result<Self> {
        let fault = |message: String| Error::from(SceneError::value("points", message));
        let (count, found) = (self.len(), previous.len());
        if found != count {
            let message =
                format!("{count} positions and {found} previous ones; each point has one");
            return Err(fault(message));
        }
        let (mut low, mut high) = (self.0.low, self.0.high);
        for (index, place) in previous.iter().enumerate() {
            // Which no NaN is.
            if !place.abs().cmple(DVec3::splat(LARGEST)).all() {
                return Err(fault(format!(
                    "point {index} was at {}, {}, {}; coordinates are finite numbers up to {LARGEST:e}",
                    place.x, place.y, place.z
                )));
            }
            (low, high) = (low.min(*place), high.max(*place));
        }
        Ok(Self(Arc::new(Points {
            places: Places::Own(self.positions().to_vec()),
            sizes: self.0.sizes.clone(),
            lights: self.0.lights.clone(),
            previous: Some(previous),
            light: self.0.light,
            low,
            high,
            revision: new_revision(),
            origin: Origin::Given,
        })))
    }

    /// Returns where points were, world units, if they have trails.
    #[must_use]
    pub fn previous(&self) -> Option<&[DVec3]> {
        self.0.previous.as_deref()
    }

    /// Returns whether points have trails.
    pub(crate) fn has_trails(&self) -> bool {
        match &self.0.places {
            Places::Own(_) => self.0.previous.is_some(),
            Places::Rows(rows) => rows.previous().is_some(),
        }
    }

    /// Returns where a point was, if it has a trail.
    pub(crate) fn previous_position(&self, index: usize) -> Option<DVec3> {
        match (&self.0.places, &self.0.previous) {
            (Places::Rows(rows), _) => rows.previous().map(|it| super::rows::place(&it[index])),
            (_, Some(previous)) => Some(previous[index]),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trails_are_part_of_a_list_and_broken_ones_are_refused() {
        let list = PointList::new(vec![DVec3::X, DVec3::Y]).unwrap();
        let moved = list
            .clone()
            .with_previous(vec![DVec3::ZERO, -DVec3::Z])
            .unwrap();
        assert!(moved != list && moved.revision() != list.revision());
        assert_eq!(moved.bounds().0, DVec3::new(0.0, 0.0, -1.0));
        assert_eq!(moved.previous_position(1), Some(-DVec3::Z));
        for (wrong, words) in [
            (vec![DVec3::ZERO], "2 positions and 1 previous"),
            (vec![DVec3::ZERO, DVec3::NAN], "point 1 was at"),
        ] {
            let error = list.clone().with_previous(wrong).unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
        }
    }
}
