//! Tangents of `smooth`: those of monotone cubics (Fritsch, Butland 1984, as MATLAB's and SciPy's pchip has them).
//! Where slopes on both sides of a key have one sign, the tangent is their harmonic mean weighted by the lengths of the
//! pieces, else 0.

use super::{Track, TrackLoop, TrackValue};

/// A piece between two keys: how long it takes, and its slope per second.
type Piece = (f64, f64);

/// Returns the tangent at a key, per second.
pub(super) fn tangent(track: &Track, key: usize) -> TrackValue {
    let last = track.times.len() - 1;
    let length = |piece: usize| track.times[piece + 1] - track.times[piece];
    let value = |key: usize| track.value(key);
    // The pieces before and behind a key, where there are any.
    let closes = value(0) == value(last) && track.looping == TrackLoop::Repeat;
    let pieces = match key {
        _ if (1..last).contains(&key) => Some((key - 1, key)),
        _ => closes.then_some((last - 1, 0)),
    };
    if let Some((before, behind)) = pieces {
        let (h, k) = (length(before), length(behind));
        let ends = [before, before + 1, behind, behind + 1].map(value);
        return TrackValue::of(ends, &mut |[a, b, c, d]| {
            inner((h, (b - a) / h), (k, (d - c) / k))
        });
    }
    // A track that goes back has no kink where it turns.
    if track.looping == TrackLoop::PingPong {
        return TrackValue::of([value(key)], &mut |_| 0.0);
    }
    let (near, far) = match key {
        0 => (0, 1.min(last - 1)),
        _ => (last - 1, last.saturating_sub(2)),
    };
    let (h, k) = (length(near), length(far));
    let ends = [near, near + 1, far, far + 1].map(value);
    TrackValue::of(ends, &mut |[a, b, c, d]| {
        end((h, (b - a) / h), (k, (d - c) / k))
    })
}

fn inner((h, slope): Piece, (k, next): Piece) -> f64 {
    if slope * next <= 0.0 {
        return 0.0;
    }
    let (before, behind) = (2.0 * k + h, k + 2.0 * h);
    (before + behind) / (before / slope + behind / next)
}

/// Returns that of a parabola through the three keys at an end, as far as it lets nothing overshoot.
fn end((h, slope): Piece, (k, next): Piece) -> f64 {
    let tangent = ((2.0 * h + k) * slope - h * next) / (h + k);
    if tangent * slope <= 0.0 {
        0.0
    } else if slope * next <= 0.0 && tangent.abs() > 3.0 * slope.abs() {
        3.0 * slope
    } else {
        tangent
    }
}
