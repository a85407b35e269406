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
        "positions = [[0, 0, 0]]\nprevious = [[0, 0, 0], [1, 1, 1]]\n",
        "6:12: points[0].previous",
        "2 values for 1 positions",
    ),
    (
        "positions = [[0, 0, 0]]\nprevious = [[1, 0, 0]]\n",
        "6:12: points[0].previous",
        "of the profile \"inverse\"",
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
        "file = \"nan.npy\"\n",
        "5:8: points[0].file",
        "nan.npy: y of point 1, column 2, is NaN",
    ),
    (
        "file = \"cut.npy\"\n",
        "5:8: points[0].file",
        "cut.npy: 23 bytes of numbers are not of shape (2, 3)",
    ),
    (
        "file = \"huge.npy\"\n",
        "5:8: points[0].file",
        "huge.npy: 24 bytes of numbers are not of shape (2147483648, 3)",
    ),
    (
        "file = \"nan.ply\"\n",
        "5:8: points[0].file",
        "nan.ply: z of point 1, column 3, is NaN",
    ),
    (
        "file = \"cut.ply\"\n",
        "5:8: points[0].file",
        "cut.ply: it ends within vertex 1 of 2",
    ),
    (
        "file = \"huge.ply\"\n",
        "5:8: points[0].file",
        "huge.ply: 2147483648 vertices; there may be",
    ),
    (
        "positions = [[0, 0, 0]]\n[integration]\ncrowd = \"always\"\n",
        "7:9: integration.crowd",
        "expected `auto` or `never`",
    ),
];

/// Returns a file of NumPy of float32.
fn npy(shape: &str, numbers: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [
        b"\x93NUMPY\x01\x00",
        &length[..],
        header.as_bytes(),
        numbers,
    ]
    .concat()
}

/// Returns vertices of three float32 each.
fn ply(count: u32, numbers: &[u8]) -> Vec<u8> {
    let properties = ["x", "y", "z"]
        .map(|name| format!("property float {name}\n"))
        .concat();
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{properties}end_header\n"
    );
    [header.as_bytes(), numbers].concat()
}

#[test]
fn bad_points_are_refused_with_their_place_and_nothing_is_written() {
    let folder = Folder::new();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("ragged.csv", "x,y,z\n1,2,3\n4,5\n");
    write("nan.csv", "1,2,3\n4,nan,5\n");
    write("unknown.csv", "x,y,z,mass\n1,2,3,4\n");
    let bytes = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let numbers = |numbers: [f32; 6]| numbers.map(f32::to_le_bytes).concat();
    let (right, nan) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], f32::NAN);
    bytes(
        "nan.npy",
        &npy("(2, 3)", &numbers([1.0, 2.0, 3.0, 4.0, nan, 6.0])),
    );
    bytes("cut.npy", &npy("(2, 3)", &numbers(right)[..23]));
    bytes("huge.npy", &npy("(2147483648, 3)", &numbers(right)));
    bytes("nan.ply", &ply(2, &numbers([1.0, 2.0, 3.0, 4.0, 5.0, nan])));
    bytes("cut.ply", &ply(2, &numbers(right)[..23]));
    bytes("huge.ply", &ply(1 << 31, &numbers(right)));
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
