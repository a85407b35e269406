//! Closed forms of what falls off otherwise than by 1/d and its square: on every part of a ray, as float64 has it.

use energywave::Renderer;
use energywave::internals::{Integrand, exact, sources};
use energywave::scene::{Method, Profile, Ray, Segment};
use fastrand::Rng;
use glam::DVec3;

use crate::common::{self, renderer};

/// Profiles, radii and reaches that have such forms.
const SHAPES: [(Profile, f64, Option<f64>); 5] = [
    (Profile::InverseCube, 0.05, None),
    (Profile::Gaussian, 0.1, None),
    (Profile::Inverse, 0.02, Some(0.7)),
    (Profile::InverseSquare, 0.05, Some(0.6)),
    (Profile::InverseCube, 0.1, Some(0.5)),
];

/// Light below this share of the brightest is measured by it.
const LEAST_LIGHT: f64 = 1e-6;

#[test]
fn closed_forms_of_shapes_serve_every_part_of_a_ray() {
    // Points and segments beside, before and behind the ends of rays, thin cores and thick ones.
    let mut own = renderer(common::device().lanes, "");
    let mut spoiled = renderer(8, "-DCUBIC_PART=0.3f");
    let mut random = Rng::with_seed(11);
    for (profile, radius, reach) in SHAPES {
        let mut scene = common::empty_scene(8, 8);
        scene.decay = None;
        let place = |random: &mut Rng| DVec3::from([0; 3].map(|_| 0.7 * random.f64() - 0.35));
        for thickness in [0.2, 1.0, 4.0] {
            scene.segments.push(Segment {
                radius: thickness * radius,
                ..Segment::new(place(&mut random), place(&mut random))
            });
        }
        for source in scene.segments.iter_mut() {
            (source.profile, source.reach, source.coefficient) = (profile, reach, 1.0);
        }
        let rays: Vec<Ray> = (0..200)
            .map(|_| {
                let (at, along) = (place(&mut random), place(&mut random));
                let size = 0.05 * 100.0_f64.powf(random.f64());
                Ray::between(at - size * along, at + size * along)
            })
            .collect();
        let integrand = Integrand {
            decay: None,
            absorption: None,
            softening: 0.0,
        };
        let parts = sources(&scene);
        let truth = |ray| {
            parts
                .iter()
                .map(|part| exact(part, ray, &integrand, 1.0))
                .sum()
        };
        let truth: Vec<f64> = rays.iter().map(truth).collect();
        let most = truth.iter().fold(0.0, |most: f64, value| most.max(*value));
        scene.integration.method = Method::exact(1e-5);
        let worst = |renderer: &mut Renderer| {
            let found = renderer.integrate(&scene, &rays).unwrap();
            let pairs = found.iter().zip(&truth);
            let errors = pairs
                .map(|([_, green, _], truth)| (green - truth).abs() / (truth + LEAST_LIGHT * most));
            errors.fold(0.0, f64::max)
        };
        let error = worst(&mut own);
        assert!(error <= 1e-4, "{profile:?}: {error:e}");
        if profile == Profile::InverseSquare {
            let error = worst(&mut spoiled);
            assert!(error > 1e-3, "spoiled, {profile:?}: {error:e}");
        }
    }
}
