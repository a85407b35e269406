//! A chain of pieces in float64, curves as they are: the nearest point of every piece among the roots of a polynomial.

use std::sync::Arc;

use glam::DVec3;

use super::added::Added;
use super::{Field, Parts, Sample, Source, crossing};
use crate::scene::chain::{LightAlong, LitChain, Piece, Run, series_at};
use crate::scene::{Falloff, LightPath, Profile, Ray};

/// A piece of a core.
#[derive(Debug, Clone)]
pub struct Part {
    pub(super) piece: Piece,
    /// A ball in which it lies.
    center: DVec3,
    ball: f64,
    length: f64,
    /// The run that it belongs to, and from where to where it goes of that, in shares of its length.
    run: usize,
    shares: [f64; 2],
}

/// The pieces of all runs, and what light and thickness are along them.
#[derive(Debug, Clone)]
pub struct Nearest {
    pub(super) parts: Arc<[Part]>,
    runs: Arc<[Run]>,
    values: Vec<(f64, f64)>,
    radii: Vec<(f64, f64)>,
}

/// Always a chain.
impl Parts for LightPath {}

/// Calls `add` with each light of a chain.
pub fn add_chain(lit: &LitChain, add: &mut dyn FnMut(Source)) {
    let runs: Arc<[Run]> = lit.chain.runs.clone().into();
    let parts: Arc<[Part]> = parts_of(&runs).into();
    for LightAlong { light, values, radii } in &lit.lights {
        let field = Nearest {
            parts: parts.clone(),
            runs: runs.clone(),
            values: values.clone(),
            radii: radii.clone(),
        };
        add(match light.falloff.profile {
            Profile::Convolution => Source::new(Added(field), *light),
            _ => Source::new(field, *light),
        });
    }
}

fn parts_of(runs: &[Run]) -> Vec<Part> {
    let mut parts = Vec::new();
    for (index, run) in runs.iter().enumerate() {
        let lengths = run.lengths();
        let whole: f64 = lengths.iter().sum();
        let mut begin = 0.0;
        for (piece, length) in run.pieces.iter().zip(lengths) {
            let end = begin + length / whole;
            let (center, ball) = piece.ball();
            parts.push(Part {
                piece: *piece,
                center,
                ball,
                length,
                run: index,
                shares: [begin, end],
            });
            begin = end;
        }
    }
    parts
}

impl Nearest {
    /// Finds the squared distance to the nearest point, its piece, and where it lies on that.
    fn nearest(&self, point: DVec3) -> (f64, usize, f64) {
        let mut nearest = (f64::INFINITY, 0, 0.0);
        for (index, part) in self.parts.iter().enumerate() {
            let beyond = (part.center.distance(point) - part.ball).max(0.0);
            if beyond * beyond < nearest.0 {
                for_each_stationary(&part.piece, |v| v, point, &mut |t| {
                    let distance2 = part.piece.at(t).distance_squared(point);
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

    /// Returns what light is multiplied with at a point of a piece, and how thick the core is there.
    pub(super) fn lit(&self, index: usize, t: f64) -> (f64, f64) {
        if self.is_even(index) {
            return (1.0, 0.0);
        }
        let part = &self.parts[index];
        let run = &self.runs[part.run];
        let [begin, end] = part.shares;
        let of_piece = part.piece.length(t) / part.length;
        let own = begin + (end - begin) * of_piece;
        // Not a number of a core that is one point.
        let own = if own.is_nan() { 0.0 } else { own };
        let value = series_at(&self.values, run.share(own), 1.0);
        (run.fade(own) * value, series_at(&self.radii, run.share(own), 0.0))
    }
}

impl Nearest {
    /// Returns whether light and thickness are the same all along a piece.
    pub(super) fn is_even(&self, index: usize) -> bool {
        let run = &self.runs[self.parts[index].run];
        self.values.is_empty() && self.radii.is_empty() && run.fade == [1.0; 2]
    }

    /// Returns where on a piece, as t, knots of its light lie, in the order of the knots.
    pub(super) fn knots(&self, index: usize) -> Vec<f64> {
        let part = &self.parts[index];
        let run = &self.runs[part.run];
        let [begin, end] = part.shares.map(|own| run.share(own));
        let of_piece = |(share, _): &(f64, f64)| (share - begin) / (end - begin);
        let inside = self.values.iter().map(of_piece).filter(|share| *share > 0.0 && *share < 1.0);
        inside.map(|share| part.piece.t_at_length(share * part.length)).collect()
    }

    pub(super) fn for_each_stationary(&self, index: usize, point: DVec3, offer: &mut impl FnMut(f64)) {
        for_each_stationary(&self.parts[index].piece, |v| v, point, offer);
    }

    /// Calls `add` with each parameter at which the ray passes a piece, or a plane through an end of one, and the point
    /// of the piece.
    pub(super) fn passes(&self, ray: &Ray, add: &mut dyn FnMut(f64, DVec3)) {
        let direction = ray.span.normalize();
        let flat = |v: DVec3| v - direction * v.dot(direction);
        let mut offer = |s: f64, point: DVec3| {
            if s.is_finite() {
                add(s, point);
            }
        };
        for Part { piece, .. } in self.parts.iter() {
            for_each_stationary(piece, flat, ray.origin, &mut |t| {
                offer(ray.nearest_to(piece.at(t)), piece.at(t));
            });
            for t in [0.0, 1.0] {
                offer(crossing(ray, piece.at(t), piece.velocity(t)), piece.at(t));
            }
        }
    }
}

impl Field for Nearest {
    fn sample(&self, point: DVec3) -> Sample {
        let (distance2, index, t) = self.nearest(point);
        Sample {
            distance2,
            intensity: self.lit(index, t).0,
        }
    }

    fn light(&self, point: DVec3, falloff: &Falloff, softening2: f64, floor2: f64) -> f64 {
        let (distance2, index, t) = self.nearest(point);
        let (value, radius) = self.lit(index, t);
        let softened2 = (distance2 + softening2 + radius * radius).max(floor2);
        value * falloff.field(distance2, softened2)
    }

    /// Adds where the ray passes a piece that is nearest there, and where it leaves the planes through the ends of one.
    fn breaks(&self, ray: &Ray, breaks: &mut Vec<f64>) {
        self.passes(ray, &mut |s, point| {
            let at = ray.at(s.clamp(0.0, 1.0));
            if point.distance_squared(at) <= self.distance2(at) * (1.0 + 1e-6) + 1e-24 {
                breaks.push(s);
            }
        });
    }
}

/// Calls `offer` with the ends of a piece, and where between them the distance from a point, seen along `flat`, is
/// stationary.
fn for_each_stationary(
    piece: &Piece,
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

/// The highest degree of a polynomial whose roots are sought.
const DEGREE: usize = 5;

/// Calls `offer` with each root in (0,1) at which a polynomial changes its sign: between the roots of its derivative
/// there is at most one, and those are found in the same way, from the straight line on.
fn for_each_root(coefficients: &[f64], offer: &mut impl FnMut(f64)) {
    let degree = coefficients.len() - 1;
    let mut derivatives = [[0.0; DEGREE + 1]; DEGREE];
    derivatives[0][..=degree].copy_from_slice(coefficients);
    for order in 1..degree {
        for k in 0..=degree - order {
            derivatives[order][k] = (k + 1) as f64 * derivatives[order - 1][k + 1];
        }
    }
    let mut turns = [1.0; DEGREE + 1]; // and the end
    let mut count = 0;
    for order in (0..degree).rev() {
        let polynomial = &derivatives[order][..=degree - order];
        let mut roots = [1.0; DEGREE + 1];
        let mut found = 0;
        let mut from = 0.0;
        let mut was_below = polynomial[0] <= 0.0;
        for &to in &turns[..=count] {
            let is_below = value_and_slope(polynomial, to).0 <= 0.0;
            if to > from && was_below != is_below {
                roots[found] = bracketed_root(polynomial, was_below, from, to);
                found += 1;
            }
            (from, was_below) = (to, is_below);
        }
        (turns, count) = (roots, found);
    }
    turns[..count].iter().copied().for_each(offer);
}

fn value_and_slope(coefficients: &[f64], t: f64) -> (f64, f64) {
    coefficients.iter().rev().fold((0.0, 0.0), |(value, slope), c| {
        (value * t + c, slope * t + value)
    })
}

/// Finds the root of a polynomial that changes its sign once in [from, to]: Newton's steps, halving where they leave
/// the bracket or shrink slowly.
fn bracketed_root(coefficients: &[f64], rises: bool, mut from: f64, mut to: f64) -> f64 {
    let mut t = 0.5 * (from + to);
    let mut last = to - from;
    // A halving and a slow step may take turns.
    for _ in 0..200 {
        let (value, slope) = value_and_slope(coefficients, t);
        if (value <= 0.0) == rises {
            from = t;
        } else {
            to = t;
        }
        let step = value / slope;
        if step.abs() <= f64::EPSILON * t.abs() || to - from <= f64::EPSILON * to {
            return t;
        }
        let newton = t - step;
        let is_quick = newton > from && newton < to && 2.0 * step.abs() < last;
        let next = if is_quick { newton } else { 0.5 * (from + to) };
        last = (next - t).abs();
        t = next;
    }
    t
}
