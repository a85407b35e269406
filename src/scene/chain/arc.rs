//! Electric arcs: a core that is displaced into kinks, and side arms that leave it.

use serde::{Deserialize, Serialize};

use super::kinks::{Displaced, Kinks};
use super::noise::Noise;
use super::{Piece, Run};
use crate::scene::values::{Checked, Fault, finite, positive};

/// Kinks of a core, as those of lightning, and side arms: a function of these numbers alone, so that the same time has
/// the same shape. A core that ends where it begins stays closed; the ends of others stay where they are.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ElectricArc {
    /// How far the core is displaced at most, world units; about 0.4 times as far in the mean.
    pub amplitude: f64,
    /// The length of the largest kinks, world units; the smallest have an eighth of it. Longer cores have more of them.
    pub scale: f64,
    /// Every seed has another shape.
    #[serde(default)]
    pub seed: u32,
    /// How often a second the shape becomes another one, without a jump.
    #[serde(default)]
    pub drift: f64,
    /// How many side arms leave the core, at most 64: forward, at 20 to 45 degrees, 0.15 to 0.4 times as long as it,
    /// with kinks half as large; their light falls to 0 towards their tips.
    #[serde(default)]
    pub branches: u32,
    /// Seconds; it counts only times `drift`.
    #[serde(default)]
    pub time: f64,
}

// What is read of `arc`.
keys! { pub(in crate::scene) ARC_KEYS;
    amplitude: NOT_NEGATIVE, WORLD, Required, "how far the core is displaced at most";
    scale: POSITIVE, WORLD, Required, "the length of the largest kinks";
    seed: WHOLE, NONE, Value("0"), "every seed has another shape";
    drift: ANY, "per second", Value("0"), "how often the shape becomes another one, without a jump";
    branches: Whole(0, MOST_BRANCHES), NONE, Value("0"), "how many side arms leave the core";
    time: ANY, "seconds", Value("0"), "when it is; counts only times drift";
}

/// Octaves of a core's kinks; of those of a branch, which begin at half the scale, one less: pieces are as long.
const OCTAVES: u32 = 4;
const OCTAVES_OF_BRANCH: u32 = OCTAVES - 1;

/// Amplitude and scale of a branch, those of the core being 1.
const OF_BRANCH: f64 = 0.5;

/// How long branches are, and where along an open core they leave it, in shares of its length; the tangents of their
/// angles to it.
const LENGTHS: [f64; 2] = [0.15, 0.4];
const PLACES: [f64; 2] = [0.08, 0.85];
const SLOPES: [f64; 2] = [0.364, 1.0];

const MOST_BRANCHES: u32 = 64;

/// Most pieces of a core with its branches; as many as a path has points.
const MOST_PIECES: f64 = 65_536.0;

impl ElectricArc {
    /// Makes kinks without branches that stay as they are.
    #[must_use]
    pub fn new(amplitude: f64, scale: f64) -> Self {
        Self {
            amplitude,
            scale,
            seed: 0,
            drift: 0.0,
            branches: 0,
            time: 0.0,
        }
    }

    /// Multiplies its lengths.
    pub(crate) fn scale_by(&mut self, scale: f64) {
        self.amplitude *= scale;
        self.scale *= scale;
    }

    /// Checks it on the core that it displaces.
    pub(super) fn check(&self, whole: &Run) -> Checked {
        finite("arc.amplitude", self.amplitude)?;
        if self.amplitude < 0.0 {
            let message = format!("a core is displaced by 0 or more; found {}", self.amplitude);
            return Err(Fault::new("arc.amplitude", message));
        }
        positive("arc.scale", self.scale)?;
        finite("arc.drift", self.drift)?;
        finite("arc.time", self.time)?;
        if self.branches > MOST_BRANCHES {
            let message = format!("{} branches; give from 0 to {MOST_BRANCHES}", self.branches);
            return Err(Fault::new("arc.branches", message));
        }
        let length = whole.length();
        let of_branches = LENGTHS[1] * f64::from(self.branches);
        let pieces = length * (1.0 + of_branches) / self.kinks_of_core().step();
        if pieces > MOST_PIECES {
            let message = format!(
                "makes {pieces:.0} pieces of a core {length:.4} long and its branches, more than {MOST_PIECES}: give \
                 at least {:.2e}",
                self.scale * pieces / MOST_PIECES
            );
            return Err(Fault::new("arc.scale", message));
        }
        Ok(())
    }

    fn kinks_of_core(&self) -> Kinks {
        Kinks {
            amplitude: self.amplitude,
            scale: self.scale,
            octaves: OCTAVES,
            end_stays: true,
            noise: self.noise(0),
        }
    }

    /// Returns the noise of the core, 0, or of a branch, from 1 on.
    fn noise(&self, arm: u32) -> Noise {
        Noise {
            seed: self.seed,
            arm,
            at: self.time * self.drift,
        }
    }

    /// Returns a whole core with its kinks, then its branches.
    pub(super) fn displaced(&self, whole: Run) -> Vec<Run> {
        let Some(core) = self.kinks_of_core().displace(&whole.pieces) else {
            return vec![whole];
        };
        let branches = (0..self.branches).filter_map(|branch| self.branch(branch, &core));
        let branches: Vec<Run> = branches.collect();
        let whole = Run::whole(core.pieces);
        std::iter::once(whole).chain(branches).collect()
    }

    fn branch(&self, index: u32, core: &Displaced) -> Option<Run> {
        let noise = self.noise(index + 1);
        let number = |which, [from, to]: [f64; 2]| from + (to - from) * noise.number(which);
        let place = (f64::from(index) + noise.number(0)) / f64::from(self.branches);
        let [first, last] = if core.is_closed { [0.0, 1.0] } else { PLACES };
        let (joint, share, at) = core.at_share(first + (last - first) * place);
        let length = number(1, LENGTHS) * core.length;
        let slope = number(2, SLOPES);
        let across = joint.across(noise.direction(3));
        let along = (joint.along + slope * across).normalize();
        let kinks = Kinks {
            amplitude: OF_BRANCH * self.amplitude,
            scale: OF_BRANCH * self.scale,
            octaves: OCTAVES_OF_BRANCH,
            end_stays: false,
            noise,
        };
        let displaced = kinks.displace(&[Piece::straight(at, at + length * along)])?;
        Some(Run {
            pieces: displaced.pieces,
            shares: [share; 2],
            fade: [1.0, 0.0],
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::DVec3;

    use super::*;
    use crate::scene::chain::{Along, Dashes};

    const LENGTH: f64 = 7.0;

    fn straight(length: f64) -> Run {
        let end = length * DVec3::new(0.6, 0.0, -0.8);
        Run::whole(vec![Piece::straight(DVec3::ZERO, end)])
    }

    fn arc() -> ElectricArc {
        ElectricArc {
            seed: 5,
            drift: 2.0,
            branches: 6,
            time: 0.3,
            ..ElectricArc::new(0.4, 0.9)
        }
    }

    fn shape(arc: ElectricArc) -> Vec<Run> {
        arc.displaced(straight(LENGTH))
    }

    /// Returns how far apart corners are at most.
    fn apart(a: &[Run], b: &[Run]) -> f64 {
        let corners = |runs: &[Run]| -> Vec<DVec3> {
            let pieces = runs.iter().flat_map(|run| &run.pieces);
            pieces
                .flat_map(|piece| [piece.at(0.0), piece.at(1.0)])
                .collect()
        };
        let (a, b) = (corners(a), corners(b));
        a.iter()
            .zip(&b)
            .map(|(a, b)| a.distance(*b))
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_shape_is_a_function_of_its_keys_and_moves_on_without_jumps() {
        assert_eq!(shape(arc()), shape(arc()));
        let other = |change: fn(&mut ElectricArc)| {
            let mut other = arc();
            change(&mut other);
            apart(&shape(arc()), &shape(other))
        };
        assert!(other(|arc| arc.seed = 6) > 0.2);
        assert!(other(|arc| arc.time += 1.0) > 0.2);
        // As much drift in less time is the same.
        assert!(other(|arc| (arc.drift, arc.time) = (4.0, 0.15)) < 1e-12);
        let still = |time| {
            shape(ElectricArc {
                drift: 0.0,
                time,
                ..arc()
            })
        };
        assert_eq!(still(0.0), still(17.5));
        // Speed is bounded: lattice values go from one to another in half a second, over less than the diameter.
        let step = 1e-3;
        let mut moved: f64 = 0.0;
        for k in 0..2000 {
            let at = |k: i32| {
                shape(ElectricArc {
                    time: step * f64::from(k),
                    ..arc()
                })
            };
            moved = moved.max(apart(&at(k), &at(k + 1)));
        }
        let fastest = 1.5 * 2.0 * 0.4 * (1.0 + OF_BRANCH) * arc().drift;
        assert!(
            moved < fastest * step && moved > 0.1 * fastest * step,
            "{moved}"
        );
    }

    #[test]
    fn kinks_stay_within_the_amplitude_and_ends_where_they_are() {
        let core = &shape(arc())[0];
        let (from, to) = (
            core.pieces[0].at(0.0),
            core.pieces[core.pieces.len() - 1].at(1.0),
        );
        let end = LENGTH * DVec3::new(0.6, 0.0, -0.8);
        assert!(from == DVec3::ZERO && to.distance(end) < 1e-12);
        for pair in core.pieces.windows(2) {
            assert!(pair[0].at(1.0).distance(pair[1].at(0.0)) < 1e-12);
        }
        let off = |piece: &Piece| piece.at(0.0).cross(end / LENGTH).length();
        let most = core.pieces.iter().map(off).fold(0.0, f64::max);
        assert!(most <= 0.4 && most > 0.15, "{most}");
    }

    #[test]
    fn longer_cores_have_more_kinks_and_not_longer_ones() {
        // Where the core turns by more than 15 degrees.
        let kinks = |length: f64| {
            let core = &arc().displaced(straight(length))[0];
            let along = |piece: &Piece| piece.velocity(0.5).normalize();
            let is_kink = |pair: &&[Piece]| along(&pair[0]).dot(along(&pair[1])) < 0.966;
            core.pieces.windows(2).filter(is_kink).count() as f64
        };
        let ratio = kinks(30.0 * LENGTH) / kinks(3.0 * LENGTH);
        assert!(ratio > 9.0 && ratio < 12.0, "{ratio}");
    }

    #[test]
    fn branches_leave_the_core_forward_and_fade() {
        let runs = shape(arc());
        let (core, branches) = runs.split_first().unwrap();
        assert_eq!(branches.len(), 6);
        let forward = DVec3::new(0.6, 0.0, -0.8);
        for branch in branches {
            let (first, last) = (
                branch.pieces[0].at(0.0),
                branch.pieces[branch.pieces.len() - 1].at(1.0),
            );
            let on = |piece: &Piece| {
                let along = (first - piece.at(0.0)).dot(piece.velocity(0.0))
                    / piece.velocity(0.0).length_squared();
                piece.at(along.clamp(0.0, 1.0)).distance(first)
            };
            assert!(core.pieces.iter().map(on).fold(f64::INFINITY, f64::min) < 1e-12);
            let span = last - first;
            let most_off = OF_BRANCH * arc().amplitude;
            assert!(
                span.length() > 0.15 * LENGTH - most_off && span.length() < 0.4 * LENGTH + most_off
            );
            assert!(span.dot(forward) > 0.7 * 0.15 * LENGTH - most_off);
            assert!(branch.fade == [1.0, 0.0] && branch.shares[0] == branch.shares[1]);
            assert!(branch.shares[0] > 0.0 && branch.shares[0] < 1.0);
        }
    }

    #[test]
    fn a_closed_core_stays_closed() {
        let ring = Piece::circle(DVec3::ONE, 2.0 * DVec3::X, 2.0 * DVec3::Z, [0.0, TAU]);
        let still = ring[0].at(0.0);
        let core = &arc().displaced(Run::whole(ring))[0];
        let (first, last) = (
            core.pieces[0].at(0.0),
            core.pieces[core.pieces.len() - 1].at(1.0),
        );
        assert!(first.distance(last) < 1e-9, "{first} {last}");
        assert!(first.distance(still) > 0.01 && first.distance(still) <= 0.4);
    }

    #[test]
    fn dashes_of_branches_are_as_long_as_those_of_the_core() {
        let along = Along {
            arc: Some(ElectricArc {
                amplitude: 0.0,
                ..arc()
            }),
            dashes: Some(Dashes::new(20)),
            ..Along::default()
        };
        let runs = along.chain(straight(LENGTH), None).runs;
        let whole = |run: &&Run| (run.length() - LENGTH / 40.0).abs() < 1e-9;
        let of_core = runs.iter().filter(|run| run.shares[0] < run.shares[1]);
        assert_eq!(of_core.filter(whole).count(), 20);
        let of_branches = runs.iter().filter(|run| run.shares[0] == run.shares[1]);
        assert!(of_branches.clone().filter(whole).count() >= 12);
        assert!(
            of_branches
                .clone()
                .all(|run| run.length() < LENGTH / 40.0 + 1e-9)
        );
    }
}
