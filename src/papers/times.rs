//! How long frames took.

use std::time::Duration;

use crate::error::{Error, Result};

/// Times of frames that were drawn whole, one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Times {
    /// How many frames were timed.
    pub frames: u32,
    /// Half of them took no longer.
    pub median: Duration,
    /// Of the quickest.
    pub least: Duration,
    /// Of the slowest.
    pub greatest: Duration,
}

impl Times {
    /// Says how times are spread.
    pub(super) fn of(mut times: Vec<Duration>) -> Result<Self> {
        times.sort();
        let (Some(least), Some(median), Some(greatest)) =
            (times.first(), times.get(times.len() / 2), times.last())
        else {
            return Err(Error::Unsupported("no frame was timed".to_owned()));
        };
        Ok(Self {
            frames: times.len() as u32,
            median: *median,
            least: *least,
            greatest: *greatest,
        })
    }

    /// Returns frames a second, by the median.
    #[must_use]
    pub fn fps(&self) -> f64 {
        1.0 / self.median.as_secs_f64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spread_is_of_all_times_in_any_order() {
        let times = |millis: &[u64]| {
            let times = millis.iter().map(|millis| Duration::from_millis(*millis));
            Times::of(times.collect())
        };
        let found = times(&[40, 10, 90, 20, 30]).unwrap();
        let millis = |time: Duration| time.as_millis();
        assert_eq!(
            (found.frames, millis(found.least), millis(found.greatest)),
            (5, 10, 90)
        );
        assert_eq!((millis(found.median), found.fps()), (30, 1.0 / 0.03));
        assert_eq!(times(&[7]).unwrap().greatest, times(&[7]).unwrap().least);
        assert!(times(&[]).is_err());
    }
}
