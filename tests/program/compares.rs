//! `energywave compare`: its maps of errors.

use energywave::RadianceImage;
use serde_json::Value;

use crate::common::program::{Folder, SCENE, device, expect};

/// Returns the arguments of a small and quick comparison.
fn compare(more: &[&'static str]) -> Vec<&'static str> {
    let mut all = vec!["compare", SCENE, "--size", "40x24", "--seconds", "0"];
    all.extend(["--device", device()]);
    all.extend(more);
    all
}

#[test]
fn the_map_is_of_the_row_of_the_scenes_tolerance() {
    let folder = Folder::new();
    let more = ["--json", "--map", "a.exr", "--map", "b.png"];
    let output = folder.run(&compare(&more));
    expect(&output, 0, "error map: exact, tolerance 1e-3");
    let rows: Value = serde_json::from_slice(&output.stdout).unwrap();
    let row = |tolerance: f64| {
        let rows = rows.as_array().unwrap().iter();
        let mut found = rows.filter(|row| row["tolerance"] == tolerance);
        found.next().unwrap().clone()
    };
    let map = RadianceImage::open(folder.path().join("a.exr")).unwrap();
    let worst = |pixel: &[f32]| f64::from(pixel[..3].iter().copied().fold(0.0, f32::max));
    let max = map.as_slice().chunks(4).map(worst).fold(0.0, f64::max);
    let is_it = |row: &Value| (max / row["max"].as_f64().unwrap() - 1.0).abs() < 1e-6;
    assert!(is_it(&row(1e-3)) && !is_it(&row(1e-2)) && !is_it(&row(1e-4)));
    let place = &row(1e-3)["worst"];
    let place = |axis: usize| place[axis].as_u64().unwrap() as u32;
    assert_eq!(worst(&map.pixel(place(0), place(1)).unwrap()), max);
    let picture = image::open(folder.path().join("b.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (320, 192 + 44));
    assert_eq!(folder.names().len(), 2);
}

#[test]
fn maps_that_cannot_be_written_are_refused_before_the_work() {
    let folder = Folder::new();
    for (name, code, words) in [
        ("errors.gif", 2, "error: errors.gif: unknown output ending"),
        (
            "none/errors.exr",
            7,
            "there is no folder none; create it first",
        ),
        ("-", 2, "error: -: unknown output ending"),
    ] {
        let output = folder.run(&compare(&["--map", "errors.png", "--map", name]));
        expect(&output, code, words);
        assert!(folder.names().is_empty() && output.stdout.is_empty());
    }
}
