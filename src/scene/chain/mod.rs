//! Cores of many pieces along which light may change: what devices and the reference draw of a path, and of every other
//! core whose light is not the same all along it.

mod along;
mod arc;
mod dashes;
mod kinks;
mod noise;
mod piece;

use glam::DVec3;

pub(crate) use along::{Along, LightAlong, series_at};
#[cfg(feature = "files")]
pub(super) use arc::ARC_KEYS;
pub use arc::ElectricArc;
#[cfg(feature = "files")]
pub(super) use dashes::DASHES_KEYS;
pub use dashes::Dashes;
pub(crate) use piece::Piece;

use super::source::ball_around;

/// Pieces that follow each other without a gap.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Run {
    pub pieces: Vec<Piece>,
    /// From where to where it goes of the whole core, in shares of its length: there series are looked up.
    pub shares: [f64; 2],
    /// What light is multiplied with where it begins and where it ends, linear between.
    pub fade: [f64; 2],
}

impl Run {
    /// Makes the run that is a whole core.
    pub(crate) fn whole(pieces: Vec<Piece>) -> Self {
        Self {
            pieces,
            shares: [0.0, 1.0],
            fade: [1.0, 1.0],
        }
    }

    /// Returns the length of each of its pieces.
    pub(crate) fn lengths(&self) -> Vec<f64> {
        self.pieces.iter().map(|piece| piece.length(1.0)).collect()
    }

    /// Returns its length, world units.
    pub(crate) fn length(&self) -> f64 {
        self.lengths().iter().sum()
    }

    /// Returns where it is of the whole core, from where it is of itself.
    pub(crate) fn share(&self, own: f64) -> f64 {
        lerp(self.shares, own)
    }

    /// Returns what light is multiplied with, besides series.
    pub(crate) fn fade(&self, own: f64) -> f64 {
        lerp(self.fade, own)
    }
}

fn lerp([from, to]: [f64; 2], share: f64) -> f64 {
    from + (to - from) * share
}

/// A core of runs; light comes from the nearest point of them all.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chain {
    pub runs: Vec<Run>,
    /// How far straight pieces may be off curved ones, world units; `None`: as the tolerance asks.
    pub flatness: Option<f64>,
}

/// A core, and the lights that it has along it.
#[derive(Debug, Clone)]
pub(crate) struct LitChain {
    pub chain: Chain,
    pub lights: Vec<LightAlong>,
}

impl LitChain {
    /// Returns whether all light is the same all along the core.
    pub(crate) fn is_even(&self) -> bool {
        let has_fades = self.chain.runs.iter().any(|run| run.fade != [1.0; 2]);
        !has_fades
            && self
                .lights
                .iter()
                .all(|it| it.values.is_empty() && it.radii.is_empty())
    }
}

/// A point of a core, at which straight lines in its place meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner {
    pub at: DVec3,
    /// Where the core itself goes before it and after it, of length 1; zero where it does not.
    pub arrives: DVec3,
    pub leaves: DVec3,
}

/// Straight lines in the place of a chain.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Level {
    /// The corners of each run.
    pub runs: Vec<Vec<Corner>>,
    /// How far they are off the chain at most.
    pub off: f64,
}

/// Most chords that a piece is cut into, and how often their number is halved.
const MOST_CHORDS: usize = 4096;
const MOST_HALVINGS: u32 = 7;

/// Cuts of a piece where only roughly counts where it is.
const ROUGH_CHORDS: usize = 16;

impl Chain {
    pub(crate) fn pieces(&self) -> impl Iterator<Item = &Piece> + Clone {
        self.runs.iter().flat_map(|run| &run.pieces)
    }

    /// Returns a ball that it lies in: its centre and radius.
    pub(crate) fn ball(&self) -> (DVec3, f64) {
        ball_around(self.pieces().map(Piece::ball))
    }

    /// Returns half the diagonal of the box around the ends of its pieces.
    pub(crate) fn size(&self) -> f64 {
        let ends = || {
            self.pieces()
                .flat_map(|piece| [piece.at(0.0), piece.at(1.0)])
        };
        let low = ends().reduce(DVec3::min).unwrap_or_default();
        let high = ends().reduce(DVec3::max).unwrap_or_default();
        0.5 * low.distance(high)
    }

    /// Returns chains of straight lines, the first off by no more than the flatness, or where there is none, what
    /// `default` says of a piece; each of the others has about half as many as the one before.
    pub(crate) fn levels(&self, default: impl Fn(&Piece) -> f64) -> Vec<Level> {
        let flatness = |piece: &Piece| self.flatness.unwrap_or_else(|| default(piece));
        let finest = |piece: &Piece| {
            let chords = (piece.bulge() / flatness(piece)).sqrt().ceil();
            chords.clamp(1.0, MOST_CHORDS as f64) as usize
        };
        let most = self.pieces().map(finest).max().unwrap_or(1);
        let level = |halvings: u32| {
            let chords = |piece: &Piece| finest(piece).div_ceil(1 << halvings);
            let off = |piece: &Piece| piece.bulge() / (chords(piece) as f64).powi(2);
            Level {
                runs: self.corners(chords),
                off: self.pieces().map(off).fold(0.0, f64::max),
            }
        };
        (0..=most.ilog2().min(MOST_HALVINGS)).map(level).collect()
    }

    /// Returns points of it, roughly.
    pub(crate) fn rough_corners(&self) -> Vec<DVec3> {
        let chords = |piece: &Piece| match piece.bulge() {
            0.0 => 1,
            _ => ROUGH_CHORDS,
        };
        self.corners(chords)
            .concat()
            .iter()
            .map(|corner| corner.at)
            .collect()
    }

    /// Returns the corners of chords of all runs. No two corners of a run that follow each other are equal; there is at
    /// least one.
    fn corners(&self, chords: impl Fn(&Piece) -> usize) -> Vec<Vec<Corner>> {
        let of_run = |run: &Run| {
            let mut corners: Vec<Corner> = Vec::with_capacity(run.pieces.len() + 1);
            for piece in &run.pieces {
                let count = chords(piece);
                for k in 0..=count {
                    let t = k as f64 / count as f64;
                    let (at, along) = (piece.at(t), piece.velocity(t).normalize_or_zero());
                    match corners.last_mut() {
                        Some(last) if last.at == at => last.leaves = along,
                        _ => corners.push(Corner {
                            at,
                            arrives: along,
                            leaves: along,
                        }),
                    }
                }
            }
            if let [first, .., last] = &mut corners[..] {
                (first.arrives, last.leaves) = (DVec3::ZERO, DVec3::ZERO);
            }
            corners
        };
        self.runs.iter().map(of_run).collect()
    }
}
