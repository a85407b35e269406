//! The light that cores cast on surfaces in float64: `E(P, n) = integral of I' max(0, n.y) / (|y|^2 + radius^2)^(3/2)`
//! over all cores, by adaptive quadrature over each core's parameter, between where it crosses the horizon, which is
//! searched for, and where it is nearest. The kernels have closed forms and rules of few nodes.

use glam::DVec3;

use super::mesh::Hiding;
use super::quadrature::integrate;
use crate::error::Result;
use crate::scene::{Emitter, EmitterCore, Lighting, Scene};

/// Relative error of an integral.
const ERROR: f64 = 1e-9;

/// Places of a core at which its height and its distance are looked at.
const PLACES: u32 = 200;

/// Halvings of a bracket.
const HALVINGS: u32 = 60;

/// Beyond which a line is not followed, in distances: what is left is smaller than its square.
const FAR: f64 = 1e14;

/// A core as it is seen from a point.
struct Seen<'a> {
    emitter: &'a Emitter,
    point: DVec3,
    normal: DVec3,
    /// Of a line: where it is nearest, how far off it is there, and the parameters of its ends.
    nearest: f64,
    distance: f64,
    ends: [f64; 2],
    /// What may hide it.
    hiding: Option<&'a Hiding>,
}

impl<'a> Seen<'a> {
    fn new(emitter: &'a Emitter, point: DVec3, normal: DVec3, hiding: Option<&'a Hiding>) -> Self {
        let mut seen = Self {
            emitter,
            point,
            normal,
            nearest: 0.0,
            distance: 1.0,
            ends: [0.0, 1.0],
            hiding,
        };
        match emitter.core {
            EmitterCore::Line {
                point: begin,
                direction,
                range,
            } => {
                seen.nearest = (point - begin).dot(direction);
                let beside = begin + seen.nearest * direction - point;
                seen.distance = beside.length().hypot(emitter.radius);
                let parameter = |t: f64| {
                    ((t - seen.nearest) / seen.distance)
                        .clamp(-FAR, FAR)
                        .asinh()
                };
                seen.ends = range.map(parameter);
            }
            EmitterCore::Arc { angles, .. } => seen.ends = angles,
            EmitterCore::Point(_) | EmitterCore::Curve(_) => {}
        }
        seen
    }

    /// Returns the vector to the core, how fast that moves on, and how far it is of the core, 0 to 1.
    fn at(&self, x: f64) -> (DVec3, f64, f64) {
        let [from, to] = self.ends;
        let share = (x - from) / (to - from);
        match self.emitter.core {
            EmitterCore::Point(place) => (place - self.point, 1.0, 0.0),
            EmitterCore::Line {
                point,
                direction,
                range,
            } => {
                let t = self.nearest + self.distance * x.sinh();
                let share = (t - range[0]) / (range[1] - range[0]);
                let share = if share.is_finite() { share } else { 0.0 };
                (
                    point + t * direction - self.point,
                    self.distance * x.cosh(),
                    share,
                )
            }
            EmitterCore::Arc {
                center,
                x: right,
                y: up,
                ..
            } => {
                let place = center + x.cos() * right + x.sin() * up;
                (place - self.point, right.length(), share)
            }
            EmitterCore::Curve(piece) => {
                (piece.at(x) - self.point, piece.velocity(x).length(), share)
            }
        }
    }

    fn height(&self, x: f64) -> f64 {
        self.at(x).0.dot(self.normal)
    }

    fn distance2(&self, x: f64) -> f64 {
        self.at(x).0.length_squared()
    }

    /// Returns whether nothing hides a place of the core.
    fn is_seen(&self, x: f64) -> bool {
        let y = self.at(x).0;
        self.hiding
            .is_none_or(|hiding| !hiding.hides(self.point, self.point + y))
    }

    /// Returns the place between two at which something changes.
    fn change(mut a: f64, mut b: f64, is_so: impl Fn(f64) -> bool) -> f64 {
        let was_so = is_so(a);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (a + b);
            match is_so(middle) == was_so {
                true => a = middle,
                false => b = middle,
            }
        }
        0.5 * (a + b)
    }

    /// Returns where the core crosses the horizon, where it goes into hiding, and where it is nearest.
    fn breaks(&self) -> Vec<f64> {
        let [from, to] = self.ends;
        let at = |k: u32| from + (to - from) * f64::from(k) / f64::from(PLACES);
        let is_above = |x: f64| self.height(x) > 0.0;
        let is_seen = |x: f64| self.is_seen(x);
        let mut breaks = Vec::new();
        let mut was_seen = is_seen(from);
        for k in 0..PLACES {
            let (a, b) = (at(k), at(k + 1));
            if is_above(a) != is_above(b) {
                breaks.push(Self::change(a, b, is_above));
            }
            let now_seen = is_seen(b);
            if was_seen != now_seen {
                breaks.push(Self::change(a, b, is_seen));
            }
            was_seen = now_seen;
            let [before, here, after] = [k.max(1) - 1, k, k + 1].map(|k| self.distance2(at(k)));
            if here <= before && here <= after {
                let (mut a, mut b) = (at(k.max(1) - 1), at(k + 1));
                for _ in 0..2 * HALVINGS {
                    let [first, second] = [1.0, 2.0].map(|third| a + (b - a) * third / 3.0);
                    match self.distance2(first) < self.distance2(second) {
                        true => b = second,
                        false => a = first,
                    }
                }
                breaks.push(0.5 * (a + b));
            }
        }
        breaks.extend(self.ends);
        breaks.sort_by(f64::total_cmp);
        breaks
    }

    /// Returns the integral of what falls on the surface, times a power of the share of the core.
    fn moment(&self, breaks: &[f64], power: i32) -> f64 {
        let integrand = |x: f64| {
            let (y, speed, share) = self.at(x);
            let distance2 = y.length_squared() + self.emitter.radius.powi(2);
            share.powi(power) * speed * y.dot(self.normal).max(0.0) / distance2.powf(1.5)
        };
        let seen = |pair: &&[f64]| self.is_seen(0.5 * (pair[0] + pair[1]));
        let part = |pair: &[f64]| {
            let of_part = |x: f64| integrand(pair[0] + x);
            integrate(of_part, &mut Vec::new(), pair[1] - pair[0], ERROR).value
        };
        breaks.windows(2).filter(seen).map(part).sum()
    }

    fn irradiance(&self) -> DVec3 {
        let [begin, middle, end] = self.emitter.light;
        if let EmitterCore::Point(_) = self.emitter.core {
            if !self.is_seen(0.0) {
                return DVec3::ZERO;
            }
            let (y, ..) = self.at(0.0);
            let distance2 = y.length_squared() + self.emitter.radius.powi(2);
            return begin * y.dot(self.normal).max(0.0) / distance2.powf(1.5);
        }
        let breaks = self.breaks();
        let even = begin * self.moment(&breaks, 0);
        if begin == middle && middle == end {
            return even;
        }
        let bend = 2.0 * (begin + end - 2.0 * middle);
        even + (end - begin - bend) * self.moment(&breaks, 1) + bend * self.moment(&breaks, 2)
    }
}

/// Returns the irradiance, linear RGB, of points of surfaces with normals of any length but zero, in float64; with
/// shadows, what the scene's meshes leave of it.
///
/// # Errors
/// [`Error::Scene`](crate::Error::Scene) if the scene is not valid.
pub fn irradiance(scene: &Scene, points: &[DVec3], normals: &[DVec3]) -> Result<Vec<[f64; 3]>> {
    scene.validate()?;
    let caster = Caster::new(scene, scene.lighting.unwrap_or_default());
    let at = |(point, normal): (&DVec3, &DVec3)| {
        let light = caster.irradiance(*point, normal.normalize());
        light.to_array()
    };
    Ok(points.iter().zip(normals).map(at).collect())
}

/// What casts light, and what hides it.
#[derive(Debug)]
pub(super) struct Caster {
    emitters: Vec<Emitter>,
    hiding: Option<Hiding>,
}

impl Caster {
    pub(super) fn new(scene: &Scene, lighting: Lighting) -> Self {
        Self {
            emitters: scene.emitters(&lighting),
            hiding: Hiding::new(&scene.meshes).filter(|_| lighting.shadows),
        }
    }

    /// Returns the irradiance of a point with a normal of length 1.
    pub(super) fn irradiance(&self, point: DVec3, normal: DVec3) -> DVec3 {
        let above = self.above(point, normal);
        let of_one = |emitter| Seen::new(emitter, above, normal, self.hiding.as_ref()).irradiance();
        self.emitters.iter().map(of_one).sum()
    }

    /// Returns whether nothing hides a direction from a point.
    pub(super) fn sees(&self, point: DVec3, normal: DVec3, direction: DVec3) -> bool {
        let above = self.above(point, normal);
        self.hiding
            .as_ref()
            .is_none_or(|hiding| !hiding.hides(above, above + hiding.beyond * direction))
    }

    /// Returns a place a little above the surface, which is not to hide itself.
    fn above(&self, point: DVec3, normal: DVec3) -> DVec3 {
        let margin = self.hiding.as_ref().map_or(0.0, |hiding| hiding.margin);
        point + margin * normal
    }
}
