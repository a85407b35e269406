//! Every fault of particles as light: exit code 3, file, line, column and key, and nothing written.

use crate::common::program::{Folder, expect};

const CAMERA: &str = "[camera]\neye = [0.0, -9.0, 2.0]\ntarget = [0.0, 0.0, 0.0]\n[[particles]]\n";

/// What follows the header in line 4; where the fault stands; words of the message.
const BAD: &[(&str, &str, &str)] = &[
    (
        "radios = 1\n",
        "5:1: particles[0].radios",
        "did you mean `radius`?",
    ),
    (
        "radius = 0\n",
        "5:10: particles[0].radius",
        "must be positive",
    ),
    (
        "coefficient = -1\n",
        "5:15: particles[0].coefficient",
        "0 or more",
    ),
    (
        "color = [1, -0.5, 0]\n",
        "5:9: particles[0].color",
        "0 or more",
    ),
    (
        "kernel = \"cones\"\n",
        "5:10: particles[0].kernel",
        "did you mean `cone`?",
    ),
    (
        "points = [[0, 0, 0], [0, nan, 0]]\n",
        "5:10: particles[0].points",
        "particle 1 is at 0, NaN, 0",
    ),
    (
        "points = [[0, 0, 0]]\nfile = \"a.csv\"\n",
        "6:8: particles[0].file",
        "`points` says already where the particles are",
    ),
    (
        "file = \"none.csv\"\n",
        "5:8: particles[0].file",
        "none.csv: cannot read",
    ),
    (
        "points = [[0, 0, 0]]\nradius = { times = [0, 1], values = [0, 1] }\n",
        "6:10: particles[0].radius",
        "must be positive, found 0 (at 0 s)",
    ),
    (
        "points = [[0, 0, 0]]\n[integration]\nreduction = \"rms\"\n",
        "7:13: integration.reduction",
        "particles add up",
    ),
];

#[test]
fn bad_particles_are_refused_with_their_place_and_nothing_is_written() {
    let folder = Folder::new();
    for (text, place, words) in BAD {
        let path = folder.path().join("bad.toml");
        std::fs::write(path, format!("{CAMERA}{text}")).unwrap();
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
