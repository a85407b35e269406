//! `[[group]]`: sources that a file places together. The scene gets them as they are placed.

use glam::DVec3;
use serde::Deserialize;

use crate::error::{Result, SceneError};
use crate::scene::group::key_in_groups;
use crate::scene::kinds::{KIND_COUNT, for_each_kind};
use crate::scene::values::read_vector;
use crate::scene::*;

macro_rules! define_group_table {
    ($($(#[$doc:meta])* $kind:ident: $Type:ident, $list:ident;)*) => {
        /// A group as a file describes it.
        #[derive(Debug, Clone, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(super) struct GroupTable {
            #[serde(default = "one")]
            scale: f64,
            #[serde(default)]
            rotate: Option<Rotation>,
            #[serde(default, deserialize_with = "read_vector")]
            translate: DVec3,
            #[serde(default)]
            repeat: Option<Repeat>,
            #[serde(default)]
            light_group: Option<Box<str>>,
            $(#[serde(default)] $kind: Vec<$Type>,)*
            #[serde(default)]
            group: Vec<GroupTable>,
        }

        impl From<GroupTable> for Group {
            fn from(table: GroupTable) -> Self {
                Self {
                    scale: table.scale,
                    rotate: table.rotate,
                    translate: table.translate,
                    repeat: table.repeat,
                    light_group: table.light_group,
                    $($list: table.$kind,)*
                    groups: table.group.into_iter().map(Self::from).collect(),
                }
            }
        }

        fn counts(scene: &Scene) -> [usize; KIND_COUNT] {
            [$(scene.$list.len()),*]
        }
    };
}
for_each_kind!(define_group_table);

// What is read of `[[group]]`, but for what it places.
keys! { pub(in crate::scene) GROUP_KEYS;
    scale: POSITIVE, NONE, Value("1"), "what all lengths are multiplied with";
    rotate: Table("rotate"), NONE, Otherwise("not turned"), "a turn about the group's origin, after the scale";
    translate: VECTOR, WORLD, Value("[0, 0, 0]"), "where the group's origin is put";
    repeat: Table("repeat"), NONE, Otherwise("once"), "copies, all of which are scaled, rotated and translated";
    light_group: Text, NONE, Otherwise("that of the group around it, or none"),
        "that of sources in it which name none";
}

fn one() -> f64 {
    1.0
}

/// The groups of a file, whose sources stand in the scene behind the others.
pub(super) struct Groups {
    groups: Vec<Group>,
    /// How many sources of each kind stand before theirs.
    before: [usize; KIND_COUNT],
}

impl Groups {
    /// Adds the sources that the groups of a file make.
    pub(super) fn add_to(scene: &mut Scene, tables: Vec<GroupTable>) -> Result<Self> {
        let groups: Vec<Group> = tables.into_iter().map(Group::from).collect();
        let before = counts(scene);
        scene.add_groups(&groups, |index| format!("group[{index}]"))?;
        Ok(Self { groups, before })
    }

    /// Checks the scene; a source at fault has the name that it has in the file.
    pub(super) fn check(&self, scene: &Scene) -> std::result::Result<(), SceneError> {
        scene.check().map_err(|fault| match self.key(&fault) {
            Some(key) => {
                let message = format!("{} (where its group puts it)", fault.message);
                SceneError::value(key, message)
            }
            None => fault,
        })
    }

    /// Returns the warnings of the scene, whose sources have the names that they have in the file.
    pub(super) fn warnings(&self, scene: &Scene) -> Vec<SceneError> {
        let warnings = scene.warnings().into_iter();
        warnings.map(|warning| self.named(warning)).collect()
    }

    /// Gives a fault of a source that a group makes the name that it has in the file.
    pub(super) fn named(&self, mut fault: SceneError) -> SceneError {
        if let Some(key) = self.key(&fault) {
            fault.key = key;
        }
        fault
    }

    fn key(&self, fault: &SceneError) -> Option<String> {
        key_in_groups(&fault.key, &self.groups, &self.before)
    }
}
