//! Scenes that are written and read again are equal, as TOML and as JSON, to the last bit of every number.

use std::path::Path;

use crate::common;
use energywave::image::{
    Alpha, Background, Bloom, DepthAlong, DepthImage, Display, Exposure, ImageSize, ToneMap,
};
use energywave::internals::KINDS;
use energywave::scene::{
    Antialias, Beam, BeamEnd, Camera, Curve, Cylinder, Dashes, Decay, ElectricArc, Integration,
    Layer, LightPath, Measure, Method, PathShape, Profile, Sampling, Segment, Sphere, Torus,
};
use energywave::{ErrorKind, Scene};
use fastrand::Rng;
use glam::DVec3;

/// Numbers with digits to the last, over many powers of ten.
fn number(random: &mut Rng) -> f64 {
    (random.f64() + 0.1) * 10_f64.powi(random.i32(-3..3))
}

fn vector(random: &mut Rng) -> DVec3 {
    DVec3::from([0; 3].map(|_| number(random) * if random.bool() { 1.0 } else { -1.0 }))
}

const PROFILES: [Profile; 5] = [
    Profile::Inverse,
    Profile::InverseSquare,
    Profile::InverseCube,
    Profile::Gaussian,
    Profile::Smeared,
];

/// None, or some that name nothing, some or all of their keys.
fn layers(random: &mut Rng) -> Vec<Layer> {
    let mut layer = |count: usize| Layer {
        coefficient: (count > 0).then(|| number(random)),
        color: (count > 1).then(|| vector(random)),
        profile: (count > 2).then_some(Profile::InverseCube),
        radius: (count > 2).then(|| number(random)),
        reach: (count > 3).then(|| 1200.0 + number(random)),
        ..Layer::default()
    };
    let layers: Vec<Layer> = (0..5).map(&mut layer).collect();
    layers[..random.usize(0..6)].to_vec()
}

/// Sources of every kind and profile, beams with every end, curves with and without a series.
fn add_sources(scene: &mut Scene, random: &mut Rng) {
    for profile in PROFILES {
        scene.spheres.push(Sphere {
            center: vector(random),
            coefficient: -number(random),
            color: vector(random),
            profile,
            radius: number(random),
            reach: Some(1200.0 + number(random)),
            peak: None,
            layers: layers(random),
            light_group: Some("far points".into()),
        });
        scene.cylinders.push(Cylinder {
            point: vector(random),
            direction: vector(random),
            coefficient: number(random),
            color: vector(random),
            profile,
            radius: number(random),
            reach: Some(1200.0 + number(random)),
            peak: None,
            layers: layers(random),
            light_group: None,
        });
        for end in [
            BeamEnd::Cap(None),
            BeamEnd::Cap(Some(0.0)),
            BeamEnd::Cap(Some(-number(random))),
            BeamEnd::Taper(number(random)),
        ] {
            scene.beams.push(Beam {
                tip: vector(random),
                direction: vector(random),
                coefficient: number(random),
                color: vector(random),
                end,
                sphere_coefficient: number(random),
                profile,
                radius: number(random),
                reach: None,
                peak: None,
                layers: layers(random),
                ..Beam::new(DVec3::X)
            });
        }
        scene.segments.push(Segment {
            coefficient: number(random),
            color: vector(random),
            profile,
            radius: number(random),
            ..Segment::new(vector(random), vector(random))
        });
        scene.segments.push(Segment {
            radii: Some(vec![number(random), 0.0, number(random)]),
            taper_lengths: [number(random), 0.0],
            intensity: Some(vec![number(random); 4]),
            colors: Some(vec![vector(random), vector(random)]),
            arc: Some(ElectricArc {
                seed: u32::MAX,
                drift: -1.0 / 3.0,
                branches: 2,
                time: 1.0 / 11.0,
                ..ElectricArc::new(1.0 / 7.0, 123.4)
            }),
            ..Segment::new(vector(random), vector(random))
        });
        let points = (0..7).map(|_| vector(random)).collect();
        scene.paths.push(LightPath {
            shape: [PathShape::Spline, PathShape::Quadratic, PathShape::Cubic][random.usize(0..3)],
            closed: false,
            flatness: random.bool().then(|| number(random)),
            coefficient: number(random),
            color: vector(random),
            profile,
            radius: number(random),
            layers: layers(random),
            ..LightPath::new(points)
        });
        scene.tori.push(Torus {
            center: vector(random),
            axis: vector(random),
            coefficient: number(random),
            color: vector(random),
            profile,
            radius: number(random),
            reach: Some(1200.0 + number(random)),
            layers: layers(random),
            start: random.bool().then(|| vector(random)),
            sweep: random.bool().then_some([-30.0, 300.0 / 7.0]),
            dashes: random.bool().then_some(Dashes {
                count: 3,
                fill: 1.0 / 3.0,
                offset: -0.1,
            }),
            ..Torus::new(number(random))
        });
        for intensity in [None, Some(vec![0.0, 0.1, 1.0 / 3.0]), Some(vec![2.0; 9])] {
            scene.curves.push(Curve {
                control_points: [0; 3].map(|_| vector(random)),
                coefficient: number(random),
                color: vector(random),
                intensity,
                profile,
                radius: number(random),
                reach: Some(1200.0 + number(random)),
                peak: None,
                layers: layers(random),
                ..Curve::new([DVec3::ZERO; 3])
            });
        }
        scene.beams.push(Beam {
            series_length: Some(number(random)),
            radii: Some(vec![0.0, number(random)]),
            colors: Some(vec![vector(random); 3]),
            ..Beam::new(vector(random))
        });
        scene.curves.push(Curve {
            radii: Some(vec![0.0, number(random)]),
            dashes: Some(Dashes::new(7)),
            ..Curve::new([0; 3].map(|_| vector(random)))
        });
    }
}

/// Every method, measure, decay, tone map, ray length, with sources of every kind.
fn rich_scenes() -> Vec<Scene> {
    let mut random = Rng::with_seed(5);
    let random = &mut random;
    let exact = |sampling| Method::Exact {
        tolerance: 1.0 / 3000.0,
        sampling,
    };
    let jittered = |divisions, seed| Method::Jittered { divisions, seed };
    let methods = [
        Method::simpson(2),
        Method::simpson(65536),
        exact(Sampling::Tiles),
        exact(Sampling::Pixels),
        Method::default(),
        jittered(1, 0),
        jittered(65535, u32::MAX),
    ];
    let mut scenes = Vec::new();
    for (index, method) in methods.into_iter().cycle().take(60).enumerate() {
        let mut camera = Camera::new(DVec3::X + vector(random), DVec3::ZERO);
        camera.up = vector(random);
        camera.fov_y = 20.0 + number(random).min(99.0);
        camera.near = 1e-4 * number(random);
        camera.ray_length = (index % 2 == 0).then(|| number(random));
        let mut scene = Scene::new(camera);
        scene.image = ImageSize {
            width: 1 + index as u32,
            height: 16384 - index as u32,
        };
        scene.decay = (index % 3 != 0).then(|| Decay::new(number(random), number(random)));
        scene.integration = Integration {
            antialias: Antialias::None,
            method,
            measure: [Measure::Parameter, Measure::Length][index % 2],
            softening: [0.0, number(random)][index / 2 % 2],
            hidden_surfaces: index % 2 == 0,
            volumes: energywave::scene::VolumeMethod::Slices { count: 64 },
            ..Integration::default()
        };
        scene.display = Display {
            exposure: [Exposure::Stops(number(random).min(99.0)), Exposure::Auto][index % 2],
            tone_map: [ToneMap::KhronosNeutral, ToneMap::Clamp][index / 2 % 2],
            alpha: [Alpha::Opaque, Alpha::Additive, Alpha::Luminance][index % 3],
            background: (index % 2 == 0).then_some(Background::Color([0.1, 0.0, 1.0])),
            bits: [None, Some(8), Some(16)][index % 3],
            quality: (index % 2 == 1).then_some(75),
            bloom: (index % 3 == 1).then_some(Bloom::new(0.25)),
        };
        add_sources(&mut scene, random);
        scene.validate().unwrap();
        let text = scene.to_toml().unwrap();
        for kind in KINDS {
            assert!(
                text.contains(&format!("[[{kind}]]")),
                "no source of the kind {kind}"
            );
        }
        scenes.push(scene);
    }
    scenes
}

/// The scene as every way to write it is read again.
fn read_again(scene: &Scene, folder: &Path) -> Vec<(&'static str, Scene)> {
    let (toml, json) = (folder.join("scene.toml"), folder.join("scene.JSON"));
    scene.save(&toml).unwrap();
    scene.save(&json).unwrap();
    vec![
        ("TOML", Scene::from_toml(&scene.to_toml().unwrap()).unwrap()),
        ("JSON", Scene::from_json(&scene.to_json().unwrap()).unwrap()),
        ("a TOML file", Scene::from_file(&toml).unwrap()),
        ("a JSON file", Scene::from_file(&json).unwrap()),
    ]
}

#[test]
fn every_scene_of_the_repository_is_read_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let depths = DepthImage::open("tests/data/tetrahedra.exr", DepthAlong::Ray).unwrap();
    for path in common::scene_files() {
        let mut scene = Scene::from_file(&path).unwrap();
        // Those of the tetrahedra.
        scene.depth = (scene.image == depths.size()).then(|| depths.clone());
        for (what, read) in read_again(&scene, folder.path()) {
            assert_eq!(read, scene, "{} as {what}", path.display());
        }
    }
}

#[test]
fn every_kind_profile_end_series_decay_and_method_is_read_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    for scene in rich_scenes() {
        for (what, read) in read_again(&scene, folder.path()) {
            assert_eq!(read, scene, "{what}");
        }
    }
}

#[test]
fn a_scene_of_defaults_is_read_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let scene = Scene::new(Camera::new(4.0 * DVec3::X, DVec3::ZERO));
    for (what, read) in read_again(&scene, folder.path()) {
        assert_eq!(read, scene, "{what}");
    }
    assert!(
        !scene.to_toml().unwrap().contains("sphere"),
        "an empty list is written"
    );
}

type Change = (&'static str, fn(&mut Scene));

/// A change of the last bit.
fn nudge(value: &mut f64) {
    *value = value.next_up();
}

#[test]
fn a_changed_value_is_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let scene = rich_scenes().swap_remove(2);
    assert!(matches!(scene.integration.method, Method::Exact { .. }));
    let changes: [Change; 18] = [
        ("eye", |s| nudge(&mut s.camera.eye.x)),
        ("up", |s| nudge(&mut s.camera.up.z)),
        ("fov_y", |s| nudge(&mut s.camera.fov_y)),
        ("ray_length", |s| s.camera.ray_length = None),
        ("width", |s| s.image.width += 1),
        ("decay", |s| nudge(&mut s.decay.as_mut().unwrap().beta)),
        ("method", |s| s.integration.method = Method::simpson(200)),
        ("sampling", |s| *s = common::sampled(s, Sampling::Pixels)),
        ("tolerance", |s| *s = common::at_tolerance(s, 1e-3)),
        ("measure", |s| s.integration.measure = Measure::Length),
        ("exposure", |s| s.display.exposure = Exposure::Stops(1.25)),
        ("sphere", |s| nudge(&mut s.spheres[1].coefficient)),
        ("profile", |s| {
            s.cylinders[0].profile = Profile::InverseSquare
        }),
        ("cap", |s| {
            s.beams[0].end = BeamEnd::Cap(Some(s.beams[0].coefficient))
        }),
        ("taper", |s| s.beams.swap(3, 7)),
        ("layer", |s| {
            let light = Layer {
                radius: Some(1.0),
                ..Layer::default()
            };
            s.tori[0].layers = vec![light];
        }),
        ("torus", |s| s.tori.truncate(1)),
        ("series", |s| {
            nudge(&mut s.curves[1].intensity.as_mut().unwrap()[2])
        }),
    ];
    for (what, change) in changes {
        let mut changed = scene.clone();
        change(&mut changed);
        for (way, read) in read_again(&changed, folder.path()) {
            assert_ne!(read, scene, "{what}, {way}");
            assert_eq!(read, changed, "{what}, {way}");
        }
    }
}

/// Depths in code, in no file.
fn hidden_scene() -> Scene {
    let mut scene = common::full_scene(9, 7);
    scene.depth = Some(common::depths(
        &scene,
        DepthAlong::Axis,
        |column, row| match column == row {
            true => f64::INFINITY,
            false => 2.0 + f64::from(column) / 3.0,
        },
    ));
    scene
}

#[test]
fn a_depth_image_in_a_file_is_read_with_the_scene_wherever_that_is_saved() {
    let (depths, scenes) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let file = depths.path().join("with space.exr");
    let mut scene = hidden_scene();
    let in_code = scene.depth.take().unwrap();
    in_code.save(&file).unwrap();
    for along in [DepthAlong::Ray, DepthAlong::Axis] {
        scene.depth = Some(DepthImage::open(&file, along).unwrap());
        for (what, read) in read_again(&scene, scenes.path()) {
            assert_eq!(read, scene, "{what}");
            let depth = read.depth.unwrap();
            assert_eq!(depth.along(), along);
            assert_eq!(depth.as_slice(), in_code.as_slice(), "{what}");
            assert_eq!(depth.file(), Some(file.as_path()), "{what}");
        }
    }
    // Other depths in the file are another scene.
    let other = common::depths(&scene, DepthAlong::Axis, |_, _| 1.0);
    let text = scene.to_toml().unwrap();
    other.save(&file).unwrap();
    assert_ne!(Scene::from_toml(&text).unwrap(), scene);
    std::fs::remove_file(&file).unwrap();
    let error = Scene::from_toml(&text).unwrap_err().to_string();
    assert!(
        error.contains("depth.file") && error.contains("cannot read"),
        "{error}"
    );
}

#[test]
fn a_depth_image_that_is_in_no_file_is_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let scene = hidden_scene();
    let (toml, json) = (folder.path().join("a.toml"), folder.path().join("a.json"));
    for refused in [
        scene.to_toml().map(drop),
        scene.to_json().map(drop),
        scene.save(&toml),
        scene.save(&json),
    ] {
        let error = refused.unwrap_err();
        assert_eq!(error.kind(), ErrorKind::Unsupported);
        let words = error.to_string();
        assert!(words.contains("the depth image is in no file"), "{words}");
        assert!(
            words.contains("save it as OpenEXR and open it again"),
            "{words}"
        );
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    let mut open = scene;
    open.depth = None;
    open.save(&toml).unwrap();
}

#[test]
fn a_scene_file_that_cannot_be_written_is_named() {
    let error = common::full_scene(4, 4).save("nowhere/a.toml").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Output);
    assert!(
        error.to_string().contains("nowhere/a.toml: cannot write"),
        "{error}"
    );
}
