//! Dashes: a core with gaps.

use serde::{Deserialize, Serialize};

use super::Run;
use crate::scene::values::{Checked, Fault, finite};

/// Most dashes of a core.
const MOST_DASHES: u32 = 10_000;

/// Dashes of the same length along a core, with gaps of the same length between them: the core is what is left of it,
/// and light comes from the nearest dash.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Dashes {
    /// How many there are, 1 to 10000.
    pub count: u32,
    /// How much of a dash with its gap is the dash, more than 0 and less than 1.
    #[serde(default = "half")]
    pub fill: f64,
    /// By how many dashes with their gaps all are moved on along the core; what leaves it at one end comes in at the
    /// other.
    #[serde(default)]
    pub offset: f64,
}

// What is read of `dashes`.
keys! { pub(in crate::scene) DASHES_KEYS;
    count: Whole(1, MOST_DASHES), NONE, Required, "how many there are";
    fill: between(0.0, 1.0), NONE, Value("0.5"), "how much of a dash with its gap is lit";
    offset: ANY, "dashes", Value("0"), "moves all on along the core, by 1 to where the next one was";
}

fn half() -> f64 {
    0.5
}

impl Dashes {
    /// Makes so many dashes, as long as the gaps between them.
    #[must_use]
    pub fn new(count: u32) -> Self {
        Self {
            count,
            fill: half(),
            offset: 0.0,
        }
    }

    pub(super) fn check(&self) -> Checked {
        if !(1..=MOST_DASHES).contains(&self.count) {
            let message = format!("{} dashes; give from 1 to {MOST_DASHES}", self.count);
            return Err(Fault::new("dashes.count", message));
        }
        if !(self.fill > 0.0 && self.fill < 1.0) {
            let message = format!(
                "is how much of a dash with its gap is lit, more than 0 and less than 1; found {}",
                self.fill
            );
            return Err(Fault::new("dashes.fill", message));
        }
        finite("dashes.offset", self.offset)
    }

    /// Returns the dashes, from where to where in shares of the core; one that goes over its end is two.
    fn shares(&self) -> Vec<[f64; 2]> {
        let step = 1.0 / f64::from(self.count);
        let mut shares = Vec::new();
        for k in 0..self.count {
            let from = (f64::from(k) + self.offset.rem_euclid(1.0)) * step;
            let to = from + self.fill * step;
            if from < 1.0 {
                shares.push([from, to.min(1.0)]);
            }
            if to > 1.0 {
                shares.push([(from - 1.0).max(0.0), to - 1.0]);
            }
        }
        shares
    }

    /// Cuts a run into its dashes, as those of a core of the length `core` that the run is a part of, or leaves: there
    /// dashes go on along it.
    pub(super) fn cut(&self, whole: &Run, core: f64) -> Vec<Run> {
        let lengths = whole.lengths();
        let length: f64 = lengths.iter().sum();
        let dash = |shares: [f64; 2]| {
            let mut pieces = Vec::new();
            let mut begin = 0.0;
            for (piece, own) in whole.pieces.iter().zip(&lengths) {
                let [from, to] = shares.map(|share| (share * length - begin).clamp(0.0, *own));
                if to - from > 1e-12 * length {
                    pieces.push(piece.between(*own, from, to));
                }
                begin += own;
            }
            Run {
                pieces,
                shares: shares.map(|share| whole.share(share)),
                fade: shares.map(|share| whole.fade(share)),
            }
        };
        let begin = whole.shares[0];
        let of_run = |share: f64| ((share - begin) * core / length).clamp(0.0, 1.0);
        let again = |shares: [f64; 2]| [shares, shares.map(|share| share + 1.0)];
        let dashes = self.shares().into_iter().flat_map(again);
        let dashes = dashes.map(|shares| dash(shares.map(of_run)));
        dashes.filter(|run| !run.pieces.is_empty()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Piece;
    use super::*;
    use glam::DVec3;

    #[test]
    fn dashes_share_a_core_evenly_and_go_over_its_end() {
        let corner = |x: f64| DVec3::new(x, 0.0, 0.0);
        let whole = Run::whole(vec![
            Piece::straight(corner(0.0), corner(3.0)),
            Piece::straight(corner(3.0), corner(4.0)),
        ]);
        let ends = |dashes: Dashes| -> Vec<(f64, f64)> {
            let ends = |run: &Run| {
                let last = run.pieces.len() - 1;
                (run.pieces[0].at(0.0).x, run.pieces[last].at(1.0).x)
            };
            dashes
                .cut(&whole, whole.length())
                .iter()
                .map(ends)
                .collect()
        };
        assert_eq!(ends(Dashes::new(2)), [(0.0, 1.0), (2.0, 3.0)]);
        let moved = Dashes {
            offset: 0.75,
            ..Dashes::new(2)
        };
        assert_eq!(ends(moved), [(1.5, 2.5), (3.5, 4.0), (0.0, 0.5)]);
        let long = Dashes {
            fill: 0.75,
            offset: -0.25,
            ..Dashes::new(1)
        };
        assert_eq!(ends(long), [(3.0, 4.0), (0.0, 2.0)]);
    }
}
