//! A chain of pieces in float64, curves as they are: the nearest point of every piece among the roots of a polynomial.

use glam::DVec3;

use super::{Field, Parts, Sample, Source, crossing, even};
use crate::scene::{Light, LightPath, PathPiece, Ray};

/// The pieces, each with a ball around it, and what light is multiplied with along them.
#[derive(Debug, Clone)]
struct Chain {
    pieces: Vec<(PathPiece, DVec3, f64)>,
    /// The share of the whole length at which each piece begins, and 1.
    begins: Vec<f64>,
    /// Shares of the length, with a value at each, linear between; none: 1 everywhere.
    knots: Vec<(f64, f64)>,
}

/// Stretches of a piece whose lengths are added up.
const STRETCHES: u32 = 256;

/// Returns the length of a piece up to t, by Simpson's rule.
fn length(piece: &PathPiece, t: f64) -> f64 {
    let [_, c1, c2, c3] = piece.0;
    let speed = |t: f64| (c1 + (2.0 * c2 + 3.0 * c3 * t) * t).length();
    if (c2, c3) == (DVec3::ZERO, DVec3::ZERO) {
        return t * speed(0.0);
    }
    let at = |k: u32| speed(t * f64::from(k) / f64::from(STRETCHES));
    let pairs = (0..STRETCHES / 2).map(|k| at(2 * k) + 4.0 * at(2 * k + 1) + at(2 * k + 2));
    pairs.sum::<f64>() * t / f64::from(3 * STRETCHES)
}

impl Parts for LightPath {
    fn add_parts(&self, light: Light, add: &mut dyn FnMut(Source)) {
        let with_ball = |piece: PathPiece| {
            let (center, radius) = piece.ball();
            (piece, center, radius)
        };
        let pieces: Vec<_> = self.pieces().into_iter().map(with_ball).collect();
        let mut begins = vec![0.0];
        for (piece, ..) in &pieces {
            begins.push(begins[begins.len() - 1] + length(piece, 1.0));
        }
        let whole = begins[begins.len() - 1];
        begins.iter_mut().for_each(|begin| *begin /= whole);
        for (light, knots) in self.along(&light) {
            let chain = Chain {
                pieces: pieces.clone(),
                begins: begins.clone(),
                knots,
            };
            add(Source::new(chain, light));
        }
    }
}

impl Chain {
    /// Finds the squared distance to the nearest point, its piece, and where it lies on that.
    fn nearest(&self, point: DVec3) -> (f64, usize, f64) {
        let mut nearest = (f64::INFINITY, 0, 0.0);
        for (index, (piece, center, radius)) in self.pieces.iter().enumerate() {
            let beyond = (center.distance(point) - radius).max(0.0);
            if beyond * beyond < nearest.0 {
                for_each_stationary(piece, |v| v, point, &mut |t| {
                    let distance2 = piece.at(t).distance_squared(point);
                    if distance2 < nearest.0 {
                        nearest = (distance2, index, t);
                    }
                });
            }
        }
        nearest
    }

    fn distance2(&self, point: DVec3) -> f64 {
        self.nearest(point).0
    }

    /// Returns what light is multiplied with at a point of a piece.
    fn intensity(&self, index: usize, t: f64) -> f64 {
        let (piece, ..) = &self.pieces[index];
        let (begin, end) = (self.begins[index], self.begins[index + 1]);
        let of_piece = length(piece, t) / length(piece, 1.0);
        let share = begin + (end - begin) * if of_piece.is_nan() { 0.0 } else { of_piece };
        let mut pairs = self.knots.windows(2);
        let around = pairs.find(|pair| share <= pair[1].0).unwrap_or(&self.knots[self.knots.len() - 2..]);
        let [(s0, v0), (s1, v1)] = [around[0], around[1]];
        v0 + (v1 - v0) * (share - s0) / (s1 - s0)
    }
}

impl Field for Chain {
    fn sample(&self, point: DVec3) -> Sample {
        let (distance2, index, t) = self.nearest(point);
        match self.knots.is_empty() {
            true => even(distance2),
            false => Sample {
                distance2,
                intensity: self.intensity(index, t),
            },
        }
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
