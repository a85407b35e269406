//! How the rows of a frame are shared out among devices: by how many each drew in how much time.

use std::ops::Range;
use std::time::Duration;

/// A device without rows gets some again once the frames without it have taken this many times as long as those rows
/// will.
const PATIENCE: f64 = 50.0;

/// The least and the greatest share of what the last frame says that is believed.
const LEAST_GAIN: f64 = 1.0 / 32.0;
const MOST_GAIN: f64 = 0.5;

/// The speeds of devices, learnt from frame to frame.
#[derive(Debug)]
pub(crate) struct Shares(Vec<Speed>);

#[derive(Debug)]
struct Speed {
    /// Beside the others'; the sum of all is 1.
    speed: f64,
    /// By how much the last frame would change it.
    change: Option<f64>,
    /// How much of that was believed.
    gain: f64,
    /// Seconds that each of its last rows took.
    row: f64,
    /// Seconds of the frames since in which it had none.
    idle: f64,
}

impl Shares {
    /// Begins with a guess at the devices' speeds beside each other, above 0.
    pub(crate) fn new(guess: impl IntoIterator<Item = f64>) -> Self {
        let speeds = guess.into_iter().map(|speed| Speed {
            speed,
            change: None,
            gain: 1.0,
            row: 0.0,
            idle: 0.0,
        });
        Self(speeds.collect())
    }

    /// Shares out the rows, in multiples of `grain` but for the last, so that all devices should be done at the same
    /// time.
    pub(crate) fn split(&self, rows: u32, grain: u32) -> Vec<Range<u32>> {
        let mut left = rows.div_ceil(grain);
        let mut grains = vec![0_u32; self.0.len()];
        for (grains, one) in grains.iter_mut().zip(&self.0) {
            if one.idle > PATIENCE * one.row * f64::from(grain) && left > 1 {
                (*grains, left) = (1, left - 1);
            }
        }
        for _ in 0..left {
            // To whoever would be done with it first.
            let done = |device: &usize| f64::from(grains[*device] + 1) / self.0[*device].speed;
            let first = (0..grains.len()).min_by(|a, b| done(a).total_cmp(&done(b)));
            grains[first.unwrap_or(0)] += 1;
        }
        let mut end = 0;
        let ranges = grains.into_iter().map(|grains| {
            let begin = end;
            end = rows.min(begin + grains * grain);
            begin..end
        });
        ranges.collect()
    }

    /// Learns from a frame: the time of each device for its rows, if it had some and its time tells its speed.
    pub(crate) fn learn(&mut self, ranges: &[Range<u32>], times: &[Option<Duration>]) {
        let frame = times.iter().flatten().max().copied().unwrap_or_default();
        let mut known = Vec::new();
        for ((one, rows), time) in self.0.iter_mut().zip(ranges).zip(times) {
            if rows.is_empty() {
                one.idle += frame.as_secs_f64();
            } else if let Some(time) = *time {
                let row = time.as_secs_f64().max(1e-9) / f64::from(rows.end - rows.start);
                (one.row, one.idle) = (row, 0.0);
                known.push((one, 1.0 / row));
            }
        }
        // Rows may cost more than in the last frame, for all devices alike: only what they did beside each other
        // counts.
        let speeds: f64 = known.iter().map(|(one, _)| one.speed).sum();
        let rates: f64 = known.iter().map(|(_, rate)| rate).sum();
        for (one, rate) in known {
            one.believe(rate * speeds / rates - one.speed);
        }
        let sum: f64 = self.0.iter().map(|one| one.speed).sum();
        for one in &mut self.0 {
            one.speed /= sum;
        }
    }
}

impl Speed {
    /// Changes the speed, less and less where it goes back and forth: by noise, or because a boundary jumps over rows
    /// that cost more than others.
    fn believe(&mut self, change: f64) {
        self.gain = match self.change {
            None => 1.0, // so far there was only a guess
            Some(before) if before * change < 0.0 => LEAST_GAIN.max(0.5 * self.gain),
            Some(_) => MOST_GAIN.min(1.5 * self.gain),
        };
        self.speed += self.gain * change;
        self.change = Some(change);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws frames on devices of these speeds; `cost` is what a row costs.
    fn frames(
        shares: &mut Shares,
        speeds: &[f64],
        rows: u32,
        grain: u32,
        cost: impl Fn(u32) -> f64,
        count: u32,
    ) -> Vec<Vec<f64>> {
        let mut frames = Vec::new();
        for _ in 0..count {
            let ranges = shares.split(rows, grain);
            assert_eq!((ranges[0].start, ranges[ranges.len() - 1].end), (0, rows));
            assert!(ranges.windows(2).all(|pair| pair[0].end == pair[1].start));
            let is_whole =
                |range: &Range<u32>| range.start.is_multiple_of(grain) || range.is_empty();
            assert!(ranges.iter().all(is_whole));
            let seconds =
                |(range, speed): (&Range<u32>, &f64)| range.clone().map(&cost).sum::<f64>() / speed;
            let times: Vec<f64> = ranges.iter().zip(speeds).map(seconds).collect();
            let took = times.iter().zip(&ranges).map(|(time, range)| {
                (!range.is_empty()).then(|| Duration::from_secs_f64(1e-3 * time))
            });
            shares.learn(&ranges, &took.collect::<Vec<_>>());
            frames.push(times);
        }
        frames
    }

    fn longest(times: &[f64]) -> f64 {
        times.iter().copied().fold(0.0, f64::max)
    }

    /// Returns the time of a frame whose rows could be cut anywhere.
    fn ideal(speeds: &[f64], rows: u32, cost: impl Fn(u32) -> f64) -> f64 {
        (0..rows).map(cost).sum::<f64>() / speeds.iter().sum::<f64>()
    }

    #[test]
    fn devices_of_any_speed_are_soon_done_together() {
        for speeds in [&[1.0, 1.0][..], &[1.0, 3.0], &[20.0, 1.0], &[1.0, 7.0, 2.0]] {
            let mut shares = Shares::new(speeds.iter().map(|_| 1.0));
            let found = frames(&mut shares, speeds, 1024, 1, |_| 1.0, 6);
            let best = ideal(speeds, 1024, |_| 1.0);
            assert!(longest(&found[5]) < 1.05 * best, "{speeds:?}: {found:?}");
        }
    }

    #[test]
    fn rows_of_unequal_cost_are_shared_by_what_they_cost() {
        let bottom = |row: u32| 1.0 + f64::from(row) / 100.0;
        let middle = |row: u32| 1.0 + 20.0 * f64::from(u32::from((450..550).contains(&row)));
        let costs: [&dyn Fn(u32) -> f64; 2] = [&bottom, &middle];
        for cost in costs {
            for speeds in [&[1.0, 1.0][..], &[1.0, 3.0], &[20.0, 1.0], &[1.0, 1.0, 1.0]] {
                let mut shares = Shares::new(speeds.iter().map(|_| 1.0));
                let found = frames(&mut shares, speeds, 1024, 1, cost, 40);
                let best = ideal(speeds, 1024, cost);
                let late = found[20..].iter().map(|times| longest(times) / best);
                let mean = late.sum::<f64>() / 20.0;
                assert!(mean < 1.03, "{speeds:?}: {mean}");
            }
        }
    }

    #[test]
    fn a_device_too_slow_for_a_grain_gets_one_now_and_then_and_costs_little() {
        let mut shares = Shares::new([1.0, 1.0]);
        let speeds = [1.0, 0.01];
        let found = frames(&mut shares, &speeds, 512, 64, |_| 1.0, 4000);
        let turns = found[10..].iter().filter(|times| times[1] > 0.0).count();
        assert!((2..20).contains(&turns), "{turns}");
        let mean = found[10..].iter().map(|times| longest(times)).sum::<f64>() / 3990.0;
        assert!(mean < 1.05 * 512.0, "{mean}");
    }

    #[test]
    fn a_device_that_was_busy_comes_back() {
        let mut shares = Shares::new([1.0, 1.0]);
        frames(&mut shares, &[1.0, 0.01], 512, 64, |_| 1.0, 30);
        assert_eq!(shares.split(512, 64)[1].len(), 0);
        let found = frames(&mut shares, &[1.0, 1.0], 512, 64, |_| 1.0, 2000);
        assert!(longest(&found[1999]) < 260.0, "{:?}", found[1999]);
    }

    #[test]
    fn an_image_of_one_grain_goes_to_the_fastest_and_unknown_times_teach_nothing() {
        let mut shares = Shares::new([1.0, 4.0, 2.0]);
        assert_eq!(shares.split(5, 64), [0..0, 0..5, 5..5]);
        shares.learn(&[0..1, 1..2, 2..3], &[None; 3]);
        assert_eq!(shares.split(7, 1), [0..1, 1..5, 5..7]);
    }
}
