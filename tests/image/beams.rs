//! Beams beside what they are made of: lines and points, whole where the plane through the tip is never crossed.

use crate::common;
use crate::common::{difference, renderer};
use energywave::scene::{Beam, BeamEnd, Cylinder, Method, Profile, Sampling, Sphere};
use energywave::{RadianceImage, Renderer, Scene};
use glam::DVec3;

/// Sums of the same float32 terms in another order.
const ROUNDING: f64 = 3e-6;

/// Far beyond all rays of the view, seen along the beam.
const FAR: f64 = 50.0;

fn view(method: Method) -> Scene {
    let mut scene = common::empty_scene(33, 21);
    scene.integration.method = method;
    scene.camera.ray_length = Some(6.0);
    scene
}

fn direction() -> DVec3 {
    DVec3::new(0.9, 0.3, -0.4).normalize()
}

fn image(renderer: &mut Renderer, method: Method, add: impl Fn(&mut Scene)) -> RadianceImage {
    let mut scene = view(method);
    add(&mut scene);
    renderer.render(&scene).unwrap()
}

/// At every pixel: tiles differ within the tolerance.
fn exact() -> Method {
    common::by(Sampling::Pixels)
}

/// Every combination of method and profile.
fn ways() -> impl Iterator<Item = (Method, Profile)> {
    let profiles = [Profile::Inverse, Profile::InverseSquare];
    let with = move |method| profiles.map(|profile| (method, profile));
    [Method::simpson(common::DIVISIONS), exact()]
        .into_iter()
        .flat_map(with)
}

#[test]
fn rays_that_never_cross_the_plane_see_a_line_or_a_point() {
    let mut renderer = renderer(common::device().lanes, "");
    for (method, profile) in ways() {
        let beam = |along: f64| {
            move |scene: &mut Scene| {
                scene.beams.push(Beam {
                    tip: direction() * along,
                    coefficient: 2.0,
                    end: BeamEnd::Cap(Some(500.0)),
                    profile,
                    ..Beam::new(3.0 * direction())
                });
            }
        };
        let ahead = image(&mut renderer, method, beam(-FAR));
        let line = image(&mut renderer, method, |scene| {
            scene.cylinders.push(Cylinder {
                coefficient: 2.0,
                profile,
                ..Cylinder::new(direction())
            });
        });
        let found = difference(&ahead, &line);
        assert!(found.max < ROUNDING, "{method:?} {profile:?}: {found:?}");

        let behind = image(&mut renderer, method, beam(FAR));
        let point = image(&mut renderer, method, |scene| {
            scene.spheres.push(Sphere {
                center: direction() * FAR,
                coefficient: 500.0,
                profile,
                ..Sphere::default()
            });
        });
        let found = difference(&behind, &point);
        assert!(found.max < ROUNDING, "{method:?} {profile:?}: {found:?}");
        assert!(difference(&ahead, &behind).max > 0.1);
    }
}

#[test]
fn parts_add_up() {
    let mut renderer = renderer(common::device().lanes, "");
    for (method, profile) in ways() {
        let plain = Beam {
            tip: DVec3::new(-0.3, 0.1, 0.2),
            profile,
            coefficient: 1.0,
            ..Beam::new(direction())
        };
        let mut draw = |beams: &[Beam], sphere: f64| {
            image(&mut renderer, method, |scene| {
                scene.beams = beams.to_vec().into();
                scene.spheres.push(Sphere {
                    center: plain.tip,
                    coefficient: sphere,
                    profile,
                    ..Sphere::default()
                });
            })
        };
        let part = |line: f64, cap: f64, sphere: f64| Beam {
            coefficient: line,
            end: BeamEnd::Cap(Some(cap)),
            sphere_coefficient: sphere,
            ..plain.clone()
        };
        let whole = draw(&[part(1.0, 1.0, 0.7)], 0.0);
        for (what, sum) in [
            ("a sphere of its own", draw(&[part(1.0, 1.0, 0.0)], 0.7)),
            ("the default cap", draw(std::slice::from_ref(&plain), 0.7)),
            (
                "line and cap apart",
                draw(&[part(1.0, 0.0, 0.0), part(0.0, 1.0, 0.0)], 0.7),
            ),
        ] {
            let found = difference(&sum, &whole);
            assert!(
                found.max < ROUNDING,
                "{what} {method:?} {profile:?}: {found:?}"
            );
        }
        let other = draw(&[part(1.0, 0.9, 0.7)], 0.0);
        assert!(difference(&other, &whole).max > 1e-3);
    }
}

#[test]
fn a_taper_is_between_a_line_and_a_cut() {
    let mut renderer = renderer(common::device().lanes, "");
    for profile in [Profile::Inverse, Profile::InverseSquare] {
        let mut draw = |taper_length: Option<f64>| {
            image(&mut renderer, exact(), |scene| {
                scene.beams.push(Beam {
                    end: taper_length.map_or(BeamEnd::Cap(Some(0.0)), BeamEnd::Taper),
                    profile,
                    coefficient: 1.0,
                    ..Beam::new(direction())
                });
            })
        };
        let cut = draw(None);
        let short = draw(Some(1e-4));
        // Of the light as a whole: some pixels see nothing but the taper, of a square even its core.
        let light = |image: &RadianceImage| image.as_slice().iter().sum::<f32>();
        let ratio = light(&short) / light(&cut);
        assert!(profile == Profile::InverseSquare || (ratio - 1.0).abs() < 1e-3);
        let lengths = [1e-4, 0.1, 1.0, 10.0, 1e6].map(|length| draw(Some(length)));
        for pair in lengths.windows(2) {
            let mut values = pair[0].as_slice().iter().zip(pair[1].as_slice());
            assert!(values.all(|(less, more)| *less <= more * 1.000_001));
        }
        let line = image(&mut renderer, exact(), |scene| {
            scene.cylinders.push(Cylinder {
                profile,
                coefficient: 1.0,
                ..Cylinder::new(direction())
            });
        });
        let found = difference(&lengths[4], &line);
        assert!(found.max < 1e-4, "{profile:?}: {found:?}");
    }
}
