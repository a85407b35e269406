//! Kinks: a core displaced across itself.
//!
//! At the arc length s it moves by `amplitude e(s) sum_k 2^-k n_k(2^k s / scale) / sum_k 2^-k`: n_k is value noise,
//! linear between lattice points at the whole numbers, each a vector of a disc of radius 1; e rises from 0 at the ends.
//! The directions across come from a frame that turns no more than the core does.

use glam::{DQuat, DVec2, DVec3};

use super::Piece;
use super::noise::Noise;

/// Lengths below this share of the core's are none.
const LEAST_SHARE: f64 = 1e-9;

/// Where no kinks are turned about their core. Frames are carried from here to where a core begins, which is possible
/// for every direction but the opposite one: no axis, along which cores often go.
const UNTURNED: DVec3 = DVec3::new(0.36, 0.48, 0.8);

/// How a core is displaced.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kinks {
    pub amplitude: f64,
    pub scale: f64,
    pub octaves: u32,
    /// Whether the end of an open core stays where it is, as its begin does.
    pub end_stays: bool,
    pub noise: Noise,
}

/// A core after it was displaced.
#[derive(Debug)]
pub(super) struct Displaced {
    pub pieces: Vec<Piece>,
    /// Where pieces begin and the last one ends, on the core as it was.
    joints: Vec<Joint>,
    /// World units, of the core as it was.
    pub length: f64,
    pub is_closed: bool,
}

/// A place of a core that is not displaced.
#[derive(Debug, Clone, Copy)]
pub(super) struct Joint {
    /// How much of the core lies before it, world units.
    from_begin: f64,
    /// Where the core goes, and one direction across it, of length 1.
    pub along: DVec3,
    across: DVec3,
}

impl Joint {
    /// Returns a direction across the core, as long as its two coordinates.
    pub fn across(&self, of: DVec2) -> DVec3 {
        of.x * self.across + of.y * self.along.cross(self.across)
    }
}

impl Displaced {
    /// Finds the place at a share of the core's length as it was, the share of its length as it is, and the point.
    pub fn at_share(&self, share: f64) -> (Joint, f64, DVec3) {
        let target = share * self.length;
        let after = self
            .joints
            .partition_point(|joint| joint.from_begin <= target);
        let index = after.clamp(1, self.pieces.len()) - 1;
        let (from, to) = (
            self.joints[index].from_begin,
            self.joints[index + 1].from_begin,
        );
        let t = ((target - from) / (to - from)).clamp(0.0, 1.0);
        let before: f64 = self.pieces[..index]
            .iter()
            .map(|piece| piece.length(1.0))
            .sum();
        let whole: f64 = self.pieces.iter().map(|piece| piece.length(1.0)).sum();
        let piece = &self.pieces[index];
        let own = (before + piece.length(t)) / whole;
        (self.joints[index], own, piece.at(t))
    }
}

impl Kinks {
    /// Returns how long pieces are: the distance of lattice points of the finest octave, world units.
    pub fn step(&self) -> f64 {
        self.scale / f64::from(1 << (self.octaves - 1))
    }

    /// Displaces pieces that follow each other; `None`: they are one point.
    pub fn displace(mut self, pieces: &[Piece]) -> Option<Displaced> {
        let lengths: Vec<f64> = pieces.iter().map(|piece| piece.length(1.0)).collect();
        let length: f64 = lengths.iter().sum();
        let (first, last) = (pieces.first()?, pieces.last()?);
        if length == 0.0 {
            return None;
        }
        let is_closed = first.at(0.0).distance(last.at(1.0)) < LEAST_SHARE * length;
        if is_closed {
            // A whole number of the largest kinks, so that what ends is what begins.
            self.scale = length / (length / self.scale).round().max(1.0);
        }
        let parts = self.parts(pieces, &lengths);
        let joints = joints(&parts, length, is_closed);
        let displacements: Vec<DVec3> = joints
            .iter()
            .map(|joint| joint.across(self.at(joint.from_begin, length, is_closed)))
            .collect();
        let displaced = parts
            .iter()
            .zip(displacements.windows(2))
            .map(|(part, ends)| {
                let [c0, c1, c2, c3] = part.piece.0;
                Piece([c0 + ends[0], c1 + (ends[1] - ends[0]), c2, c3])
            });
        Some(Displaced {
            pieces: displaced.collect(),
            joints,
            length,
            is_closed,
        })
    }

    /// Cuts pieces where lattice points of the finest octave lie.
    fn parts(&self, pieces: &[Piece], lengths: &[f64]) -> Vec<Part> {
        let step = self.step();
        let least = LEAST_SHARE * lengths.iter().sum::<f64>();
        let mut parts = Vec::new();
        let mut begin = 0.0;
        for (piece, &own) in pieces.iter().zip(lengths) {
            let mut from = 0.0;
            let mut k = (begin / step).floor();
            while own - from > least {
                k += 1.0;
                let to = k * step - begin;
                let to = if own - to > least { to } else { own };
                if to - from > least {
                    let from_begin = begin + from;
                    let piece = piece.between(own, from, to);
                    parts.push(Part { piece, from_begin });
                    from = to;
                }
            }
            begin += own;
        }
        parts
    }

    /// Returns the displacement in two directions across a core of some length, world units.
    fn at(&self, from_begin: f64, length: f64, is_closed: bool) -> DVec2 {
        let lattice = from_begin / self.scale;
        let period = is_closed.then(|| (length / self.scale).round().max(1.0) as u64);
        let octaves = 0..self.octaves;
        let weight = |octave: u32| 1.0 / f64::from(1 << octave);
        let sum: DVec2 = octaves
            .clone()
            .map(|octave| weight(octave) * self.noise.octave(octave, lattice, period))
            .sum();
        let rise = |from_end: f64| (from_end / self.scale.min(0.5 * length)).clamp(0.0, 1.0);
        let envelope = match (is_closed, self.end_stays) {
            (true, _) => 1.0,
            (false, true) => rise(from_begin).min(rise(length - from_begin)),
            (false, false) => rise(from_begin),
        };
        self.amplitude * envelope * sum / octaves.map(weight).sum::<f64>()
    }
}

/// A part of a core as it was, and how much of that lies before it.
#[derive(Debug, Clone, Copy)]
struct Part {
    piece: Piece,
    from_begin: f64,
}

/// Returns where parts meet, with a frame that turns no more than the core does; around a closed one evenly back to
/// where it began.
fn joints(parts: &[Part], length: f64, is_closed: bool) -> Vec<Joint> {
    let count = parts.len();
    let goes = |part: Option<&Part>, t: f64| {
        part.map_or(DVec3::ZERO, |part| {
            part.piece.velocity(t).normalize_or_zero()
        })
    };
    let tangent = |k: usize| {
        let (before, after) = match (k, is_closed) {
            (0, true) => (parts.last(), parts.first()),
            (0, false) => (None, parts.first()),
            (k, true) if k == count => (parts.last(), parts.first()),
            (k, _) => (parts.get(k - 1), parts.get(k)),
        };
        let (arrives, leaves) = (goes(before, 1.0), goes(after, 0.0));
        // Not a direction where the core goes back as it came.
        (arrives + leaves).try_normalize().unwrap_or(arrives)
    };
    let mut along = UNTURNED;
    let mut across = UNTURNED.any_orthonormal_vector();
    let mut joints = Vec::with_capacity(count + 1);
    for k in 0..=count {
        let next = tangent(k).try_normalize().unwrap_or(along);
        let turned = DQuat::from_rotation_arc(along, next) * across;
        along = next;
        across = (turned - turned.dot(along) * along).normalize();
        let from_begin = parts.get(k).map_or(length, |part| part.from_begin);
        joints.push(Joint {
            from_begin,
            along,
            across,
        });
    }
    if let (true, [first, .., last]) = (is_closed, &joints[..]) {
        let sine = last.across.cross(first.across).dot(first.along);
        let missing = sine.atan2(last.across.dot(first.across));
        for joint in &mut joints {
            let angle = missing * joint.from_begin / length;
            joint.across = DQuat::from_axis_angle(joint.along, angle) * joint.across;
        }
    }
    joints
}
