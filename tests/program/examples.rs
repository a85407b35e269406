//! Every example runs and draws what it says.

use std::path::{Path, PathBuf};
use std::process::Command;

/// An example's program: cargo builds examples beside the tests.
fn program(name: &str) -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let folder = test.parent().unwrap().parent().unwrap();
    folder.join("examples").join(name)
}

/// The names of what an example leaves in a folder, in order.
fn drawn(name: &str) -> (Vec<String>, tempfile::TempDir) {
    let (names, folder, _) = drawn_and_said(name);
    (names, folder)
}

/// The same, and what it says.
fn drawn_and_said(name: &str) -> (Vec<String>, tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(program(name))
        .arg(folder.path())
        .env("POCL_DEVICES", "pthread pthread") // one CPU as two devices; other drivers do not read it
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {message}");
    let entries = std::fs::read_dir(folder.path()).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    (names, folder, String::from_utf8(output.stdout).unwrap())
}

/// Mean of a picture's bytes, 0 to 255.
fn brightness(path: &Path) -> f64 {
    let bytes = image::open(path).unwrap().into_rgb8().into_raw();
    let sum: f64 = bytes.iter().map(|byte| f64::from(*byte)).sum();
    sum / bytes.len() as f64
}

#[test]
fn minimal_draws_a_ring() {
    let (names, folder) = drawn("minimal");
    assert_eq!(names, ["ring.png"]);
    let mean = brightness(&folder.path().join("ring.png"));
    assert!((10.0..80.0).contains(&mean), "{mean}");
}

#[test]
fn animation_grows_brighter_from_frame_to_frame() {
    let (names, folder) = drawn("animation");
    assert_eq!(names.len(), 24);
    assert_eq!(names[23], "frame-23.png");
    let means: Vec<f64> = names
        .iter()
        .map(|name| brightness(&folder.path().join(name)))
        .collect();
    assert_eq!(means[0], 0.0);
    assert!(
        means.windows(2).all(|pair| pair[0] <= pair[1] + 0.05),
        "{means:?}"
    );
    assert!(means[23] > 20.0, "{means:?}");
}

#[test]
fn hidden_surfaces_draws_tetrahedra_and_their_depths() {
    let (names, folder) = drawn("hidden_surfaces");
    assert_eq!(names, ["hidden-surfaces-depth.exr", "hidden-surfaces.png"]);
    let picture = image::open(folder.path().join("hidden-surfaces.png")).unwrap();
    let picture = picture.into_rgb8();
    // The near tetrahedron stands before the wave, the rest of the picture glows.
    let at = |column, row| {
        picture
            .get_pixel(column, row)
            .0
            .map(u32::from)
            .iter()
            .sum::<u32>()
    };
    assert!(
        3 * at(160, 125) < at(20, 200),
        "{} {}",
        at(160, 125),
        at(20, 200)
    );
}

#[test]
fn host_opencl_draws_into_its_own_image() {
    let (names, folder) = drawn("host_opencl");
    assert_eq!(names, ["host.png"]);
    let picture = image::open(folder.path().join("host.png"))
        .unwrap()
        .into_rgb8();
    assert_eq!(picture.dimensions(), (320, 240));
    // The last ring: orange, paled by the tone map where it is hot, and darker in its middle than on it.
    let [red, _, blue] = picture.get_pixel(160, 155).0;
    let [middle, ..] = picture.get_pixel(160, 120).0;
    assert!(
        red > 150 && u32::from(red) > u32::from(blue) + 30,
        "{red} {blue}"
    );
    assert!(middle < red / 2, "{middle} {red}");
}

#[test]
fn jittered_says_what_it_gains() {
    let (names, _, said) = drawn_and_said("jittered");
    assert_eq!(names, ["figure-14-jittered.png"]);
    let rows = said.lines().skip(1).map(|row| {
        let numbers = row.split_whitespace().skip(1);
        numbers.map(|number| number.parse().unwrap()).collect()
    });
    let rows: Vec<Vec<f64>> = rows.collect();
    assert_eq!(rows.len(), 4, "{said}");
    for pair in rows.chunks(2) {
        let [simpson, jittered] = pair else {
            panic!("{said}")
        };
        assert_eq!(simpson[0], jittered[0]);
        assert!(
            jittered[2] < 0.8 * simpson[2] && jittered[2] < jittered[1],
            "{said}"
        );
    }
}

#[test]
fn several_devices_share_a_picture() {
    let (names, folder, said) = drawn_and_said("several_devices");
    assert_eq!(names, ["curve.png"]);
    let mean = brightness(&folder.path().join("curve.png"));
    assert!((10.0..120.0).contains(&mean), "{mean}");
    if said.contains("pthread") {
        assert!(
            said.starts_with("frame 0: rows 0..192 by 0: pthread"),
            "{said}"
        );
        assert_eq!(said.lines().count(), 16, "{said}");
    }
}

#[test]
fn sparks_draws_a_million_points_that_a_host_moves() {
    let (names, folder, said) = drawn_and_said("sparks");
    assert_eq!(names, ["sparks-0.png", "sparks-1.png", "sparks-2.png"]);
    assert_eq!(said.matches("1000000 sparks moved").count(), 3, "{said}");
    let [first, last] = ["sparks-0.png", "sparks-2.png"]
        .map(|name| image::open(folder.path().join(name)).unwrap().into_rgb8());
    assert_ne!(first, last);
    // Hot in the middle, dark in the corners.
    let sum = |column, row| {
        last.get_pixel(column, row)
            .0
            .map(u32::from)
            .iter()
            .sum::<u32>()
    };
    assert!(
        sum(480, 270) > 2 * sum(2, 2),
        "{} {}",
        sum(480, 270),
        sum(2, 2)
    );
}
