//! Points in the memory of others, four float32 each, as a host's buffers have them: read where they lie.

use std::ops::Range;
use std::sync::Arc;

use glam::DVec3;

use super::{MOST_POINTS, Origin, PointList, Points};
use crate::scene::list::new_revision;
use crate::scene::values::LARGEST;
use crate::threads;

/// So many points are looked at by one thread at a time, and summed before others are added.
const PART: usize = 1 << 16;

/// Rows of four float32, of which the first three count.
pub(crate) trait PointRows: Send + Sync {
    /// Where points are, world units.
    fn positions(&self) -> &[[f32; 4]];

    /// Their light, linear RGB; as many rows as there are positions.
    fn lights(&self) -> Option<&[[f32; 4]]>;

    /// Where points were, as many rows.
    fn previous(&self) -> Option<&[[f32; 4]]>;
}

/// Where the positions of a list are.
pub(super) enum Places {
    Own(Vec<DVec3>),
    Rows(Box<dyn PointRows>),
}

/// What is found in a part of the rows.
#[derive(Clone)]
struct Part {
    low: DVec3,
    high: DVec3,
    wrong: Option<String>,
}

impl Places {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Own(positions) => positions.len(),
            Self::Rows(rows) => rows.positions().len(),
        }
    }

    /// Returns those that are listed; none of rows.
    pub(super) fn listed(&self) -> &[DVec3] {
        match self {
            Self::Own(positions) => positions,
            Self::Rows(_) => &[],
        }
    }
}

impl PointList {
    /// Makes a list of rows, which are kept as long as the list is.
    ///
    /// # Errors
    /// Says which point is none, if one is not.
    pub(crate) fn of_rows(rows: Box<dyn PointRows>) -> Result<Self, String> {
        let count = rows.positions().len();
        if count > MOST_POINTS {
            return Err(format!("{count} points; there may be {MOST_POINTS}"));
        }
        let mut parts = vec![Part::new(); count.div_ceil(PART)];
        threads::for_each_part(&mut parts, 1, |number, part| {
            let range = number * PART..count.min((number + 1) * PART);
            part[0].look(&*rows, range);
        });
        if let Some(wrong) = parts.iter().find_map(|part| part.wrong.clone()) {
            return Err(wrong);
        }
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for part in &parts {
            (low, high) = (low.min(part.low), high.max(part.high));
        }
        let light = match rows.lights() {
            Some(lights) => light_of(count, |index| first_three(&lights[index])),
            None => [1.0, count as f64, 1.0],
        };
        Ok(Self(Arc::new(Points {
            revision: new_revision(),
            places: Places::Rows(rows),
            sizes: None,
            lights: None,
            previous: None,
            light,
            low,
            high,
            origin: Origin::Given,
        })))
    }

    /// Returns where a point is, world units.
    pub(crate) fn position(&self, index: usize) -> DVec3 {
        match &self.0.places {
            Places::Own(positions) => positions[index],
            Places::Rows(rows) => place(&rows.positions()[index]),
        }
    }

    /// Calls `visit` with each of some points: where it is, and the light that it has of its own. How the list has
    /// them is asked once, not for each.
    #[inline]
    pub(crate) fn for_each(
        &self,
        range: Range<usize>,
        mut visit: impl FnMut(DVec3, Option<[f32; 3]>),
    ) {
        match &self.0.places {
            Places::Own(positions) => {
                let positions = &positions[range.clone()];
                match &self.0.lights {
                    Some(lights) => (positions.iter().zip(&lights[range]))
                        .for_each(|(place, light)| visit(*place, Some(*light))),
                    None => positions.iter().for_each(|place| visit(*place, None)),
                }
            }
            Places::Rows(rows) => {
                let positions = &rows.positions()[range.clone()];
                match rows.lights() {
                    Some(lights) => (positions.iter().zip(&lights[range]))
                        .for_each(|(row, light)| visit(place(row), Some(first_three(light)))),
                    None => positions.iter().for_each(|row| visit(place(row), None)),
                }
            }
        }
    }

    /// Returns the light that a point has of its own.
    pub(crate) fn own_light(&self, index: usize) -> Option<[f32; 3]> {
        match (&self.0.places, &self.0.lights) {
            (Places::Rows(rows), _) => rows.lights().map(|it| first_three(&it[index])),
            (_, Some(lights)) => Some(lights[index]),
            _ => None,
        }
    }

    /// Returns whether points have lights of their own.
    pub(crate) fn has_lights(&self) -> bool {
        match &self.0.places {
            Places::Own(_) => self.0.lights.is_some(),
            Places::Rows(rows) => rows.lights().is_some(),
        }
    }
}

impl Part {
    fn new() -> Self {
        Self {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
            wrong: None,
        }
    }

    fn look(&mut self, rows: &dyn PointRows, range: Range<usize>) {
        // Which no NaN is.
        let is_right = |row: &[f32; 4]| row[..3].iter().all(|it| it.abs() <= LARGEST as f32);
        let places = [
            (rows.positions(), "is"),
            (rows.previous().unwrap_or_default(), "was"),
        ];
        for (places, is) in places.into_iter().filter(|(it, _)| !it.is_empty()) {
            for (index, row) in range.clone().zip(&places[range.clone()]) {
                if !is_right(row) {
                    let [x, y, z, _] = row;
                    self.wrong = Some(format!(
                        "point {index} {is} at {x}, {y}, {z}; coordinates are finite numbers up to {LARGEST:e}"
                    ));
                    return;
                }
                let place = place(row);
                (self.low, self.high) = (self.low.min(place), self.high.max(place));
            }
        }
        let Some(lights) = rows.lights() else {
            return;
        };
        if let Some(at) = lights[range.clone()].iter().position(|row| !is_right(row)) {
            let index = range.start + at;
            let light = first_three(&lights[index]);
            self.wrong = Some(format!(
                "the light of point {index} is {light:?}; it is finite, up to {LARGEST:e}"
            ));
        }
    }
}

pub(super) fn place(row: &[f32; 4]) -> DVec3 {
    DVec3::new(row[0].into(), row[1].into(), row[2].into())
}

fn first_three(row: &[f32; 4]) -> [f32; 3] {
    let [x, y, z, _] = *row;
    [x, y, z]
}

/// Returns the least light of any channel, the sum of all, and the greatest: of each point the brightest channel. The
/// order of the sums depends on their number alone.
pub(super) fn light_of(count: usize, light: impl Fn(usize) -> [f32; 3] + Send + Sync) -> [f64; 3] {
    let mut parts = vec![[0.0_f64; 3]; count.div_ceil(PART)];
    threads::for_each_part(&mut parts, 1, |number, part| {
        let found = &mut part[0];
        for index in number * PART..count.min((number + 1) * PART) {
            let [red, green, blue] = light(index).map(f64::from);
            let most = red.max(green).max(blue);
            found[0] = found[0].min(red.min(green).min(blue));
            found[1] += most.max(0.0);
            found[2] = found[2].max(most);
        }
    });
    let both = |a: [f64; 3], b: [f64; 3]| [a[0].min(b[0]), a[1] + b[1], a[2].max(b[2])];
    parts.into_iter().fold([0.0; 3], both)
}
