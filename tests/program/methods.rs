//! The ways to integrate, as files and the program's options choose them, and what does not go together.

use energywave::scene::Method;
use energywave::{ErrorKind, RadianceImage, Scene};

use crate::bad_scenes::CAMERA;
use crate::common::program::{Folder, expect};

/// What follows the camera, at its fault: a place, and words of the message.
const BAD: &[(&str, &str, &str)] = &[
    (
        "[integration]\nmethod = \"jittered\"\ndivisions = 0\n",
        "6:13: integration.divisions",
        "0; stratified samples need 1 to 65536",
    ),
    (
        "[integration]\nmethod = \"jittered\"\ndivisions = 65537\n",
        "6:13: integration.divisions",
        "1 to 65536",
    ),
    (
        "[integration]\nmethod = \"jittered\"\nsampling = \"tiles\"\n",
        "6:12: integration.sampling",
        "\"jittered\" takes every pixel",
    ),
    (
        "[integration]\nmethod = \"jittered\"\nseed = -1\n",
        "6:8: integration.seed",
        "a whole number from 0 to 4294967295",
    ),
    (
        "[integration]\nmethod = \"jittered\"\nseed = 1.5\n",
        "6:8: integration.seed",
        "whole number",
    ),
    (
        "[integration]\nmethod = \"jitter\"\n",
        "5:10: integration.method",
        "expected one of `simpson`, `jittered`, `exact`",
    ),
];

#[test]
fn bad_values_are_told_with_their_place() {
    for (rest, place, words) in BAD {
        let error = Scene::from_toml(&format!("{CAMERA}{rest}")).unwrap_err();
        let message = error.to_string();
        assert_eq!(error.kind(), ErrorKind::Scene, "{message}");
        assert!(message.contains(place), "{message}\nhas not: {place}");
        assert!(message.contains(words), "{message}\nhas not: {words}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

#[test]
fn a_file_names_divisions_and_a_seed() {
    let method = |keys: &str| {
        let text = format!("{CAMERA}[integration]\nmethod = \"jittered\"\n{keys}");
        Scene::from_toml(&text).unwrap().integration.method
    };
    let jittered = |divisions, seed| Method::Jittered { divisions, seed };
    assert_eq!(method(""), jittered(200, 0));
    assert_eq!(method("divisions = 7\nseed = 9\n"), jittered(7, 9));
}

#[test]
fn the_program_jitters_when_asked_to() {
    let folder = Folder::new();
    let text = format!(
        "{CAMERA}[integration]\nmethod = \"jittered\"\ndivisions = 64\nseed = 3\n[[torus]]\nmajor_radius = 1\n"
    );
    std::fs::write(folder.path().join("scene.toml"), text).unwrap();
    let draw = |name: &str, more: &[&str]| {
        let all = ["render", "scene.toml", "-o", name, "--size", "16x16"];
        let output = folder.run(&[&all[..], &["--device", "reference"], more].concat());
        expect(&output, 0, "");
        RadianceImage::open(folder.path().join(name)).unwrap()
    };
    let own = draw("a.exr", &[]);
    let same = draw("b.exr", &["--method", "jittered", "--divisions", "64"]);
    assert!(own == same);
    // Divisions leave the method as it is where it has some.
    let more = draw("c.exr", &["--divisions", "66"]);
    assert!(more == draw("d.exr", &["--method", "jittered", "--divisions", "66"]));
    assert!(own != more);
    let simpson = draw("e.exr", &["--method", "simpson"]);
    assert!(simpson != own);
    let exact = draw("f.exr", &["--tolerance", "1e-3"]);
    assert!(exact == draw("g.exr", &["--method", "exact"]) && exact != own);
    let conflict = ["--method", "jittered", "--sampling", "tiles"];
    expect(&folder.render("h.exr", &conflict), 2, "every pixel");
}
