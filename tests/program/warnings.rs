//! What a scene was hardly meant to say is told with its place; the repository's scenes are told nothing.

use std::path::Path;

use crate::common::program::{Folder, expect, stderr};
use energywave::Scene;

const CAMERA: &str = "[camera]\neye = [0.0, -4.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\n";

#[test]
fn no_scene_of_the_repository_is_warned_of() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let folders = ["", "animations", "presets"].map(|name| folder.join(name));
    let entries = folders.map(|folder| std::fs::read_dir(folder).unwrap());
    let scenes = entries
        .into_iter()
        .flatten()
        .map(|entry| entry.unwrap().path());
    let scenes = scenes.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    let mut count = 0;
    for path in scenes {
        let (_, warnings) = Scene::from_file_with_warnings(&path, |_, _| Ok(())).unwrap();
        assert!(warnings.is_empty(), "{}: {warnings:?}", path.display());
        count += 1;
    }
    assert!(count >= 20, "{count}");
}

/// Draws a scene quietly; the lines on standard error.
fn said(name: &str, text: &str) -> Vec<String> {
    let folder = Folder::new();
    std::fs::write(folder.path().join(name), text).unwrap();
    let arguments = [
        "render",
        name,
        "-o",
        "o.png",
        "-q",
        "--device",
        "reference",
        "--size",
        "2x2",
    ];
    let output = folder.run(&arguments);
    expect(&output, 0, "");
    stderr(&output).lines().map(str::to_owned).collect()
}

#[test]
fn warnings_have_file_line_column_and_key_and_are_told_quietly_too() {
    for (rest, place, words) in [
        (
            "fov_y = 0.8\n[[sphere]]\n",
            "4:9: camera.fov_y",
            "write 45.8",
        ),
        (
            "[[sphere]]\n[[torus]]\nmajor_radius = 1\ncolor = [255, 128, 0]\n",
            "7:9: torus[0].color",
            "write [1.0, 0.502, 0.0]",
        ),
        (
            "[[sphere]]\n[[group]]\nrepeat = { count = 3, step = [1, 0, 0] }\n[[group.sphere]]\ncolor = [0, 0, 255]\n",
            "8:9: group[0].sphere[0].color",
            "write [0.0, 0.0, 1.0] (2 more sources have such colours)",
        ),
        (
            "[[group]]\ntranslate = [0, -90, 40]\n[[group.sphere]]\n",
            "6:1: group[0].sphere[0]",
            "behind the eye",
        ),
        (
            "[[sphere]]\ncoefficient = 0\n",
            "4:1: sphere[0]",
            "gives no light",
        ),
        (
            "[[sphere]]\ncenter = [0, -9, 4]\n",
            "4:1: sphere[0]",
            "behind the eye",
        ),
        (
            "ray_length = 20\n[[sphere]]\ncenter = [0, 90, 0]\n",
            "5:1: sphere[0]",
            "beyond the end of the rays",
        ),
    ] {
        let lines = said("scene.toml", &format!("{CAMERA}{rest}"));
        assert_eq!(lines.len(), 1, "{lines:?}");
        let begin = format!("warning: scene.toml:{place}: ");
        assert!(
            lines[0].starts_with(&begin) && lines[0].contains(words),
            "{lines:?}"
        );
    }
    let two = format!("{CAMERA}fov_y = 1.0\n");
    let lines = said("scene.toml", &two);
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(lines[0].contains("camera.fov_y") && lines[1].contains("no source of light"));
    let json =
        r#"{"camera": {"eye": [0, -4, 2], "target": [0, 0, 0], "fov_y": 0.8}, "sphere": [{}]}"#;
    let lines = said("scene.json", json);
    assert!(
        lines[0].starts_with("warning: scene.json: camera.fov_y: "),
        "{lines:?}"
    );
    assert_eq!(
        said("scene.toml", &format!("{CAMERA}fov_y = 40\n[[sphere]]\n")),
        [""; 0]
    );
}

#[test]
fn a_cycle_that_does_not_fit_into_the_loop_is_told_with_its_place() {
    let scene = |loops: &str, track: &str| {
        let time = format!("[time]\nloop = {loops}\n");
        said("scene.toml", &format!("{CAMERA}{time}{track}"))
    };
    let radius = |keys: &str| {
        format!(
            "[[sphere]]\n[[torus]]\nmajor_radius = {{ times = [0, 0.8], values = [1, 2], {keys} }}\n"
        )
    };
    let repeat = radius("loop = \"repeat\"");
    let ping_pong = radius("loop = \"ping-pong\"");
    for (loops, track, words) in [
        (
            "3",
            &repeat,
            "8:16: torus[0].major_radius: begins again every 0.8 s, and jumps where the scene does after 3 s; \
             a cycle of 0.75 s fits in",
        ),
        ("3", &ping_pong, "every 1.6 s"),
        ("0.5", &repeat, "a cycle of 0.5 s fits in"),
        (
            "3",
            &repeat.replace(
                "[[sphere]]\n",
                &format!(
                    "[[group]]\n[[group.sphere]]\n{}",
                    radius("loop = \"repeat\"")
                        .replace("[[torus]]", "[[group.torus]]")
                        .replace("[[sphere]]\n", "")
                ),
            ),
            "group[0].torus[0].major_radius: begins again every 0.8 s",
        ),
    ] {
        let lines = scene(loops, track);
        assert_eq!(lines.len(), 1, "{loops}, {track}: {lines:?}");
        assert!(
            lines[0].starts_with("warning: scene.toml:") && lines[0].contains(words),
            "{lines:?}"
        );
    }
    // What is told of the first is told of no other.
    let lines = scene(
        "3",
        &(repeat.clone() + &radius("loop = \"repeat\"").replace("[[sphere]]\n", "")),
    );
    assert!(
        lines.len() == 1 && lines[0].contains("(1 more tracks jump there)"),
        "{lines:?}"
    );
    // Cycles that fit, tracks that end, a value that is the same there, and noise, whose steps are fitted, do not jump.
    let noise = "loop = \"repeat\", noise = { amplitude = 0.1, frequency = 0.7 }";
    for (loops, track) in [
        ("2.4", &repeat),
        ("1.6", &ping_pong),
        ("2.4000001", &repeat),
        ("3", &radius("loop = \"once\"")),
        ("3", &repeat.replace("[1, 2]", "[1, 1]")),
        ("2.4", &radius(noise)),
    ] {
        assert_eq!(scene(loops, track), [""; 0], "{loops}, {track}");
    }
}
