//! The noise that displaces cores: a function of what it belongs to.

use glam::DVec2;

use crate::scene::random;

/// Value noise of one core or branch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise {
    pub seed: u32,
    pub arm: u32,
    /// When it is; from one whole number to the next it becomes another one.
    pub at: f64,
}

/// What numbers are for.
#[derive(Debug, Clone, Copy)]
enum Purpose {
    Branch,
    Phase,
    Lattice,
}

impl Noise {
    fn unit(&self, purpose: Purpose, words: [u64; 3]) -> f64 {
        let named = [u64::from(self.seed), u64::from(self.arm), purpose as u64];
        random::unit(named.into_iter().chain(words))
    }

    /// Returns a vector of the disc of radius 1: of a square, each row of which is made as long as the disc is there.
    fn in_disc(&self, purpose: Purpose, words: [u64; 2]) -> DVec2 {
        let coordinate = |which: u64| 2.0 * self.unit(purpose, [words[0], words[1], which]) - 1.0;
        let (x, y) = (coordinate(0), coordinate(1));
        DVec2::new(
            x * (1.0 - 0.5 * y * y).sqrt(),
            y * (1.0 - 0.5 * x * x).sqrt(),
        )
    }

    /// Returns a number in [0,1) that stays as it is over time.
    pub(super) fn number(&self, which: u64) -> f64 {
        self.unit(Purpose::Branch, [which, 0, 0])
    }

    /// Returns a direction that stays as it is over time.
    pub(super) fn direction(&self, which: u64) -> DVec2 {
        let vector = self.in_disc(Purpose::Branch, [which, 0]);
        vector.try_normalize().unwrap_or(DVec2::X)
    }

    /// Returns an octave's vector, of length 1 at most; `period` is after how many of the largest lattice steps it
    /// begins again.
    pub(super) fn octave(&self, octave: u32, lattice: f64, period: Option<u64>) -> DVec2 {
        let steps = f64::from(1 << octave) * lattice;
        let before = steps.floor();
        let vector = |index: u64| match period {
            Some(period) => self.vector(octave, index % (period << octave)),
            None => self.vector(octave, index),
        };
        let index = before as u64;
        vector(index).lerp(vector(index + 1), steps - before)
    }

    /// Returns the vector at a lattice point: from one to another over time, each point in its own rhythm.
    fn vector(&self, octave: u32, index: u64) -> DVec2 {
        let key = u64::from(octave) << 32 | index;
        let at = self.at + self.unit(Purpose::Phase, [key, 0, 0]);
        let before = at.floor();
        let share = at - before;
        let tick = before as i64;
        let at_tick = |tick: i64| self.in_disc(Purpose::Lattice, [key, tick as u64]);
        let eased = share * share * (3.0 - 2.0 * share);
        at_tick(tick).lerp(at_tick(tick.wrapping_add(1)), eased)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_fill_a_disc_evenly() {
        let noise = Noise {
            seed: 1,
            arm: 2,
            at: 0.0,
        };
        let count = 20_000;
        let vectors = (0..count).map(|k| noise.in_disc(Purpose::Lattice, [k, 0]));
        let mut sum = DVec2::ZERO;
        let (mut most, mut squares): (f64, f64) = (0.0, 0.0);
        for vector in vectors {
            sum += vector;
            squares += vector.length_squared();
            most = most.max(vector.length());
        }
        let count = count as f64;
        // x^2 (1 - y^2/2) has the mean 1/3 (1 - 1/6).
        assert!((squares / count - 5.0 / 9.0).abs() < 0.01, "{squares}");
        assert!(sum.length() / count < 0.02 && most <= 1.0 && most > 0.99);
    }
}
