//! Random numbers of a scene: any, or such as people type, whose sums and products are exact and meet each other.

use fastrand::Rng;
use glam::DVec3;

/// The same for the same seed and number.
pub struct Dice {
    random: Rng,
    /// Whether numbers are such as people type: halves, powers of two, axes.
    is_tidy: bool,
}

impl Dice {
    /// Makes the dice of a scene.
    pub fn new(seed: u64, number: u64) -> Self {
        let mixed = seed
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .wrapping_add(number.wrapping_mul(0xd1b5_4a32_d192_ed03));
        let mut random = Rng::with_seed(mixed);
        let is_tidy = random.bool();
        Self { random, is_tidy }
    }

    /// Returns a number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        self.random.usize(0..count)
    }

    /// Returns true once in `count`.
    pub fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    /// Returns one of them.
    pub fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// Returns a number from 0 to 1; a tidy one is a multiple of a quarter.
    pub fn share(&mut self) -> f64 {
        match self.is_tidy {
            true => self.below(5) as f64 / 4.0,
            false => self.random.f64(),
        }
    }

    /// Returns a number between two, evenly in the logarithm; a tidy one is a power of two.
    pub fn spread(&mut self, from: f64, to: f64) -> f64 {
        let number = from * (to / from).powf(self.random.f64());
        match self.is_tidy {
            true => number.log2().round().exp2(),
            false => number,
        }
    }

    /// Returns a small offset, often none.
    pub fn slight(&mut self) -> f64 {
        let offset = self.spread(1e-7, 1e-1);
        let sign = self.of(&[-1.0, 1.0]);
        self.of(&[0.0, 0.0, sign * offset])
    }

    /// Returns a point of a cube around the origin; a tidy one has halves of its reach as coordinates.
    pub fn point(&mut self, reach: f64) -> DVec3 {
        let mut coordinate = || match self.is_tidy {
            true => reach * (self.random.usize(0..5) as f64 / 2.0 - 1.0),
            false => reach * (2.0 * self.random.f64() - 1.0),
        };
        DVec3::new(coordinate(), coordinate(), coordinate())
    }

    /// Returns a unit vector; a tidy one is mostly an axis.
    pub fn direction(&mut self) -> DVec3 {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        if self.is_tidy && !self.one_in(4) {
            return self.of(&[-1.0, 1.0]) * self.of(&axes);
        }
        let any = DVec3::from([0; 3].map(|_| 2.0 * self.random.f64() - 1.0));
        any.try_normalize().unwrap_or(DVec3::X)
    }

    /// Returns a unit vector perpendicular to another; a tidy one is an axis where one is perpendicular.
    pub fn beside(&mut self, vector: DVec3) -> DVec3 {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let beside: Vec<DVec3> = axes
            .into_iter()
            .filter(|axis| axis.dot(vector) == 0.0)
            .collect();
        if self.is_tidy && !beside.is_empty() {
            return self.of(&[-1.0, 1.0]) * self.of(&beside);
        }
        let mut across = DVec3::ZERO;
        while across.length() < 0.1 {
            across = vector.normalize().cross(self.direction());
        }
        across.normalize()
    }
}
