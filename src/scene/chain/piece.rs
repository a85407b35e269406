//! A polynomial piece of a core.

use std::f64::consts::TAU;

use glam::DVec3;

/// A polynomial piece of a core: `c0 + c1 t + c2 t^2 + c3 t^3`, t in `[0,1]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece(pub [DVec3; 4]);

/// Stretches of a piece whose lengths are added up by Simpson's rule; an even number.
const STRETCHES: u32 = 64;

/// Cubic curves that stand for a whole circle: off by 2e-11 of its radius.
const OF_CIRCLE: f64 = 64.0;

impl Piece {
    pub(crate) fn straight(from: DVec3, to: DVec3) -> Self {
        Self([from, to - from, DVec3::ZERO, DVec3::ZERO])
    }

    pub(crate) fn quadratic([b0, b1, b2]: [DVec3; 3]) -> Self {
        Self([b0, 2.0 * (b1 - b0), b0 - 2.0 * b1 + b2, DVec3::ZERO])
    }

    pub(crate) fn cubic([b0, b1, b2, b3]: [DVec3; 4]) -> Self {
        Self([
            b0,
            3.0 * (b1 - b0),
            3.0 * (b0 - 2.0 * b1 + b2),
            b3 - b0 + 3.0 * (b1 - b2),
        ])
    }

    /// Makes the pieces of a part of a circle; `x` and `y` are perpendicular and as long as its radius, angles are in
    /// radians, from x to y.
    pub(crate) fn circle(center: DVec3, x: DVec3, y: DVec3, [from, to]: [f64; 2]) -> Vec<Self> {
        let count = ((to - from).abs() / TAU * OF_CIRCLE).ceil().max(1.0);
        let step = (to - from) / count;
        let handle = 4.0 / 3.0 * (step / 4.0).tan();
        let piece = |k: u32| {
            let at = |angle: f64| x * angle.cos() + y * angle.sin();
            let along = |angle: f64| y * angle.cos() - x * angle.sin();
            let (a, b) = (from + f64::from(k) * step, from + f64::from(k + 1) * step);
            let points = [
                at(a),
                at(a) + handle * along(a),
                at(b) - handle * along(b),
                at(b),
            ];
            Self::cubic(points.map(|point| center + point))
        };
        (0..count as u32).map(piece).collect()
    }

    pub(crate) fn at(&self, t: f64) -> DVec3 {
        let [c0, c1, c2, c3] = self.0;
        ((c3 * t + c2) * t + c1) * t + c0
    }

    /// Returns how it moves on with t.
    pub(crate) fn velocity(&self, t: f64) -> DVec3 {
        let [_, c1, c2, c3] = self.0;
        c1 + (2.0 * c2 + 3.0 * c3 * t) * t
    }

    pub(crate) fn is_straight(&self) -> bool {
        let [_, _, c2, c3] = self.0;
        (c2, c3) == (DVec3::ZERO, DVec3::ZERO)
    }

    /// Returns its length up to t.
    pub(crate) fn length(&self, t: f64) -> f64 {
        let speed = |t: f64| self.velocity(t).length();
        if self.is_straight() {
            return t * speed(0.0);
        }
        let at = |k: u32| speed(t * f64::from(k) / f64::from(STRETCHES));
        let pairs = (0..STRETCHES / 2).map(|k| at(2 * k) + 4.0 * at(2 * k + 1) + at(2 * k + 2));
        pairs.sum::<f64>() * t / f64::from(3 * STRETCHES)
    }

    /// Returns the t up to which it is so long.
    pub(crate) fn t_at_length(&self, length: f64) -> f64 {
        let (mut from, mut to) = (0.0, 1.0);
        let mut t = length / self.length(1.0);
        for _ in 0..60 {
            let missing = length - self.length(t);
            if missing == 0.0 {
                break;
            }
            (from, to) = if missing > 0.0 { (t, to) } else { (from, t) };
            let next = t + missing / self.velocity(t).length();
            let next = match next > from && next < to {
                true => next,
                false => 0.5 * (from + to),
            };
            if (next - t).abs() < 1e-15 {
                break;
            }
            t = next;
        }
        t.clamp(0.0, 1.0)
    }

    /// Returns its part between two values of t.
    pub(crate) fn part(&self, from: f64, to: f64) -> Self {
        let [_, _, c2, c3] = self.0;
        let width = to - from;
        Self([
            self.at(from),
            self.velocity(from) * width,
            (c2 + 3.0 * c3 * from) * (width * width),
            c3 * width.powi(3),
        ])
    }

    /// Returns its part between two lengths; its own is `whole`.
    pub(in crate::scene) fn between(&self, whole: f64, from: f64, to: f64) -> Self {
        let t = |length: f64| match length {
            length if length <= 0.0 => 0.0,
            length if length >= whole => 1.0,
            length => self.t_at_length(length),
        };
        self.part(t(from), t(to))
    }

    /// Returns a ball in which it lies: its centre and radius.
    pub(crate) fn ball(&self) -> (DVec3, f64) {
        let [_, c1, c2, c3] = self.0;
        let half = 0.5 * (c1.length() + c2.length() + c3.length());
        (self.at(0.5), half.max(self.at(0.5).distance(self.at(1.0))))
    }

    /// Returns how far a chord over all of it is off at most: an eighth of its greatest second derivative. Chords over
    /// a k-th of it are off by that over k squared.
    pub(super) fn bulge(&self) -> f64 {
        let [_, _, c2, c3] = self.0;
        let bend = (2.0 * c2).length().max((2.0 * c2 + 6.0 * c3).length());
        bend / 8.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_lie_on_their_piece_and_lengths_lead_back_to_t() {
        let piece = Piece::cubic(
            [
                [0.0, 0.1, 0.0],
                [1.0, 2.0, -1.0],
                [2.0, -1.0, 0.5],
                [3.0, 0.4, 1.0],
            ]
            .map(DVec3::from),
        );
        let part = piece.part(0.2, 0.7);
        for k in 0..=10 {
            let t = f64::from(k) / 10.0;
            assert!(part.at(t).distance(piece.at(0.2 + 0.5 * t)) < 1e-14);
            let back = piece.t_at_length(piece.length(t));
            assert!((back - t).abs() < 1e-9, "{t} {back}");
        }
        let whole = part.length(1.0);
        assert!((piece.length(0.7) - piece.length(0.2) - whole).abs() < 1e-6 * whole);
    }

    #[test]
    fn circles_are_round_and_even() {
        let (x, y) = (2.0 * DVec3::X, 2.0 * DVec3::Z);
        let pieces = Piece::circle(DVec3::ONE, x, y, [0.0, TAU]);
        assert_eq!(pieces.len(), 64);
        for piece in &pieces {
            for k in 0..=20 {
                let radius = piece.at(f64::from(k) / 20.0).distance(DVec3::ONE);
                assert!((radius - 2.0).abs() < 1e-10, "{radius}");
            }
            assert!((piece.length(1.0) - 2.0 * TAU / 64.0).abs() < 1e-9);
        }
        let quarter = Piece::circle(DVec3::ZERO, x, y, [0.0, TAU / 4.0]);
        assert!(quarter[quarter.len() - 1].at(1.0).distance(y) < 1e-12);
    }
}
