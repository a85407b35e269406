//! Adaptive Gauss-Kronrod quadrature on given pieces (QUADPACK's QAG: Piessens, de Doncker, Uberhuber, Kahaner 1983).
//!
//! The piece with the largest error estimate is halved until the sum of the estimates meets the wanted relative error.
//! Peaks, kinks and jumps inside a piece cost halvings, not accuracy; breaks given at them save the halvings.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Non-negative nodes of the 21-point Kronrod rule on `[-1,1]`, outermost first; odd places are the 10-point Gauss
/// rule's.
const NODES: [f64; 11] = [
    0.995_657_163_025_808_1,
    0.973_906_528_517_171_7,
    0.930_157_491_355_708_2,
    0.865_063_366_688_984_5,
    0.780_817_726_586_416_9,
    0.679_409_568_299_024_4,
    0.562_757_134_668_604_7,
    0.433_395_394_129_247_2,
    0.294_392_862_701_460_2,
    0.148_874_338_981_631_22,
    0.0,
];

/// Kronrod weights of `NODES`.
const KRONROD: [f64; 11] = [
    0.011_694_638_867_371_874,
    0.032_558_162_307_964_725,
    0.054_755_896_574_351_995,
    0.075_039_674_810_919_96,
    0.093_125_454_583_697_6,
    0.109_387_158_802_297_64,
    0.123_491_976_262_065_84,
    0.134_709_217_311_473_34,
    0.142_775_938_577_060_09,
    0.147_739_104_901_338_49,
    0.149_445_554_002_916_9,
];

/// Gauss weights of `NODES` at the odd places.
const GAUSS: [f64; 5] = [
    0.066_671_344_308_688_14,
    0.149_451_349_150_580_6,
    0.219_086_362_515_982_04,
    0.269_266_719_309_996_35,
    0.295_524_224_714_752_87,
];

/// Halvings after which a sum is taken as it stands; a jump needs about 40, a peak of width 1e-6 about 40.
const MOST_PIECES: usize = 2000;

/// A value with an estimate of its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The integral.
    pub value: f64,
    /// Estimated absolute error.
    pub error: f64,
}

struct Piece {
    from: f64,
    to: f64,
    value: f64,
    magnitude: f64,
    error: f64,
}

impl Piece {
    /// Applies one Gauss-Kronrod pair to [from, to], with QUADPACK's error estimate.
    fn new(integrand: &impl Fn(f64) -> f64, from: f64, to: f64) -> Self {
        let middle = 0.5 * (from + to);
        let half = 0.5 * (to - from);
        let mut values = [0.0; 21];
        for (k, node) in NODES.iter().enumerate() {
            values[k] = integrand(middle - half * node);
            values[20 - k] = integrand(middle + half * node);
        }
        let kronrod_weight = |i: usize| KRONROD[if i <= 10 { i } else { 20 - i }];
        let mut kronrod = 0.0;
        let mut magnitude = 0.0;
        for (i, value) in values.iter().enumerate() {
            kronrod += kronrod_weight(i) * value;
            magnitude += kronrod_weight(i) * value.abs();
        }
        let gauss: f64 = (0..5)
            .map(|j| GAUSS[j] * (values[2 * j + 1] + values[19 - 2 * j]))
            .sum();
        let mean = 0.5 * kronrod;
        let spread: f64 = (0..21)
            .map(|i| kronrod_weight(i) * (values[i] - mean).abs())
            .sum();
        let difference = (kronrod - gauss).abs();
        let estimate = match spread {
            0.0 => difference,
            spread => spread * (200.0 * difference / spread).powf(1.5).min(1.0),
        };
        let rounding = 50.0 * f64::EPSILON * magnitude;
        Self {
            from,
            to,
            value: kronrod * half,
            magnitude: magnitude * half,
            error: estimate.max(rounding) * half,
        }
    }

    /// Returns whether it is too narrow to halve, or already as good as float64 allows.
    fn is_final(&self) -> bool {
        self.to - self.from <= 4.0 * f64::EPSILON * self.to.abs().max(self.from.abs())
            || self.error <= 51.0 * f64::EPSILON * self.magnitude
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Piece {}
impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error.total_cmp(&other.error)
    }
}

/// Integrates `integrand` over `[0,end]`, beginning with the pieces between `breaks` (in any order; those outside are
/// ignored), to the error `relative` times the integral of the integrand's magnitude.
pub fn integrate(
    integrand: impl Fn(f64) -> f64,
    breaks: &mut Vec<f64>,
    end: f64,
    relative: f64,
) -> Estimate {
    breaks.retain(|s| *s > 0.0 && *s < end);
    breaks.push(0.0);
    breaks.push(end);
    breaks.sort_by(f64::total_cmp);
    let mut open: BinaryHeap<Piece> = breaks
        .windows(2)
        .filter(|pair| pair[1] > pair[0])
        .map(|pair| Piece::new(&integrand, pair[0], pair[1]))
        .collect();
    let mut error: f64 = open.iter().map(|piece| piece.error).sum();
    let mut magnitude: f64 = open.iter().map(|piece| piece.magnitude).sum();
    let mut done = Vec::new();
    while error > relative * magnitude && open.len() + done.len() < MOST_PIECES {
        let Some(worst) = open.pop() else { break };
        if worst.is_final() {
            done.push(worst);
            continue;
        }
        let middle = 0.5 * (worst.from + worst.to);
        error -= worst.error;
        magnitude -= worst.magnitude;
        for half in [
            Piece::new(&integrand, worst.from, middle),
            Piece::new(&integrand, middle, worst.to),
        ] {
            error += half.error;
            magnitude += half.magnitude;
            open.push(half);
        }
    }
    let pieces = || open.iter().chain(&done);
    Estimate {
        value: pieces().map(|piece| piece.value).sum(),
        error: pieces().map(|piece| piece.error).sum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the integral of a function of which the rule sees 21 samples a piece.
    fn over(integrand: impl Fn(f64) -> f64, breaks: &[f64]) -> f64 {
        integrate(integrand, &mut breaks.to_vec(), 1.0, 1e-12).value
    }

    #[test]
    fn one_pair_integrates_polynomials_up_to_degree_31() {
        for degree in 0..=31 {
            let value = Piece::new(&|s: f64| s.powi(degree), 0.0, 1.0).value;
            let exact = 1.0 / f64::from(degree + 1);
            assert!(
                (value / exact - 1.0).abs() < 1e-14,
                "{degree}: {value} {exact}"
            );
        }
    }

    #[test]
    fn peaks_kinks_and_jumps_are_integrated() {
        let width: f64 = 1e-6;
        let peak = over(|s| 1.0 / ((s - 0.3).powi(2) + width * width).sqrt(), &[0.3]);
        let exact = (0.7 / width).asinh() + (0.3 / width).asinh();
        assert!((peak / exact - 1.0).abs() < 1e-11, "{peak} {exact}");
        let kink = over(|s| (s - 0.3).abs(), &[]);
        assert!((kink - 0.29).abs() < 1e-12, "{kink}");
        let jump = over(|s| if s < 0.3 { 1.0 } else { 2.0 }, &[]);
        assert!((jump - 1.7).abs() < 1e-11, "{jump}");
    }

    #[test]
    fn a_peak_that_no_break_announces_and_no_node_meets_is_missed() {
        let hidden = |s: f64| if (s - 0.3).abs() < 1e-7 { 1e7 } else { 1.0 };
        assert!((over(hidden, &[]) - 3.0).abs() > 1.0);
        assert!(
            (over(hidden, &[0.3]) - 3.0).abs() > 1.0,
            "a break alone shows no plateau"
        );
    }
}
