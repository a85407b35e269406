//! `[camera]` of matrices in scene files: what is read is what was written, and what cannot be a camera is told with
//! its place.

use energywave::Scene;
use energywave::image::ClipRange;
use energywave::scene::ClipY;

const VIEW: &str = "view = [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, -4], [0, 0, 0, 1]]\n";
const PROJECTION: &str = "projection = [1.5,0,0.2,0, 0,2,0,0, 0,0,0,0.1, 0,0,-1,0]\n";
const ORTHOGRAPHIC: &str = "projection = [[1,0,0,0], [0,1,0,0], [0,0,-0.1,0], [0,0,0,1]]\n";

/// The keys of `[camera]`, the place and key of the fault, and what is said of it.
const BAD: &[(&[&str], &str, &str)] = &[
    (
        &[VIEW],
        "2:8: camera.view",
        "needs a `projection` beside it",
    ),
    (
        &[PROJECTION],
        "2:14: camera.projection",
        "needs a `view` beside it",
    ),
    (
        &[VIEW, PROJECTION, "eye = [0, 1, 2]\n"],
        "4:7: camera.eye",
        "leave one or the other out",
    ),
    (
        &[VIEW, PROJECTION, "fov_y = 30\n"],
        "4:9: camera.fov_y",
        "leave one or the other out",
    ),
    (
        &["eye = [0, 0, 0]\n", "target = [0, 9, 0]\n", PROJECTION],
        "4:14: camera.projection",
        "needs a `view`",
    ),
    (
        &[
            "eye = [0, 0, 0]\n",
            "target = [0, 9, 0]\n",
            "range = \"0..1\"\n",
        ],
        "4:9: camera.range",
        "belongs to `view`",
    ),
    (
        &[VIEW, "projection = [1, 0, 0]\n"],
        "3:14: camera.projection",
        "16 numbers by rows, or 4 rows of 4, found 3 numbers",
    ),
    (
        &[
            "view = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]]\n",
            PROJECTION,
        ],
        "2:8: camera.view",
        "found a row of 3",
    ),
    (
        &["view = [[1, 0, 0, 0]]\n", PROJECTION],
        "2:8: camera.view",
        "found 1 rows",
    ),
    (
        &["view = 5\n", PROJECTION],
        "2:8: camera.view",
        "expected a list",
    ),
    (
        &[VIEW, "projection = [1,0,0,0, 0,1,0,0, 0,0,0,0, 0,0,-1,0]\n"],
        "3:14: camera.projection",
        "singular",
    ),
    (
        &[
            VIEW,
            "projection = [1,0,0,0, 0,1,0,0, 0,0,-1,nan, 0,0,-1,0]\n",
        ],
        "3:14: camera.projection",
        "NaN in row 2, column 3",
    ),
    (
        &[
            "view = [1,0,0,0, 0,inf,0,0, 0,0,1,0, 0,0,0,1]\n",
            PROJECTION,
        ],
        "2:8: camera.view",
        "inf in row 1, column 1",
    ),
    (
        &[
            VIEW,
            "projection = [1,0,0,0, 0,2,0,0, 0,0,-1,-1, 0,0,-0.2,0]\n",
        ],
        "3:14: camera.projection",
        "it looks transposed",
    ),
    (
        &[
            VIEW,
            "projection = [1,0,0,0, 0,2,0,0, 0.5,0,-1,-0.2, 0,0,-1,0]\n",
        ],
        "3:14: camera.projection",
        "neither a perspective nor an orthographic",
    ),
    (
        &[
            "view = [1,0,0,0, 0,0,-1,0, 0,1,0,0, 0,0,-4,1]\n",
            PROJECTION,
        ],
        "2:8: camera.view",
        "its last row is 0 0 -4 1, not 0 0 0 1",
    ),
    (
        &["view = [1,0,0,0, 0,2,0,0, 0,0,1,0, 0,0,0,1]\n", PROJECTION],
        "2:8: camera.view",
        "has no shear",
    ),
    (
        &[VIEW, PROJECTION, "near = -1\n"],
        "4:8: camera.near",
        "must be positive",
    ),
    (
        &[VIEW, PROJECTION, "range = \"1..0\"\n"],
        "4:9: camera.range",
        "expected `0..1` or `-1..1`",
    ),
    (
        &[VIEW, PROJECTION, "y = \"left\"\n"],
        "4:5: camera.y",
        "expected `up` or `down`",
    ),
    (
        &[VIEW, PROJECTION, "jitter = [0, 2]\n"],
        "4:10: camera.jitter",
        "stays within a pixel",
    ),
    (
        &[VIEW, PROJECTION, "jitter = [0]\n"],
        "4:10: camera.jitter",
        "expected two numbers, found 1",
    ),
    (
        &[VIEW, PROJECTION, "zoom = 2\n"],
        "4:1: camera.zoom",
        "unknown field",
    ),
];

fn scene_of(keys: &[&str]) -> String {
    format!("[camera]\n{}", keys.concat())
}

#[test]
fn what_is_no_camera_is_told_with_its_place() {
    let mut wrong = Vec::new();
    for (keys, place, words) in BAD {
        let text = scene_of(keys);
        let found = Scene::from_toml(&text).unwrap_err().to_string();
        let has_place = found.starts_with(&format!("scene:{place}: "));
        if !has_place || !found.contains(words) || found.contains('\n') {
            wrong.push(format!("{text}{found}\nexpected {place}: {words}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn matrices_are_read_as_they_were_written() {
    let rest =
        "range = \"-1..1\"\ny = \"down\"\nnear = 0.2\njitter = [0.25, -0.5]\nray_length = 9\n";
    for projection in [PROJECTION, ORTHOGRAPHIC] {
        let scene = Scene::from_toml(&scene_of(&[VIEW, projection, rest])).unwrap();
        let matrices = scene.camera.matrices.unwrap();
        assert_eq!(matrices.range, Some(ClipRange::MinusOneToOne));
        assert_eq!(matrices.y, Some(ClipY::Down));
        assert_eq!(matrices.view.row(2).to_array(), [0.0, -1.0, 0.0, -4.0]);
        assert_eq!(scene.camera.near, 0.2);
        assert_eq!(scene.camera.jitter.to_array(), [0.25, -0.5]);
        assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene);
        assert_eq!(Scene::from_json(&scene.to_json().unwrap()).unwrap(), scene);
    }
}

#[test]
fn rays_begin_at_the_near_plane_unless_near_says_where() {
    let near = |keys: &[&str]| Scene::from_toml(&scene_of(keys)).unwrap().camera.near;
    assert_eq!(near(&[VIEW, PROJECTION]), 0.1);
    assert_eq!(near(&[VIEW, PROJECTION, "near = 0.5\n"]), 0.5);
    assert_eq!(near(&[VIEW, ORTHOGRAPHIC]), 0.0);
    let finite = "projection = [1,0,0,0, 0,1,0,0, 0,0,-1.25,-2.25, 0,0,-1,0]\n";
    assert_eq!(near(&[VIEW, finite]), 2.25 / 1.25);
    assert_eq!(near(&[VIEW, finite, "range = \"-1..1\"\n"]), 1.0);
}
