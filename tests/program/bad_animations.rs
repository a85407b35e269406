//! Animations that cannot be: each is refused with its reason, and nothing is written.

use std::fs;

use crate::animate::{CAMERA, RING, scene, sorted};
use crate::common::program::{Folder, expect};

#[test]
fn what_is_wrong_is_said_before_anything_is_written() {
    let folder = Folder::new();
    scene(&folder, "a.toml", "");
    let noise = "radius = { value = 0.2, noise = { amplitude = 0.1, frequency = 3 } }";
    let noisy = format!("{CAMERA}[[sphere]]\n{noise}\n");
    let shrinking = "[[sphere]]\nradius = { times = [0, 2], values = [0.5, -0.1] }\n";
    for (name, text) in [
        ("still.toml", format!("{CAMERA}[[sphere]]\nradius = 0.2\n")),
        ("noisy.toml", noisy),
        ("shrinks.toml", format!("{CAMERA}{shrinking}")),
        (
            "clear.toml",
            format!("{CAMERA}{RING}[display]\nalpha = \"luminance\"\n"),
        ),
        ("long.toml", format!("{CAMERA}[time]\nloop = 1e8\n{RING}")),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    fs::create_dir(folder.path().join("folder")).unwrap();
    let before = sorted(&folder);
    let wrong: [(&[&str], i32, &str); 34] = [
        (
            &["a.toml", "-o", "f.png", "--frames", ""],
            2,
            "frames are numbers from 0",
        ),
        (
            &["a.toml", "-o", "f.png", "--frames", "5..4"],
            2,
            "frames run forwards: 4..5",
        ),
        (
            &["a.toml", "-o", "f.png", "--frames", "-3..4"],
            2,
            "frames are numbers from 0",
        ),
        (
            &["a.toml", "-o", "f.png", "--frames", "0..1e9"],
            2,
            "such as 0..239",
        ),
        (
            &["a.toml", "-o", "f.png", "--fps", "0"],
            2,
            "a rate is a number of frames a second above 0",
        ),
        (
            &["a.toml", "-o", "f.png", "--fps", "-24"],
            2,
            "a rate is a number",
        ),
        (
            &["a.toml", "-o", "f.png", "--fps", "nan"],
            2,
            "a rate is a number",
        ),
        (
            &["a.toml", "-o", "f.png", "--fps", "1/0"],
            2,
            "a rate is a number",
        ),
        (
            &["a.toml", "-o", "f.png", "--shard", "3/2"],
            2,
            "a shard is one of N shares",
        ),
        (
            &["a.toml", "-o", "f.png", "--shard", "0/2"],
            2,
            "a shard is one of N shares",
        ),
        (
            &["a.toml", "-o", "f.png", "--flipbook", "0x4"],
            2,
            "a flipbook has columns and rows",
        ),
        (
            &["a.toml", "-o", "f.png", "--flipbook", "4"],
            2,
            "a flipbook has columns and rows",
        ),
        (
            &["a.toml", "-o", "f.png", "--padding", "4"],
            2,
            "--flipbook",
        ),
        (
            &[
                "a.toml",
                "-o",
                "f.png",
                "--flipbook",
                "9x9",
                "--padding",
                "-1",
            ],
            2,
            "a padding is",
        ),
        (
            &["a.toml", "-o", "f.png", "--flipbook", "4x4"],
            2,
            "61 frames, and 4x4 cells are 16",
        ),
        (
            &["a.toml", "-o", "f.png", "--flipbook", "900x1"],
            2,
            "900x1 frames of 24x16 pixels, 0 around each, has 21600x16",
        ),
        (
            &[
                "a.toml",
                "-o",
                "f.png",
                "--flipbook",
                "4294967295x4294967295",
            ],
            2,
            "at most 16384x16384",
        ),
        (
            &["a.toml", "-o", "f.apng", "--flipbook", "9x9"],
            2,
            "it is a .png or an .exr",
        ),
        (
            &["a.toml", "-o", "-", "--flipbook", "9x9"],
            2,
            "in a file that a JSON is beside",
        ),
        (
            &[
                "a.toml",
                "-o",
                "f.png",
                "--flipbook",
                "9x9",
                "--shard",
                "1/2",
            ],
            2,
            "a flipbook needs all frames",
        ),
        (
            &["a.toml", "-o", "f.apng", "--shard", "1/2"],
            2,
            "one file needs all frames",
        ),
        (
            &["a.toml", "-o", "f.apng", "--fps", "70000"],
            2,
            "fractions of numbers up to 65535",
        ),
        (
            &["a.toml", "-o", "f.gif"],
            2,
            "f.gif: unknown ending of frames; use .png or .exr",
        ),
        (
            &["a.toml", "-o", "-", "--format", "png"],
            2,
            "frames are numbered files",
        ),
        (
            &["a.toml", "-o", "-", "--json"],
            2,
            "--json: its report would stand between the frames",
        ),
        (
            &["a.toml", "-o", "none/f.png"],
            7,
            "there is no folder none; create it first",
        ),
        (
            &["a.toml", "-o", "none/f.##.exr"],
            7,
            "there is no folder none; create it first",
        ),
        (
            &["a.toml", "-o", "folder", "--format", "png"],
            7,
            "it is a folder; name the frames in it",
        ),
        (
            &["still.toml", "-o", "f.png"],
            2,
            "nothing moves in the scene",
        ),
        (&["noisy.toml", "-o", "f.png"], 2, "noise, which has no end"),
        (
            &["long.toml", "-o", "f.png"],
            2,
            "the scene moves for 100000000 s",
        ),
        (&["shrinks.toml", "-o", "f.png"], 3, "shrinks.toml:5:"),
        (
            &["clear.toml", "-o", "f.y4m"],
            3,
            "display.alpha: Y4M has no alpha",
        ),
        (
            &["a.toml", "-o", "f.y4m", "--bits", "16"],
            3,
            "16 bits a channel; Y4M has 8",
        ),
    ];
    for (arguments, code, words) in wrong {
        let all = [&["animate"], arguments, &["--device", "reference"]].concat();
        let output = folder.run(&all);
        expect(&output, code, words);
        assert!(output.stdout.is_empty(), "{arguments:?}");
        assert_eq!(sorted(&folder), before, "{arguments:?}");
    }
    let shrinks = folder.run(&["animate", "shrinks.toml", "-o", "f.png"]);
    expect(&shrinks, 3, "(at 1.");
}
