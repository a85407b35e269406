//! Every bad scene: exit code 3, one message with file, line, column and key, and nothing written.

use std::path::Path;
use std::process::Command;

pub const CAMERA: &str = "[camera]\neye = [0.0, -4.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\n";

/// What follows a valid [camera] of three lines; where the fault stands; words of the message.
const BAD: &[(&str, &str, &str)] = &[
    (
        "zoom = 1\n",
        "4:1: camera.zoom",
        "unknown field `zoom`, expected one of",
    ),
    (
        "[toruss]\nmajor_radius = 1\n",
        "4:2: toruss",
        "unknown field `toruss`",
    ),
    (
        "fov_y = \"wide\"\n",
        "4:9: camera.fov_y",
        "expected a number",
    ),
    (
        "[[torus]]\nmajor_radius = [1.0]\n",
        "5:16: torus[0].major_radius",
        "expected a number",
    ),
    (
        "up = [0, 1]\n",
        "4:6: camera.up",
        "expected three numbers, found 2",
    ),
    (
        "up = [0, 1, 0, 0]\n",
        "4:6: camera.up",
        "expected three numbers, found 4",
    ),
    ("near = nan\n", "4:8: camera.near", "not a finite number"),
    (
        "[[sphere]]\ncenter = [0.0, inf, 0.0]\n",
        "5:10: sphere[0].center",
        "not a finite number",
    ),
    (
        "[[sphere]]\ncoefficient = 1e30\n",
        "5:15: sphere[0].coefficient",
        "beyond 1e9",
    ),
    ("[image]\nwidth = 0\n", "5:9: image.width", "at least 1"),
    (
        "[image]\nheight = -5\n",
        "5:10: image.height",
        "a whole number from 0",
    ),
    (
        "[image]\nheight = 2.5\n",
        "5:10: image.height",
        "whole number",
    ),
    (
        "[image]\nheight = 16385\n",
        "5:10: image.height",
        "at most 16384x16384",
    ),
    (
        "[[cylinder]]\ndirection = [0, 0, 0]\n",
        "5:13: cylinder[0].direction",
        "zero vector",
    ),
    (
        "[[torus]]\nmajor_radius = 1\n[[torus]]\naxis = [0, 0, 0]\nmajor_radius = 1\n",
        "7:8: torus[1].axis",
        "zero vector",
    ),
    (
        "[[beam]]\ndirection = [0.0, 0.0, 0.0]\n",
        "5:13: beam[0].direction",
        "zero vector",
    ),
    (
        "[[beam]]\ndirection = [0.0, 0.0, 1.0]\ncoefficient = 1e10\n",
        "6:15: beam[0].coefficient",
        "1e10 is beyond 1e9",
    ),
    (
        "[[beam]]\ntip = [0.0, 0.0, 0.0]\n",
        "4:1: beam[0].direction",
        "required, but missing",
    ),
    (
        "[[beam]]\ndirection = [0.0, 0.0, 1.0]\ntaper_length = -0.5\n",
        "6:16: beam[0].taper_length",
        "must be positive, found -0.5",
    ),
    (
        "[[beam]]\ndirection = [0.0, 0.0, 1.0]\ntaper_length = 0.5\ncap_coefficient = 1\n",
        "7:19: beam[0].cap_coefficient",
        "a cap or a taper",
    ),
    (
        "[[beam]]\ndirection = [0.0, 0.0, 1.0]\nsphere_coefficient = nan\n",
        "6:22: beam[0].sphere_coefficient",
        "not a finite number",
    ),
    (
        "[[sphere]]\nprofile = \"square\"\n",
        "5:11: sphere[0].profile",
        "expected one of `inverse`, `inverse-square`, `inverse-cube`, `gaussian`, `smeared`",
    ),
    (
        "[depth]\nfile = \"nowhere.exr\"\n",
        "5:8: depth.file",
        "nowhere.exr: cannot read: No such file",
    ),
    ("[depth]\nfile = \".\"\n", "5:8: depth.file", "cannot read"),
    (
        "[depth]\nfile = \"scene.toml\"\n",
        "5:8: depth.file",
        "not an OpenEXR image",
    ),
    (
        "[depth]\nfile = \"d.exr\"\nalong = \"z\"\n",
        "6:9: depth.along",
        "expected one of `ray`, `axis`, `ndc`, `buffer`",
    ),
    (
        "[depth]\nalong = \"axis\"\n",
        "4:1: depth.file",
        "required, but missing",
    ),
    (
        "up = [0.0, 4.0, -2.0]\n",
        "4:6: camera.up",
        "parallel to the view",
    ),
    ("near = 100.0\n", "4:8: camera.near", "behind the target"),
    ("fov_y = 180.0\n", "4:9: camera.fov_y", "179.9"),
    (
        "[[curve]]\ncontrol_points = [[0, 0, 0], [1, 1, 1]]\n",
        "5:18: curve[0].control_points",
        "three control points, found 2",
    ),
    (
        "[[curve]]\ncontrol_points = [[0, 0, 0], [1, 1, 1], [1, 2, 1], [3, 3, 3]]\n",
        "5:18: curve[0].control_points",
        "three control points, found 4",
    ),
    (
        "[[curve]]\ncontrol_points = [[0, 0, 0], [1, 1], [1, 2, 1]]\n",
        "5:30: curve[0].control_points[1]",
        "three numbers, found 2",
    ),
    (
        "[[curve]]\ncontrol_points = [[0, 0, 0], [1, 1, 1], [1, 2, 1]]\nintensity = [1, 2]\n",
        "6:13: curve[0].intensity",
        "at least 3 values, found 2",
    ),
    (
        "[[curve]]\ncontrol_points = [[0, 0, 0], [1, 1, 1], [1, 2, 1]]\nintensity = [1, 2, nan]\n",
        "6:20: curve[0].intensity[2]",
        "not a finite number",
    ),
    (
        "[integration]\ndivisions = 201\n",
        "5:13: integration.divisions",
        "even number",
    ),
    (
        "[integration]\ndivisions = 0\n",
        "5:13: integration.divisions",
        "even number",
    ),
    (
        "[integration]\ndivisions = 65538\n",
        "5:13: integration.divisions",
        "65536",
    ),
    (
        "[integration]\nmethod = \"romberg\"\n",
        "5:10: integration.method",
        "expected one of `simpson`, `jittered`, `exact`",
    ),
    (
        "[integration]\nsampling = \"rows\"\n",
        "5:12: integration.sampling",
        "expected `pixels` or `tiles`",
    ),
    (
        "[integration]\nmethod = \"simpson\"\nsampling = \"tiles\"\n",
        "6:12: integration.sampling",
        "\"simpson\" takes every pixel",
    ),
    (
        "[integration]\nsoftening = -0.1\n",
        "5:13: integration.softening",
        "negative",
    ),
    (
        "[integration]\ntolerance = 0.0\n",
        "5:13: integration.tolerance",
        "between",
    ),
    (
        "[decay]\nalpha = 0.0\nbeta = 0.1\n",
        "5:9: decay.alpha",
        "must be positive, found 0",
    ),
    (
        "[decay]\nalpha = 0.1\nbeta = -1\n",
        "6:8: decay.beta",
        "must be positive, found -1",
    ),
    (
        "[decay]\nalpha = 0.1\n",
        "4:1: decay.beta",
        "required, but missing",
    ),
    (
        "[[torus]]\nmajor_radius = 0\n",
        "5:16: torus[0].major_radius",
        "must be positive",
    ),
    (
        "[[torus]]\naxis = [0, 0, 1]\n",
        "4:1: torus[0].major_radius",
        "required, but missing",
    ),
    (
        "[torus]\nmajor_radius = 1\n",
        "4:1: torus",
        "write double brackets, [[torus]]",
    ),
    (
        "[[sphere]]\ncoefficient = 1e9\ncolor = [1e9, 1, 1]\n[decay]\nalpha = 1e6\nbeta = 0.01\n",
        "5:15: sphere[0].coefficient",
        "more than float32 holds",
    ),
    (
        "[decay]\nalpha = 1e9\nbeta = 1e-9\n",
        "6:8: decay.beta",
        "more than float32 holds",
    ),
    (
        "[display]\nexposure = 1e4\n",
        "5:12: display.exposure",
        "100 stops",
    ),
    (
        "[display]\ntone_map = \"filmic\"\n",
        "5:12: display.tone_map",
        "`exponential`",
    ),
    ("eye = [1, 2, 3]\n", "4:1:", "duplicate key `eye`"),
    ("up = [0, 0\n", "4:11:", "unclosed array"),
];

/// Whole files; JSON has the key path in place of line and column.
const BAD_FILES: &[(&str, &[u8], &str)] = &[
    ("empty.toml", b"", "empty.toml:1:1: camera: the file is empty"),
    ("no-camera.toml", b"[image]\nwidth = 5\n", "no-camera.toml:1:1: camera: required"),
    ("no-eye.toml", b"[camera]\ntarget = [0, 0, 0]\n", "no-eye.toml:1:1: camera.eye: required"),
    ("same.toml", b"[camera]\neye = [1, 1, 1]\ntarget = [1, 1, 1]\n", "same.toml:3:10: camera.target: the same point"),
    ("above.toml", b"[camera]\neye = [0, 0, 4]\ntarget = [0, 0, 0]\n", "above.toml:1:1: camera.up: [0, 0, 1], the default, is parallel to the view direction; write another, such as up = [0.0, 1.0, 0.0]"),
    ("cut.toml", b"[camera]\neye = [0.0, -4", "cut.toml:2:15: unclosed array"),
    ("binary.toml", b"\x89PNG\r\n\x1a\n\x00\x00\xff\xfe", "binary.toml: not a text file"),
    ("zeros.toml", &[0; 64], "zeros.toml: not a text file (byte 0)"),
    ("type.json", b"{\"camera\": {\"eye\": [0, -4, 2], \"target\": 5}}", "type.json:1:42: camera.target: invalid type"),
    ("value.json", b"{\"camera\": {\"eye\": [0, -4, 2], \"target\": [0, 0, 0]}, \"torus\": [{\"major_radius\": -1}]}", "value.json: torus[0].major_radius: must be positive"),
    ("four.json", b"{\"camera\": {\"eye\": [0, -4, 2, 1], \"target\": [0, 0, 0]}}", "camera.eye: expected three numbers, found 4"),
    ("cut.json", b"{\"camera\": {\"eye\": [0, -4", "cut.json:1:25:"),
    ("empty.JSON", b"", "empty.JSON:1:1: camera: the file is empty"),
    ("twice.json", b"{\"camera\": {\"eye\": [0, -4, 2], \"target\": [0, 0, 0]}} {}", "twice.json:1:54: trailing"),
];

/// Renders a file in a fresh folder: exit code, standard error, and what else is in the folder afterwards.
fn render(name: &str, contents: &[u8]) -> (Option<i32>, String, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), contents).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_energywave"))
        .args([
            "render",
            name,
            "-o",
            "out.png",
            "--device",
            "reference",
            "--size",
            "4x4",
        ])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert!(output.stdout.is_empty(), "data on standard output");
    let left = |folder: &Path| {
        let entries = std::fs::read_dir(folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.filter(|found| found != name).collect()
    };
    let stderr = String::from_utf8(output.stderr).unwrap();
    (output.status.code(), stderr, left(folder.path()))
}

pub fn check(name: &str, contents: &[u8], expected: &[&str]) {
    let (code, message, left) = render(name, contents);
    let text = String::from_utf8_lossy(&contents[..contents.len().min(300)]);
    assert_eq!(code, Some(3), "{text}\n{message}");
    let is_shown = |c: char| !c.is_control() || c == '\n';
    assert!(
        message.len() < 1000 && message.chars().all(is_shown),
        "{message:?}"
    );
    for words in expected {
        assert!(
            message.contains(words),
            "{text}\n{message}\nhas not: {words}"
        );
    }
    assert_eq!(message.lines().count(), 1, "{text}\n{message}");
    assert!(!message.contains("panic"), "{text}\n{message}");
    assert!(left.is_empty(), "{text}\nleft {left:?}");
}

#[test]
fn a_bad_value_is_named_with_file_line_column_and_key() {
    for (rest, place, words) in BAD {
        // The size is given on the command line: what is wrong in the file must not pass for that.
        let scene = format!("{CAMERA}{rest}");
        if place.contains("image.") {
            check_library(&scene, place, words);
        } else {
            check(
                "scene.toml",
                scene.as_bytes(),
                &[&format!("scene.toml:{place}"), words],
            );
        }
    }
}

fn check_library(scene: &str, place: &str, words: &str) {
    let message = energywave::Scene::from_toml(scene).unwrap_err().to_string();
    assert!(
        message.contains(place) && message.contains(words),
        "{scene}\n{message}"
    );
}

#[test]
fn a_bad_file_is_named() {
    for (name, contents, words) in BAD_FILES {
        check(name, contents, &[words]);
    }
}

#[test]
fn the_valid_scene_that_the_bad_ones_grow_from_is_drawn() {
    let (code, message, left) = render("scene.toml", CAMERA.as_bytes());
    assert_eq!(
        (code, left),
        (Some(0), vec!["out.png".to_owned()]),
        "{message}"
    );
}

#[test]
fn toml_and_json_say_the_same() {
    let toml = format!(
        "{CAMERA}[[torus]]\nmajor_radius = 2\naxis = [1, 0, 0]\n[decay]\nalpha = 1\nbeta = 2\n"
    );
    let json = r#"{"camera": {"eye": [0, -4, 2], "target": [0, 0, 0]},
        "torus": [{"major_radius": 2, "axis": [1, 0, 0]}], "decay": {"alpha": 1, "beta": 2}}"#;
    let toml = energywave::Scene::from_toml(&toml).unwrap();
    assert_eq!(toml, energywave::Scene::from_json(json).unwrap());
    assert_eq!(toml.tori.len(), 1);
}

#[test]
fn a_missing_file_and_a_folder_are_named() {
    for (name, words) in [
        ("nowhere.toml", "nowhere.toml: cannot read"),
        (".", ".: cannot read"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_energywave"))
            .args(["render", name, "-o", "/nowhere/out.png"])
            .current_dir(tempfile::tempdir().unwrap().path())
            .output()
            .unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(3), "{message}");
        assert!(message.contains(words), "{message}");
    }
}
