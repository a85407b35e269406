//! The core of a path by definition: its points, sampled, and the distance to the nearest of them.

use energywave::scene::{LightPath, PathShape};
use glam::DVec3;

/// A Bezier curve by de Casteljau's construction.
fn casteljau(points: &[DVec3], t: f64) -> DVec3 {
    let mut points = points.to_vec();
    while points.len() > 1 {
        points = points
            .windows(2)
            .map(|pair| pair[0].lerp(pair[1], t))
            .collect();
    }
    points[0]
}

/// A point of a path: `place` counts its pieces.
pub fn at(path: &LightPath, place: f64) -> DVec3 {
    let count = path.points.len() as i64;
    let point = |k: i64| match path.closed {
        true => path.points[k.rem_euclid(count) as usize],
        // Beyond an end it goes on as straight as it came.
        false if k < 0 => 2.0 * path.points[0] - path.points[1],
        false if k >= count => {
            2.0 * path.points[count as usize - 1] - path.points[count as usize - 2]
        }
        false => path.points[k as usize],
    };
    let piece = (place.floor() as i64).min(piece_count(path) as i64 - 1);
    let t = place - piece as f64;
    let bezier = |degree: i64| {
        let controls: Vec<DVec3> = (0..=degree).map(|k| point(degree * piece + k)).collect();
        casteljau(&controls, t)
    };
    match path.shape {
        PathShape::Quadratic => bezier(2),
        PathShape::Cubic => bezier(3),
        PathShape::Spline => {
            let [a, b, c, d] = [-1, 0, 1, 2].map(|k| point(piece + k));
            // Catmull, Rom 1974, in the form of their matrix.
            0.5 * (2.0 * b
                + (c - a) * t
                + (2.0 * a - 5.0 * b + 4.0 * c - d) * t * t
                + (3.0 * b - a - 3.0 * c + d) * t * t * t)
        }
        _ => bezier(1),
    }
}

pub fn piece_count(path: &LightPath) -> usize {
    let step = match path.shape {
        PathShape::Quadratic => 2,
        PathShape::Cubic => 3,
        _ => 1,
    };
    (path.points.len() - usize::from(!path.closed)) / step
}

/// The distance to the nearest of many samples, refined beside the nearest few.
pub fn distance(path: &LightPath, point: DVec3) -> f64 {
    const SAMPLES: usize = 40;
    let count = piece_count(path) * SAMPLES;
    let to = |k: usize| at(path, k as f64 / SAMPLES as f64).distance(point);
    let sampled: Vec<f64> = (0..=count).map(to).collect();
    let nearest = sampled.iter().copied().fold(f64::INFINITY, f64::min);
    let mut least = nearest;
    for k in (0..=count).filter(|k| sampled[*k] < nearest + 0.05) {
        let beside = |k: f64| (k / SAMPLES as f64).clamp(0.0, piece_count(path) as f64);
        let (mut from, mut to) = (beside(k as f64 - 1.0), beside(k as f64 + 1.0));
        for _ in 0..60 {
            let (left, right) = (from + (to - from) / 3.0, to - (to - from) / 3.0);
            match at(path, left).distance(point) < at(path, right).distance(point) {
                true => to = right,
                false => from = left,
            }
        }
        least = least.min(at(path, 0.5 * (from + to)).distance(point));
    }
    least
}
