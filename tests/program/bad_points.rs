//! Every fault of points of light: exit code 3, file, line, column and key, and nothing written.

use crate::common::program::{Folder, expect};

const CAMERA: &str = "[camera]\neye = [0.0, -9.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\n[[points]]\n";

/// What follows the header in line 4; where the fault stands; words of the message.
const BAD: &[(&str, &str, &str)] = &[
    (
        "position = [[0, 0, 0]]\n",
        "5:1: points[0].position",
        "did you mean `positions`?",
    ),
    (
        "positions = [[0, 0, 0], [nan, 0, 0]]\n",
        "5:13: points[0].positions",
        "particle 1 is at",
    ),
    (
        "positions = [[0, 0]]\n",
        "5:14: points[0].positions",
        "three numbers",
    ),
    (
        "positions = [[0, 0, 0]]\ncolors = [[1, 1, 1], [1, 0, 0]]\n",
        "6:10: points[0].colors",
        "2 values for 1 positions",
    ),
    (
        "positions = [[0, 0, 0]]\ncoefficients = []\n",
        "6:16: points[0].coefficients",
        "0 values for 1 positions",
    ),
    (
        "profile = \"gaussian\"\n",
        "5:11: points[0].profile",
        "\"inverse-square\"",
    ),
    ("radius = -1\n", "5:10: points[0].radius", "0 for none"),
    ("reach = 0\n", "5:9: points[0].reach", "must be positive"),
    (
        "positions = [[0, 0, 0]]\nfile = \"a.csv\"\n",
        "5:13: points[0].positions",
        "write one of both",
    ),
    (
        "file = \"a.xyz\"\n",
        "5:8: points[0].file",
        "end in .csv, .npy or .ply",
    ),
    (
        "file = \"none.csv\"\n",
        "5:8: points[0].file",
        "cannot read",
    ),
    (
        "file = \"ragged.csv\"\n",
        "5:8: points[0].file",
        "ragged.csv:3: 2 columns, the lines before have 3",
    ),
    (
        "file = \"nan.csv\"\n",
        "5:8: points[0].file",
        "nan.csv:2: column 2, y: \"nan\" is no number",
    ),
    (
        "file = \"unknown.csv\"\n",
        "5:8: points[0].file",
        "unknown.csv:1: column 4 is called \"mass\"",
    ),
    (
        "positions = [[0, 0, 0]]\n[integration]\ncrowd = \"always\"\n",
        "7:9: integration.crowd",
        "expected `auto` or `never`",
    ),
];

#[test]
fn bad_points_are_refused_with_their_place_and_nothing_is_written() {
    let folder = Folder::new();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("ragged.csv", "x,y,z\n1,2,3\n4,5\n");
    write("nan.csv", "1,2,3\n4,nan,5\n");
    write("unknown.csv", "x,y,z,mass\n1,2,3,4\n");
    for (text, place, words) in BAD {
        write("bad.toml", &format!("{CAMERA}{text}"));
        let render = [
            "render",
            "bad.toml",
            "-o",
            "out.png",
            "--device",
            "reference",
        ];
        let output = folder.run(&render);
        expect(&output, 3, &format!("bad.toml:{place}"));
        expect(&output, 3, words);
        assert!(!folder.names().contains(&"out.png".to_owned()), "{text}");
    }
}
