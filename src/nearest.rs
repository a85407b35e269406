//! The name that was likely meant.

/// Returns of some names the one that a word is most like, if it is like one: at most half of its letters would have to
/// be changed, put in, left out or swapped with the next.
///
/// ```
/// let names = ["eye", "target", "fov_y"];
/// assert_eq!(energywave::nearest("traget", names), Some("target"));
/// assert_eq!(energywave::nearest("quarterstaff", names), None);
/// ```
#[must_use]
pub fn nearest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Nobody types a name of this length, and the distance takes as much memory as both together have letters.
    if word.len() > MOST_BYTES {
        return None;
    }
    let edits = |name: &&str| (strsim::osa_distance(word, name), name.len());
    let nearest = names.into_iter().min_by_key(edits)?;
    (edits(&nearest).0 <= nearest.len() / 2).then_some(nearest)
}

const MOST_BYTES: usize = 80;
