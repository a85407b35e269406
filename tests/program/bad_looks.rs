//! Every fault of layers, groups and paths is named with its place, in TOML and in JSON.

use crate::bad_scenes::{CAMERA, check};
use energywave::Scene;

/// What follows a valid [camera] of three lines; where the fault stands; words of the message.
const BAD_PATHS: &[(&str, &str, &str)] = &[
    ("[[path]]\n", "4:1: path[0].points", "required, but missing"),
    (
        "[[path]]\npoints = []\n",
        "5:10: path[0].points",
        "a path has at least two points, found 0",
    ),
    (
        "[[path]]\npoints = [[0, 0, 0]]\n",
        "5:10: path[0].points",
        "a path has at least two points, found 1",
    ),
    (
        "[[path]]\npoints = [[0, 0, 0], [1, 0]]\n",
        "5:22: path[0].points[1]",
        "expected three numbers, found 2",
    ),
    (
        "[[path]]\npoints = [[0, 0, 0], [1, nan, 0]]\n",
        "5:22: path[0].points[1]",
        "NaN is not a finite number",
    ),
    (
        "[[path]]\nshape = \"quadratic\"\npoints = [[0, 0, 0], [1, 0, 0]]\n",
        "6:10: path[0].points",
        "2 points make no open chain of quadratic curves: end and control point in turn, such as 3 or 5 points",
    ),
    (
        "[[path]]\nshape = \"cubic\"\nclosed = true\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\n",
        "7:10: path[0].points",
        "4 points make no closed chain of cubic curves: an end and two control points in turn, such as 6 or 9 points",
    ),
    (
        "[[path]]\nshape = \"zigzag\"\npoints = [[0, 0, 0], [1, 0, 0]]\n",
        "5:9: path[0].shape",
        "expected one of `polyline`, `spline`, `quadratic`, `cubic`",
    ),
    (
        "[[path]]\nflatness = 0\npoints = [[0, 0, 0], [1, 0, 0]]\n",
        "5:12: path[0].flatness",
        "must be positive",
    ),
];

/// What follows a valid [camera] of three lines; where the fault stands; words of the message.
const BAD_LAYERS: &[(&str, &str, &str)] = &[
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

const BAD_GROUPS: &[(&str, &str, &str)] = &[
    (
        "[[group]]\nscale = 0\n",
        "5:9: group[0].scale",
        "must be positive, found 0",
    ),
    (
        "[[group]]\nscale = -2\n",
        "5:9: group[0].scale",
        "must be positive, found -2",
    ),
    (
        "[[group]]\nscale = [1, 2, 3]\n",
        "5:9: group[0].scale",
        "expected a number",
    ),
    (
        "[[group]]\ntranslate = [0, 0]\n",
        "5:13: group[0].translate",
        "expected three numbers, found 2",
    ),
    (
        "[[group]]\ntranslate = [0, 0, 1e10]\n",
        "5:13: group[0].translate",
        "1e10 is beyond 1e9",
    ),
    (
        "[[group]]\nrotate = { axis = [0, 0, 0], angle = 5 }\n",
        "5:19: group[0].rotate.axis",
        "zero vector",
    ),
    (
        "[[group]]\nrotate = { axis = [0, 0, 1] }\n",
        "5:10: group[0].rotate.angle",
        "required, but missing",
    ),
    (
        "[[group]]\nrotate = { axis = [0, 0, 1], angle = inf }\n",
        "5:38: group[0].rotate.angle",
        "not a finite number",
    ),
    (
        "[[group]]\nrepeat = { count = 0, axis = [0, 0, 1] }\n",
        "5:20: group[0].repeat.count",
        "0 copies; give from 1 to 10000",
    ),
    (
        "[[group]]\nrepeat = { count = 1_000_000, axis = [0, 0, 1] }\n",
        "5:20: group[0].repeat.count",
        "1000000 copies; give from 1 to 10000",
    ),
    (
        "[[group]]\nrepeat = { count = -1, axis = [0, 0, 1] }\n",
        "5:20: group[0].repeat.count",
        "a whole number from 0",
    ),
    (
        "[[group]]\nrepeat = { count = 2.0, axis = [0, 0, 1] }\n",
        "5:20: group[0].repeat.count",
        "whole number from 0 to 4294967295; write 2",
    ),
    (
        "[[group]]\nrepeat = { axis = [0, 0, 1] }\n",
        "5:10: group[0].repeat.count",
        "required, but missing",
    ),
    (
        "[[group]]\nrepeat = { count = 3, axis = [0, 0, 0] }\n",
        "5:30: group[0].repeat.axis",
        "zero vector",
    ),
    (
        "[[group]]\nrepeat = { count = 3, angle = 20 }\n",
        "5:31: group[0].repeat.angle",
        "an angle needs an axis",
    ),
    (
        "[[group]]\nrepeat = { count = 3 }\n",
        "5:10: group[0].repeat",
        "give an axis or a step",
    ),
    (
        "[[group]]\nrepeat = { count = 3, step = [nan, 0, 0] }\n",
        "5:30: group[0].repeat.step",
        "not a finite number",
    ),
    (
        "[[group]]\nrepeat = { count = 3, stop = [1, 0, 0] }\n",
        "5:23: group[0].repeat.stop",
        "unknown field `stop`, expected one of `count`",
    ),
    (
        "[[group]]\nturn = 5\n",
        "5:1: group[0].turn",
        "unknown field `turn`, expected one of `scale`",
    ),
    (
        "[group]\nscale = 1\n",
        "4:1: group",
        "write double brackets, [[group]]",
    ),
    (
        "[[group]]\n[group.torus]\nmajor_radius = 1\n",
        "5:1: group[0].torus",
        "write double brackets, [[group.torus]]",
    ),
    (
        "[[group]]\n[[group.camera]]\neye = [0, 0, 1]\n",
        "5:9: group[0].camera",
        "unknown field `camera`",
    ),
    (
        "[[group]]\n[[group]]\n[[group.torus]]\naxis = [0, 0, 1]\n",
        "6:1: group[1].torus[0].major_radius",
        "required, but missing",
    ),
    (
        "[[group]]\n[[group]]\nscale = 3\n[[group.segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nradius = -0.5\n",
        "10:10: group[1].segment[0].radius",
        "0 for none; found -0.5",
    ),
    (
        "[[group]]\n[[group]]\n[[group.sphere]]\ncenter = [0, .5, 0]\n",
        "7:14: group[1].sphere[0].center",
        "write 0.5",
    ),
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\n[[group]]\n[[group]]\nrepeat = { count = 3, step = [0, 4e8, 0] }\n\
         [[group.segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\n[[group.segment]]\nfrom = [0, 5e8, 0]\nto = [1, 0, 0]\n",
        "14:8: group[1].segment[1].from",
        "1.3e9 is beyond 1e9, what float32 devices can integrate (where its group puts it)",
    ),
    (
        "[[group]]\nscale = 1e6\n[[group.group]]\nscale = 1e6\n[[group.group.group]]\n[[group.group.group.torus]]\nmajor_radius = 1\n",
        "10:16: group[0].group[0].group[0].torus[0].major_radius",
        "1e12 is beyond 1e9",
    ),
];

#[test]
fn a_fault_of_a_group_is_named_with_file_line_column_and_key() {
    for (rest, place, words) in BAD_GROUPS {
        let scene = format!("{CAMERA}{rest}");
        let place = format!("scene.toml:{place}");
        check("scene.toml", scene.as_bytes(), &[&place, words]);
    }
}

#[test]
fn groups_are_eight_deep_and_make_a_million_sources_and_no_more() {
    let deep = |depth: usize| {
        let names: Vec<String> = (1..=depth).map(|n| vec!["group"; n].join(".")).collect();
        let tables: String = names.iter().map(|name| format!("[[{name}]]\n")).collect();
        let last = names.last().unwrap();
        format!("{CAMERA}{tables}[[{last}.sphere]]\n")
    };
    assert_eq!(Scene::from_toml(&deep(8)).unwrap().spheres.len(), 1);
    let words =
        "group[0].group[0].group[0].group[0].group[0]: groups stand in each other at most 8 deep";
    check(
        "deep.toml",
        deep(9).as_bytes(),
        &["deep.toml:12:1: ", words],
    );
    let many = |count: usize| {
        let repeat = |count| format!("repeat = {{ count = {count}, axis = [0, 0, 1] }}\n");
        format!(
            "{CAMERA}[[group]]\n[[group]]\n{}[[group.group]]\n{}[[group.group.sphere]]\nreach = 0.5\n",
            repeat(1000),
            repeat(count)
        )
    };
    let place =
        "many.toml:5:1: group[1]: groups make 1001000 sources, more than 1000000: repeat less";
    check("many.toml", many(1001).as_bytes(), &[place]);
    assert_eq!(Scene::from_toml(&many(3)).unwrap().spheres.len(), 3000);
}

#[test]
fn a_fault_of_a_group_in_json_has_its_key() {
    for (group, words) in [
        (
            "{}",
            "group: there may be several: write a list of them, also of one: \"group\": [{ }]",
        ),
        ("[{\"scale\": 0}]", "group[0].scale: must be positive"),
        (
            "[{}, {\"sphere\": [{\"radius\": -1}]}]",
            "group[1].sphere[0].radius: a thickness",
        ),
        (
            "[{\"scale\": 1e9, \"torus\": [{\"major_radius\": 5}]}]",
            "group[0].torus[0].major_radius: 5e9 is beyond",
        ),
    ] {
        let scene = format!(
            "{{\"camera\": {{\"eye\": [0, -4, 2], \"target\": [0, 0, 0]}}, \"group\": {group}}}"
        );
        check("scene.json", scene.as_bytes(), &[words]);
    }
}

#[test]
fn a_fault_of_a_path_or_a_layer_is_named_with_file_line_column_and_key() {
    for (rest, place, words) in BAD_PATHS.iter().chain(BAD_LAYERS) {
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
