//! Random scenes of every kind of source, the same for the same seed.

use energywave::Scene;
use energywave::image::ImageSize;
use energywave::scene::{
    Antialias, Beam, BeamEnd, Camera, Curve, Cylinder, Decay, Measure, Method, Profile, Sphere,
    Torus,
};
use fastrand::Rng;
use glam::DVec3;

/// The kinds of source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    Sphere,
    Cylinder,
    Beam,
    Torus,
    Curve,
}

pub const KINDS: [Kind; 5] = [
    Kind::Sphere,
    Kind::Cylinder,
    Kind::Beam,
    Kind::Torus,
    Kind::Curve,
];

/// Between `from` and `to`, evenly in the logarithm.
fn spread(random: &mut Rng, from: f64, to: f64) -> f64 {
    from * (to / from).powf(random.f64())
}

fn point(random: &mut Rng, reach: f64) -> DVec3 {
    DVec3::from([0; 3].map(|_| reach * (2.0 * random.f64() - 1.0)))
}

/// A camera anywhere around the origin, with or without decay, by either measure, sometimes softened; no sources.
pub fn random_view(random: &mut Rng, size: u32) -> Scene {
    let eye = point(random, 1.0).normalize() * spread(random, 1.0, 8.0);
    let mut camera = Camera::new(eye, point(random, 0.7));
    camera.up = point(random, 1.0);
    camera.fov_y = 20.0 + 50.0 * random.f64();
    camera.near = spread(random, 0.05, 1.0) * eye.length();
    camera.ray_length = Some(spread(random, 0.5, 4.0) * eye.length());
    let mut scene = Scene::new(camera);
    scene.image = ImageSize {
        width: size,
        height: size,
    };
    scene.integration.method = Method::default();
    scene.integration.antialias = Antialias::None;
    if random.u32(0..4) > 0 {
        scene.decay = Some(Decay::new(
            spread(random, 0.1, 1.0),
            spread(random, 0.02, 2.0),
        ));
    }
    scene.integration.measure = match random.bool() {
        true => Measure::Length,
        false => Measure::Parameter,
    };
    if random.u32(0..4) == 0 {
        scene.integration.softening = spread(random, 1e-3, 0.3);
    }
    scene
}

/// Adds a source within about 1.5 of the origin.
pub fn add_source(random: &mut Rng, kind: Kind, scene: &mut Scene) {
    let coefficient = spread(random, 0.5, 5.0);
    let color = DVec3::from([0; 3].map(|_| 0.1 + random.f64()));
    match kind {
        Kind::Sphere => scene.spheres.push(Sphere {
            center: point(random, 1.0),
            coefficient,
            color,
            profile: Profile::Inverse,
            ..Sphere::default()
        }),
        Kind::Cylinder => scene.cylinders.push(Cylinder {
            point: point(random, 1.0),
            coefficient,
            color,
            profile: Profile::Inverse,
            ..Cylinder::new(point(random, 1.0))
        }),
        Kind::Beam => {
            let has_taper = random.bool();
            let tip = point(random, 1.0);
            let cap = (!has_taper && random.bool()).then(|| spread(random, 0.1, 5.0));
            let sphere_coefficient = if random.bool() { random.f64() } else { 0.0 };
            let end = match has_taper {
                true => BeamEnd::Taper(spread(random, 0.01, 3.0)),
                false => BeamEnd::Cap(cap),
            };
            scene.beams.push(Beam {
                tip,
                coefficient,
                color,
                end,
                sphere_coefficient,
                profile: Profile::Inverse,
                ..Beam::new(point(random, 1.0))
            });
        }
        Kind::Torus => scene.tori.push(Torus {
            center: point(random, 0.5),
            axis: point(random, 1.0),
            coefficient,
            color,
            profile: Profile::Inverse,
            ..Torus::new(spread(random, 0.1, 2.0))
        }),
        Kind::Curve => {
            let intensity = random
                .bool()
                .then(|| (0..3 + random.usize(0..6)).map(|_| random.f64()).collect());
            scene.curves.push(Curve {
                coefficient,
                color,
                intensity,
                profile: Profile::Inverse,
                ..Curve::new([0; 3].map(|_| point(random, 1.5)))
            });
        }
    }
}

/// One source of a kind.
pub fn scene_of(kind: Kind, seed: u64, size: u32) -> Scene {
    let mut random = Rng::with_seed(seed);
    let mut scene = random_view(&mut random, size);
    add_source(&mut random, kind, &mut scene);
    scene
}

/// One or two rings, one or two curves, or a source of every kind: few combinations, each a program to compile.
pub fn random_scene(seed: u64, size: u32) -> Scene {
    let mut random = Rng::with_seed(seed);
    let mut scene = random_view(&mut random, size);
    let count = 1 + random.usize(0..2);
    let kinds = match seed % 3 {
        0 => vec![Kind::Torus; count],
        1 => vec![Kind::Curve; count],
        _ => KINDS.to_vec(),
    };
    for kind in kinds {
        add_source(&mut random, kind, &mut scene);
    }
    scene
}
