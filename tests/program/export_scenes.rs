//! Scenes that are exported as shaders.

use std::path::{Path, PathBuf};

use energywave::Scene;
use energywave::image::ImageSize;
use energywave::scene::{
    Absorption, Antialias, Beam, BeamEnd, Curve, Cylinder, Decay, Preset, Profile, Segment, Sphere,
    Torus,
};
use glam::DVec3;

use crate::common::empty_scene;

/// Width and height of pictures, and of those with rings and curves, which take more time.
pub const SIDE: u32 = 256;
const SIDE_OF_NODES: u32 = 96;

/// The papers' figures that have closed forms, and what they lack.
pub fn scenes() -> Vec<(String, Scene)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let figures = [
        "2006-figure-5-1",
        "2006-figure-5-3-20",
        "2006-figure-5-3-40",
        "2006-figure-5-3-60",
        "2010-figure-08",
        "2010-figure-09",
        "2010-figure-10",
        "2010-figure-11",
        "2010-figure-12",
        "2010-figure-13",
        "2010-figure-14",
    ];
    let of_file = |name: &&str| {
        let path: PathBuf = root.join(format!("{name}.toml"));
        ((*name).to_owned(), Scene::from_file(path).unwrap())
    };
    let mut scenes: Vec<_> = figures.iter().map(of_file).collect();
    scenes.extend(shaped_scenes());
    for profile in [Profile::Inverse, Profile::InverseSquare] {
        for (decay, radius) in [(None, 0.0), (None, 0.05), (Some(Decay::new(0.1, 0.1)), 0.1)] {
            let mut scene = empty_scene(SIDE, SIDE);
            scene.decay = decay;
            let (from, to) = (DVec3::new(-0.9, 0.3, 0.2), DVec3::new(0.4, -0.5, 0.7));
            scene.segments.push(Segment {
                radius,
                profile,
                ..Segment::new(from, to)
            });
            scene.spheres.push(Sphere {
                center: to,
                radius,
                profile,
                ..Sphere::default()
            });
            let cylinder = Cylinder::new(DVec3::new(1.0, 0.2, 0.9));
            scene.cylinders.push(Cylinder {
                radius,
                profile,
                ..cylinder
            });
            scenes.push((format!("{profile:?} {decay:?} {radius}"), scene));
            let mut scene = empty_scene(SIDE, SIDE);
            scene.decay = decay;
            for end in [BeamEnd::Cap(Some(0.4)), BeamEnd::Taper(0.7)] {
                let beam = Beam::new(DVec3::new(-1.0, 0.2, 0.6));
                scene.beams.push(Beam {
                    tip: from,
                    end,
                    radius,
                    profile,
                    sphere_coefficient: 0.3,
                    ..beam
                });
            }
            scenes.push((format!("beams {profile:?} {decay:?} {radius}"), scene));
        }
    }
    for (_, scene) in &mut scenes {
        scene.image = ImageSize {
            width: SIDE,
            height: SIDE,
        };
        scene.integration.antialias = Antialias::None;
    }
    scenes
}

/// Straight light that ends at a reach, and of profiles beside 1/d and 1/d^2.
fn shaped_scenes() -> Vec<(String, Scene)> {
    let mut scenes = Vec::new();
    let profiles = [
        (Profile::InverseSquare, Some(0.6)),
        (Profile::Inverse, Some(0.6)),
        (Profile::InverseCube, None),
        (Profile::Gaussian, None),
        (Profile::Gaussian, Some(0.3)),
    ];
    for (profile, reach) in profiles {
        for decay in [None, Some(Decay::new(0.1, 0.1))] {
            let mut scene = empty_scene(SIDE, SIDE);
            scene.decay = decay;
            let radius = 0.1;
            let (from, to) = (DVec3::new(-0.9, 0.3, 0.2), DVec3::new(0.4, -0.5, 0.7));
            scene.segments.push(Segment {
                radius,
                profile,
                reach,
                ..Segment::new(from, to)
            });
            scene.spheres.push(Sphere {
                center: DVec3::new(0.7, 0.1, -0.6),
                radius,
                profile,
                reach,
                ..Sphere::default()
            });
            let beam = Beam::new(DVec3::new(1.0, 0.2, 0.6));
            scene.beams.push(Beam {
                tip: DVec3::new(-0.6, 0.0, -0.8),
                end: BeamEnd::Taper(0.7),
                radius,
                profile,
                reach,
                sphere_coefficient: 0.3,
                ..beam
            });
            scenes.push((format!("shaped {profile:?} {reach:?} {decay:?}"), scene));
        }
    }
    for (power, kappa) in [(1, 0.0), (3, 0.0), (2, 0.4), (0, 0.4)] {
        for (profile, radius) in [(Profile::Inverse, 0.05), (Profile::InverseSquare, 0.1)] {
            let mut scene = faded(power, kappa);
            let (from, to) = (DVec3::new(-0.9, 0.3, 0.2), DVec3::new(0.4, -0.5, 0.7));
            scene.segments.push(Segment {
                radius,
                profile,
                ..Segment::new(from, to)
            });
            let beam = Beam::new(DVec3::new(1.0, 0.2, 0.6));
            scene.beams.push(Beam {
                tip: DVec3::new(-0.6, 0.0, -0.8),
                end: BeamEnd::Taper(0.7),
                radius,
                profile,
                sphere_coefficient: 0.3,
                ..beam
            });
            scenes.push((format!("faded {power} {kappa} {profile:?}"), scene));
        }
    }
    scenes
}

/// Makes a scene whose light decays by a power and is absorbed.
fn faded(power: u32, kappa: f64) -> Scene {
    let mut scene = empty_scene(SIDE, SIDE);
    let mut decay = Decay::new(0.1, 0.1);
    decay.power = power;
    scene.decay = Some(decay);
    scene.absorption = (kappa > 0.0).then_some(Absorption { kappa });
    scene
}

/// Cores of many pieces: smooth, with corners, parts of rings; with light and thickness that change along them.
fn chains() -> Vec<(String, Scene)> {
    let head = "[camera]\neye = [0.3, -3.5, 2]\ntarget = [0, 0, 0]\n";
    let smooth = "points = [[-1, 0, 0.2], [-0.4, 0.6, -0.3], [0.2, -0.3, 0.4], [1, 0.2, 0]]\n";
    [
        ("smooth", format!("[[path]]\n{smooth}radius = 0.03\n")),
        ("without end", format!("[[path]]\n{smooth}radius = 0.05\nprofile = \"inverse\"\n")),
        (
            "along",
            format!("[[path]]\n{smooth}radii = [0.02, 0.08, 0.04]\nintensity = [0.2, 1.5, 0.7]\nreach = 0.5\n"),
        ),
        ("part of a ring", "[[torus]]\nmajor_radius = 0.8\nsweep = [20, 210]\nradius = 0.05\n".to_owned()),
        (
            "dashes",
            "[[segment]]\nfrom = [-1, 0.2, 0.1]\nto = [1, -0.3, 0.4]\nradius = 0.06\ndashes = { count = 5 }\n"
                .to_owned(),
        ),
    ]
    .map(|(name, text)| {
        let mut scene = Scene::from_toml(&format!("{head}{text}")).unwrap();
        (scene.image.width, scene.image.height) = (SIDE_OF_NODES, SIDE_OF_NODES);
        scene.integration.antialias = Antialias::None;
        (name.to_owned(), scene)
    })
    .into()
}

/// Rings and curves from all sides, and presets.
pub fn mapped_scenes() -> Vec<(String, Scene)> {
    let mut scenes = Vec::new();
    for preset in Preset::ALL {
        let mut scene = Scene::from_toml(preset.text).unwrap();
        (scene.image.width, scene.image.height) = (SIDE_OF_NODES, SIDE_OF_NODES);
        scene.integration.antialias = Antialias::None;
        scenes.push((preset.name.to_owned(), scene));
    }
    scenes.extend(chains());
    let curves = [
        [
            DVec3::new(-1.0, -0.5, -0.5),
            DVec3::new(0.3, 0.9, 0.4),
            DVec3::new(0.8, -0.8, 0.7),
        ],
        [
            DVec3::new(-1.0, 0.1, 0.5),
            DVec3::new(0.1, 0.2, -1.5),
            DVec3::new(1.0, 0.3, 0.6),
        ],
        [
            DVec3::new(-0.7, 0.0, 0.2),
            DVec3::ZERO,
            DVec3::new(0.7, 0.0, -0.2),
        ],
    ];
    let axes = [
        DVec3::new(0.3, -0.5, 0.8),
        DVec3::Y,
        DVec3::new(1.0, 0.1, 0.2),
    ];
    for profile in [Profile::Inverse, Profile::InverseSquare] {
        for (decay, radius) in [(None, 0.0), (None, 0.05), (Some(Decay::new(0.1, 0.1)), 0.1)] {
            if profile == Profile::InverseSquare && radius == 0.0 {
                continue; // a ray into a bare core is off by more, as docs/shaders.md says
            }
            for (number, (axis, control_points)) in axes.into_iter().zip(curves).enumerate() {
                let new = || {
                    let mut scene = empty_scene(SIDE_OF_NODES, SIDE_OF_NODES);
                    scene.decay = decay;
                    scene.integration.antialias = Antialias::None;
                    scene
                };
                let mut rings = new();
                let ring = Torus::new(0.8);
                rings.tori.push(Torus {
                    axis,
                    radius,
                    profile,
                    ..ring
                });
                scenes.push((
                    format!("ring {number} {profile:?} {decay:?} {radius}"),
                    rings,
                ));
                let mut scene = new();
                let curve = Curve::new(control_points);
                scene.curves.push(Curve {
                    radius,
                    profile,
                    ..curve
                });
                scenes.push((
                    format!("curve {number} {profile:?} {decay:?} {radius}"),
                    scene,
                ));
            }
        }
    }
    scenes
}
