//! A chain of pieces in float64, curves as they are: the nearest point of every piece among the roots of a polynomial.

use glam::DVec3;

use super::{Field, Parts, Sample, Source, crossing, even};
use crate::scene::{Light, LightPath, PathPiece, Ray};

/// The pieces, each with a ball around it.
#[derive(Debug, Clone)]
struct Chain {
    pieces: Vec<(PathPiece, DVec3, f64)>,
}

impl Parts for LightPath {
    fn add_parts(&self, light: Light, add: &mut dyn FnMut(Source)) {
        let with_ball = |piece: PathPiece| {
            let (center, radius) = piece.ball();
            (piece, center, radius)
        };
        let pieces = self.pieces().into_iter().map(with_ball).collect();
        add(Source::new(Chain { pieces }, light));
    }
}

impl Chain {
    fn distance2(&self, point: DVec3) -> f64 {
        let mut least = f64::INFINITY;
        for (piece, center, radius) in &self.pieces {
            let beyond = (center.distance(point) - radius).max(0.0);
            if beyond * beyond < least {
                for_each_stationary(piece, |v| v, point, &mut |t| {
                    least = least.min(piece.at(t).distance_squared(point));
                });
            }
        }
        least
    }
}

impl Field for Chain {
    fn sample(&self, point: DVec3) -> Sample {
        even(self.distance2(point))
    }

    /// Adds where the ray passes a piece that is nearest there, and where it leaves the planes through the ends of one.
    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        let direction = ray.span.normalize();
        let flat = |v: DVec3| v - direction * v.dot(direction);
        let mut found = Vec::new();
        for (piece, ..) in &self.pieces {
            for_each_stationary(piece, flat, ray.origin, &mut |t| {
                found.push((ray.nearest_to(piece.at(t)), piece.at(t)));
            });
            let [_, c1, c2, c3] = piece.0;
            for (end, tangent) in [(0.0, c1), (1.0, c1 + 2.0 * c2 + 3.0 * c3)] {
                found.push((crossing(ray, piece.at(end), tangent), piece.at(end)));
            }
        }
        let is_nearest = |(s, point): &(f64, DVec3)| {
            let at = ray.at(s.clamp(0.0, 1.0));
            s.is_finite() && point.distance_squared(at) <= self.distance2(at) * (1.0 + 1e-6) + 1e-24
        };
        found.retain(is_nearest);
        breaks.extend(found.iter().map(|(s, _)| s));
    }
}

/// Calls `offer` with the ends of a piece, and where between them the distance from a point, seen along `flat`, is
/// stationary.
fn for_each_stationary(
    piece: &PathPiece,
    flat: impl Fn(DVec3) -> DVec3,
    point: DVec3,
    offer: &mut impl FnMut(f64),
) {
    let [c0, c1, c2, c3] = piece.0;
    let [c0, c1, c2, c3] = [flat(c0 - point), flat(c1), flat(c2), flat(c3)];
    offer(0.0);
    offer(1.0);
    // Half the derivative of the squared length.
    let derivative = [
        c0.dot(c1),
        c1.dot(c1) + 2.0 * c0.dot(c2),
        3.0 * (c1.dot(c2) + c0.dot(c3)),
        2.0 * c2.dot(c2) + 4.0 * c1.dot(c3),
        5.0 * c2.dot(c3),
        3.0 * c3.dot(c3),
    ];
    let degree = match (c2, c3) {
        (DVec3::ZERO, DVec3::ZERO) => 1,
        (_, DVec3::ZERO) => 3,
        _ => 5,
    };
    for_each_root(&derivative[..=degree], offer);
}

/// Calls `offer` with each root in (0,1) at which a polynomial changes its sign; between the roots of its derivative
/// there is at most one.
fn for_each_root(coefficients: &[f64], offer: &mut impl FnMut(f64)) {
    let value = |t: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c);
    let mut from = 0.0;
    let mut look_up_to = |to: f64| {
        if to > from && (value(from) <= 0.0) != (value(to) <= 0.0) {
            offer(bisected(&value, from, to));
        }
        from = to;
    };
    if coefficients.len() > 2 {
        let derivative: Vec<f64> = (1..coefficients.len())
            .map(|k| k as f64 * coefficients[k])
            .collect();
        let mut turns = Vec::new();
        for_each_turn(&derivative, &mut |t| turns.push(t));
        turns.into_iter().for_each(&mut look_up_to);
    }
    look_up_to(1.0);
}

/// The same through a pointer: a polynomial of each degree asks for that of the next lower one.
fn for_each_turn(coefficients: &[f64], offer: &mut dyn FnMut(f64)) {
    for_each_root(coefficients, &mut |t| offer(t));
}

fn bisected(value: &impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> f64 {
    let rises = value(from) <= 0.0;
    // Regula falsi, halving where it stalls (Illinois).
    let (mut low, mut high) = (value(from), value(to));
    for _ in 0..200 {
        let middle = (from * high - to * low) / (high - low);
        let middle = match middle > from && middle < to {
            true => middle,
            false => 0.5 * (from + to),
        };
        if to - from <= f64::EPSILON * to.abs() || middle == from || middle == to {
            return middle;
        }
        let found = value(middle);
        if found == 0.0 {
            return middle;
        }
        if (found <= 0.0) == rises {
            (from, low, high) = (middle, found, 0.5 * high);
        } else {
            (to, high, low) = (middle, found, 0.5 * low);
        }
        if (to - from) < 1e-15 {
            return 0.5 * (from + to);
        }
    }
    0.5 * (from + to)
}
