//! Groups: sources that are scaled, rotated and moved together, once or in many copies. A scene holds none: it gets the
//! sources as they are placed.

#[cfg(feature = "files")]
mod names;
mod placement;

use glam::DVec3;

#[cfg(feature = "files")]
pub(super) use names::key_in_groups;
pub(crate) use placement::Placement;
#[cfg(feature = "files")]
pub(super) use placement::{REPEAT_KEYS, ROTATION_KEYS};
pub use placement::{Repeat, Rotation};

use super::kinds::{KIND_COUNT, for_each_kind};
use super::light_group::check_light_group;
use super::source::*;
use super::values::{Checked, direction, finite, positive, vector};
use super::{List, Measure, Reduction, Scene};
use crate::error::{Error, Result, SceneError};
use crate::memory;

/// Groups stand in each other no deeper than this.
const DEEPEST: usize = 8;

/// Sources that all groups of a file, or one of a program, make.
const MOST_SOURCES: u64 = 1_000_000;

macro_rules! define_group {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// Sources that are placed together: repeated, then scaled, rotated and translated. [`Scene::add_group`] puts
        /// them into a scene.
        ///
        /// ```
        /// use energywave::glam::DVec3;
        /// use energywave::scene::{Beam, Camera, Group, Repeat, Scene};
        ///
        /// let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -8.0, 2.0), DVec3::ZERO));
        /// scene.add_group(&Group {
        ///     beams: vec![Beam::new(DVec3::X)],
        ///     repeat: Some(Repeat::around(12, DVec3::Z)),
        ///     ..Group::default()
        /// })?;
        /// assert_eq!(scene.beams.len(), 12);
        /// # Ok::<(), energywave::Error>(())
        /// ```
        #[derive(Debug, Clone, PartialEq)]
        pub struct Group {
            /// What all lengths are multiplied with: distances, `radius`, `reach`, `major_radius`, `taper_length`;
            /// positive. Coefficients and peaks stay.
            pub scale: f64,
            /// A turn about the group's origin, after the scale.
            pub rotate: Option<Rotation>,
            /// Where the group's origin is put, after the turn; world units, or those of the group around it.
            pub translate: DVec3,
            /// Copies, all of which are scaled, rotated and translated.
            pub repeat: Option<Repeat>,
            /// The group of lights of sources in it, and in groups within, that name none.
            pub light_group: Option<Box<str>>,
            $($(#[$doc])* pub $list: Vec<$Type>,)*
            /// Groups within this one, at most 8 deep.
            pub groups: Vec<Group>,
        }

        impl Default for Group {
            fn default() -> Self {
                Self {
                    scale: 1.0,
                    rotate: None,
                    translate: DVec3::ZERO,
                    repeat: None,
                    light_group: None,
                    $($list: Vec::new(),)*
                    groups: Vec::new(),
                }
            }
        }

        impl Group {
            /// Returns how many sources of each kind stand in it, without copies and without the groups within.
            fn own_counts(&self) -> [usize; KIND_COUNT] {
                [$(self.$list.len()),*]
            }

            /// Checks its own sources as they are written, but for how bright they are.
            fn check_sources(&self, measure: Measure, path: &str) -> std::result::Result<(), SceneError> {
                let brightness = Brightness { most: 0.0, least_distance: 1.0, measure, reduction: Reduction::Sum };
                $(for (index, source) in self.$list.iter().enumerate() {
                    source.check(&brightness).map_err(|fault| {
                        fault.of(&format!("{path}.{}[{index}]", stringify!($kind)))
                    })?;
                })*
                Ok(())
            }

            /// Adds its own sources to a scene; those that name no group of lights to this one.
            fn place_sources(&self, place: &Placement, light_group: Option<&str>, scene: &mut Scene) {
                $(if !self.$list.is_empty() {
                    scene.$list.extend(self.$list.iter().map(|source| {
                        let mut placed = source.placed(place);
                        light_group.into_iter().for_each(|group| placed.join(group));
                        placed
                    }));
                })*
            }
        }

        /// Makes room for so many more sources of each kind.
        fn reserve(scene: &mut Scene, counts: [u64; KIND_COUNT]) -> Result<()> {
            let sizes = [$(size_of::<$Type>() as u64),*];
            let needed = counts.iter().zip(sizes).map(|(count, size)| count * size).sum();
            if let Some(shortage) = memory::shortage(needed) {
                let count: u64 = counts.iter().sum();
                let message = format!("the {count} sources of groups: {shortage}; repeat less");
                return Err(Error::OutOfMemory(message));
            }
            let mut counts = counts.into_iter();
            $(match counts.next() {
                None | Some(0) => {}
                Some(more) => reserve_list(&mut scene.$list, more),
            })*
            Ok(())
        }
    };
}
for_each_kind!(define_group);

fn reserve_list<T: Clone>(list: &mut List<T>, more: u64) {
    list.reserve_exact(more as usize);
}

impl Group {
    fn copies(&self) -> u32 {
        self.repeat.map_or(1, |repeat| repeat.count)
    }

    fn own_placement(&self) -> Placement {
        Placement::new(self.scale, self.rotate, self.translate)
    }

    /// Returns how many sources of each kind it makes.
    fn counts(&self) -> [u64; KIND_COUNT] {
        let mut counts = self.own_counts().map(|count| count as u64);
        for group in &self.groups {
            add_counts(&mut counts, group.counts());
        }
        let copies = u64::from(self.copies());
        counts.map(|count| count.saturating_mul(copies))
    }

    /// Checks its numbers and its sources, which are measured so, and those of the groups within; `path` is its key.
    fn check(
        &self,
        measure: Measure,
        path: &str,
        depth: usize,
    ) -> std::result::Result<(), SceneError> {
        if depth > DEEPEST {
            let message = format!("groups stand in each other at most {DEEPEST} deep");
            return Err(SceneError::value(path, message));
        }
        self.check_numbers().map_err(|fault| fault.of(path))?;
        self.check_sources(measure, path)?;
        for (index, group) in self.groups.iter().enumerate() {
            group.check(measure, &format!("{path}.group[{index}]"), depth + 1)?;
        }
        Ok(())
    }

    fn check_numbers(&self) -> Checked {
        positive("scale", self.scale)?;
        vector("translate", self.translate)?;
        if let Some(rotation) = &self.rotate {
            direction("rotate.axis", rotation.axis)?;
            finite("rotate.angle", rotation.angle)?;
        }
        let light_group = self.light_group.as_deref();
        light_group.map_or(Ok(()), check_light_group)?;
        self.repeat.map_or(Ok(()), |repeat| repeat.check())
    }

    /// Adds all that it makes to a scene, its own space put into the scene's by `place`.
    fn place(&self, place: &Placement, light_group: Option<&str>, scene: &mut Scene) {
        if self.counts() == [0; KIND_COUNT] {
            return;
        }
        let light_group = self.light_group.as_deref().or(light_group);
        let own = self.own_placement().then(place);
        for copy in 0..self.copies() {
            let place = match &self.repeat {
                Some(repeat) => repeat.placement(copy).then(&own),
                None => own,
            };
            self.place_sources(&place, light_group, scene);
            for group in &self.groups {
                group.place(&place, light_group, scene);
            }
        }
    }
}

fn add_counts(sum: &mut [u64; KIND_COUNT], counts: [u64; KIND_COUNT]) {
    for (sum, count) in sum.iter_mut().zip(counts) {
        *sum = sum.saturating_add(count);
    }
}

impl Scene {
    /// Adds the sources that a group makes.
    ///
    /// # Errors
    /// [`Error::Scene`] if a number of the group or of its sources is no good, if groups nest more than 8 deep or make
    /// more than a million sources; [`Error::OutOfMemory`] if these do not fit. The scene is then as it was.
    pub fn add_group(&mut self, group: &Group) -> Result<()> {
        self.add_groups(std::slice::from_ref(group), |_| "group".to_owned())
    }

    /// Adds the sources that groups make, whose keys are given for faults.
    pub(super) fn add_groups(
        &mut self,
        groups: &[Group],
        key: impl Fn(usize) -> String,
    ) -> Result<()> {
        let mut counts = [0; KIND_COUNT];
        for (index, group) in groups.iter().enumerate() {
            group.check(self.integration.measure, &key(index), 1)?;
            add_counts(&mut counts, group.counts());
            let all = counts
                .iter()
                .fold(0, |sum: u64, count| sum.saturating_add(*count));
            if all > MOST_SOURCES {
                let message =
                    format!("groups make {all} sources, more than {MOST_SOURCES}: repeat less");
                return Err(SceneError::value(key(index), message).into());
            }
        }
        reserve(self, counts)?;
        for group in groups {
            group.place(&Placement::NONE, None, self);
        }
        Ok(())
    }
}
