//! `[lighting]` of scene files: what it is read as, tracks, a warning, and every fault with its place.

use energywave::Scene;
use energywave::glam::DVec3;
use energywave::scene::{AnimatedScene, Lighting};

use crate::common::program::{Folder, expect};

const CAMERA: &str = "[camera]\neye = [0.0, -9.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\n[lighting]\n";

/// What follows the header in line 4; where the fault stands; words of the message.
const BAD: &[(&str, &str, &str)] = &[
    ("gian = 1\n", "5:1: lighting.gian", "did you mean `gain`?"),
    ("gain = -1\n", "5:8: lighting.gain", "0 or more; found -1"),
    ("gain = nan\n", "5:8: lighting.gain", "not a finite number"),
    ("gain = \"much\"\n", "5:8: lighting.gain", "number"),
    ("cast = 1\n", "5:8: lighting.cast", "boolean"),
    ("radius = 0\n", "5:10: lighting.radius", "must be positive"),
    (
        "shadow_samples = 0\n",
        "5:18: lighting.shadow_samples",
        "from 1 to 1024",
    ),
    (
        "shadow_samples = 1025\n",
        "5:18: lighting.shadow_samples",
        "from 1 to 1024",
    ),
    (
        "ambient = [0, -0.1, 0]\n",
        "5:11: lighting.ambient",
        "0 or more",
    ),
    (
        "ambient = [0, 0]\n",
        "5:11: lighting.ambient",
        "expected three numbers",
    ),
    (
        "sun = { direction = [0, 0, 0] }\n",
        "lighting.sun.direction",
        "has no direction",
    ),
    (
        "sun = { direction = [0, 0, 1], color = [-1, 0, 0] }\n",
        "lighting.sun.color",
        "0 or more",
    ),
    ("sun = { color = [1, 0, 0] }\n", "lighting.sun", "direction"),
    (
        "sun = { directoin = [0, 0, 1] }\n",
        "lighting.sun.directoin",
        "did you mean `direction`?",
    ),
];

#[test]
fn every_fault_is_told_with_its_place() {
    let folder = Folder::new();
    for (line, place, words) in BAD {
        let scene = folder.path().join("bad.toml");
        std::fs::write(scene, format!("{CAMERA}{line}")).unwrap();
        let output = folder.run(&[
            "render",
            "bad.toml",
            "-o",
            "out.png",
            "--device",
            "reference",
        ]);
        expect(&output, 3, "bad.toml:5:");
        expect(&output, 3, place);
        expect(&output, 3, words);
        assert!(!folder.names().contains(&"out.png".to_owned()), "{line}");
    }
}

fn lighting(text: &str) -> Option<Lighting> {
    let (before, table) = match text.strip_prefix("lighting") {
        Some(_) => (text, ""),
        None => ("", text),
    };
    let camera = "[camera]\neye = [0.0, -9.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\n";
    let scene = Scene::from_toml(&format!("{before}\n{camera}{table}")).unwrap();
    let written = Scene::from_toml(&scene.to_toml().unwrap()).unwrap();
    assert_eq!(written.lighting, scene.lighting);
    scene.lighting
}

#[test]
fn it_is_read_as_it_is_written() {
    assert_eq!(lighting(""), None);
    assert_eq!(lighting("lighting = false"), None);
    assert_eq!(lighting("lighting = true"), Some(Lighting::default()));
    assert_eq!(lighting("[lighting]"), Some(Lighting::default()));
    let text = "[lighting]\ncast = false\ngain = 3\nradius = 0.1\nshadows = true\nshadow_samples = 5\n\
                ambient = \"#ffffff\"\nsun = { direction = [0, 1, 2] }\n";
    let found = lighting(text).unwrap();
    assert!(!found.cast && found.shadows);
    assert_eq!(
        (found.gain, found.radius, found.shadow_samples),
        (3.0, Some(0.1), 5)
    );
    let sun = found.sun.unwrap();
    assert_eq!(
        (found.ambient, sun.direction, sun.color),
        (DVec3::ONE, DVec3::new(0.0, 1.0, 2.0), DVec3::ONE)
    );
}

#[test]
fn tracks_move_it() {
    let text = format!(
        "{CAMERA}gain = {{ times = [0, 2], values = [1, 3] }}\n\
         sun = {{ direction = [{{ times = [0, 2], values = [0, 4] }}, 0, 1] }}\n"
    );
    let scene = AnimatedScene::from_toml(text).unwrap();
    let found = scene.at(1.0).unwrap().lighting.unwrap();
    assert_eq!(found.gain, 2.0);
    assert_eq!(found.sun.unwrap().direction, DVec3::new(2.0, 0.0, 1.0));
}

#[test]
fn lighting_without_a_mesh_is_warned_of() {
    let text = format!("{CAMERA}[[sphere]]\n");
    let scene = Scene::from_toml(&text).unwrap();
    let warnings = scene.warnings();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert_eq!(warnings[0].key, "lighting");
    assert!(warnings[0].message.contains("no [[mesh]]"));
}
