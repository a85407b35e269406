//! A list that knows whether it changed, so that what was made of it can be kept.

use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::extent::Extent;

/// A `Vec` with a revision: two lists of one revision hold the same. It reads and changes like the `Vec` it
/// dereferences to; every mutable access counts as a change. Clones share what they hold until one is changed.
///
/// ```
/// use energywave::scene::{List, Sphere};
///
/// let mut spheres = List::from(vec![Sphere::default()]);
/// spheres.push(Sphere::default());
/// assert_eq!(spheres.len(), 2);
/// ```
#[derive(Debug, Clone)]
pub struct List<T> {
    items: Arc<Vec<T>>,
    revision: u64,
    /// Where they are, once somebody asked.
    extent: OnceLock<Extent>,
}

impl<T> List<T> {
    /// Makes an empty list.
    #[must_use]
    pub fn new() -> Self {
        Self {
            items: Arc::default(),
            revision: 0,
            extent: OnceLock::new(),
        }
    }

    /// Returns where the sources are, which is found once for each revision.
    pub(super) fn extent(&self, find: impl FnOnce(&[T]) -> Extent) -> Extent {
        *self.extent.get_or_init(|| find(&self.items))
    }

    /// Returns a number that no list of other contents has had in this process.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }
}

pub(super) fn new_revision() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

impl<T> Default for List<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> From<Vec<T>> for List<T> {
    fn from(items: Vec<T>) -> Self {
        let revision = if items.is_empty() { 0 } else { new_revision() };
        Self {
            items: Arc::new(items),
            revision,
            extent: OnceLock::new(),
        }
    }
}

impl<T> FromIterator<T> for List<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        Vec::from_iter(items).into()
    }
}

impl<T> Deref for List<T> {
    type Target = Vec<T>;

    fn deref(&self) -> &Vec<T> {
        &self.items
    }
}

impl<T: Clone> DerefMut for List<T> {
    fn deref_mut(&mut self) -> &mut Vec<T> {
        self.revision = new_revision();
        self.extent = OnceLock::new();
        Arc::make_mut(&mut self.items)
    }
}

impl<'a, T> IntoIterator for &'a List<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.items.iter()
    }
}

impl<T: PartialEq> PartialEq for List<T> {
    fn eq(&self, other: &Self) -> bool {
        self.items == other.items
    }
}

impl<T: Serialize> Serialize for List<T> {
    fn serialize<S: Serializer>(&self, writer: S) -> Result<S::Ok, S::Error> {
        self.items.serialize(writer)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for List<T> {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        Vec::deserialize(reader).map(Self::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_change_has_a_new_revision_and_reading_has_none() {
        let mut list = List::from(vec![1, 2]);
        let first = list.revision();
        let copy = list.clone();
        assert_eq!((list.len(), list.iter().sum::<i32>()), (2, 3));
        assert_eq!(list.revision(), first);
        list.push(3);
        let second = list.revision();
        list[0] = 5;
        assert!(first != second && second != list.revision());
        assert_eq!((copy.revision(), copy[0], list[0]), (first, 1, 5));
        assert_eq!(
            List::<i32>::new().revision(),
            List::<f64>::default().revision()
        );
        assert!(List::from(vec![1, 2]).revision() != first && List::from(vec![1, 2]) == copy);
    }
}
