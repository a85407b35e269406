//! The light of many points along rays, by a closed form in float64: what adaptive quadrature would take hours for.
//! With `v = -1 / (s + beta)` the integrals of `zeta / d` and `zeta / d^2` become those of `v / sqrt(X)` and
//! `v^2 / X`, X a parabola in v, whose primitives textbooks have; without decay they are arsinh and arctan. Points are
//! taken in blocks, and logarithms and angles by series without branches, so that processors take several at once.

use std::f64::consts::{LN_2, PI};

use glam::DVec3;

use crate::scene::{CORE_FLOOR, Decay, Points, Profile, Ray, Scene};
use crate::threads;

/// So many points a ray looks at before the next ray does, and so many rays of a thread look at them.
const BLOCK: usize = 256;
const RAYS: usize = 32;

/// So many sums run side by side.
const SUMS: usize = 8;

/// Returns the light of all `[[points]]` of a scene along rays, as thin as points are: linear RGB, by the scene's
/// measure. Of decays, those of power 2; points have neither radius nor reach. Next to the pole of a decay, behind
/// where a ray begins, it has few digits.
pub fn light_of_points(scene: &Scene, rays: &[Ray]) -> Vec<[f64; 3]> {
    let whole: Vec<(Ray, f64)> = rays.iter().map(|ray| (*ray, 1.0)).collect();
    light_of_points_up_to(scene, &whole)
}

/// Returns the light of all points of a scene along rays of which each ends at a share of its length, as
/// [`light_of_points`] does.
#[must_use]
pub fn light_of_points_up_to(scene: &Scene, rays: &[(Ray, f64)]) -> Vec<[f64; 3]> {
    let mut lights: Vec<(DVec3, &(Ray, f64))> = rays.iter().map(|ray| (DVec3::ZERO, ray)).collect();
    threads::for_each_part(&mut lights, RAYS, |_, part| {
        for points in scene.points.iter() {
            for begin in (0..points.points.len()).step_by(BLOCK) {
                let block = Block::new(points, begin);
                for (light, (ray, end)) in part.iter_mut() {
                    *light += block.light(&Line::new(ray, *end), points.profile, scene.decay);
                }
            }
        }
    });
    let scaled = |(light, (ray, _)): (DVec3, &(Ray, f64))| {
        (light * scene.integration.scale(ray.span.length())).to_array()
    };
    lights.into_iter().map(scaled).collect()
}

/// Some of the points of a list, by columns.
struct Block {
    places: [[f64; BLOCK]; 3],
    lights: [[f64; BLOCK]; 3],
}

/// A ray, and what is known of it alone.
struct Line {
    origin: DVec3,
    span: DVec3,
    end: f64,
    length2: f64,
    floor2: f64,
}

/// How a point lies beside a ray: at which share of the ray, and how far away, squared.
struct Beside {
    foot: f64,
    beside2: f64,
}

impl Line {
    fn new(ray: &Ray, end: f64) -> Self {
        let length2 = ray.span.length_squared();
        Self {
            origin: ray.origin,
            span: ray.span,
            end,
            length2,
            floor2: CORE_FLOOR * CORE_FLOOR * length2,
        }
    }
}

impl Block {
    /// Takes points from one on; where there are no more, dark ones.
    fn new(points: &Points, begin: usize) -> Self {
        let mut block = Self {
            places: [[0.0; BLOCK]; 3],
            lights: [[0.0; BLOCK]; 3],
        };
        for k in 0..BLOCK {
            let index = begin + k;
            let is_there = index < points.points.len();
            let place = points.points.position(if is_there { index } else { begin });
            let light = match is_there {
                true => points.light(index),
                false => DVec3::ZERO,
            };
            for axis in 0..3 {
                (block.places[axis][k], block.lights[axis][k]) = (place[axis], light[axis]);
            }
        }
        block
    }

    /// Returns the integral of the light of all its points over s from 0 to the end of a ray.
    fn light(&self, line: &Line, profile: Profile, decay: Option<Decay>) -> DVec3 {
        let is_square = profile == Profile::InverseSquare;
        let length = line.length2.sqrt();
        let Some(Decay { alpha, beta, .. }) = decay else {
            let ends = |it: &Beside| {
                let beside = it.beside2.sqrt();
                let at = |s: f64| (s + it.foot) * length / beside;
                (beside, at(line.end), at(0.0))
            };
            return match is_square {
                true => self.sum(line, |it| {
                    let (beside, end, begin) = ends(&it);
                    (end.atan() - begin.atan()) / (beside * length)
                }),
                false => self.sum(line, |it| {
                    let (_, end, begin) = ends(&it);
                    (end.asinh() - begin.asinh()) / length
                }),
            };
        };
        let [v0, v1] = [0.0, line.end].map(|s| -1.0 / (s + beta));
        let light = match is_square {
            true => self.sum(line, |it| {
                square_with_decay(line.length2, beta, [v0, v1], it)
            }),
            false => self.sum(line, |it| {
                inverse_with_decay(line.length2, beta, [v0, v1], it)
            }),
        };
        light * alpha
    }

    /// Returns the sum of its lights, each times an integral.
    #[inline(always)]
    fn sum(&self, line: &Line, integral: impl Fn(Beside) -> f64) -> DVec3 {
        let (o, d) = (line.origin, line.span);
        let per_length2 = 1.0 / line.length2;
        let [xs, ys, zs] = &self.places;
        let mut along = [0.0; BLOCK];
        for (k, along) in along.iter_mut().enumerate() {
            let (x, y, z) = (o.x - xs[k], o.y - ys[k], o.z - zs[k]);
            let foot = (x * d.x + y * d.y + z * d.z) * per_length2;
            let (x, y, z) = (x - d.x * foot, y - d.y * foot, z - d.z * foot);
            let beside2 = (x * x + y * y + z * z).max(line.floor2);
            *along = integral(Beside { foot, beside2 });
        }
        let sum = |lights: &[f64; BLOCK]| {
            let mut sums = [0.0; SUMS];
            for (along, lights) in along.chunks_exact(SUMS).zip(lights.chunks_exact(SUMS)) {
                for k in 0..SUMS {
                    sums[k] += along[k] * lights[k];
                }
            }
            sums.iter().sum::<f64>()
        };
        let [red, green, blue] = &self.lights;
        DVec3::new(sum(red), sum(green), sum(blue))
    }
}

/// X is `a v^2 + 2 b v + length2`, and `a X = p^2 + root2` with `p = a v + b`: returns a, b, root2, and p of two v.
#[inline(always)]
fn parabola(length2: f64, beta: f64, v: [f64; 2], it: &Beside) -> (f64, f64, f64, [f64; 2]) {
    let b0 = it.foot * length2;
    let begin2 = b0 * it.foot + it.beside2;
    let a = length2 * beta * beta - 2.0 * b0 * beta + begin2;
    let b = length2 * beta - b0;
    (a, b, length2 * it.beside2, v.map(|v| a * v + b))
}

/// Returns `a^-1.5 (b arsinh(p / root) - sqrt(p^2 + root2))` from one end to the other.
#[inline(always)]
fn inverse_with_decay(length2: f64, beta: f64, v: [f64; 2], it: Beside) -> f64 {
    let (a, b, root2, [p0, p1]) = parabola(length2, beta, v, &it);
    let [q0, q1] = [p0, p1].map(|p| (p * p + root2).sqrt());
    // root exp(arsinh(p / root)) is |p| + q, or root2 divided by that: no digits are lost.
    let (u0, u1) = (p0.abs() + q0, p1.abs() + q1);
    let (above1, below1) = if p1 > 0.0 { (u1, 1.0) } else { (root2, u1) };
    let (above0, below0) = if p0 > 0.0 { (1.0, u0) } else { (u0, root2) };
    let growth = ln(above1 * above0 / (below1 * below0));
    (b * growth - (q1 - q0)) / (a * a.sqrt())
}

/// Returns `v / a - b / a^2 ln X + (2 b^2 - a length2) / (a^2 root) arctan(p / root)` from one end to the other.
#[inline(always)]
fn square_with_decay(length2: f64, beta: f64, v: [f64; 2], it: Beside) -> f64 {
    let (a, b, root2, [p0, p1]) = parabola(length2, beta, v, &it);
    let (x0, x1) = (p0 * p0 + root2, p1 * p1 + root2);
    let root = root2.sqrt();
    let (y, x) = (root * (p1 - p0), root2 + p0 * p1);
    let turn = angle(y, x, (x0 * x1).sqrt());
    let per_a = 1.0 / a;
    let bent = (2.0 * b * b - a * length2) * turn / root;
    per_a * (v[1] - v[0] + per_a * (bent - b * ln(x1 / x0)))
}

/// Returns the logarithm of a positive number that is not denormal, to the last digits: the number is `m 2^e`, m from
/// sqrt(1/2) to sqrt(2), and `ln m = 2 artanh((m - 1) / (m + 1))`.
#[inline(always)]
fn ln(number: f64) -> f64 {
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    const ROOT_OF_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
    const MANTISSA: u64 = 0x000f_ffff_ffff_ffff;
    /// 2^52, to whose digits a small whole number is added.
    const LARGE: u64 = 0x4330_0000_0000_0000;
    let bits = number.to_bits().wrapping_add(ONE - ROOT_OF_HALF);
    let m = f64::from_bits((bits & MANTISSA) + ROOT_OF_HALF);
    let e = f64::from_bits(bits >> 52 | LARGE) - (f64::from_bits(LARGE) + 1023.0);
    let s = (m - 1.0) / (m + 1.0);
    e * LN_2 + 2.0 * s * series::<11>(s * s)
}

/// Returns the angle of a point above the axis, from its coordinates and its distance: four times the arctangent of its
/// fourth.
#[inline(always)]
fn angle(y: f64, x: f64, distance: f64) -> f64 {
    let half = y / (x.abs() + distance);
    let fourth = half / (1.0 + (1.0 + half * half).sqrt());
    let turn = 4.0 * fourth * series::<21>(-fourth * fourth);
    if x < 0.0 { PI - turn } else { turn }
}

/// Returns `1 + x / 3 + x^2 / 5 + ..`, so many terms.
#[inline(always)]
fn series<const TERMS: usize>(x: f64) -> f64 {
    let mut sum = 0.0;
    for term in (0..TERMS).rev() {
        sum = sum * x + const { reciprocals::<TERMS>() }[term];
    }
    sum
}

const fn reciprocals<const TERMS: usize>() -> [f64; TERMS] {
    let mut found = [0.0; TERMS];
    let mut term = 0;
    while term < TERMS {
        found[term] = 1.0 / (2 * term + 1) as f64;
        term += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, PointList, Points};

    #[test]
    fn the_closed_form_is_what_quadrature_finds() {
        let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO));
        let ray = Ray::between(DVec3::new(0.1, -3.0, 0.2), DVec3::new(0.4, 5.0, -0.3));
        for decay in [None, Some(Decay::new(0.1, 0.1)), Some(Decay::new(1.0, 0.7))] {
            scene.decay = decay;
            for profile in [Profile::Inverse, Profile::InverseSquare] {
                let places = [DVec3::new(0.3, 0.1, 0.1), DVec3::new(-2.0, -3.5, 1.0)];
                let mut points = Points::new(PointList::new(places.to_vec()).unwrap());
                points.profile = profile;
                scene.points = vec![points].into();
                let found = light_of_points(&scene, &[ray])[0];
                let apart = scene.with_points_apart();
                let fields = crate::reference::sources(&apart);
                let integrand = crate::reference::Integrand::of(&apart);
                let sum: f64 = (fields.iter())
                    .map(|source| crate::reference::exact(source, &ray, &integrand, 1.0))
                    .sum();
                let expected = sum * scene.integration.scale(ray.span.length());
                assert!(
                    (found[1] / expected - 1.0).abs() < 1e-8,
                    "{found:?} {expected}"
                );
            }
        }
    }

    #[test]
    fn logarithms_and_angles_have_all_digits() {
        for k in -4000..4000 {
            let x = (0.017 * f64::from(k)).exp();
            assert!(
                (ln(x) - x.ln()).abs() <= 4e-16 * x.ln().abs().max(0.5),
                "{x}"
            );
            let turn = PI * (f64::from(k) + 4000.5) / 8000.0;
            let (y, x) = turn.sin_cos();
            assert!(
                (angle(3.0 * y, 3.0 * x, 3.0) - turn).abs() < 2e-15,
                "{turn}"
            );
            let small = angle(x.abs() * 1e-9, 1.0, 1.0);
            assert!((small - x.abs() * 1e-9).abs() <= 1e-15 * small, "{small}");
        }
        let short = 2.0 * series::<5>(0.0294);
        assert!(
            (short - 2.0 * series::<11>(0.0294)).abs() > 1e-9,
            "terms count"
        );
    }

    #[test]
    fn blocks_have_every_point_once() {
        let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 0.0), DVec3::ZERO));
        scene.decay = Some(Decay::new(0.1, 0.1));
        let ray = Ray::between(DVec3::new(0.1, -3.0, 0.2), DVec3::new(0.4, 5.0, -0.3));
        for profile in [Profile::Inverse, Profile::InverseSquare] {
            let mut light_of = |count: usize, first: usize| {
                let place = |k: usize| {
                    let k = k as f64;
                    DVec3::new((1.3 * k).sin(), (2.9 * k).cos(), (0.7 * k).sin())
                };
                let places = (first..first + count).map(place).collect();
                let mut points = Points::new(PointList::new(places).unwrap());
                points.profile = profile;
                scene.points = vec![points].into();
                light_of_points(&scene, &[ray; 3])
            };
            let all = light_of(2 * BLOCK + 5, 0);
            let alone: f64 = (0..2 * BLOCK + 5).map(|k| light_of(1, k)[0][0]).sum();
            assert!((all[0][0] / alone - 1.0).abs() < 1e-12, "{all:?} {alone}");
            assert_eq!(all[0], all[2]);
            let fewer = light_of(2 * BLOCK + 4, 0);
            assert!((fewer[0][0] / alone - 1.0).abs() > 1e-6);
        }
    }
}
