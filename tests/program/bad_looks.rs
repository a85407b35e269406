//! Every fault of layers is named with its place, in TOML and in JSON.

use crate::bad_scenes::{CAMERA, check};
use energywave::Scene;

/// What follows a valid [camera] of three lines; where the fault stands; words of the message.
const BAD: &[(&str, &str, &str)] = &[
    (
        "[[sphere]]\nlayers = []\n",
        "5:10: sphere[0].layers",
        "an empty list of layers is no light: leave layers out",
    ),
    (
        "[[sphere]]\nlayers = { radius = 1 }\n",
        "5:10: sphere[0].layers",
        "there may be several: write a list of them, also of one: layers = [{ }]",
    ),
    (
        "[[sphere]]\nlayers = [{ radius = 1 }, { radius = -1 }]\n",
        "5:38: sphere[0].layers[1].radius",
        "a thickness is positive, or 0 for none; found -1",
    ),
    (
        "[[sphere]]\nlayers = [{ color = [1, 1] }]\n",
        "5:21: sphere[0].layers[0].color",
        "expected three numbers, found 2",
    ),
    (
        "[[sphere]]\nlayers = [{ zoom = 1 }]\n",
        "5:13: sphere[0].layers[0].zoom",
        "unknown field `zoom`, expected one of `coefficient`",
    ),
    (
        "[[sphere]]\nradius = 0.5\nlayers = [{ color = [1, 1, 1] }, { reach = 0.4 }]\n",
        "6:44: sphere[0].layers[1].reach",
        "make reach larger",
    ),
    (
        "[[sphere]]\nreach = 0.5\nlayers = [{ radius = 0.6 }]\n",
        "5:9: sphere[0].reach",
        "a core of the radius 0.6: make reach larger",
    ),
    (
        "[[sphere]]\nradius = -0.5\nlayers = [{ radius = 1 }]\n",
        "5:10: sphere[0].radius",
        "a thickness is positive",
    ),
    (
        "[[sphere]]\nlayers = [{ profile = \"gaussian\" }]\n",
        "5:11: sphere[0].layers[0].radius",
        "give one, such as 0.1",
    ),
    (
        "[[sphere]]\nlayers = [{ coefficient = 2, peak = 1, radius = 1 }]\n",
        "5:37: sphere[0].layers[0].peak",
        "takes the place of coefficient: leave one of them out",
    ),
    (
        "[integration]\nmeasure = \"parameter\"\n[[sphere]]\nlayers = [{ peak = 1, radius = 1 }]\n",
        "7:20: sphere[0].layers[0].peak",
        "write measure = \"length\"",
    ),
    (
        "[[torus]]\nmajor_radius = 1\nlayers = [{ coefficient = 1e30 }]\n",
        "6:27: torus[0].layers[0].coefficient",
        "beyond 1e9",
    ),
    (
        "[[torus]]\nmajor_radius = 1\n[[torus.layers]]\nradius = 1\n[[torus.layers]]\nreach = 0\n",
        "9:9: torus[0].layers[1].reach",
        "must be positive",
    ),
];

#[test]
fn a_fault_of_a_layer_is_named_with_file_line_column_and_key() {
    for (rest, place, words) in BAD {
        let scene = format!("{CAMERA}{rest}");
        let place = format!("scene.toml:{place}");
        check("scene.toml", scene.as_bytes(), &[&place, words]);
    }
}

#[test]
fn a_core_has_sixteen_layers_and_no_more() {
    let scene = |count| format!("{CAMERA}[[sphere]]\nlayers = [{}]\n", "{},".repeat(count));
    assert_eq!(
        Scene::from_toml(&scene(16)).unwrap().spheres[0]
            .layers
            .len(),
        16
    );
    let error = Scene::from_toml(&scene(17)).unwrap_err().to_string();
    assert!(
        error.contains("5:10: sphere[0].layers: 17 layers on one core; give at most 16"),
        "{error}"
    );
}

#[test]
fn a_fault_of_a_layer_in_json_has_its_key() {
    for (layers, words) in [
        (
            "[{}, {\"radius\": -1}]",
            "sphere[0].layers[1].radius: a thickness",
        ),
        ("[]", "sphere[0].layers: an empty list"),
        ("{}", "sphere[0].layers: there may be several"),
    ] {
        let scene = format!(
            "{{\"camera\": {{\"eye\": [0, -4, 2], \"target\": [0, 0, 0]}}, \"sphere\": [{{\"layers\": {layers}}}]}}"
        );
        check("scene.json", scene.as_bytes(), &[words]);
    }
}
