//! The corners and triangles of a mesh, which clones share.

use std::fmt;
use std::path::Path;
#[cfg(feature = "files")]
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use glam::DVec3;

use crate::error::{Result, SceneError};
use crate::scene::list::new_revision;
use crate::scene::values::LARGEST;

/// Triangles, and corners: indices of 32 bits, and what a device's buffers hold.
pub(super) const MOST: usize = 1 << 26;

/// Triangles, by the indices of their three corners. Those without area, such as one that names a corner twice, hide
/// nothing and are left out.
///
/// ```
/// use energywave::glam::DVec3;
/// use energywave::scene::TriangleList;
///
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
/// assert_eq!(TriangleList::new(corners.clone(), vec![[0, 1, 2], [0, 1, 1]])?.len(), 1);
/// assert!(TriangleList::new(corners, vec![[0, 1, 3]]).is_err());
/// # Ok::<(), energywave::Error>(())
/// ```
#[derive(Clone)]
pub struct TriangleList(Arc<Triangles>);

struct Triangles {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    low: DVec3,
    high: DVec3,
    revision: u64,
    /// Once somebody asked.
    is_closed: OnceLock<bool>,
    #[cfg(feature = "files")]
    file: Option<PathBuf>,
}

/// What is wrong with triangles, and with which of both lists.
#[derive(Debug)]
pub(super) struct Wrong {
    pub key: &'static str,
    pub message: String,
}

impl TriangleList {
    /// Makes triangles of corners, world units, and the indices of three for each.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) if a coordinate is not a finite number or beyond 1e9, an index names no
    /// corner, there are no triangles with an area, or more than 2^26 of either.
    pub fn new(vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self> {
        let list = Self::checked(vertices, triangles);
        Ok(list.map_err(|wrong| SceneError::value(wrong.key, wrong.message))?)
    }

    /// Reads a file; its ending chooses. `.obj` (Wavefront): its vertices and faces, which are cut into triangles.
    /// `.gltf` and `.glb` (glTF 2.0): the triangles of all nodes of its scene, where these put them.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) if the file cannot be read, or does not hold that.
    #[cfg(feature = "files")]
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self> {
        Ok(super::file::open(path.as_ref())?)
    }

    pub(super) fn checked(
        vertices: Vec<DVec3>,
        triangles: Vec<[u32; 3]>,
    ) -> std::result::Result<Self, Wrong> {
        let wrong = |key, message| Err(Wrong { key, message });
        for (key, count) in [("vertices", vertices.len()), ("triangles", triangles.len())] {
            if count == 0 {
                return wrong(
                    key,
                    format!("there are no {key}; a mesh has a triangle at least"),
                );
            }
            if count > MOST {
                return wrong(key, format!("{count} {key}; there may be {MOST}"));
            }
        }
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for (index, place) in vertices.iter().enumerate() {
            // Which no NaN is.
            if !place.abs().cmple(DVec3::splat(LARGEST)).all() {
                let [x, y, z] = place.to_array();
                let message = format!(
                    "vertex {index} is at {x}, {y}, {z}; coordinates are finite numbers up to {LARGEST:e}"
                );
                return wrong("vertices", message);
            }
            (low, high) = (low.min(*place), high.max(*place));
        }
        let count = vertices.len();
        for (index, corners) in triangles.iter().enumerate() {
            if let Some(corner) = corners.iter().find(|corner| **corner as usize >= count) {
                let last = count - 1;
                let message = format!(
                    "triangle {index} names vertex {corner}; they are numbered 0 to {last}"
                );
                return wrong("triangles", message);
            }
        }
        let mut triangles = triangles;
        triangles.retain(|corners| {
            let [a, b, c] = corners.map(|corner| vertices[corner as usize]);
            (b - a).cross(c - a) != DVec3::ZERO
        });
        if triangles.is_empty() {
            return wrong("triangles", "no triangle has an area".to_owned());
        }
        Ok(Self(Arc::new(Triangles {
            vertices,
            triangles,
            low,
            high,
            revision: new_revision(),
            is_closed: OnceLock::new(),
            #[cfg(feature = "files")]
            file: None,
        })))
    }

    /// Says which file it was read from.
    #[cfg(feature = "files")]
    pub(super) fn of_file(mut self, path: PathBuf) -> Self {
        if let Some(list) = Arc::get_mut(&mut self.0) {
            list.file = Some(path);
        }
        self
    }

    /// Returns the corners.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.0.vertices
    }

    /// Returns the indices of the corners of all triangles that have an area.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.0.triangles
    }

    /// Returns the number of triangles that have an area.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.triangles.len()
    }

    /// Returns whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.triangles.is_empty()
    }

    /// Returns the corners of the box around all vertices; of none, the origin twice.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.0.low, self.0.high)
    }

    /// Returns whether it has an inside: every edge, by the places of its ends, has as many triangles that go along it
    /// one way as the other.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        *self.0.is_closed.get_or_init(|| {
            let place = |corner: u32| (self.0.vertices[corner as usize] + DVec3::ZERO).to_array();
            let key = |corner: u32| place(corner).map(f64::to_bits);
            let mut edges = Vec::with_capacity(3 * self.len());
            for &[a, b, c] in self.triangles() {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    let (from, to) = (key(from), key(to));
                    edges.push((
                        from.min(to),
                        from.max(to),
                        if from < to { 1_i64 } else { -1 },
                    ));
                }
            }
            edges.sort_unstable();
            let ends =
                |one: &(_, _, i64), other: &(_, _, i64)| (one.0, one.1) == (other.0, other.1);
            let mut shared = edges.chunk_by(ends);
            shared.all(|edges| edges.iter().map(|it| it.2).sum::<i64>() == 0)
        })
    }

    /// Returns a number that no list of other contents has had in this process.
    #[cfg(test)]
    fn revision(&self) -> u64 {
        self.0.revision
    }

    /// Returns the file that the list was read from.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        #[cfg(feature = "files")]
        return self.0.file.as_deref();
        #[cfg(not(feature = "files"))]
        return None;
    }
}

/// Says how many there are; a million would fill a screen for hours.
impl fmt::Debug for TriangleList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "TriangleList({} triangles, {:?})",
            self.len(),
            self.file()
        )
    }
}

/// No triangles, which no mesh may have.
impl Default for TriangleList {
    fn default() -> Self {
        Self(Arc::new(Triangles {
            vertices: Vec::new(),
            triangles: Vec::new(),
            low: DVec3::ZERO,
            high: DVec3::ZERO,
            revision: 0,
            is_closed: OnceLock::new(),
            #[cfg(feature = "files")]
            file: None,
        }))
    }
}

/// Two lists are equal if they hold the same, wherever it came from.
impl PartialEq for TriangleList {
    fn eq(&self, other: &Self) -> bool {
        let (own, others) = (&self.0, &other.0);
        let is_same = Arc::ptr_eq(own, others) || own.revision == others.revision;
        is_same || (own.triangles == others.triangles && own.vertices == others.vertices)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clones_are_one_list_and_triangles_without_area_are_left_out() {
        let corners = vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X, DVec3::Y];
        let triangles = vec![[0, 1, 3], [0, 1, 2], [3, 3, 1], [1, 2, 3]];
        let list = TriangleList::new(corners.clone(), triangles.clone()).unwrap();
        assert_eq!(list.triangles(), [[0, 1, 3], [1, 2, 3]]);
        let again = TriangleList::new(corners, triangles).unwrap();
        assert!(again == list && again.revision() != list.revision());
        assert_eq!(list.clone().revision(), list.revision());
        assert_eq!(list.bounds(), (DVec3::ZERO, DVec3::new(2.0, 1.0, 0.0)));
        assert!(TriangleList::default().is_empty() && TriangleList::default() != list);
        // The four faces of a corner of a cube, with a corner of its own for each triangle.
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let apart = faces
            .as_flattened()
            .iter()
            .map(|it| corners[*it])
            .collect::<Vec<_>>();
        let faces = |count: u32| {
            (0..count)
                .map(|it| [3 * it, 3 * it + 1, 3 * it + 2])
                .collect()
        };
        let is_closed = |count| {
            TriangleList::new(apart.clone(), faces(count))
                .unwrap()
                .is_closed()
        };
        assert!(is_closed(4) && !is_closed(3) && !list.is_closed());
    }

    #[test]
    fn what_is_no_triangle_is_refused() {
        let corners = || vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let fault = |corners: Vec<DVec3>, triangles: Vec<[u32; 3]>| {
            let error = TriangleList::new(corners, triangles).unwrap_err();
            error.to_string()
        };
        let all = vec![[0, 1, 2]];
        for wrong in [f64::NAN, f64::INFINITY, -2e9] {
            let mut corners = corners();
            corners[1].y = wrong;
            let found = fault(corners, all.clone());
            assert!(found.contains("vertex 1 is at"), "{found}");
        }
        for (triangles, words) in [
            (vec![[0, 1, 2], [2, 1, 3]], "triangle 1 names vertex 3"),
            (vec![], "there are no triangles"),
            (vec![[0, 1, 1]], "no triangle has an area"),
        ] {
            let found = fault(corners(), triangles);
            assert!(found.contains(words), "{found}");
        }
        assert!(fault(vec![], all).contains("there are no vertices"));
    }
}
