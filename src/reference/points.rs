//! The light of many points along rays, by a closed form in float64: what adaptive quadrature would take hours for.
//! With `v = -1 / (s + beta)` the integrals of `zeta / d` and `zeta / d^2` become those of `v / sqrt(X)` and
//! `v^2 / X`, X a parabola in v, whose primitives textbooks have; without decay they are arsinh and arctan.

use glam::DVec3;

use crate::scene::{CORE_FLOOR, Decay, Profile, Ray, Scene};
use crate::threads;

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
    let mut lights: Vec<([f64; 3], &(Ray, f64))> = rays.iter().map(|ray| ([0.0; 3], ray)).collect();
    threads::for_each_chunk(&mut lights, 1, |_, chunk| {
        for (light, (ray, end)) in chunk {
            let mut sum = DVec3::ZERO;
            for points in scene.points.iter() {
                for index in 0..points.points.len() {
                    let point = points.points.position(index);
                    let here = along(ray, *end, point, points.profile, scene.decay);
                    sum += points.light(index) * here;
                }
            }
            *light = (sum * scene.integration.scale(ray.span.length())).to_array();
        }
    });
    lights.into_iter().map(|(light, _)| light).collect()
}

/// Returns the integral of `zeta / d` or `zeta / d^2` over s from 0 to an end.
fn along(ray: &Ray, end: f64, point: DVec3, profile: Profile, decay: Option<Decay>) -> f64 {
    let from = ray.origin - point;
    let length2 = ray.span.length_squared();
    let (length, b0) = (length2.sqrt(), from.dot(ray.span));
    let foot = b0 / length2;
    let floor2 = CORE_FLOOR * CORE_FLOOR * length2;
    let beside2 = (from - ray.span * foot).length_squared().max(floor2);
    let is_square = profile == Profile::InverseSquare;
    let Some(Decay { alpha, beta, .. }) = decay else {
        let beside = beside2.sqrt();
        let at = |s: f64| (s + foot) * length / beside;
        return match is_square {
            true => (at(end).atan() - at(0.0).atan()) / (beside * length),
            false => (at(end).asinh() - at(0.0).asinh()) / length,
        };
    };
    // X(v) = a v^2 + 2 b v + |span|^2.
    let begin2 = length2 * foot * foot + beside2;
    let a = length2 * beta * beta - 2.0 * b0 * beta + begin2;
    let b = length2 * beta - b0;
    let root = (length2 * beside2).sqrt();
    let primitive = |s: f64| {
        let v = -1.0 / (s + beta);
        let x = a * v * v + 2.0 * b * v + length2;
        let turn = (a * v + b) / root;
        match is_square {
            true => {
                let angle = (2.0 * b * b - a * length2) / (a * a * root) * turn.atan();
                v / a - b / (a * a) * x.ln() + angle
            }
            false => b * a.powf(-1.5) * turn.asinh() - x.sqrt() / a,
        }
    };
    alpha * (primitive(end) - primitive(0.0))
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
}
