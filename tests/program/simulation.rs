//! Waves of particles in scene files: figures of 2013, `energywave contacts`, and every fault with its place.

use std::fs;

use energywave::Scene;
use energywave::particle::{LightElement, Simulation};
use energywave::scene::{AnimatedScene, ColliderShape, Varying};

use crate::bad_scenes::CAMERA;
use crate::common;
use crate::common::program::{Folder, expect, stderr};

const SPLASH: &str = "[simulation]\ntime = 40\n[[wave]]\norigin = [-50, 0, 0]\ndirection = [1, 0, 0]\n\
    [[collider]]\nbox = { center = [8, 0, 0], half = [8, 22, 22] }\n";

#[test]
fn every_figure_of_2013_is_simulated_and_no_two_are_alike() {
    let mut all: Vec<(String, Vec<LightElement>, bool)> = Vec::new();
    for path in common::scene_files() {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if !name.starts_with("2013-") {
            continue;
        }
        let scene = Scene::from_file(&path).unwrap();
        let time = scene.simulation_settings().time.unwrap();
        let light = Simulation::new(&scene).unwrap().light(time).unwrap();
        println!("{name}: {} elements", light.len());
        assert!(light.len() > 700, "{name}");
        // Another eye sees the same.
        let is_view = name.contains("-4-6-") || name.ends_with("-4-1");
        for (other, theirs, is_view_too) in &all {
            let is_same = is_view && *is_view_too;
            assert_eq!(*theirs == light, is_same, "{name} and {other}");
        }
        all.push((name, light, is_view));
    }
    assert_eq!(all.len(), 13);
}

#[test]
fn contacts_are_those_of_the_library() {
    let folder = Folder::new();
    fs::write(
        folder.path().join("splash.toml"),
        format!("{CAMERA}{SPLASH}"),
    )
    .unwrap();
    let scene = Scene::from_toml(&format!("{CAMERA}{SPLASH}")).unwrap();
    let expected = Simulation::new(&scene).unwrap().contacts(0..=40).unwrap();
    let read = |text: &[u8]| serde_json::from_slice::<Vec<serde_json::Value>>(text).unwrap();

    let output = folder.run(&["contacts", "splash.toml"]);
    expect(
        &output,
        0,
        &format!("contacts: {} in frames 0 to 40", expected.len()),
    );
    let found = read(&output.stdout);
    assert!(expected.len() > 300 && found.len() == expected.len());
    for (found, contact) in found.iter().zip(&expected) {
        let numbers = |key: &str| {
            let list = found[key].as_array().unwrap();
            let numbers: Vec<f64> = list.iter().map(|it| it.as_f64().unwrap()).collect();
            numbers
        };
        assert_eq!(found["time"].as_f64(), Some(contact.time));
        assert_eq!(found["frame"].as_f64(), Some(contact.frame));
        assert_eq!(numbers("point"), contact.point.to_array());
        assert_eq!(numbers("normal"), contact.normal.to_array());
        assert_eq!(found["speed"].as_f64(), Some(contact.speed));
        assert_eq!(
            found["particle"].as_u64(),
            Some(u64::from(contact.particle))
        );
        assert_eq!(
            (found["wave"].as_u64(), found["collider"].as_u64()),
            (Some(0), Some(0))
        );
        assert_eq!(found["is_first"].as_bool(), Some(true));
    }

    let output = folder.run(&[
        "contacts",
        "splash.toml",
        "--frames",
        "30..31",
        "-o",
        "out.json",
    ]);
    expect(&output, 0, " in frames 30 to 31");
    assert!(output.stdout.is_empty());
    let part = read(&fs::read(folder.path().join("out.json")).unwrap());
    let expected = expected
        .iter()
        .filter(|it| (30.0..32.0).contains(&it.frame));
    assert_eq!(part.len(), expected.count());
}

#[test]
fn contacts_that_cannot_be_told_are_refused() {
    let folder = Folder::new();
    let write =
        |name: &str, text: String| fs::write(folder.path().join(name), CAMERA.to_owned() + &text);
    write("splash.toml", SPLASH.to_owned()).unwrap();
    write("endless.toml", SPLASH.replace("time = 40\n", "")).unwrap();
    write("bad.toml", SPLASH.replace("[1, 0, 0]", "[0, 0, 0]")).unwrap();
    write("bare.toml", String::new()).unwrap();
    for (arguments, code, words) in [
        (
            &["contacts", "endless.toml"][..],
            2,
            "--frames A..B is needed: the scene's [simulation] names no time",
        ),
        (
            &["contacts", "splash.toml", "--frames", "5..2"],
            2,
            "frames run forwards",
        ),
        (
            &["contacts", "splash.toml", "--frames", "2000000"],
            2,
            "counted from 0 to 1000000; found 2000000",
        ),
        (
            &["contacts", "bad.toml"],
            3,
            "bad.toml:8:13: wave[0].direction: ",
        ),
        (&["contacts", "nowhere.toml"], 3, "cannot read"),
        (&["contacts", "splash.toml", "-o", "."], 7, "cannot write"),
    ] {
        let output = folder.run(arguments);
        expect(&output, code, words);
        assert!(output.stdout.is_empty(), "{arguments:?}");
    }
    let output = folder.run(&["contacts", "bare.toml", "--frames", "0..9"]);
    expect(&output, 0, "nothing can be hit");
    assert_eq!(output.stdout, b"[]\n");
    let output = folder.run(&["contacts", "splash.toml", "--frames", "0..9"]);
    expect(&output, 0, "contacts: 0 in frames 0 to 9");
    assert!(!stderr(&output).contains("warning"));
}

#[test]
fn more_particles_than_the_memory_holds_are_refused() {
    let text = SPLASH.replace("direction", "rate = 1e8\ndirection");
    let scene = Scene::from_toml(&format!(
        "{CAMERA}{}",
        text.replace("time = 40", "time = 1")
    ))
    .unwrap();
    let error = Simulation::new(&scene).unwrap_err().to_string();
    assert!(
        error.contains("wave[0].rate") && error.contains("available"),
        "{error}"
    );
}

#[test]
fn waves_are_shown_at_the_scenes_time_and_written_as_they_were_read() {
    let text = "[simulation]\nframe = 0.02\n[[wave]]\ndirection = [1, 0, 0]\n\
        origin = [0, { times = [0, 1], values = [2, 3] }, 0]\n\
        rate = { value = 9, noise = { amplitude = 2, frequency = 5 } }\ncircular = 0.5\n\
        control = [{ position = { times = [0, 1], values = [[0, 0, 1], [2, 0, 1]], loop = \"ping-pong\" } }]\n\
        mixture = [{ probability = 0.5, samples = 1 }]\ncolor = \"#ff8000\"\n\
        [[collider]]\nbox = { half = [1, 2, 3], rotation = { axis = [0, 0, 1], angle = 30 } }\n\
        [[collider]]\nsphere = { radius = 2 }\nvisible = false\n[[collider]]\nplane = { }\n";
    let moving = AnimatedScene::from_toml(format!("{CAMERA}{text}")).unwrap();
    assert!(moving.is_animated());
    let scene = moving.at(1.5).unwrap();
    assert_eq!(scene.simulation_settings().time, Some(75.0));
    assert_eq!(
        moving.at(0.0).unwrap().simulation_settings().time,
        Some(0.0)
    );
    let wave = &scene.waves[0];
    // Tracks stay what they are: the simulation begins before the frame that is shown.
    assert!(matches!(wave.rate, Varying::Track(_)) && wave.origin.at(0.25).y == 2.25);
    assert_eq!(wave.control[0].position.at(1.5).x, 1.0);
    assert!(
        matches!(scene.colliders[2].shape, ColliderShape::Plane { normal, .. } if normal.z == 1.0)
    );
    for read in [
        Scene::from_toml(&scene.to_toml().unwrap()).unwrap(),
        Scene::from_json(&scene.to_json().unwrap()).unwrap(),
    ] {
        assert_eq!(read, scene);
    }
    // A frame that is named stays, and a track shows others.
    let still = AnimatedScene::from_toml(format!("{CAMERA}{SPLASH}")).unwrap();
    assert!(
        !still.is_animated() && still.at(2.0).unwrap().simulation_settings().time == Some(40.0)
    );
    let slow = SPLASH.replace("40", "{ times = [0, 10], values = [0, 100] }");
    let slow = AnimatedScene::from_toml(format!("{CAMERA}{slow}")).unwrap();
    assert_eq!(slow.at(2.5).unwrap().simulation_settings().time, Some(25.0));
}

#[test]
fn a_scene_of_waves_alone_is_no_dark_one() {
    let scene = Scene::from_toml(&format!("{CAMERA}{SPLASH}")).unwrap();
    assert_eq!(scene.warnings(), []);
}

#[test]
fn an_open_mesh_that_waves_hit_is_told_of() {
    let wave = "[camera]\neye = [0, -9, 1]\ntarget = [0, 0, 0]\n[[wave]]\norigin = [-9, 0, 0]\ndirection = [1, 0, 0]\n";
    let mesh = |triangles: &str| {
        let corners = "[[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]]";
        let keys = format!("vertices = {corners}, triangles = {triangles}");
        format!("{wave}[[collider]]\nmesh = {{ {keys} }}\n")
    };
    let warnings = |text: &str| {
        let folder = Folder::new();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, text).unwrap();
        Scene::from_file_with_warnings(&path, |_, _| Ok(()))
            .unwrap()
            .1
    };
    let closed = "[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]";
    assert!(warnings(&mesh(closed)).is_empty());
    let found = warnings(&mesh("[[0, 2, 1], [0, 1, 3], [0, 3, 2]]"));
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].key, "collider[0].mesh");
    let text = found[0].to_string();
    assert!(
        text.contains("scene.toml:8:") && text.contains("is open"),
        "{text}"
    );
}
