//! The ways to integrate, as files and the program's options choose them, and what does not go together.

use energywave::scene::{Measure, Method, Reduction};
use energywave::{Device, ErrorKind, RadianceImage, Ray, Renderer, Scene};
use glam::DVec3;

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
    (
        "[integration]\nreduction = \"mean\"\n",
        "5:13: integration.reduction",
        "expected `sum` or `rms`",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[sphere]]\n[[torus]]\nmajor_radius = 1\n",
        "5:13: integration.reduction",
        "there are 2 sources: leave one, or write \"sum\"",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[group]]\nrepeat = { count = 3, step = [1, 0, 0] }\n[[group.sphere]]\n",
        "5:13: integration.reduction",
        "there are 3 sources",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[sphere]]\nlayers = [{ radius = 0.1 }, { radius = 0.2 }]\n",
        "7:10: sphere[0].layers",
        "takes the root of one light",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[group]]\n[[group.beam]]\ndirection = [1, 0, 0]\ntaper_length = 0.4\n",
        "9:16: group[0].beam[0].taper_length",
        "even along its core: leave this out",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[beam]]\ndirection = [1, 0, 0]\nsphere_coefficient = 0.4\n",
        "8:22: beam[0].sphere_coefficient",
        "one light",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[beam]]\ndirection = [1, 0, 0]\ncap_coefficient = 0.4\n",
        "8:19: beam[0].cap_coefficient",
        "one light",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[curve]]\ncontrol_points = [[0, 0, 0], [1, 1, 1], [1, 2, 1]]\nintensity = [1, 2, 3]\n",
        "8:13: curve[0].intensity",
        "even along its core",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[path]]\npoints = [[0, 0, 0], [1, 1, 1]]\nintensity = [1, 2]\n",
        "8:13: path[0].intensity",
        "even along its core",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[path]]\npoints = [[0, 0, 0], [1, 1, 1]]\ncolors = [\"#ff0000\", \"#00ff00\"]\n",
        "8:10: path[0].colors",
        "even along its core",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[sphere]]\nradius = 0.1\npeak = 2\n",
        "8:8: sphere[0].peak",
        "give a coefficient",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[sphere]]\nradius = 0.1\nlayers = [{ peak = 2 }]\n",
        "8:20: sphere[0].layers[0].peak",
        "give a coefficient",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nprofile = \"convolution\"\n",
        "9:11: segment[0].profile",
        "choose another profile, or reduction = \"sum\"",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[sphere]]\nprofile = \"inverse-cube\"\ncoefficient = 1000\n",
        "8:15: sphere[0].coefficient",
        "its square comes to",
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

#[test]
fn a_root_is_written_and_read_and_has_an_exposure_that_fits() {
    let scene = |reduction: &str| {
        let source = "[[sphere]]\nprofile = \"inverse\"\nradius = 0.02\n";
        Scene::from_toml(&format!("{CAMERA}[integration]\n{reduction}{source}")).unwrap()
    };
    let (sum, root) = (scene(""), scene("reduction = \"rms\"\n"));
    assert_eq!(sum.integration.reduction, Reduction::Sum);
    assert_eq!(root.integration.reduction, Reduction::Rms);
    for text in [sum.to_toml().unwrap(), sum.to_json().unwrap()] {
        assert!(!text.contains("reduction"), "{text}");
    }
    assert_eq!(Scene::from_toml(&root.to_toml().unwrap()).unwrap(), root);
    assert_eq!(Scene::from_json(&root.to_json().unwrap()).unwrap(), root);
    // Light is 1 beside the core, a share of the picture's height away from it.
    let mut device = Renderer::new(&Device::reference()).unwrap();
    let height = 2.0 * 20.0_f64.sqrt() * 22.5_f64.to_radians().tan();
    for measure in [Measure::Length, Measure::Parameter] {
        let mut root = root.clone();
        root.integration.measure = measure;
        let stops = root.fitting_exposure();
        let eye = root.camera.eye;
        let to = DVec3::new(0.008 * height, 0.0, 0.0) - eye;
        let ray = Ray::between(eye, eye + to.normalize() * root.ray_length());
        let light = device.integrate(&root, &[ray]).unwrap()[0][0];
        let shown = light * stops.exp2();
        assert!((0.9..1.1).contains(&shown), "{measure:?}: {shown}");
    }
}
