//! Every fault of what changes along a core is named with its place.

use crate::bad_scenes::{CAMERA, check};

/// What follows a valid [camera] of three lines; where the fault stands; words of the message.
const BAD_SERIES: &[(&str, &str, &str)] = &[
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nradii = [0.1]\n",
        "7:9: segment[0].radii",
        "needs at least 2 values, from one end to the other; found 1",
    ),
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nradii = [0.1, -0.2]\n",
        "7:15: segment[0].radii[1]",
        "a core is 0 or more thick; found -0.2",
    ),
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nradii = [0.1, 0.2]\nradius = 0.1\n",
        "7:9: segment[0].radii",
        "take the place of radius: leave one of them out",
    ),
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nradii = [0.1, 0.2]\nprofile = \"gaussian\"\n",
        "7:9: segment[0].radii",
        "go with the profiles inverse, inverse-square and inverse-cube; give a radius instead",
    ),
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nradii = [0.1, 0.5]\nreach = 0.4\n",
        "8:9: segment[0].reach",
        "",
    ),
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\ntaper_lengths = [0.1, -0.2]\n",
        "7:17: segment[0].taper_lengths",
        "light rises over 0 or more from either end; found -0.2",
    ),
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\ntaper_lengths = 0.3\n",
        "7:17: segment[0].taper_lengths",
        "",
    ),
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nintensity = [1, inf]\n",
        "7:17: segment[0].intensity[1]",
        "not a finite number",
    ),
    (
        "[[torus]]\nmajor_radius = 1\nsweep = [90, 30]\n",
        "6:9: torus[0].sweep",
        "goes from one angle to a greater one, by at most 360 degrees; found -60",
    ),
    (
        "[[torus]]\nmajor_radius = 1\nsweep = [0, 400]\n",
        "6:9: torus[0].sweep",
        "by at most 360 degrees; found 400",
    ),
    (
        "[[torus]]\nmajor_radius = 1\nsweep = [0, 90]\nstart = [0, 0, 2]\n",
        "7:9: torus[0].start",
        "lies along the axis: give a direction across it",
    ),
    (
        "[[torus]]\nmajor_radius = 1\ndashes = { count = 0 }\n",
        "6:20: torus[0].dashes.count",
        "0 dashes; give from 1 to 10000",
    ),
    (
        "[[torus]]\nmajor_radius = 1\ndashes = { count = 8, fill = 1.0 }\n",
        "6:30: torus[0].dashes.fill",
        "more than 0 and less than 1; found 1",
    ),
    (
        "[[torus]]\nmajor_radius = 1\ndashes = { fill = 0.4 }\n",
        "6:10: torus[0].dashes.count",
        "required, but missing",
    ),
    (
        "[[beam]]\ndirection = [1, 0, 0]\nintensity = [1, 2]\n",
        "4:1: beam[0].series_length",
        "required with intensity, colors, radii or dashes",
    ),
    (
        "[[beam]]\ndirection = [1, 0, 0]\nradii = [0.1, 0.2]\nseries_length = 2\ntaper_length = 1\n",
        "8:16: beam[0].taper_length",
        "does not go with intensity, colors, radii or dashes",
    ),
    (
        "[[curve]]\ncontrol_points = [[0,0,0],[1,0,0],[2,0,1]]\nintensity = [1, 2, 1]\ndashes = { count = 3 }\n",
        "6:13: curve[0].intensity",
        "goes by the curve's parameter",
    ),
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\narc = { amplitude = -0.1, scale = 1 }\n",
        "7:21: segment[0].arc.amplitude",
        "a core is displaced by 0 or more; found -0.1",
    ),
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\narc = { amplitude = 0.1, scale = 0 }\n",
        "7:34: segment[0].arc.scale",
        "positive",
    ),
    (
        "[[segment]]\nfrom = [0, 0, 0]\nto = [3, 0, 0]\narc = { amplitude = 0.1, scale = 1e-6 }\n",
        "7:34: segment[0].arc.scale",
        "makes 24000000 pieces of a core 3.0000 long and its branches, more than 65536: give at least 3.66e-4",
    ),
    (
        "[[beam]]\ndirection = [1, 0, 0]\nseries_length = 2\narc = { amplitude = 0.1, scale = 1 }\n",
        "7:7: beam[0].arc",
        "displaces cores that end, and a beam does not: draw a [[segment]]",
    ),
    (
        "[[torus]]\nmajor_radius = 1\narc = { amplitude = 0.1, scale = 1, branches = 65 }\n",
        "6:48: torus[0].arc.branches",
        "65 branches; give from 0 to 64",
    ),
    (
        "[[path]]\npoints = [[0, 0, 0], [1, 0, 0]]\narc = { amplitude = 0.1, scale = 1, time = inf }\n",
        "6:44: path[0].arc.time",
        "not a finite number",
    ),
    (
        "[[path]]\npoints = [[0, 0, 0], [1, 0, 0]]\narc = { amplitude = 0.1 }\n",
        "6:7: path[0].arc.scale",
        "required, but missing",
    ),
    (
        "[integration]\nreduction = \"rms\"\n[[segment]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\n\
         arc = { amplitude = 0.1, scale = 1, branches = 2 }\n",
        "9:7: segment[0].arc",
        "even along its core: leave this out",
    ),
    (
        "[[sphere]]\nprofile = \"convolution\"\n",
        "5:11: sphere[0].profile",
        "adds up the light of a [[segment]], [[path]] or [[torus]]; other cores have none",
    ),
    (
        "[[sphere]]\nintensity = [1, 2]\n",
        "5:1: sphere[0].intensity",
        "unknown",
    ),
];

#[test]
fn a_fault_of_a_series_is_named_with_file_line_column_and_key() {
    for (text, place, words) in BAD_SERIES {
        let scene = format!("{CAMERA}{text}");
        let place = format!("scene.toml:{place}");
        check("scene.toml", scene.as_bytes(), &[&place, words]);
    }
}
