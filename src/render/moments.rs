//! When to look while a shutter is open, and when that was often enough.
//!
//! ```text
//! mean of f over [0,1] = sum g'(k/n) f(g(k/n)) / sum g'(k/n),  0 < k < n        the trapezoid rule in u, t = g(u)
//! g'(u) = (1 - cos(pi u / r)) / 2 below r, 1 in the middle, the same mirrored above 1 - r
//! ```
//!
//! A core that crosses a pixel is a pulse in time, of which equal steps miss the least. At the ends, where pulses are
//! cut, steps that shrink to nothing leave no error of the ends, which equal steps have (Sidi 1993). So few frames do
//! for slow motion, nearly as few as by Gauss' rule, and a level adds its nodes between those of the levels before: no
//! frame is drawn in vain.

/// How far the steps grow from either end, r above.
const RAMP: f64 = 0.25;

/// Level k adds 2^k nodes between those of the levels before. No fewer levels than this are enough, 7 nodes: what
/// repeats itself within the shutter looks the same at the 3 of two levels.
pub(super) const LEAST_LEVEL: u32 = 2;

/// The last level there is: 1023 nodes.
pub(super) const LAST_LEVEL: u32 = 9;

/// Returns how many nodes the levels up to one have.
pub(super) fn count(level: u32) -> u32 {
    (2 << level) - 1
}

/// Returns the nodes of a level in their order: which share of the time has passed, and their weight.
pub(super) fn nodes(level: u32) -> impl Iterator<Item = (f64, f64)> {
    let steps = f64::from(2_u32 << level);
    (0..1_u32 << level).map(move |node| {
        let u = f64::from(2 * node + 1) / steps;
        (passed(u), step(u.min(1.0 - u)))
    })
}

/// Returns g', for u up to the middle.
fn step(u: f64) -> f64 {
    0.5 - 0.5 * (std::f64::consts::PI * u.min(RAMP) / RAMP).cos()
}

/// Returns g.
fn passed(u: f64) -> f64 {
    if u > 0.5 {
        return 1.0 - passed(1.0 - u);
    }
    let (turn, ramp) = (std::f64::consts::PI / RAMP, u.min(RAMP));
    let sum = (ramp - (turn * ramp).sin() / turn) / 2.0 + (u - ramp);
    sum / (1.0 - RAMP)
}

/// How far the mean of a level's frames is from that of all before, relative, by pixels: 99.9 % of them are within
/// this, and none is beyond ten times as much.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gap(f64);

impl Gap {
    /// Finds it among the differences of all pixels, which it puts in another order.
    pub(super) fn of(differences: &mut [f32]) -> Self {
        let within = (0.999 * differences.len() as f64).ceil() as usize;
        let place = within.clamp(1, differences.len().max(1)) - 1;
        if place >= differences.len() {
            return Self(0.0);
        }
        let (_, most, beyond) = differences.select_nth_unstable_by(place, f32::total_cmp);
        let worst = beyond.iter().copied().fold(*most, f32::max);
        Self(f64::from(*most).max(f64::from(worst) / 10.0))
    }

    /// Returns how far the mean of all is from the truth, about: at most a third of the gap, what is left of a pulse
    /// that is met by chance; less where gaps shrink faster from level to level.
    pub(super) fn error(self, before: Option<Self>) -> f64 {
        self.0 * self.gain(before)
    }

    /// Returns how many further levels it takes until the error is within a tolerance, about.
    pub(super) fn levels_to(self, before: Option<Self>, tolerance: f64) -> u32 {
        let excess = self.error(before) / tolerance;
        match excess > 1.0 {
            true => (excess.ln() / -self.gain(before).max(1e-3).ln()).ceil() as u32,
            false => 0,
        }
    }

    fn gain(self, before: Option<Self>) -> f64 {
        match before {
            Some(Self(before)) if before > 0.0 => (self.0 / before).min(1.0 / 3.0),
            _ => 1.0 / 3.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the mean of a function over the nodes of all levels up to one.
    fn mean(level: u32, f: impl Fn(f64) -> f64) -> f64 {
        let all = (0..=level).flat_map(nodes);
        let (sum, weight) = all.fold((0.0, 0.0), |(sum, all), (t, w)| (sum + w * f(t), all + w));
        sum / weight
    }

    #[test]
    fn nodes_lie_in_order_between_those_of_the_levels_before() {
        let mut all: Vec<f64> = (0..=LAST_LEVEL)
            .flat_map(nodes)
            .map(|node| node.0)
            .collect();
        assert_eq!(all.len(), count(LAST_LEVEL) as usize);
        for level in 0..=LAST_LEVEL {
            let level: Vec<f64> = nodes(level).map(|node| node.0).collect();
            assert!(level.windows(2).all(|pair| pair[0] < pair[1]));
        }
        all.sort_by(f64::total_cmp);
        assert!(all.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(all[0] > 0.0 && all[all.len() - 1] < 1.0);
    }

    #[test]
    fn means_are_those_of_known_integrals_and_equal_steps_miss_them() {
        let parabola = |t: f64| t * t;
        let pulse = |t: f64| 1.0 / (1.0 + (20.0 * (t - 0.3)).powi(2)).sqrt();
        let of_pulse = (14.0_f64.asinh() + 6.0_f64.asinh()) / 20.0;
        assert!((mean(2, parabola) - 1.0 / 3.0).abs() < 1e-3);
        assert!((mean(4, parabola) - 1.0 / 3.0).abs() < 1e-5);
        let error = |found: f64| (found / of_pulse - 1.0).abs();
        assert!(error(mean(4, pulse)) < 1e-4);
        // Light that is cut at the ends, and the middles of equal steps.
        let rise = |t: f64| (3.0 * t).exp() * 3.0 / (3.0_f64.exp() - 1.0);
        assert!((mean(4, rise) - 1.0).abs() < 3e-5);
        let equal = (0..31).map(|k| rise((f64::from(k) + 0.5) / 31.0));
        let equal = equal.sum::<f64>() / 31.0 - 1.0;
        assert!(equal.abs() > 3e-4, "{equal}");
        // One frame at the middle.
        assert!(error(mean(0, pulse)) > 0.1);
    }

    #[test]
    fn gaps_are_those_of_all_but_a_thousandth() {
        let mut differences = vec![0.01_f32; 10_000];
        differences[..10].fill(0.05);
        assert!((Gap::of(&mut differences).0 - 0.01).abs() < 1e-6);
        differences[..11].fill(0.05);
        assert!((Gap::of(&mut differences).0 - 0.05).abs() < 1e-6);
        differences.fill(0.01);
        differences[77] = 5.0;
        assert!((Gap::of(&mut differences).0 - 0.5).abs() < 1e-6);
        assert_eq!(Gap::of(&mut []), Gap(0.0));
    }

    #[test]
    fn errors_are_a_third_of_a_gap_or_less_where_gaps_shrink() {
        assert!((Gap(0.03).error(None) - 0.01).abs() < 1e-12);
        assert!((Gap(0.03).error(Some(Gap(0.04))) - 0.01).abs() < 1e-12);
        assert!((Gap(0.03).error(Some(Gap(3.0))) - 0.0003).abs() < 1e-12);
        assert_eq!(Gap(0.03).levels_to(None, 0.011), 0);
        assert_eq!(Gap(0.27).levels_to(None, 0.011), 2);
    }
}
