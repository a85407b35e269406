//! The reference rays: hard rays with integrals known to nine digits.

use crate::common;
use energywave::Ray;
use energywave::internals::{self, Integrand};
use energywave::scene::Method;
use energywave::verify::{DIVISIONS, KnownRay, Row, built_in_rays, verify};
use energywave::{Device, Renderer};

/// The reference aims at 1e-10; the file's own values are good to 1e-9.
const REFERENCE_ERROR: f64 = 1e-8;

/// float64 sums of the same 201 terms.
const SIMPSON_ERROR: f64 = 1e-11;

const SIMPSON: Method = Method::Simpson {
    divisions: DIVISIONS,
};

/// Rays of ten kinds.
const KNOWN: usize = 10 * 16;

fn through(renderer: &mut Renderer, method: Method) -> Vec<Row> {
    let rays = built_in_rays().unwrap();
    assert_eq!(rays.len(), KNOWN);
    let rows = verify(renderer, "device", &rays, method).unwrap();
    assert_eq!(rows.len(), KNOWN);
    rows
}

#[test]
fn the_reference_meets_the_exact_integrals() {
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    for row in through(&mut reference, Method::exact(1e-3)) {
        assert!(row.relative_error < REFERENCE_ERROR, "{row:?}");
    }
}

#[test]
fn the_references_simpson_meets_the_known_sums() {
    let mut reference = Renderer::new(&Device::reference()).unwrap();
    for row in through(&mut reference, SIMPSON) {
        assert!(row.relative_error < SIMPSON_ERROR, "{row:?}");
    }
}

#[test]
fn the_reference_notices_a_ray_moved_by_a_millionth() {
    let is_off = |known: &KnownRay| {
        let scene = known.scene.as_ref()?;
        let integrand = Integrand {
            decay: scene.decay,
            absorption: None,
            softening: 0.0,
        };
        let source = &internals::sources(scene)[0];
        let moved = Ray {
            origin: known.ray.origin + 1e-6,
            ..known.ray
        };
        let value = internals::exact(source, &moved, &integrand, 1.0);
        Some((value / known.exact - 1.0).abs() > REFERENCE_ERROR)
    };
    let rays = built_in_rays().unwrap();
    let off = rays.iter().filter_map(is_off).filter(|off| *off).count();
    assert!(
        off > KNOWN * 9 / 10,
        "only {off} of {KNOWN} moved rays are noticed"
    );
}

#[test]
fn the_device_meets_the_known_simpson_sums_on_every_lane_width() {
    let builds = common::lane_widths().into_iter().map(|lanes| (lanes, ""));
    let portable = [1, 8].map(|lanes| (lanes, "-DPORTABLE_ROOTS"));
    for (lanes, roots) in builds.chain(portable) {
        for row in through(&mut common::renderer(lanes, roots), SIMPSON) {
            assert!(row.passes(), "{lanes} lanes, {roots}: {row:?}");
        }
    }
}

#[test]
fn a_spoiled_field_fails_on_every_ray() {
    for row in through(&mut common::renderer(8, common::BROKEN_FIELDS), SIMPSON) {
        assert!(!row.passes(), "the spoiled build passed: {row:?}");
    }
}

#[test]
fn many_rays_of_one_launch_are_as_good_as_one_by_one() {
    let rays = built_in_rays().unwrap();
    let mut scene = rays[32].scene.clone().unwrap();
    scene.integration.method = SIMPSON;
    let all: Vec<Ray> = rays.iter().map(|known| known.ray).collect();
    for lanes in common::lane_widths() {
        let mut renderer = common::renderer(lanes, "");
        let together = renderer.integrate(&scene, &all).unwrap();
        let mut reference = Renderer::new(&Device::reference()).unwrap();
        let expected = reference.integrate(&scene, &all).unwrap();
        for (i, (found, expected)) in together.iter().zip(&expected).enumerate() {
            let error = (found[0] / expected[0] - 1.0).abs();
            assert!(
                error < 1e-4 || i == 32 && error < 1e-3,
                "{lanes} lanes, ray {i}: {error:e}"
            );
        }
    }
}
