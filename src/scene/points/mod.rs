//! Lists of particles: positions, each with a radius and a weight of its own where somebody gives them. Clones share
//! what they hold, which never changes, so that scenes with a million particles are copied and compared at once.

#[cfg(feature = "files")]
mod file;
mod lattice;
#[cfg(feature = "files")]
mod lit;
#[cfg(feature = "files")]
mod npy;
#[cfg(feature = "files")]
mod ply;
mod rows;
mod trails;

use std::fmt;
use std::path::Path;
#[cfg(feature = "files")]
use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;

pub use lattice::Lattice;
use rows::Places;
pub(crate) use rows::PointRows;

use super::list::new_revision;
use super::values::LARGEST;
use crate::error::{Result, SceneError};

/// Particles: indices of 32 bits, and what a device's buffers hold.
const MOST_POINTS: usize = 1 << 27;

/// Positions of particles, world units, with radii and weights of their own where they are given.
///
/// ```
/// use energywave::glam::DVec3;
/// use energywave::scene::PointList;
///
/// let points = PointList::new(vec![DVec3::ZERO, DVec3::X])?;
/// assert_eq!(points.len(), 2);
/// assert!(PointList::new(vec![DVec3::NAN]).is_err());
/// # Ok::<(), energywave::Error>(())
/// ```
#[derive(Clone)]
pub struct PointList(Arc<Points>);

struct Points {
    places: Places,
    sizes: Option<Vec<PointSize>>,
    lights: Option<Vec<[f32; 3]>>,
    /// Where each was.
    previous: Option<Vec<DVec3>>,
    /// Least light, the sum of all, and the greatest: of each the brightest channel.
    light: [f64; 3],
    low: DVec3,
    high: DVec3,
    revision: u64,
    #[cfg_attr(
        not(feature = "files"),
        allow(dead_code, reason = "what files are written with")
    )]
    origin: Origin,
}

/// What a particle has of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSize {
    /// Radius, world units, positive: in the place of that of all.
    pub radius: f64,
    /// What the particle's field is multiplied with, positive.
    pub weight: f64,
}

/// Where a list comes from.
#[derive(Debug, Clone, PartialEq)]
enum Origin {
    Given,
    Lattice(Lattice),
    #[cfg(feature = "files")]
    File(PathBuf),
}

impl PointList {
    /// Makes a list of positions, world units.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) if a coordinate is not a finite number or beyond 1e9, or there are more
    /// than 2^27.
    pub fn new(positions: Vec<DVec3>) -> Result<Self> {
        Ok(Self::checked(positions, (None, None), Origin::Given)?)
    }

    /// Makes a list of positions, each with a radius and a weight of its own.
    ///
    /// # Errors
    /// As [`PointList::new`], and if there is not one of each for every position, or one is not positive.
    pub fn with_sizes(positions: Vec<DVec3>, sizes: Vec<PointSize>) -> Result<Self> {
        Ok(Self::checked(
            positions,
            (Some(sizes), None),
            Origin::Given,
        )?)
    }

    /// Makes a list of positions, each with a light of its own: linear RGB times what its field is multiplied with.
    ///
    /// # Errors
    /// As [`PointList::new`], and if there is not one light for every position, or one is not finite or beyond 1e9.
    pub fn with_lights(positions: Vec<DVec3>, lights: Vec<[f32; 3]>) -> Result<Self> {
        Ok(Self::checked(
            positions,
            (None, Some(lights)),
            Origin::Given,
        )?)
    }

    /// Makes the points of a lattice.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) if a value of the lattice cannot be used.
    pub fn lattice(lattice: &Lattice) -> Result<Self> {
        lattice.check().map_err(|fault| fault.of("lattice"))?;
        let origin = Origin::Lattice(lattice.clone());
        Ok(Self::checked(lattice.positions(), (None, None), origin)?)
    }

    /// Reads a file; its ending chooses. `.csv`: a line for each particle, x, y, z, and if wanted radius and weight,
    /// with commas, semicolons or spaces between. `.f32`: float32 without a header, three for each particle, the least
    /// significant byte first. `.npy` (NumPy): float32 or float64 of shape (n, 3). `.ply`: the x, y and z of its
    /// vertices, and if they have them `radius` and `weight`.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) if the file cannot be read, or does not hold that.
    #[cfg(feature = "files")]
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self> {
        Ok(file::open(path.as_ref())?)
    }

    /// Reads a file of points of light; its ending chooses. Each has x, y and z, and where the file has them r, g and
    /// b, a coefficient and a radius. `.csv`: the first line may name the columns `x`, `y`, `z`, `r`, `g`, `b`,
    /// `coefficient`, `radius`, in any order; without names, and in `.npy` (NumPy, float32 or float64, shape (n, 3) to
    /// (n, 8)), they stand in this order: 4 columns have a coefficient, 5 also a radius, 6 r, g and b, 7 also a
    /// coefficient, 8 also a radius. `.ply`: the properties of its vertices; `red`, `green` and `blue` of one byte are
    /// sRGB, others linear.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) if the file cannot be read, or does not hold that.
    #[cfg(feature = "files")]
    pub fn lit_from_file(path: impl AsRef<Path>) -> Result<Self> {
        Ok(lit::open(path.as_ref())?)
    }

    fn checked(
        positions: Vec<DVec3>,
        (sizes, lights): (Option<Vec<PointSize>>, Option<Vec<[f32; 3]>>),
        origin: Origin,
    ) -> std::result::Result<Self, SceneError> {
        let fault = |message: String| SceneError::value("points", message);
        if positions.len() > MOST_POINTS {
            let found = positions.len();
            return Err(fault(format!(
                "{found} particles; there may be {MOST_POINTS}"
            )));
        }
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for (index, position) in positions.iter().enumerate() {
            // Which no NaN is.
            if !position.abs().cmple(DVec3::splat(LARGEST)).all() {
                return Err(fault(format!(
                    "particle {index} is at {}, {}, {}; coordinates are finite numbers up to {LARGEST:e}",
                    position.x, position.y, position.z
                )));
            }
            (low, high) = (low.min(*position), high.max(*position));
        }
        if let Some(sizes) = &sizes {
            check_sizes(positions.len(), sizes).map_err(fault)?;
        }
        if let Some(lights) = &lights {
            check_lights(positions.len(), lights).map_err(fault)?;
        }
        let light = match (&lights, &sizes) {
            (None, None) => [1.0, positions.len() as f64, 1.0],
            (lights, sizes) => rows::light_of(positions.len(), |index| {
                let weight = sizes.as_ref().map_or(1.0, |it| it[index].weight as f32);
                let own = lights.as_ref().map_or([1.0; 3], |it| it[index]);
                own.map(|channel| channel * weight)
            }),
        };
        Ok(Self(Arc::new(Points {
            revision: new_revision(),
            places: Places::Own(positions),
            sizes,
            light,
            lights,
            previous: None,
            low,
            high,
            origin,
        })))
    }

    /// Returns the positions, world units.
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        self.0.places.listed()
    }

    /// Returns radii and weights, if the particles have some of their own.
    #[must_use]
    pub fn sizes(&self) -> Option<&[PointSize]> {
        self.0.sizes.as_deref()
    }

    /// Returns the lights, linear RGB times coefficient, if the points have some of their own.
    #[must_use]
    pub fn lights(&self) -> Option<&[[f32; 3]]> {
        self.0.lights.as_deref()
    }

    /// Returns the least light of any channel of a point; 1 where they have none of their own.
    pub(crate) fn least_light(&self) -> f64 {
        self.0.light[0]
    }

    /// Returns the light of all points, and of the brightest, weights included: of each the brightest channel; 1 for
    /// each where they have none of their own.
    pub(crate) fn total_light(&self) -> (f64, f64) {
        (self.0.light[1], self.0.light[2])
    }

    /// Returns the number of particles.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.places.len()
    }

    /// Returns whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.places.len() == 0
    }

    /// Returns the corners of the box around all positions, previous ones too; of no particle, the origin twice.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        match self.is_empty() {
            true => (DVec3::ZERO, DVec3::ZERO),
            false => (self.0.low, self.0.high),
        }
    }

    /// Returns a number that no list of other contents has had in this process.
    pub(crate) fn revision(&self) -> u64 {
        self.0.revision
    }

    /// Returns the file that the list was read from.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        match &self.0.origin {
            #[cfg(feature = "files")]
            Origin::File(path) => Some(path),
            _ => None,
        }
    }

    /// Returns the lattice that the list was made of.
    #[must_use]
    pub fn made_of(&self) -> Option<&Lattice> {
        match &self.0.origin {
            Origin::Lattice(lattice) => Some(lattice),
            _ => None,
        }
    }
}

fn check_sizes(count: usize, sizes: &[PointSize]) -> std::result::Result<(), String> {
    if sizes.len() != count {
        let found = sizes.len();
        return Err(format!(
            "{count} positions and {found} sizes; each particle has one"
        ));
    }
    let is_right = |value: f64| (1e-9..=LARGEST).contains(&value);
    for (index, size) in sizes.iter().enumerate() {
        for (what, value) in [("radius", size.radius), ("weight", size.weight)] {
            if !is_right(value) {
                return Err(format!(
                    "the {what} of particle {index} is {value}; it is positive, 1e-9 to {LARGEST:e}"
                ));
            }
        }
    }
    Ok(())
}

fn check_lights(count: usize, lights: &[[f32; 3]]) -> std::result::Result<(), String> {
    if lights.len() != count {
        let found = lights.len();
        return Err(format!(
            "{count} positions and {found} lights; each point has one"
        ));
    }
    let is_wrong = |light: &[f32; 3]| !light.iter().all(|it| it.abs() <= LARGEST as f32);
    match lights.iter().position(is_wrong) {
        Some(index) => Err(format!(
            "the light of point {index} is {:?}; it is finite, up to {LARGEST:e}",
            lights[index]
        )),
        None => Ok(()),
    }
}

/// Says how many there are; a million would fill a screen for hours.
impl fmt::Debug for PointList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "PointList({} points, {:?})", self.len(), self.0.origin)
    }
}

impl Default for PointList {
    fn default() -> Self {
        Self(Arc::new(Points {
            places: Places::Own(Vec::new()),
            sizes: None,
            lights: None,
            previous: None,
            light: [0.0; 3],
            low: DVec3::ZERO,
            high: DVec3::ZERO,
            revision: 0,
            origin: Origin::Given,
        }))
    }
}

/// Two lists are equal if they hold the same, wherever it came from.
impl PartialEq for PointList {
    fn eq(&self, other: &Self) -> bool {
        let (own, others) = (&self.0, &other.0);
        let is_same = Arc::ptr_eq(own, others) || own.revision == others.revision;
        let is_light_same = own.lights == others.lights && own.previous == others.previous;
        let listed = [own, others].map(|it| it.places.listed());
        let is_listed = [own, others].map(|it| it.places.len()) == listed.map(<[_]>::len);
        is_same
            || (is_listed && listed[0] == listed[1] && own.sizes == others.sizes && is_light_same)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_are_one_list_and_equal_contents_are_equal() {
        let list = PointList::new(vec![DVec3::X, DVec3::new(-1.0, 2.0, 3.0)]).unwrap();
        let again = PointList::new(list.positions().to_vec()).unwrap();
        assert_eq!(list.clone().revision(), list.revision());
        assert!(again == list && again.revision() != list.revision());
        assert_eq!(
            list.bounds(),
            (DVec3::new(-1.0, 0.0, 0.0), DVec3::new(1.0, 2.0, 3.0))
        );
        assert!(PointList::default().is_empty() && PointList::default() != list);
    }

    #[test]
    fn what_is_no_place_and_no_size_is_refused() {
        for wrong in [f64::NAN, f64::INFINITY, -2e9] {
            let error = PointList::new(vec![DVec3::ZERO, DVec3::new(0.0, wrong, 0.0)]).unwrap_err();
            assert!(error.to_string().contains("particle 1 is at"), "{error}");
        }
        let size = |radius, weight| PointSize { radius, weight };
        let sized = |sizes| PointList::with_sizes(vec![DVec3::ZERO], sizes);
        assert!(sized(vec![size(1.0, 2.0)]).is_ok());
        for wrong in [
            vec![],
            vec![size(0.0, 1.0)],
            vec![size(1.0, -1.0)],
            vec![size(1.0, f64::NAN)],
        ] {
            assert!(sized(wrong).is_err());
        }
    }
}
