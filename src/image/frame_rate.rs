//! How many frames a second has: a fraction, so that frame n is at n / rate to the last bit.

use std::fmt;
use std::str::FromStr;

/// Frames a second, more than 0 and at most [`FrameRate::LIMIT`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRate {
    numerator: u32,
    denominator: u32,
}

impl FrameRate {
    /// The most frames a second.
    pub const LIMIT: u32 = 100_000;

    /// Makes the rate `numerator / denominator`, such as 30000 / 1001; `None` if it is 0 or beyond the limit.
    #[must_use]
    pub fn new(numerator: u32, denominator: u32) -> Option<Self> {
        Self::of(numerator.into(), denominator.into())
    }

    fn of(numerator: u64, denominator: u64) -> Option<Self> {
        let divisor = divisor(numerator, denominator);
        let rate = Self {
            numerator: (numerator / divisor).try_into().ok()?,
            denominator: (denominator / divisor).try_into().ok()?,
        };
        let is_rate = rate.numerator > 0 && rate.denominator > 0;
        (is_rate && rate.per_second() <= Self::LIMIT.into()).then_some(rate)
    }

    /// Returns the numerator and the denominator, without common divisors.
    #[must_use]
    pub fn parts(self) -> (u32, u32) {
        (self.numerator, self.denominator)
    }

    /// Returns the frames a second as a number.
    #[must_use]
    pub fn per_second(self) -> f64 {
        f64::from(self.numerator) / f64::from(self.denominator)
    }

    /// Returns when a frame is, seconds: that of number 0 is at 0 s.
    #[must_use]
    pub fn time_of(self, frame: u32) -> f64 {
        f64::from(frame) * f64::from(self.denominator) / f64::from(self.numerator)
    }

    /// Returns how many frames some seconds are, which need not be a whole number.
    #[must_use]
    pub fn frames_in(self, seconds: f64) -> f64 {
        seconds * f64::from(self.numerator) / f64::from(self.denominator)
    }
}

fn divisor(a: u64, b: u64) -> u64 {
    match b {
        0 => a.max(1),
        _ => divisor(b, a % b),
    }
}

impl Default for FrameRate {
    fn default() -> Self {
        Self {
            numerator: 30,
            denominator: 1,
        }
    }
}

impl fmt::Display for FrameRate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.numerator, self.denominator) {
            (numerator, 1) => write!(f, "{numerator}"),
            (numerator, denominator) if 1_000_000_u32.is_multiple_of(denominator) => {
                write!(f, "{}", f64::from(numerator) / f64::from(denominator))
            }
            (numerator, denominator) => write!(f, "{numerator}/{denominator}"),
        }
    }
}

impl FromStr for FrameRate {
    type Err = String;

    /// Reads a number with up to six digits behind its point, or a fraction such as `30000/1001`.
    fn from_str(text: &str) -> Result<Self, String> {
        let read = match text.split_once('/') {
            Some((numerator, denominator)) => numerator.parse().ok().zip(denominator.parse().ok()),
            None => decimal(text),
        };
        let rate = read.and_then(|(numerator, denominator)| Self::of(numerator, denominator));
        rate.ok_or_else(|| {
            format!(
                "a rate is a number of frames a second above 0 and up to {}, such as 30, 23.976 or 30000/1001",
                Self::LIMIT
            )
        })
    }
}

/// Reads a decimal number as a fraction.
fn decimal(text: &str) -> Option<(u64, u64)> {
    let (whole, digits) = text.split_once('.').unwrap_or((text, ""));
    let is_number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if whole.is_empty() || digits.len() > 6 || !is_number(whole) || !is_number(digits) {
        return None;
    }
    let numerator = format!("{whole}{digits}").parse().ok()?;
    Some((numerator, 10_u64.pow(digits.len() as u32)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_read_as_the_fractions_that_they_are() {
        for (text, parts, shown) in [
            ("30", (30, 1), "30"),
            ("29.970", (2997, 100), "29.97"),
            ("60000/1001", (60000, 1001), "60000/1001"),
            ("50/2", (25, 1), "25"),
            ("0.5", (1, 2), "0.5"),
            ("100000.0", (100_000, 1), "100000"),
        ] {
            let rate: FrameRate = text.parse().unwrap();
            assert_eq!((rate.parts(), rate.to_string().as_str()), (parts, shown));
        }
        let wrong = [
            "0",
            "0.0",
            "-1",
            "nan",
            "inf",
            "",
            ".",
            "1/0",
            "0/1",
            "1e3",
            "100001",
            "1.2345678",
            "30 ",
            "a/b",
        ];
        for text in wrong {
            assert!(text.parse::<FrameRate>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_frame_is_at_the_nearest_number_to_its_time() {
        let rate: FrameRate = "30".parse().unwrap();
        assert_eq!(rate.time_of(30), 1.0);
        assert_eq!(rate.time_of(1), 1.0 / 30.0);
        let rate: FrameRate = "30000/1001".parse().unwrap();
        assert_eq!(rate.time_of(30000), 1001.0);
        assert_eq!(rate.frames_in(1001.0), 30000.0);
    }
}
