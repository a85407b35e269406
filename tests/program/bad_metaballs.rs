//! Every fault of surfaces and their particles: exit code 3, file, line, column and key, and nothing written.

use crate::common::program::{Folder, expect};

const CAMERA: &str = "[camera]\neye = [0.0, -9.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\n[[metaballs]]\n";

/// What follows the header in line 4; where the fault stands; words of the message.
const BAD: &[(&str, &str, &str)] = &[
    (
        "radios = 1\n",
        "5:1: metaballs[0].radios",
        "did you mean `radius`?",
    ),
    (
        "radius = 0\n",
        "5:10: metaballs[0].radius",
        "must be positive",
    ),
    (
        "radius = nan\n",
        "5:10: metaballs[0].radius",
        "not a finite number",
    ),
    (
        "threshold = -1\n",
        "5:13: metaballs[0].threshold",
        "must be positive",
    ),
    (
        "threshold = inf\n",
        "5:13: metaballs[0].threshold",
        "not a finite number",
    ),
    (
        "kernel = \"cones\"\n",
        "5:10: metaballs[0].kernel",
        "did you mean `cone`?",
    ),
    (
        "method = \"sampled\"\n",
        "5:10: metaballs[0].method",
        "`sampling`",
    ),
    (
        "samples = 0\n",
        "5:11: metaballs[0].samples",
        "there are 1 to 65536",
    ),
    (
        "interval = 0\n",
        "5:12: metaballs[0].interval",
        "must be positive",
    ),
    (
        "color = [1, -0.5, 0]\n",
        "5:9: metaballs[0].color",
        "0 or more",
    ),
    (
        "points = [[0, 0]]\n",
        "5:11: metaballs[0].points",
        "expected three numbers, found 2",
    ),
    (
        "points = [[0, 0, 0], [0, nan, 0]]\n",
        "5:10: metaballs[0].points",
        "particle 1 is at 0, NaN, 0",
    ),
    (
        "points = [[0, inf, 0]]\n",
        "5:10: metaballs[0].points",
        "particle 0 is at 0, inf, 0",
    ),
    (
        "points = [[0, 0, 0]]\nfile = \"a.csv\"\n",
        "6:8: metaballs[0].file",
        "`points` says already",
    ),
    (
        "translate = [2e9, 0, 0]\n",
        "5:13: metaballs[0].translate",
        "beyond 1e9",
    ),
    (
        "lattice = { count = 8, spacing = 0 }\n",
        "5:34: metaballs[0].lattice.spacing",
        "must be positive",
    ),
    (
        "lattice = { spacing = 1 }\n",
        "5:11: metaballs[0].lattice",
        "count",
    ),
    (
        "lattice = { count = -8, spacing = 1 }\n",
        "5:21: metaballs[0].lattice.count",
        "a whole number from 0",
    ),
    (
        "lattice = { columns = [0, 4], count = 8, spacing = 1 }\n",
        "5:23: metaballs[0].lattice.columns",
        "whole numbers, 1 or more",
    ),
    (
        "lattice = { columns = [2.5, 4], count = 8, spacing = 1 }\n",
        "5:23: metaballs[0].lattice.columns",
        "whole numbers, 1 or more",
    ),
    (
        "lattice = { count = 8, spacing = 1, jitter = 2 }\n",
        "5:46: metaballs[0].lattice.jitter",
        "a share of the spacing",
    ),
    (
        "lattice = { count = 4000000000, spacing = 1 }\n",
        "5:21: metaballs[0].lattice.count",
        "there may be 134217728",
    ),
    (
        "file = \"none.csv\"\n",
        "5:8: metaballs[0].file",
        "none.csv: cannot read",
    ),
    (
        "file = \"short.csv\"\n",
        "5:8: metaballs[0].file",
        "short.csv:3: 2 numbers, the lines before have 3",
    ),
    (
        "file = \"words.csv\"\n",
        "5:8: metaballs[0].file",
        "words.csv:2: \"two\" is no number",
    ),
    (
        "file = \"nan.csv\"\n",
        "5:8: metaballs[0].file",
        "nan.csv: particle 0 is at NaN, 0, 0",
    ),
    (
        "file = \"weight.csv\"\n",
        "5:8: metaballs[0].file",
        "the weight of particle 0 is -1; it is positive",
    ),
    (
        "file = \"cut.f32\"\n",
        "5:8: metaballs[0].file",
        "cut.f32: 13 bytes are no multiple of 12",
    ),
    (
        "file = \"a.npy\"\n",
        "5:8: metaballs[0].file",
        "a.npy: it does not begin as a .npy of NumPy does",
    ),
    (
        "file = \"a.ply\"\n",
        "5:8: metaballs[0].file",
        "a.ply: it does not begin as a PLY file does",
    ),
    (
        "file = \"a.obj\"\n",
        "5:8: metaballs[0].file",
        "particles are in files that end in .csv",
    ),
    (
        "radius = { times = [0, 1], values = [0, 1] }\n",
        "5:10: metaballs[0].radius",
        "must be positive, found 0 (at 0 s)",
    ),
];

#[test]
fn every_bad_surface_is_refused_with_its_place_and_nothing_is_written() {
    let folder = Folder::new();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    write("short.csv", b"# x y z\n1,2,3\n1,2\n");
    write("words.csv", b"x,y,z\n1,two,3\n");
    write("nan.csv", b"nan,0,0\n");
    write("weight.csv", b"0,0,0,1,-1\n");
    write("cut.f32", &[0; 13]);
    for name in ["a.npy", "a.ply"] {
        write(name, b"nothing of the kind");
    }
    for (text, place, words) in BAD {
        write("bad.toml", format!("{CAMERA}{text}").as_bytes());
        let output = folder.run(&[
            "render",
            "bad.toml",
            "-o",
            "out.png",
            "--device",
            "reference",
        ]);
        expect(&output, 3, &format!("bad.toml:{place}"));
        expect(&output, 3, words);
        assert!(!folder.names().contains(&"out.png".to_owned()), "{text}");
    }
    let one = CAMERA.replace("[[metaballs]]", "[metaballs]");
    write("bad.toml", one.as_bytes());
    let output = folder.run(&[
        "render",
        "bad.toml",
        "-o",
        "out.png",
        "--device",
        "reference",
    ]);
    expect(&output, 3, "write double brackets, [[metaballs]]");
}
