//! What is written wrongly is named with what to write instead; what a message repeats of others is escaped and short.

use std::process::Command;

use super::bad_scenes::{CAMERA, check};

/// Lines behind a valid [camera] of three lines, `/` for a line break; where the fault stands; words of the message.
const TOML: &str = r#"
near = .5 | 4:8: camera.near | `.5` is no number of TOML; write 0.5
near = 5. | 4:10: camera.near | write 5.0
near = 1,5 | 4:9: camera.near | write 1.5
near = 0,5 # m | 4:9: camera.near | write 0.5
near = 1e | 4:10: camera.near | `1e` is no number of TOML
near = +-1 | 4:9: camera.near | write -1.0
near = 0x | 4:8: camera.near | `0x` is no number of TOML
near = 01 | 4:8: camera.near | write 1.0
near = 0.5f | 4:11: camera.near | write 0.5
near = 45° | 4:8: camera.near | write 45.0
near = | 4:7: camera.near | there is no value
fov = 45 | 4:1: camera.fov | did you mean `fov_y`?
fovY = 45 | 4:1: camera.fovY | did you mean `fov_y`?
major_radius = 1 | 4:1: camera.major_radius | [[torus]] has a key of this name
[integration]/method = "simson" | 5:10: integration.method | did you mean `simpson`?
[[torus]]/major_radius = 1/color_ = 1 | 6:1: torus[0].color_ | did you mean `color`?
[[torsu]]/major_radius = 1 | 4:3: torsu | did you mean `torus`?
near = NaN | 4:8: camera.near | a finite one
near = "0.5" | 4:8: camera.near | expected a number; write 0.5
near = "inf" | 4:8: camera.near | expected a number
near = inf | 4:8: camera.near | not a finite number
near = 99999999999999999999 | 4:8: camera.near | write 1e20
up = [.5, 0, 1] | 4:7: camera.up | `.5` is no number of TOML; write 0.5
up = { x = 0 } | 4:6: camera.up | a table, expected a list, such as [0.0, 0.0, 1.0]
[image]/width = 5. | 5:11: image.width | write 5
[image]/width = 5.0 | 5:9: image.width | write 5
[display]/tone_map = aces | 5:12: display.tone_map | words in quotes, "aces"
[[torus]]/major_radius = 1/[[torus]]/major_radius = .5 | 7:16: torus[1].major_radius | write 0.5
[torus]/major_radius = 1 | 4:1: torus | write double brackets, [[torus]]
[[decay]]/alpha = 1/beta = 1 | 4:1: decay | write single brackets, [decay]
"\u001b[31mred" = 1 | 4:1: camera.\u{1b}[31mred | unknown field `\u{1b}[31mred`
"a\nb\u202e" = 1 | 4:1: camera.a\nb\u{202e} | unknown field
"#;

/// What follows a valid camera in JSON, and words of the message.
const JSON: &str = r#"
}, "torus": {"major_radius": 1}} | torus: there may be several: write a list of them, also of one: "torus": [{ }]
}, "toruses": 5} | did you mean `torus`?
}, "torus": 5} | torus: there may be several
, "near": .5}} | camera.near: `.5` is no number of JSON; write 0.5
, "near": 5.}} | camera.near: `5.` is no number of JSON; write 5.0
, "near": 1,5}} | `1,5` is no number of JSON; write 1.5
, "near": NaN}} | camera.near: `NaN` is no number
, "near": "0.5"}} | camera.near: invalid type: string "0.5", expected a number; write 0.5
}, "image": [{"width": 5}]} | image: a scene has one, no list of them: write "image": { }
}, "\u001b[2J": 1} | unknown field `\u{1b}[2J`
"#;

#[test]
fn what_is_written_wrongly_is_named_with_what_to_write() {
    for case in TOML.lines().skip(1) {
        let [rest, place, words] = [0, 1, 2].map(|part| case.split(" | ").nth(part).unwrap());
        let scene = format!("{CAMERA}{}\n", rest.replace('/', "\n"));
        check(
            "scene.toml",
            scene.as_bytes(),
            &[&format!("scene.toml:{place}"), words],
        );
    }
    for case in JSON.lines().skip(1) {
        let (rest, words) = case.split_once(" | ").unwrap();
        let scene = format!(r#"{{"camera": {{"eye": [0, -4, 2], "target": [0, 0, 0]{rest}"#);
        check("scene.json", scene.as_bytes(), &[words]);
    }
}

#[test]
fn what_a_message_repeats_of_a_file_or_of_what_was_typed_is_short() {
    let long = "k".repeat(100_000);
    let scene = format!("{CAMERA}{long} = 1\n");
    check(
        "scene.toml",
        scene.as_bytes(),
        &["camera.kkk", "…", "expected one of `eye`"],
    );
    let quoted = format!("{CAMERA}near = \"{long}\"\n");
    check(
        "scene.toml",
        quoted.as_bytes(),
        &["4:8: camera.near", "…", "expected a number"],
    );
    let twice = format!("{CAMERA}{long} = 1\n{long} = 1\n");
    check("scene.toml", twice.as_bytes(), &["5:1:", "duplicate key"]);
    let depth = format!("{CAMERA}[depth]\nfile = \"\\u001b{}\"\n", &long[..300]);
    check(
        "scene.toml",
        depth.as_bytes(),
        &["depth.file", "\\u{1b}", "…"],
    );
    let json = format!("{{\"{long}\": 1}}");
    check("scene.json", json.as_bytes(), &["unknown field", "…"]);

    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), CAMERA).unwrap();
    let typed = format!("\u{1b}[31m{}", &long[..50_000]);
    for arguments in [
        vec!["render", "scene.toml", "-o", "o.png", "--device", &typed],
        vec!["render", &typed, "-o", "o.png"],
        vec!["render", "scene.toml", "-o", &typed],
        vec!["render", "scene.toml", "-o", "o.png", "--size", &typed],
        vec![typed.as_str()],
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_energywave"));
        let output = command
            .args(&arguments)
            .current_dir(folder.path())
            .output()
            .unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success());
        assert!(
            message.len() < 2000 && !message.contains('\u{1b}'),
            "{message:?}"
        );
        assert!(
            message.contains("kkk") && message.contains('…'),
            "{message}"
        );
    }
}
