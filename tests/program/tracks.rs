//! Scenes that move: frames are those of the scenes that they stand for.

use std::fmt::Write;

use crate::common::program::{Folder, expect};
use energywave::glam::DVec3;
use energywave::scene::{AnimatedScene, Camera, Interpolation, Sphere, Torus, Track, TrackNoise};
use energywave::{Device, Renderer, Scene};

const CAMERA: &str = "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n";

const MOVING: &str = "[display]\nexposure = 0\n\
    [camera]\neye = { times = [0, 4], values = [[0, -4, 2], [0, -8, 4]] }\ntarget = [0, 0, 0]\n\
    [image]\nwidth = 6\nheight = 4\n[[sphere]]\ncoefficient = 0.01\n[[torus]]\nradius = 0.1\nmajor_radius = 0.5\n\
    [[torus]]\ncolor = { times = [0, 2], values = [\"#ff0000\", [0.5, 0, 1]] }\nmajor_radius.times = [0, 1, 2]\n\
    major_radius.values = [1, 2, 4]\nmajor_radius.interpolation = \"step\"\n[torus.coefficient]\ntimes = [1, 3]\n\
    values = [0.25, 0.75]\n[[torus.layers]]\nradius = 0.125\n[[torus.layers]]\n\
    reach = { times = [0, 2], values = [1, 3] }\n[[group]]\n[group.rotate]\naxis = [0, 0, 1]\n\
    angle = { times = [0, 4], values = [0, 360], loop = \"repeat\" }\n[[group.sphere]]\ncenter = [1, 0, 0]\n";

/// The same at 1 s, written out.
const AT_ONE: &str = "[display]\nexposure = 0\n\
    [camera]\neye = [0, -5, 2.5]\ntarget = [0, 0, 0]\n[image]\nwidth = 6\nheight = 4\n\
    [[sphere]]\ncoefficient = 0.01\n[[torus]]\nradius = 0.1\nmajor_radius = 0.5\n[[torus]]\ncolor = [0.75, 0, 0.5]\n\
    major_radius = 2\ncoefficient = 0.25\n[[torus.layers]]\nradius = 0.125\n[[torus.layers]]\nreach = 2\n\
    [[group]]\n[group.rotate]\naxis = [0, 0, 1]\nangle = 90\n[[group.sphere]]\ncenter = [1, 0, 0]\n";

fn drawn(scene: &Scene) -> Vec<f32> {
    let mut renderer = Renderer::new(&Device::reference()).unwrap();
    renderer.render(scene).unwrap().as_slice().to_vec()
}

#[test]
fn a_frame_is_that_of_the_scene_written_out() {
    let moving = AnimatedScene::from_toml(MOVING).unwrap();
    let still = Scene::from_toml(AT_ONE).unwrap();
    let frame = moving.at(1.0).unwrap();
    assert_eq!(frame, still);
    assert_eq!(drawn(&frame), drawn(&still));
    let begin = moving.at(0.0).unwrap();
    assert_ne!(drawn(&begin), drawn(&still));
    // A file is the scene at 0 s; times may come in any order.
    assert_eq!(Scene::from_toml(MOVING).unwrap(), begin);
    assert_eq!(moving.at(1.0).unwrap(), still);
    let json = serde_json::to_string(&toml::from_str::<toml::Table>(MOVING).unwrap()).unwrap();
    assert_eq!(
        AnimatedScene::from_json(json).unwrap().at(1.0).unwrap(),
        still
    );
    assert!(!AnimatedScene::from_toml(AT_ONE).unwrap().is_animated());
}

#[test]
fn the_program_draws_a_scene_at_a_time() {
    let folder = Folder::new();
    let draw = |scene: &str, arguments: &[&str]| {
        std::fs::write(folder.path().join("a.toml"), scene).unwrap();
        let output = folder.run(&[&["render", "a.toml"], arguments].concat());
        expect(&output, 0, "");
        let image = energywave::RadianceImage::open(folder.path().join("out.exr")).unwrap();
        image.as_slice().to_vec()
    };
    let arguments = ["--device", "reference", "-o", "out.exr", "--time", "1"];
    assert_eq!(draw(MOVING, &arguments), draw(AT_ONE, &arguments));
    assert_ne!(draw(MOVING, &arguments), draw(MOVING, &arguments[..4]));
    let wrong = folder.run(&["render", "a.toml", "-o", "x.exr", "--time", "nan"]);
    expect(&wrong, 2, "a time is a number of seconds");
}

#[test]
fn a_loop_closes_to_the_bit() {
    let looped = |time: &str| {
        let noise = "noise = { amplitude = 0.1, frequency = 7.3, octaves = 3 }";
        AnimatedScene::from_toml(format!(
            "{CAMERA}{time}[image]\nwidth = 6\nheight = 4\n[[sphere]]\ncenter = {{ value = [0, 0, 0], {noise} }}\n\
             radius = {{ times = [0, 0.7], values = [0.1, 0.2], loop = \"ping-pong\", {noise} }}\n"
        ))
        .unwrap()
    };
    let scene = looped("[time]\nloop = 1.7\n");
    assert_eq!(scene.period(), Some(1.7));
    let begin = scene.at(0.0).unwrap();
    for end in [1.7, 3.4, -1.7] {
        assert_eq!(scene.at(end).unwrap(), begin);
    }
    assert_eq!(drawn(&scene.at(1.7).unwrap()), drawn(&begin));
    assert_ne!(scene.at(0.85).unwrap(), begin);
    assert_ne!(looped("").at(1.7).unwrap(), begin);
}

#[test]
fn sources_of_a_large_file_move_in_their_places() {
    let mut text = CAMERA.to_owned();
    for index in 0..20_000 {
        let _ = writeln!(text, "[[torus]]\nmajor_radius = {}", 1 + index % 5);
        if index % 999 == 0 {
            let _ = writeln!(
                text,
                "coefficient = {{ times = [0, 1], values = [0, {index}] }}"
            );
        }
        let _ = writeln!(text, "# {}", "x".repeat(60));
    }
    assert!(text.len() > 1 << 20);
    let scene = AnimatedScene::from_toml(text).unwrap();
    let frame = scene.at(0.5).unwrap();
    assert_eq!(frame.tori.len(), 20_000);
    for (index, torus) in frame.tori.iter().enumerate() {
        assert_eq!(torus.major_radius, 1.0 + (index % 5) as f64);
        let expected = if index % 999 == 0 {
            0.5 * index as f64
        } else {
            1.0
        };
        assert_eq!(torus.coefficient, expected, "{index}");
    }
}

#[test]
fn tracks_are_set_into_a_scene_made_in_code() {
    let mut scene = Scene::new(Camera::new(DVec3::new(0.0, -4.0, 2.0), DVec3::ZERO));
    scene.tori.push(Torus::new(0.5));
    scene.spheres.push(Sphere::default());
    let mut cubic = Track::new([(0.0, 0.0); 6]);
    cubic.times = vec![0.0, 1.0];
    cubic.values = [0.0, 1.0, 0.0, 0.0, 2.0, 0.0].map(Into::into).to_vec();
    cubic.interpolation = Interpolation::Cubic;
    let mut trembling = Track::constant(DVec3::ZERO);
    trembling.noise = Some(TrackNoise::new(0.1, 5.0, 1));
    let tracks = [
        ("torus[0].major_radius", cubic),
        ("sphere[0].center", trembling.clone()),
    ];
    let moving = AnimatedScene::new(scene.clone(), tracks)
        .unwrap()
        .with_loop(2.0);
    assert_eq!(moving.at(0.5).unwrap().tori[0].major_radius, 1.5);
    assert_eq!(moving.at(2.0).unwrap(), moving.at(0.0).unwrap());
    let center = moving.at(0.4).unwrap().spheres[0].center;
    assert!(
        center != DVec3::ZERO && center.abs().max_element() <= 0.1,
        "{center}"
    );
    for key in [
        "torus[1].major_radius",
        "torus[0].shape",
        "image.width",
        "sphere[0]",
        "x",
        "",
    ] {
        let error = AnimatedScene::new(scene.clone(), [(key, trembling.clone())]).unwrap_err();
        assert_eq!(error.kind(), energywave::ErrorKind::Scene, "{error}");
    }
    let still = AnimatedScene::new(scene.clone(), std::iter::empty::<(&str, Track)>()).unwrap();
    assert_eq!(still.at(3.0).unwrap(), scene);
}

#[test]
fn the_program_blurs_while_the_shutter_is_open() {
    let folder = Folder::new();
    let text = format!(
        "{MOVING}[time]\nshutter = 0.25\n[integration]\nantialias = \"none\"\ntolerance = 0.01\n"
    );
    std::fs::write(folder.path().join("a.toml"), &text).unwrap();
    let draw = |arguments: &[&str], words: &str| {
        let output = folder.run(
            &[
                &["render", "a.toml", "-o", "out.exr", "--device", "reference"],
                arguments,
            ]
            .concat(),
        );
        expect(&output, 0, words);
        energywave::RadianceImage::open(folder.path().join("out.exr")).unwrap()
    };
    let moving = AnimatedScene::from_toml(text).unwrap();
    let mut renderer = Renderer::new(&Device::reference()).unwrap();
    assert_eq!(moving.open_at(1.0, 2.0), 1.0..1.125);
    let blurred = renderer.render_shutter(&moving, 1.0..1.125).unwrap();
    let words = format!(", the mean of {} moments,", renderer.last_moments());
    assert_eq!(draw(&["--time", "1", "--fps", "2"], &words), blurred);
    let moment = draw(&["--time", "1"], "time.shutter: a share of a frame");
    assert_eq!(moment.as_slice(), drawn(&moving.at(1.0).unwrap()));
    assert_ne!(moment, blurred);
    let wide = draw(&["--time", "1", "--fps", "2", "--size", "8x5"], &words);
    assert_eq!((wide.size().width, wide.size().height), (8, 5));
    for rate in ["0", "-1", "nan", "inf", "fast"] {
        let wrong = folder.run(&["render", "a.toml", "-o", "x.exr", "--fps", rate]);
        expect(&wrong, 2, "a positive number of frames a second");
    }
    assert_eq!(folder.names().len(), 2);
}

#[test]
fn groups_of_lights_are_blurred_each_and_files_are_read_once() {
    let folder = Folder::new();
    let text = format!(
        "{MOVING}light_group = \"far\"\n[time]\nshutter = 1\n[integration]\ntolerance = 0.01\n\
         antialias = \"none\"\n[depth]\nfile = \"near.f32\"\n"
    );
    let name = |file: &str| folder.path().join(file);
    std::fs::write(name("a.toml"), text).unwrap();
    let depths: Vec<u8> = (0..24)
        .flat_map(|k: i32| (3.0 + k as f32 / 8.0).to_le_bytes())
        .collect();
    std::fs::write(name("near.f32"), depths).unwrap();
    let arguments = ["render", "a.toml", "--device", "reference", "--fps", "4"];
    let output = folder.run(&[&arguments[..], &["-o", "out.exr", "--light-groups"]].concat());
    expect(&output, 0, "the mean of");
    let all = energywave::RadianceImage::open(name("out.exr")).unwrap();
    let part = |layer| energywave::RadianceImage::open_layer(name("out.exr"), layer).unwrap();
    let (far, rest) = (part("far"), part("rest"));
    for ((all, far), rest) in all
        .as_slice()
        .iter()
        .zip(far.as_slice())
        .zip(rest.as_slice())
    {
        let sum = far + rest;
        assert!(
            (all - sum).abs() <= 0.02 * all || *all == 1.0,
            "{all}, {sum}"
        );
    }
    // Depths stay where they were read, though the camera moves.
    let moving = AnimatedScene::from_file(name("a.toml")).unwrap();
    let begin = moving.at(0.0).unwrap();
    std::fs::remove_file(name("near.f32")).unwrap();
    assert_eq!(moving.at(1.0).unwrap().depth, begin.depth);
    let larger = moving.at_with(1.0, |scene, _| {
        scene.image.width = 7;
        Ok(())
    });
    assert!(larger.unwrap_err().to_string().contains("depth.file"));
    let given = moving.at_with(1.0, |scene, _| {
        scene.depth = Some(begin.depth.clone().unwrap());
        Ok(())
    });
    assert_eq!(given.unwrap(), moving.at(1.0).unwrap());
}

#[test]
fn one_exposure_fits_the_brightest_moment_of_a_scene_that_names_none() {
    let light = |coefficient: &str| {
        format!("{CAMERA}[[torus]]\nmajor_radius = 0.5\ncoefficient = {coefficient}\n")
    };
    let stops = |scene: &Scene| scene.display.exposure;
    let still = |coefficient: &str| stops(&Scene::from_toml(&light(coefficient)).unwrap());
    let moving =
        AnimatedScene::from_toml(light("{ times = [0, 1, 2], values = [0, 4, 0.5] }")).unwrap();
    for time in [0.0, 0.5, 1.0, 1.9, 7.0] {
        assert_eq!(stops(&moving.at(time).unwrap()), still("4"), "{time}");
    }
    assert_ne!(still("4"), still("0.5"));
    let named = light("{ times = [0, 1], values = [0, 4] }") + "[display]\nexposure = 1.5\n";
    assert_eq!(
        stops(&AnimatedScene::from_toml(named).unwrap().at(0.5).unwrap()),
        1.5.into()
    );
}
