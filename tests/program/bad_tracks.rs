//! Wrong tracks, named with file, line, column and key.

use energywave::scene::AnimatedScene;

use crate::bad_scenes::check;

const CAMERA: &str = "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n";

/// What stands in the place of a sphere's radius, at which line and column (or key) of the file, and what is said.
const BAD: &[(&str, &str, &str)] = &[
    (
        "{ times = [0, 2, 1], values = [1, 2, 3] }",
        ":5:27: sphere[0].radius.times[2]:",
        "1 s is not later than the 2 s before it",
    ),
    (
        "{ times = [0, 0], values = [1, 2] }",
        "times[1]:",
        "0 s is not later",
    ),
    (
        "{ times = [0], values = [1] }",
        ":5:20: sphere[0].radius.times:",
        "one key is no motion",
    ),
    ("{ times = [], values = [] }", "times:", "is empty"),
    (
        "{ times = [0, 1], values = [1, 2, 3] }",
        "values:",
        "3 values for 2 times",
    ),
    (
        "{ times = [0, 1], values = [1, 2], interpolation = \"cubic\" }",
        "values:",
        "\"cubic\" takes three for each",
    ),
    (
        "{ times = [0, nan], values = [1, 2] }",
        "times[1]:",
        "not finite",
    ),
    (
        "{ times = [0, 1], values = [1, nan] }",
        "values[1]:",
        "not finite",
    ),
    (
        "{ times = [0, 1], values = [1, 1e10] }",
        "values[1]:",
        "beyond 1e9",
    ),
    (
        "{ times = [0, 1], values = [1, [2]] }",
        "values[1]:",
        "is a list of 1, the first value is a number",
    ),
    (
        "{ times = [0, 1], values = [[1, 2], [1]] }",
        "values[1]:",
        "is a list of 1, the first value is a list of 2",
    ),
    (
        "{ times = [0, 1], values = [[1, 2], [2, 3]] }",
        ":5:10: sphere[0].radius:",
        "expected a number",
    ),
    (
        "{ times = [0, 1], values = [1, 2], interpolation = \"liner\" }",
        "interpolation:",
        "did you mean `linear`?",
    ),
    (
        "{ times = [0, 1], values = [1, 2], loop = \"pingpong\" }",
        "loop:",
        "did you mean `ping-pong`?",
    ),
    (
        "{ times = [0, 1], values = [1, 2], speed = 2 }",
        ":5:45: sphere[0].radius.speed:",
        "unknown field `speed`",
    ),
    (
        "{ time = [0, 1], values = [1, 2] }",
        "radius.time:",
        "did you mean `times`?",
    ),
    (
        "{ times = [0, 1], values = [1, 2], phase = inf }",
        "phase:",
        "not finite",
    ),
    (
        "{ times = [0, 1], values = [\"a\", \"b\"] }",
        "values[0]:",
        "values that change by and by",
    ),
    (
        "{ times = [0, 1], values = [true, false] }",
        "values[0]:",
        "boolean `true`, expected a number",
    ),
    (
        "{ times = [0, 1], values = [{ a = 1 }, 2] }",
        "values[0]:",
        "no tables",
    ),
    (
        "{ times = [0, 1], values = [{ times = [0, 1], values = [1, 2] }, 2] }",
        "values[0]:",
        "a track stands in no track",
    ),
    (
        "{ times = [0, 1] }",
        "radius.values:",
        "required, but missing",
    ),
    (
        "{ values = [0, 1] }",
        "radius.times:",
        "required, but missing",
    ),
    (
        "{ times = [0, 1], values = [1, 2], value = 3 }",
        "radius.value:",
        "write either",
    ),
    ("{ value = 3 }", "radius.value:", "does not change"),
    (
        "{ noise = { amplitude = 1, frequency = 1 } }",
        "radius.noise:",
        "write a `value` beside it",
    ),
    (
        "{ value = [], noise = { amplitude = 1, frequency = 1 } }",
        "radius.value",
        "is empty",
    ),
    (
        "{ value = 1, noise = { amplitude = 1, frequency = -1 } }",
        ":5:60: sphere[0].radius.noise.frequency:",
        "must be positive",
    ),
    (
        "{ value = 1, noise = { amplitude = -1, frequency = 1 } }",
        "noise.amplitude:",
        "0 or more",
    ),
    (
        "{ value = 1, noise = { amplitude = [1, 2], frequency = 1 } }",
        "noise.amplitude:",
        "is a list of 2, the value is a number",
    ),
    (
        "{ value = 1, noise = { amplitude = 1, frequency = 1, octaves = 0 } }",
        "noise.octaves:",
        "must be 1 to 8, found 0",
    ),
    (
        "{ value = 1, noise = { amplitude = 1, frequency = 1, octaves = 1000 } }",
        "noise.octaves:",
        "found 1000",
    ),
    (
        "{ value = 1, noise = { amplitude = 1, frequency = 1, seed = 0.5 } }",
        "noise.seed:",
        "whole number",
    ),
    (
        "{ value = 1, noise = { amplitude = 1 } }",
        "noise.frequency:",
        "required, but missing",
    ),
    (
        "{ times = [0, 1], values = [-1, 2] }",
        ":5:10: sphere[0].radius:",
        "a thickness is positive, or 0 for none; found -1 (at 0 s)",
    ),
    (
        "1\nlayers = { times = [0, 1], values = [1, 2] }",
        ":6:",
        "there may be several",
    ),
    (
        "1\ntimes = [0, 1]",
        ":6:9: sphere[0].times:",
        "not of a whole table",
    ),
    (
        "1\nprofile = { times = [0, 1], values = [1, 2] }",
        ":6:11: sphere[0].profile:",
        "this stays as it is over time",
    ),
    (
        "1\n[image]\nheight = { times = [0, 1], values = [1, 2] }",
        ":7:10: image.height:",
        "this stays as it is over time",
    ),
    (
        "1\n[depth]\nfile = { times = [0, 1], values = [\"a\", \"b\"] }",
        ":7:8: depth.file:",
        "this stays as it is over time",
    ),
    (
        "1\n[time]\nloop = 0",
        ":7:8: time.loop:",
        "must be positive, found 0",
    ),
    ("1\n[time]\nloop = -2", "time.loop:", "must be positive"),
    (
        "1\n[time]\nloop = { times = [0, 1], values = [1, 2] }",
        "time.loop:",
        "expected a number",
    ),
    (
        "1\n[time]\nshutter = 1.5",
        ":7:11: time.shutter:",
        "a share of a frame from 0, not at all, to 1, all of it; found 1.5",
    ),
    ("1\n[time]\nshutter = -0.1", "time.shutter:", "found -0.1"),
    (
        "1\n[time]\nshutter = nan",
        "time.shutter:",
        "not a finite number",
    ),
    (
        "1\n[time]\nshutter = \"half\"",
        ":7:11: time.shutter:",
        "expected a number",
    ),
    (
        "1\n[time]\nshutters = 0.5",
        ":7:1: time.shutters:",
        "did you mean `shutter`?",
    ),
];

#[test]
fn a_wrong_track_is_named_with_its_place() {
    for (value, place, words) in BAD {
        let scene = format!("{CAMERA}[[sphere]]\nradius = {value}\n");
        check("a.toml", scene.as_bytes(), &["a.toml:", place, words]);
        let json: Result<serde_json::Value, _> = toml::from_str(&scene);
        // JSON has no infinity, and toml gives null for it.
        if let Ok(json) = json.map(|it| it.to_string())
            && !json.contains("null")
        {
            let key = place
                .rsplit(' ')
                .next()
                .unwrap()
                .trim_start_matches([':', '6', '1']);
            check("a.json", json.as_bytes(), &["a.json:", key, words]);
        }
    }
    let twice = br#"{"camera": {"eye": [0, -4, 2], "target": [0, 0, 0]}, "sphere": [{"radius":
        {"times": [0, 1], "values": [1, 2], "times": [0, 2]}}]}"#;
    check("a.json", twice, &["a.json:2:", "duplicate field `times`"]);
    let cut = &twice[..120];
    check("a.json", cut, &["a.json:2:", "EOF"]);
    let broken = format!(
        "{CAMERA}[[sphere]]\nradius = {{ times = [0, 1], values = [1, 2] }}\ncoefficient = .5\n"
    );
    check(
        "a.toml",
        broken.as_bytes(),
        &["a.toml:6:15: sphere[0].coefficient:", "write 0.5"],
    );
}

#[test]
fn a_value_that_is_wrong_at_a_time_says_when() {
    let text = format!(
        "{CAMERA}[[sphere]]\n[[sphere]]\nradius = {{ times = [0, 2], values = [1, -1] }}\n"
    );
    let scene = AnimatedScene::from_toml(text).unwrap();
    scene.at(0.5).unwrap();
    let error = scene.at(1.5).unwrap_err().to_string();
    assert_eq!(
        error,
        "scene:6:10: sphere[1].radius: a thickness is positive, or 0 for none; found -0.5 (at 1.5 s)"
    );
    let error = scene.at(f64::NAN).unwrap_err().to_string();
    assert!(error.contains("NaN is no time"), "{error}");
}
