//! What the sources that groups make are called in the file that the groups stand in.

use super::Group;
use crate::scene::kinds::{KIND_COUNT, KINDS};

/// Returns the key in a file of a source of a scene, such as `segment[7].to`, where groups made it: they made the last
/// of the scene's sources; `before` tells how many of each kind were there already.
pub(crate) fn key_in_groups(
    key: &str,
    groups: &[Group],
    before: &[usize; KIND_COUNT],
) -> Option<String> {
    let (kind, rest) = key.split_once('[')?;
    let (index, rest) = rest.split_once(']')?;
    let kind = KINDS.iter().position(|it| *it == kind)?;
    let index: u64 = index.parse().ok()?;
    let mut index = index.checked_sub(before[kind] as u64)?;
    Some(key_in(groups, kind, &mut index)? + rest)
}

/// Returns the key of a source that groups make, such as `group[1].segment[0]`.
fn key_in(groups: &[Group], kind: usize, index: &mut u64) -> Option<String> {
    let mut numbered = groups.iter().enumerate();
    numbered.find_map(|(number, group)| {
        let inside = group.key_of(kind, index)?;
        Some(format!("group[{number}].{inside}"))
    })
}

impl Group {
    /// Returns the key in this group of the source that is number `index` of its kind among those that the group makes;
    /// where it makes fewer, takes their number off the index.
    fn key_of(&self, kind: usize, index: &mut u64) -> Option<String> {
        let all = self.counts()[kind];
        if *index >= all {
            *index -= all;
            return None;
        }
        *index %= all / u64::from(self.copies());
        let own = self.own_counts()[kind] as u64;
        if *index < own {
            return Some(format!("{}[{index}]", KINDS[kind]));
        }
        *index -= own;
        key_in(&self.groups, kind, index)
    }
}
